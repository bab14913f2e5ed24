//! Any driver behind the shield.

use super::{Driver, DriverFactory, View, observe, scene};
use cede_controller::{Cause, Contract, Scene, Shield};
use cede_data::encounter::Encounter;

/// Passes what another kind of driver wants through the shield that the controller carries.
pub struct Shielded {
    drivers: Box<dyn DriverFactory>,
    contract: Contract,
}

impl Shielded {
    /// Shields `drivers` under `contract`.
    #[must_use]
    pub fn new(drivers: Box<dyn DriverFactory>, contract: Contract) -> Self {
        Self { drivers, contract }
    }
}

impl DriverFactory for Shielded {
    fn name(&self) -> &str {
        self.drivers.name()
    }

    fn driver(&self, encounter: &Encounter, ego: usize, seed: u64) -> Box<dyn Driver> {
        let driver = self.drivers.driver(encounter, ego, seed);
        match scene(encounter, ego) {
            Some(scene) => Box::new(Behind {
                driver,
                shield: Shield::new(self.contract),
                scene,
                cause: Cause::Policy,
            }),
            // With nobody to meet there is nothing to shield from.
            None => driver,
        }
    }
}

struct Behind {
    driver: Box<dyn Driver>,
    shield: Shield<1>,
    scene: Scene<1>,
    cause: Cause,
}

impl Driver for Behind {
    fn accelerate(&mut self, view: &View<'_>) -> f32 {
        let wanted = self.driver.accelerate(view);
        let Some(seen) = observe(view) else {
            self.cause = Cause::Policy;
            return wanted;
        };
        let decision = self.shield.filter(&self.scene, &seen, wanted);
        self.cause = decision.cause;
        decision.acceleration
    }

    fn cause(&self) -> Cause {
        self.cause
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::InitialSpeed;
    use crate::episode::{End, Episode};
    use crate::evaluate::clearance;
    use crate::fixture::crossing;
    use crate::metrics::Measures;
    use cede_data::encounter::Role;

    #[test]
    fn one_shielded_vehicle_prevents_the_collision_that_two_blind_ones_have() {
        let encounter = crossing([40.0, 8.0], [40.0, 8.0]);
        let run = |first: &dyn DriverFactory| {
            let mut drivers = [
                first.driver(&encounter, 0, 0),
                InitialSpeed.driver(&encounter, 1, 0),
            ];
            Episode::run(&encounter, &mut drivers, Some(clearance(&encounter)))
        };
        assert_eq!(run(&InitialSpeed).end, End::Collision);
        let shielded = Shielded::new(Box::new(InitialSpeed), Contract::WORST_CASE);
        let episode = run(&shielded);
        assert_ne!(episode.end, End::Collision);
        assert!(Measures::of(&encounter, &episode, &[Role::Left]).shielded > 0.0);
    }
}
