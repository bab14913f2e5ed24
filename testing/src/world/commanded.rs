//! A vehicle that is commanded: commands take effect late, and no harder than the vehicle can.

use super::motion::State;
use crate::vehicle::Truth;
use std::collections::VecDeque;

/// The ego, or another that has a shield.
#[derive(Clone, Debug)]
pub(crate) struct Commanded {
    pub(crate) state: State,
    /// What the actuator does, in m/s².
    acceleration: f64,
    /// Commands (m/s²) on their way, each with the seconds that are left until it takes effect.
    coming: VecDeque<(f64, f64)>,
}

impl Commanded {
    pub(crate) fn new(state: State) -> Self {
        Self {
            state,
            acceleration: 0.0,
            coming: VecDeque::new(),
        }
    }

    /// Gives `command` (m/s²), which takes effect `late` seconds from now, and not before those before it.
    pub(crate) fn command(&mut self, command: f32, late: f64) {
        let last = self.coming.back().map_or(0.0, |(left, _)| *left);
        self.coming.push_back((late.max(last), command.into()));
    }

    /// Moves on by `time` (s), within what is true of the vehicle.
    pub(crate) fn advance(&mut self, truth: &Truth, mut time: f64) {
        while let Some(&(left, command)) = self.coming.front().filter(|(left, _)| *left <= time) {
            self.coast(truth, left);
            self.acceleration = command;
            time -= left;
            self.coming.pop_front();
        }
        self.coast(truth, time);
    }

    fn coast(&mut self, truth: &Truth, time: f64) {
        let acceleration = self.acceleration.clamp(-truth.braking, truth.acceleration);
        self.state = self.state.after(acceleration, time, f64::INFINITY);
        for (left, _) in &mut self.coming {
            *left -= time;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cede_controller::Contract;

    #[test]
    fn commands_take_effect_in_their_order_and_within_what_is_achieved() {
        let truth = Truth {
            braking: 2.0,
            ..Truth::as_contracted(&Contract::WORST_CASE)
        };
        let mut ego = Commanded::new(State { s: 0.0, v: 10.0 });
        ego.command(1.0, 0.1);
        ego.advance(&truth, 0.1);
        assert!((ego.state.v - 10.0).abs() < 1e-9);
        ego.command(-3.0, 0.0);
        ego.advance(&truth, 0.1);
        assert!((ego.state.v - 9.8).abs() < 1e-9, "{}", ego.state.v);
    }
}
