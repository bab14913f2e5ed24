//! The one trait behind which human models, baselines, replay and the controller sit.
//!
//! A [`DriverFactory`] makes one [`Driver`] for each vehicle and episode; a
//! [`Baseline`] names the rule-based ones and fits those that learn from
//! recorded encounters.

mod baseline;
mod constant;
mod controller;
mod human;
pub(crate) mod idm;
mod logistic;
mod nearer_first;
mod policy_alone;
mod replay;
mod right_of_way;
mod rule_of_the_road;
mod shielded;

pub use baseline::{Baseline, FitError, UnknownBaseline};
pub use constant::{InitialSpeed, MeanSpeed};
pub use controller::Cede;
pub use human::Human;
pub use idm::Idm;
pub use logistic::Logistic;
pub use nearer_first::NearerFirst;
pub use policy_alone::PolicyAlone;
pub use replay::Replay;
pub use rule_of_the_road::RuleOfTheRoad;
pub use shielded::Shielded;

use crate::meeting::Meeting;
use cede_controller::Cause;
use cede_controller::kinematics::State;
use cede_data::encounter::{Encounter, Participant};

/// What a driver sees when it decides.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// The encounter with its routes.
    pub encounter: &'a Encounter,
    /// Steps since the encounter's start.
    pub step: u32,
    /// Index of the driver's own vehicle in `states` and in the encounter's participants.
    pub ego: usize,
    /// State of every participant; `None` while it is not there.
    pub states: &'a [Option<State>],
}

impl View<'_> {
    /// State of participant `index`; `None` while it is not there.
    #[must_use]
    pub fn state(&self, index: usize) -> Option<State> {
        self.states.get(index).copied().flatten()
    }

    /// The driver's own vehicle and its state; `None` if it is not there.
    #[must_use]
    pub fn own(&self) -> Option<(&Participant, State)> {
        self.participant(self.ego)
    }

    /// The judged vehicle that a judged vehicle meets, and its state; `None` if it is not there.
    #[must_use]
    pub fn rival(&self) -> Option<(&Participant, State)> {
        self.participant(1_usize.checked_sub(self.ego)?)
    }

    fn participant(&self, index: usize) -> Option<(&Participant, State)> {
        Some((self.encounter.participants.get(index)?, self.state(index)?))
    }
}

/// Drives one vehicle through one encounter.
pub trait Driver {
    /// The acceleration (m/s²) for the step that begins now. The simulation clamps it to [−3, 3].
    fn accelerate(&mut self, view: &View<'_>) -> f32;

    /// Who chose the acceleration of the step that was decided last: the driver itself, or a safety
    /// shield in its stead, and why. Others are told by their numbers in [`View::states`].
    fn cause(&self) -> Cause {
        Cause::Policy
    }
}

/// Makes drivers of one kind, one for each vehicle and encounter.
pub trait DriverFactory: Sync {
    /// Name on the command line and in tables, as in `nearer-first`.
    fn name(&self) -> &str;

    /// A driver for participant `ego` of an encounter; every random choice it makes comes from `seed`.
    fn driver<'m>(&self, meeting: &'m Meeting<'_>, ego: usize, seed: u64) -> Box<dyn Driver + 'm>;
}
