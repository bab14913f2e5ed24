//! The controller's policy without its shield: what the shield is compared with.

use super::controller::{Refused, Sensed, around, part};
use super::{Driver, DriverFactory, View};
use crate::meeting::{Meeting, path};
use crate::observation_model::Bystanders;
use cede_controller::{Approach, Contract, Drive, Policy};

/// Cede without the shield: for comparison, never for a vehicle.
#[derive(Clone, Debug)]
pub struct PolicyAlone {
    policy: Policy<'static>,
}

impl PolicyAlone {
    /// Drives with `policy`.
    #[must_use]
    pub const fn new(policy: Policy<'static>) -> Self {
        Self { policy }
    }
}

impl DriverFactory for PolicyAlone {
    fn name(&self) -> &str {
        "cede"
    }

    fn driver<'m>(&self, meeting: &'m Meeting<'_>, ego: usize, _: u64) -> Box<dyn Driver + 'm> {
        // The contract is not looked at: only the shield does.
        let drive = Drive::new(self.policy, Contract::WORST_CASE, part(ego));
        match drive.enter_with_room(&meeting.junction, path(ego)) {
            Ok(approach) => Box::new(Alone {
                approach,
                bystanders: Bystanders::new(meeting.encounter, ego),
            }),
            Err(_) => Box::new(Refused),
        }
    }
}

struct Alone<'m> {
    approach: Approach<'m, 'static, 1>,
    bystanders: Bystanders,
}

impl Driver for Alone<'_> {
    fn accelerate(&mut self, view: &View<'_>) -> f32 {
        self.approach.set_traffic(around(&self.bystanders, view));
        Sensed::of(view).map_or(0.0, |seen| self.approach.proposal(&seen.observation()))
    }
}
