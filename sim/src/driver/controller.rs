//! The controller itself, as a driver: the code that runs in the vehicle.

use super::{Driver, DriverFactory, View};
use crate::observation_model::{Bystanders, scene};
use cede_controller::kinematics::State;
use cede_controller::{
    Cause, Contract, Controller, Decision, Observation, Part, Policy, Scene, TrafficContext,
    Vehicle,
};
use cede_data::encounter::{Encounter, Role};

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

    fn driver(&self, encounter: &Encounter, ego: usize, _: u64) -> Box<dyn Driver> {
        match scene(encounter, ego) {
            Some(scene) => Box::new(Seat {
                controller: Controller::new(self.policy, self.contract, part(ego)),
                scene,
                bystanders: Bystanders::new(encounter, ego),
                last: None,
            }),
            // Without a vehicle to meet there is nothing to decide.
            None => Box::new(Nobody),
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

/// What vehicle `view.ego` senses of itself and the one that it meets; `None` if it is not there itself.
#[must_use]
pub fn observe(view: &View<'_>) -> Option<Observation<1>> {
    let vehicle = |(participant, state): (&cede_data::Participant, State)| Vehicle {
        s: state.s,
        speed: state.v,
        pose: participant.route.pose(state.s),
    };
    Some(Observation {
        ego: vehicle(view.own()?),
        others: [view.rival().map(vehicle)],
    })
}

/// What the bystanders are to vehicle `view.ego` now.
pub(super) fn around(bystanders: &Bystanders, view: &View<'_>) -> TrafficContext {
    view.own()
        .map_or_else(TrafficContext::default, |(_, state)| {
            bystanders.around(view.encounter, view.step as usize, state.s)
        })
}

struct Seat {
    controller: Controller<'static, 1>,
    scene: Scene<1>,
    bystanders: Bystanders,
    last: Option<Decision>,
}

impl Driver for Seat {
    fn accelerate(&mut self, view: &View<'_>) -> f32 {
        self.controller.set_traffic(around(&self.bystanders, view));
        self.last = observe(view).map(|seen| self.controller.decide(&self.scene, &seen));
        self.last.map_or(0.0, |decision| decision.acceleration)
    }

    fn cause(&self) -> Cause {
        self.last.map_or(Cause::Policy, |decision| decision.cause)
    }
}

struct Nobody;

impl Driver for Nobody {
    fn accelerate(&mut self, _: &View<'_>) -> f32 {
        0.0
    }
}
