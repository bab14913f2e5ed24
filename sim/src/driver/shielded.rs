//! Any driver behind the shield.

use super::controller::{Refused, Sensed};
use super::{Driver, DriverFactory, View};
use crate::meeting::{Meeting, instant, path};
use cede_controller::{Cause, Contract, Shield};

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

    fn driver<'m>(&self, meeting: &'m Meeting<'_>, ego: usize, seed: u64) -> Box<dyn Driver + 'm> {
        let driver = self.drivers.driver(meeting, ego, seed);
        match Shield::enter(self.contract, &meeting.junction, path(ego)) {
            Ok(shield) => Box::new(Behind {
                driver,
                shield,
                cause: Cause::Policy,
            }),
            Err(_) => Box::new(Refused),
        }
    }
}

struct Behind<'m> {
    driver: Box<dyn Driver + 'm>,
    shield: Shield<'m, 1>,
    cause: Cause,
}

impl Driver for Behind<'_> {
    fn accelerate(&mut self, view: &View<'_>) -> f32 {
        let wanted = self.driver.accelerate(view);
        let Some(seen) = Sensed::of(view) else {
            self.cause = Cause::Policy;
            return wanted;
        };
        if let Some(gone) = seen.gone() {
            self.shield.forget(gone);
        }
        let decision = self
            .shield
            .filter(instant(view.step), &seen.observation(), wanted);
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
        let meeting = Meeting::new(&encounter).unwrap();
        let run = |first: &dyn DriverFactory| {
            let mut drivers = [
                first.driver(&meeting, 0, 0),
                InitialSpeed.driver(&meeting, 1, 0),
            ];
            Episode::run(&encounter, &mut drivers, Some(clearance(&meeting)))
        };
        assert_eq!(run(&InitialSpeed).end, End::Collision);
        let shielded = Shielded::new(Box::new(InitialSpeed), Contract::WORST_CASE);
        let episode = run(&shielded);
        assert_ne!(episode.end, End::Collision);
        assert!(Measures::of(&encounter, &episode, &[Role::Left]).shielded > 0.0);
    }
}
