//! The controller itself, as a driver: the code that runs in the vehicle.

use super::{Driver, DriverFactory, View};
use crate::meeting::{Meeting, REACH, instant, path, sensed};
use crate::observation_model::Bystanders;
use cede_controller::kinematics::{MAX_ACCELERATION, State};
use cede_controller::{
    Approach, Cause, Contract, Decision, Drive, Fault, Observation, Part, Policy, Track,
    TrafficContext, Vehicle,
};
use cede_data::encounter::Role;

/// Cede: a policy behind the shield. Each vehicle considers the one that it meets;
/// its policy also knows the traffic around them.
#[derive(Clone, Debug)]
pub struct Cede {
    policy: Policy<'static>,
    contract: Contract,
}

impl Cede {
    /// Drives with `policy`; the shield assumes `contract`.
    #[must_use]
    pub const fn new(policy: Policy<'static>, contract: Contract) -> Self {
        Self { policy, contract }
    }
}

impl DriverFactory for Cede {
    fn name(&self) -> &str {
        "cede"
    }

    fn driver<'m>(&self, meeting: &'m Meeting<'_>, ego: usize, _: u64) -> Box<dyn Driver + 'm> {
        let drive = Drive::new(self.policy, self.contract, part(ego));
        match drive.enter_with_room(&meeting.junction, path(ego)) {
            Ok(approach) => Box::new(Seat {
                approach,
                bystanders: Bystanders::new(meeting.encounter, ego),
                last: None,
            }),
            Err(_) => Box::new(Refused),
        }
    }
}

/// The part that a joint policy gives judged vehicle `ego`.
pub(super) const fn part(ego: usize) -> Part {
    if ego == Role::Left as usize {
        Part::Left
    } else {
        Part::Other
    }
}

/// What a judged vehicle senses of itself and of the one that it meets, whose track number is its number in
/// [`View::states`].
pub(super) struct Sensed {
    ego: Vehicle,
    rival: u16,
    track: Option<Track>,
}

impl Sensed {
    /// What vehicle `view.ego` senses; `None` if it is not there itself, or has left the junction.
    pub(super) fn of(view: &View<'_>) -> Option<Self> {
        let inside = |(_, state): &(&cede_data::Participant, State)| state.s < REACH;
        let (own, state) = view.own().filter(inside)?;
        let index = 1_usize.checked_sub(view.ego)?;
        let rival = index as u16;
        let on = |(participant, state): (&cede_data::Participant, _)| {
            Track::on(rival, path(index), sensed(&participant.route, state))
        };
        Some(Self {
            ego: sensed(&own.route, state),
            rival,
            track: view.rival().filter(inside).map(on),
        })
    }

    pub(super) fn observation(&self) -> Observation<'_> {
        Observation {
            ego: self.ego,
            tracks: self.track.as_slice(),
        }
    }

    /// Track number of the other, if it is known not to be there any more.
    pub(super) const fn gone(&self) -> Option<u16> {
        match self.track {
            Some(_) => None,
            None => Some(self.rival),
        }
    }
}

/// What the bystanders are to vehicle `view.ego` now.
pub(super) fn around(bystanders: &Bystanders, view: &View<'_>) -> TrafficContext {
    view.own()
        .map_or_else(TrafficContext::default, |(_, state)| {
            bystanders.around(view.encounter, view.step as usize, state.s)
        })
}

struct Seat<'m> {
    approach: Approach<'m, 'static, 1>,
    bystanders: Bystanders,
    last: Option<Decision>,
}

impl Driver for Seat<'_> {
    fn accelerate(&mut self, view: &View<'_>) -> f32 {
        self.approach.set_traffic(around(&self.bystanders, view));
        self.last = Sensed::of(view).map(|seen| {
            if let Some(gone) = seen.gone() {
                self.approach.forget(gone);
            }
            self.approach
                .decide(instant(view.step), &seen.observation())
        });
        self.last.map_or(0.0, |decision| decision.acceleration)
    }

    fn cause(&self) -> Cause {
        self.last.map_or(Cause::Policy, |decision| decision.cause)
    }
}

/// Stands in for a driver whose shield cannot enter the junction: nothing is promised, and it stops.
pub(super) struct Refused;

impl Driver for Refused {
    fn accelerate(&mut self, _: &View<'_>) -> f32 {
        -MAX_ACCELERATION
    }

    fn cause(&self) -> Cause {
        Cause::Fallback(Fault::NoPlan)
    }
}
