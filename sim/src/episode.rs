//! One episode: drivers take over the two judged vehicles from their recorded initial states.

use crate::driver::{Driver, View};
use crate::stepper::{Stepper, first};
use cede_controller::Cause;
use cede_controller::kinematics::{State, clamp_acceleration};
use cede_data::encounter::{Encounter, Role};

pub use crate::stepper::End;

/// When an episode is over, if neither a collision nor a time-out ends it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Until {
    /// When the first of the two reaches its conflict point: the paper's protocol.
    Conflict,
    /// When both have left the conflict zone: catches the collisions that the paper's protocol cannot.
    Cleared,
}

/// What happened in an episode, step by step.
#[derive(Clone, Debug)]
pub struct Episode {
    /// How it ended.
    pub end: End,
    /// When each reached its conflict point, in steps from the start and within the step by linear interpolation.
    pub arrivals: [Option<f32>; 2],
    /// States of both at the start and after each step: one more than steps.
    pub states: Vec<[State; 2]>,
    /// What both did in each step.
    pub actions: Vec<[Action; 2]>,
}

/// What a vehicle did in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Action {
    /// The acceleration (m/s²) that it was given, within ±3.
    pub acceleration: f32,
    /// Who chose it: the driver ([`Cause::Policy`]), or a safety shield, and why. The only other that a
    /// judged vehicle's shield knows is the other judged one, whose number is 0 or 1, as in [`Episode::states`].
    pub cause: Cause,
}

impl Action {
    /// Whether a safety shield chose it.
    #[must_use]
    pub fn shielded(&self) -> bool {
        self.cause != Cause::Policy
    }
}

impl Episode {
    /// Lets `drivers` drive the two judged vehicles of `encounter`, at 10 Hz; bystanders are replayed.
    ///
    /// `clearance` holds the arc lengths (m) at which the two have left the conflict zone, and
    /// makes the episode run until then; without it the episode ends at the conflict point.
    /// Both vehicles are 5.0 m × 2.0 m, as the paper's. An encounter that begins at the conflict point,
    /// or with a touch, ends in its first step.
    #[must_use]
    pub fn run(
        encounter: &Encounter,
        drivers: &mut [Box<dyn Driver + '_>; 2],
        clearance: Option<[f32; 2]>,
    ) -> Self {
        let stepper = Stepper::new(encounter, clearance);
        let mut world = World::new(encounter, stepper.start());
        let mut episode = Self {
            end: End::TimeOut,
            arrivals: [None; 2],
            states: vec![stepper.start()],
            actions: Vec::new(),
        };
        loop {
            world.replay_bystanders(episode.steps());
            let actions = world.decide(episode.steps(), drivers);
            let accelerations = actions.map(|action| action.acceleration);
            let step = stepper.step(episode.actions.len(), episode.last(), accelerations);
            for (known, new) in episode.arrivals.iter_mut().zip(step.arrivals()) {
                *known = known.or(new);
            }
            episode.actions.push(actions);
            episode.states.push(step.states);
            if let Some(end) = step.end() {
                episode.end = end;
                return episode;
            }
            world.place(step.states);
        }
    }

    /// Steps that the episode took.
    #[must_use]
    pub fn steps(&self) -> u32 {
        self.actions.len() as u32
    }

    /// Who reached its conflict point first; `None` if nobody did.
    #[must_use]
    pub fn first(&self) -> Option<Role> {
        first(self.arrivals)
    }

    fn last(&self) -> [State; 2] {
        self.states[self.states.len() - 1]
    }
}

/// The states of all participants while an episode runs.
struct World<'a> {
    encounter: &'a Encounter,
    states: Vec<Option<State>>,
}

impl<'a> World<'a> {
    fn new(encounter: &'a Encounter, judged: [State; 2]) -> Self {
        let mut world = Self {
            encounter,
            states: vec![None; encounter.participants.len()],
        };
        world.place(judged);
        world
    }

    fn place(&mut self, judged: [State; 2]) {
        for (place, state) in self.states.iter_mut().zip(judged) {
            *place = Some(state);
        }
    }

    fn replay_bystanders(&mut self, step: u32) {
        let bystanders = self.encounter.participants.iter().zip(&mut self.states);
        for (vehicle, state) in bystanders.skip(2) {
            *state = vehicle.recorded(step).map(|sample| State {
                s: sample.s,
                v: sample.v,
            });
        }
    }

    fn decide(&self, step: u32, drivers: &mut [Box<dyn Driver + '_>; 2]) -> [Action; 2] {
        [0, 1].map(|ego| {
            let view = View {
                encounter: self.encounter,
                step,
                ego,
                states: &self.states,
            };
            Action {
                acceleration: clamp_acceleration(drivers[ego].accelerate(&view)),
                cause: drivers[ego].cause(),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::{DriverFactory, InitialSpeed, Replay};
    use crate::evaluate::clearance;
    use crate::fixture::crossing;
    use crate::meeting::Meeting;

    /// Always asks for the same acceleration.
    struct Constant(f32);

    impl Driver for Constant {
        fn accelerate(&mut self, _: &View<'_>) -> f32 {
            self.0
        }
    }

    fn constant(left: f32, other: f32) -> [Box<dyn Driver>; 2] {
        [Box::new(Constant(left)), Box::new(Constant(other))]
    }

    #[test]
    fn the_first_arrival_ends_the_papers_episode_and_is_interpolated() {
        // 20 m at 8 m/s: 2.5 s; 30 m at 8 m/s: 3.75 s.
        let encounter = crossing([20.0, 8.0], [30.0, 8.0]);
        let meeting = Meeting::new(&encounter).unwrap();
        let mut drivers = [0, 1].map(|i| InitialSpeed.driver(&meeting, i, 0));
        let episode = Episode::run(&encounter, &mut drivers, None);
        assert_eq!(episode.end, End::Finished);
        assert_eq!(episode.first(), Some(Role::Left));
        assert_eq!(episode.states.len(), episode.actions.len() + 1);
        assert!((episode.arrivals[0].unwrap() - 25.0).abs() < 1e-3);
        assert_eq!(episode.arrivals[1], None);
    }

    #[test]
    fn replay_of_the_record_is_the_record() {
        let encounter = crossing([33.0, 7.0], [30.0, 9.0]);
        let meeting = Meeting::new(&encounter).unwrap();
        let mut drivers = [0, 1].map(|i| Replay.driver(&meeting, i, 0));
        let episode = Episode::run(&encounter, &mut drivers, None);
        assert_eq!(episode.steps(), encounter.steps);
        assert_eq!(episode.first(), Some(encounter.first));
    }

    #[test]
    fn a_face_off_is_a_time_out_at_twice_the_recorded_length() {
        let encounter = crossing([20.0, 5.0], [30.0, 5.0]);
        let episode = Episode::run(&encounter, &mut constant(-3.0, -3.0), None);
        assert_eq!(episode.end, End::TimeOut);
        assert_eq!(episode.steps(), 2 * encounter.steps);
        assert_eq!(episode.first(), None);
    }

    #[test]
    fn only_an_episode_that_runs_on_sees_the_collision_behind_the_conflict_point() {
        let encounter = crossing([20.0, 5.0], [20.0, 5.0]);
        let paper = Episode::run(&encounter, &mut constant(0.0, 0.0), None);
        assert_eq!(paper.end, End::Finished);
        let exits = clearance(&Meeting::new(&encounter).unwrap());
        let on = Episode::run(&encounter, &mut constant(0.0, 0.0), Some(exits));
        assert_eq!(on.end, End::Collision);
        assert!(on.arrivals.iter().all(Option::is_some));
    }

    #[test]
    fn both_leave_the_zone_in_a_cleared_episode() {
        let encounter = crossing([20.0, 8.0], [40.0, 8.0]);
        let exits = clearance(&Meeting::new(&encounter).unwrap());
        // Half a length and half a width beyond the crossing at s = 100 m.
        for exit in exits {
            assert!((103.5..=104.5).contains(&exit), "{exit}");
        }
        let episode = Episode::run(&encounter, &mut constant(0.0, 0.0), Some(exits));
        assert_eq!(episode.end, End::Finished);
        let last = episode.last();
        assert!((0..2).all(|i| last[i].s >= exits[i]));
    }

    #[test]
    fn what_a_driver_asks_for_is_clamped() {
        let encounter = crossing([20.0, 8.0], [40.0, 8.0]);
        let episode = Episode::run(&encounter, &mut constant(50.0, f32::NAN), None);
        let asked = episode.actions[0].map(|action| action.acceleration);
        assert_eq!(asked, [3.0, -3.0]);
    }
}
