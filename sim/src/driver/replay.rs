//! Replay of recorded accelerations: the floor of the simulator's own error.

use super::{Driver, DriverFactory, View};
use crate::meeting::Meeting;

/// Applies the recorded accelerations step by step, whatever the others do; past the record's end, none.
#[derive(Clone, Copy, Debug)]
pub struct Replay;

impl DriverFactory for Replay {
    fn name(&self) -> &str {
        "replay"
    }

    fn driver<'m>(&self, _: &'m Meeting<'_>, _: usize, _: u64) -> Box<dyn Driver + 'm> {
        Box::new(*self)
    }
}

impl Driver for Replay {
    fn accelerate(&mut self, view: &View<'_>) -> f32 {
        view.own()
            .and_then(|(own, _)| own.recorded(view.step))
            .map_or(0.0, |sample| sample.a)
    }
}
