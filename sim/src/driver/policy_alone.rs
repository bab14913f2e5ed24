//! The controller's policy without its shield: what the shield is compared with.

use super::controller::{around, part};
use super::{Driver, DriverFactory, View, observe, scene};
use crate::observation_model::Bystanders;
use cede_controller::{Contract, Controller, Policy, Scene};
use cede_data::encounter::Encounter;

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

    fn driver(&self, encounter: &Encounter, ego: usize, _: u64) -> Box<dyn Driver> {
        // The contract is not looked at: only the shield does.
        let controller = Controller::new(self.policy, Contract::WORST_CASE, part(ego));
        Box::new(Alone {
            seat: scene(encounter, ego).map(|scene| (controller, scene)),
            bystanders: Bystanders::new(encounter, ego),
        })
    }
}

struct Alone {
    seat: Option<(Controller<'static, 1>, Scene<1>)>,
    bystanders: Bystanders,
}

impl Driver for Alone {
    fn accelerate(&mut self, view: &View<'_>) -> f32 {
        let Some((controller, scene)) = &mut self.seat else {
            return 0.0;
        };
        controller.set_traffic(around(&self.bystanders, view));
        observe(view).map_or(0.0, |seen| controller.proposal(scene, &seen))
    }
}
