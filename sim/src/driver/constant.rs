//! Two drivers without eyes: they keep a speed.

use super::{Driver, DriverFactory, View};
use crate::meeting::Meeting;
use cede_controller::kinematics::STEP;
use cede_data::encounter::{Encounter, Manoeuvre, Role};
use std::collections::HashMap;

/// Keeps the speed that the vehicle had at the start.
#[derive(Clone, Copy, Debug)]
pub struct InitialSpeed;

impl DriverFactory for InitialSpeed {
    fn name(&self) -> &str {
        "initial-speed"
    }

    fn driver<'m>(&self, _: &'m Meeting<'_>, _: usize, _: u64) -> Box<dyn Driver + 'm> {
        Box::new(*self)
    }
}

impl Driver for InitialSpeed {
    fn accelerate(&mut self, _: &View<'_>) -> f32 {
        0.0
    }
}

/// Keeps the mean recorded speed (m/s) of vehicles in its role with its manoeuvre.
#[derive(Clone, Debug)]
pub struct MeanSpeed {
    speeds: HashMap<(Role, Manoeuvre), f32>,
    /// For a role and manoeuvre that did not occur in training.
    overall: f32,
}

impl MeanSpeed {
    /// Means over every recorded step of the judged vehicles until the first reached its conflict
    /// point; `None` without such a step.
    #[must_use]
    pub fn fit(training: &[&Encounter]) -> Option<Self> {
        let mut sums: HashMap<(Role, Manoeuvre), (f64, f64)> = HashMap::new();
        let mut all = (0.0, 0.0);
        for encounter in training {
            for role in Role::BOTH {
                let vehicle = encounter.judged(role);
                let sum = sums.entry((role, vehicle.manoeuvre)).or_default();
                for sample in vehicle.record.iter().take(encounter.steps as usize) {
                    for sum in [&mut *sum, &mut all] {
                        sum.0 += f64::from(sample.v);
                        sum.1 += 1.0;
                    }
                }
            }
        }
        let mean = |(sum, n): (f64, f64)| (sum / n) as f32;
        (all.1 > 0.0).then(|| Self {
            overall: mean(all),
            speeds: sums
                .into_iter()
                .filter(|(_, sum)| sum.1 > 0.0)
                .map(|(key, sum)| (key, mean(sum)))
                .collect(),
        })
    }
}

impl DriverFactory for MeanSpeed {
    fn name(&self) -> &str {
        "mean-speed"
    }

    fn driver<'m>(&self, meeting: &'m Meeting<'_>, ego: usize, _: u64) -> Box<dyn Driver + 'm> {
        let encounter = meeting.encounter;
        let speed = Role::BOTH
            .get(ego)
            .and_then(|&role| self.speeds.get(&(role, encounter.judged(role).manoeuvre)));
        Box::new(Keep {
            speed: *speed.unwrap_or(&self.overall),
        })
    }
}

/// Takes up a speed as fast as it may, and keeps it.
struct Keep {
    speed: f32,
}

impl Driver for Keep {
    fn accelerate(&mut self, view: &View<'_>) -> f32 {
        view.own()
            .map_or(0.0, |(_, state)| (self.speed - state.v) / STEP)
    }
}
