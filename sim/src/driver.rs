//! The one trait behind which human models, baselines, replay and the controller sit.

use crate::encounter::Encounter;

/// State of a vehicle along its route.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Arc length in metres.
    pub s: f32,
    /// Speed in m/s, never negative.
    pub v: f32,
}

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

/// Drives one vehicle through one encounter.
pub trait Driver {
    /// The acceleration (m/s²) for the step that begins now. The simulation clamps it to [−3, 3].
    fn accelerate(&mut self, view: &View<'_>) -> f32;
}

/// Makes drivers of one kind, one for each vehicle and encounter.
pub trait DriverFactory: Sync {
    /// Name on the command line and in tables, as in `nearer-first`.
    fn name(&self) -> &str;

    /// A driver for participant `ego` of `encounter`; every random choice it makes comes from `seed`.
    fn driver(&self, encounter: &Encounter, ego: usize, seed: u64) -> Box<dyn Driver>;
}
