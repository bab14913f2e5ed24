//! What is measured on one episode against its record.

mod deviation;
mod svo;
mod ttc;

pub use svo::{recorded_states, svo_series};
pub(crate) use ttc::half_diagonal;
pub use ttc::{HORIZON as TTC_HORIZON, least_ttc};

use crate::episode::{Action, End, Episode};
use cede_controller::Footprint;
use cede_controller::kinematics::STEP;
use cede_data::encounter::{Encounter, Role};

/// Horizons of the position error in seconds.
pub const HORIZONS: [u32; 3] = [1, 3, 5];

/// The measures of one episode.
///
/// Those of a vehicle's own motion (position, jerk, shield) are taken over the
/// vehicles under test alone: both in joint mode, the ego in ego mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// Whether the vehicle that arrived first is the recorded one; collisions and time-outs are wrong.
    pub correct: bool,
    /// Steps l until the first arrival, or until the episode ended without one; at most 2 l_GT.
    pub length: u32,
    /// |l − l_GT| / l_GT, in [0, 1] but for very short records.
    pub length_error: f64,
    /// |l − l_GT| in seconds.
    pub length_error_s: f64,
    /// Root mean square of the position error along the route (m) after 1, 3 and 5 s; `None` once
    /// the episode or the record is over.
    pub position_error: [Option<f64>; 3],
    /// The same over the whole episode.
    pub position_rmse: f64,
    /// Root mean square error of the SVO (rad) while both are short of their conflict points.
    pub svo_rmse: Option<f64>,
    /// | PET − recorded PET | in seconds; `None` if not both arrived.
    pub pet_error: Option<f64>,
    /// Least time (s) in which the two would have touched at constant speed; `None` above [`TTC_HORIZON`].
    pub min_ttc: Option<f64>,
    /// Root mean square of the jerk in m/s³; `None` for an episode of one step.
    pub jerk: Option<f64>,
    /// Share of steps in which the shield overruled the driver.
    pub shielded: f64,
    /// Whether the vehicle under test arrived before the other; `None` if both are under test.
    pub went_first: Option<bool>,
    /// Seconds by which the vehicle under test arrived later than it was recorded to. One that had not arrived by the
    /// time-out has at least the delay until then, and that is counted. `None` if both are under test, and where the
    /// episode ended otherwise before it arrived.
    pub delay_s: Option<f64>,
}

impl Measures {
    /// Measures `episode`, driven in `encounter`, where the vehicles in `tested` are under test.
    ///
    /// Cost: O(steps × 50) box tests, for the time to collision.
    #[must_use]
    pub fn of(encounter: &Encounter, episode: &Episode, tested: &[Role]) -> Self {
        let limit = 2 * encounter.steps;
        let arrival = episode.arrivals.iter().flatten().copied().reduce(f32::min);
        let length = arrival.map_or(episode.steps(), |steps| steps.ceil() as u32);
        let length = length.min(limit);
        let difference = f64::from(length.abs_diff(encounter.steps));
        Self {
            correct: episode.end == End::Finished && episode.first() == Some(encounter.first),
            length,
            length_error: difference / f64::from(encounter.steps.max(1)),
            length_error_s: difference * f64::from(STEP),
            position_error: HORIZONS
                .map(|seconds| deviation::position_at(encounter, episode, tested, 10 * seconds)),
            position_rmse: deviation::position(encounter, episode, tested),
            svo_rmse: svo::error(encounter, episode),
            pet_error: pet_error(encounter, episode),
            min_ttc: least_ttc(encounter, &episode.states, [Footprint::PAPER; 2])
                .map(|(_, seconds)| seconds),
            jerk: jerk(episode, tested),
            shielded: shielded(episode, tested),
            went_first: alone(tested).map(|role| episode.first() == Some(role)),
            delay_s: alone(tested).and_then(|role| delay(encounter, episode, role)),
        }
    }
}

/// The vehicle under test, if it is one.
fn alone(tested: &[Role]) -> Option<Role> {
    match tested {
        &[role] => Some(role),
        _ => None,
    }
}

fn delay(encounter: &Encounter, episode: &Episode, role: Role) -> Option<f64> {
    let end = (episode.end == End::TimeOut).then(|| episode.steps() as f32);
    let arrival = episode.arrivals[role as usize].or(end)?;
    let second = if role == encounter.first {
        0.0
    } else {
        f64::from(encounter.pet)
    };
    Some(f64::from(STEP) * (f64::from(arrival) - f64::from(encounter.steps)) - second)
}

fn pet_error(encounter: &Encounter, episode: &Episode) -> Option<f64> {
    let [left, other] = episode.arrivals;
    let pet = f64::from((left? - other?).abs()) * f64::from(STEP);
    Some((pet - f64::from(encounter.pet)).abs())
}

fn jerk(episode: &Episode, tested: &[Role]) -> Option<f64> {
    let squares = episode.actions.windows(2).flat_map(|pair| {
        tested.iter().map(move |&role| {
            let [before, after] = [0, 1].map(|i| pair[i][role as usize].acceleration);
            (f64::from(after - before) / f64::from(STEP)).powi(2)
        })
    });
    deviation::root_mean(squares)
}

fn shielded(episode: &Episode, tested: &[Role]) -> f64 {
    let steps = tested.len() * episode.actions.len();
    let overruled = episode
        .actions
        .iter()
        .flat_map(|actions| tested.iter().map(|&role| actions[role as usize]))
        .filter(Action::shielded);
    overruled.count() as f64 / steps.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::{Driver, DriverFactory, InitialSpeed, Replay, View};
    use crate::fixture::crossing;
    use crate::meeting::Meeting;
    use cede_controller::{Cause, Fault};

    fn drive(encounter: &Encounter, mut drivers: [Box<dyn Driver + '_>; 2]) -> Measures {
        let episode = Episode::run(encounter, &mut drivers, None);
        Measures::of(encounter, &episode, &Role::BOTH)
    }

    /// Alternates between ±1 m/s².
    struct Saw;

    impl Driver for Saw {
        fn accelerate(&mut self, view: &View<'_>) -> f32 {
            if view.step.is_multiple_of(2) {
                1.0
            } else {
                -1.0
            }
        }

        fn cause(&self) -> Cause {
            Cause::Fallback(Fault::NoPlan)
        }
    }

    #[test]
    fn the_record_itself_has_no_error() {
        let encounter = crossing([33.0, 7.0], [50.0, 9.0]);
        let meeting = Meeting::new(&encounter).unwrap();
        let drivers = [0, 1].map(|i| Replay.driver(&meeting, i, 0));
        let measures = drive(&encounter, drivers);
        assert!(measures.correct);
        assert_eq!(measures.length_error, 0.0);
        assert!(measures.position_rmse < 1e-4, "{measures:?}");
        assert!(measures.svo_rmse.unwrap() < 1e-5, "{measures:?}");
        assert_eq!(measures.jerk, Some(0.0));
        assert_eq!(measures.shielded, 0.0);
    }

    #[test]
    fn errors_are_measured_against_the_record() {
        // Recorded: 40 steps for the left-turner. Driven: from the 10 m/s of a faster record.
        let mut encounter = crossing([20.0, 5.0], [60.0, 5.0]);
        encounter.participants[0].record[0].v = 10.0;
        let meeting = Meeting::new(&encounter).unwrap();
        let drivers = [0, 1].map(|i| InitialSpeed.driver(&meeting, i, 0));
        let measures = drive(&encounter, drivers);
        assert_eq!((measures.length, encounter.steps), (20, 40));
        assert_eq!(measures.length_error, 0.5);
        assert!((measures.length_error_s - 2.0).abs() < 1e-6);
        // The left-turner is 5 m ahead after 1 s, the other where it was recorded.
        let after_1s = measures.position_error[0].unwrap();
        assert!((after_1s - 5.0 / 2.0_f64.sqrt()).abs() < 1e-4, "{after_1s}");
        assert_eq!(measures.position_error[1], None);
        assert_eq!(measures.pet_error, None);
    }

    #[test]
    fn jerk_and_shield_are_those_of_the_vehicle_under_test() {
        let encounter = crossing([20.0, 8.0], [40.0, 8.0]);
        let meeting = Meeting::new(&encounter).unwrap();
        let mut drivers: [Box<dyn Driver>; 2] =
            [Box::new(Saw), InitialSpeed.driver(&meeting, 1, 0)];
        let episode = Episode::run(&encounter, &mut drivers, None);
        let of = |tested: &[Role]| Measures::of(&encounter, &episode, tested);
        assert!((of(&[Role::Left]).jerk.unwrap() - 20.0).abs() < 1e-4);
        assert_eq!(of(&[Role::Left]).shielded, 1.0);
        assert_eq!(of(&[Role::Other]).jerk, Some(0.0));
        assert_eq!(of(&Role::BOTH).shielded, 0.5);
    }

    #[test]
    fn who_went_first_and_how_late_is_told_of_one_vehicle_under_test() {
        // The left-turner is recorded to arrive after 2.5 s, the other 3 s later.
        let encounter = crossing([20.0, 8.0], [44.0, 8.0]);
        let meeting = Meeting::new(&encounter).unwrap();
        let replays = || [0, 1].map(|i| Replay.driver(&meeting, i, 0));
        let exits = Some(crate::evaluate::clearance(&meeting));
        let of = |mut drivers: [Box<dyn Driver + '_>; 2], tested: &[Role]| {
            let episode = Episode::run(&encounter, &mut drivers, exits);
            let measures = Measures::of(&encounter, &episode, tested);
            (measures.went_first, measures.delay_s)
        };
        assert_eq!(of(replays(), &Role::BOTH), (None, None));
        for (role, first) in [(Role::Left, true), (Role::Other, false)] {
            let (went_first, delay) = of(replays(), &[role]);
            assert_eq!(went_first, Some(first));
            assert!(delay.unwrap().abs() < 0.11, "{delay:?}");
        }
        let [left, _] = replays();
        let standing: [Box<dyn Driver>; 2] = [left, Box::new(Brake)];
        let (went_first, delay) = of(standing, &[Role::Other]);
        assert_eq!(went_first, Some(false));
        assert!(delay.unwrap() > 1.0, "{delay:?}");
    }

    /// Brakes as hard as it can.
    struct Brake;

    impl Driver for Brake {
        fn accelerate(&mut self, _: &View<'_>) -> f32 {
            -3.0
        }
    }

    #[test]
    fn time_to_collision_is_that_of_constant_speeds() {
        let left_first = |d| drive_constant(&crossing([20.0, 8.0], [d, 8.0]));
        // Both in the middle of the crossing at once: touching 3.5 m before it, 21.5 m from the start,
        // the paper's episode ends after 20 m.
        let ttc = left_first(20.0).min_ttc.unwrap();
        assert!((ttc - 0.2).abs() < 0.11, "{ttc}");
        assert_eq!(left_first(60.0).min_ttc, None);
    }

    fn drive_constant(encounter: &Encounter) -> Measures {
        let meeting = Meeting::new(encounter).unwrap();
        drive(
            encounter,
            [0, 1].map(|i| InitialSpeed.driver(&meeting, i, 0)),
        )
    }
}
