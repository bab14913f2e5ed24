//! The worst moments of the driver under test, found in all of its episodes.

use super::called::called;
use super::replayed::Case;
use super::why::{Class, words};
use cede_controller::Footprint;
use cede_controller::kinematics::{STEP, State};
use cede_data::{Encounter, EncounterId, Role};
use cede_sim::episode::{Action, End};
use cede_sim::evaluate::Drive;
use cede_sim::metrics::least_ttc;
use serde::Serialize;

/// Maximum number of moments of each kind.
const OF_EACH: usize = 3;
/// A time to collision (s) below which an episode is a near miss.
const NEAR: f64 = 1.5;
/// A vehicle that is slower (m/s) stands.
const STANDS: f32 = 0.2;
/// Minimum number of steps of a face-off: 2 s.
const FACE_OFF: usize = 20;
/// Seconds of the replay before the moment.
const BEFORE: f32 = 2.0;

/// What is bad about a moment.
#[derive(Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Kind {
    Collision,
    NearMiss,
    Intervention,
    FaceOff,
}

const KINDS: [Kind; 4] = [
    Kind::Collision,
    Kind::NearMiss,
    Kind::Intervention,
    Kind::FaceOff,
];

/// A bad moment of an episode.
struct Moment {
    kind: Kind,
    /// Greater is worse; comparable within a kind.
    badness: f32,
    step: usize,
    words: String,
}

/// A moment with its replay.
struct Found {
    moment: Moment,
    id: EncounterId,
    driver: String,
    /// The encounter with this episode alone.
    case: Case,
}

/// The worst moments so far.
#[derive(Default)]
pub(super) struct Gallery(Vec<Found>);

/// A moment as the page shows it.
#[derive(Serialize)]
pub(super) struct Exhibit {
    kind: Kind,
    words: String,
    driver: String,
    /// Its place in the page's cases.
    case: usize,
    /// Where the replay starts, in s.
    time: f32,
}

impl Gallery {
    /// Looks for bad moments in an episode of `driver`.
    pub(super) fn add(&mut self, driver: &str, drive: &Drive<'_>) {
        for moment in moments(drive) {
            self.offer(driver, drive, moment);
        }
    }

    /// Keeps `moment`, if it is among the worst of its kind and driver. An encounter is shown once in each kind.
    fn offer(&mut self, driver: &str, drive: &Drive<'_>, moment: Moment) {
        let id = &drive.encounter.id;
        let own = is_cede(driver);
        let rivals = || {
            let own_kind = move |(_, found): &(usize, &Found)| {
                found.moment.kind == moment.kind && is_cede(&found.driver) == own
            };
            self.0.iter().enumerate().filter(own_kind)
        };
        let same = rivals().find(|(_, found)| found.id == *id);
        let full = rivals().count() == OF_EACH;
        let mildest = || {
            let mild = |(_, a): &(_, &Found), (_, b): &(_, &Found)| {
                a.moment.badness.total_cmp(&b.moment.badness)
            };
            rivals().min_by(mild)
        };
        let replaced = same.or_else(|| full.then(mildest).flatten());
        if let Some((place, found)) = replaced {
            if found.moment.badness >= moment.badness {
                return;
            }
            self.0.remove(place);
        }
        let mut case = Case::of(drive.encounter);
        case.add(driver.to_owned(), drive);
        self.0.push(Found {
            moment,
            id: id.clone(),
            driver: driver.to_owned(),
            case,
        });
    }

    /// The moments, the worst of each kind first; of Cede alone, if it is among the drivers. `place` gives the place of
    /// a case among those of the page.
    pub(super) fn exhibits(
        self,
        mut place: impl FnMut(&EncounterId, Case) -> usize,
    ) -> Vec<Exhibit> {
        let own = self.0.iter().any(|found| is_cede(&found.driver));
        let mut found = self.0;
        found.retain(|found| is_cede(&found.driver) == own);
        found.sort_by(|a, b| b.moment.badness.total_cmp(&a.moment.badness));
        let kind = |found: &Found| KINDS.iter().position(|kind| *kind == found.moment.kind);
        found.sort_by_key(kind);
        let exhibit = |found: Found| Exhibit {
            kind: found.moment.kind,
            words: found.moment.words,
            case: place(&found.id, found.case),
            driver: found.driver,
            time: (seconds(found.moment.step) - BEFORE).max(0.0),
        };
        found.into_iter().map(exhibit).collect()
    }
}

fn is_cede(driver: &str) -> bool {
    driver.starts_with("cede")
}

fn seconds(steps: usize) -> f32 {
    steps as f32 * STEP
}

/// The bad moments of an episode, at most one of each kind.
fn moments(drive: &Drive<'_>) -> Vec<Moment> {
    let (episode, encounter) = (&drive.episode, drive.encounter);
    let contact = match episode.end {
        End::Collision => Some(collision(&episode.states)),
        End::Finished | End::TimeOut => near_miss(drive),
    };
    let roles = drive.ego.map_or(Role::BOTH.to_vec(), |role| vec![role]);
    let overruled = roles
        .into_iter()
        .filter_map(|role| intervention(encounter, role, &episode.actions));
    let worst = overruled.max_by(|a, b| a.badness.total_cmp(&b.badness));
    let stands = face_off(encounter, &episode.states);
    [contact, worst, stands].into_iter().flatten().collect()
}

fn collision(states: &[[State; 2]]) -> Moment {
    let speeds = states
        .last()
        .map_or([0.0; 2], |last| last.map(|state| state.v));
    let step = states.len().saturating_sub(1);
    let [left, other] = speeds;
    Moment {
        kind: Kind::Collision,
        badness: left + other,
        step,
        words: format!(
            "collision after {:.1} s, at {left:.1} and {other:.1} m/s",
            seconds(step)
        ),
    }
}

fn near_miss(drive: &Drive<'_>) -> Option<Moment> {
    let known = drive.measures.min_ttc.filter(|seconds| *seconds < NEAR)?;
    let (step, _) = least_ttc(
        drive.encounter,
        &drive.episode.states,
        [Footprint::PAPER; 2],
    )?;
    Some(Moment {
        kind: Kind::NearMiss,
        badness: -known as f32,
        step,
        words: format!(
            "{known:.1} s from a collision, {:.1} s after the beginning",
            seconds(step)
        ),
    })
}

/// Where the shield changed the acceleration of the vehicle in `role` most within a step.
fn intervention(encounter: &Encounter, role: Role, actions: &[[Action; 2]]) -> Option<Moment> {
    let steps = actions.windows(2).zip(1..);
    let jumps = steps.filter_map(|(pair, step)| {
        let [before, now] = [pair[0], pair[1]].map(|both| both[role as usize]);
        let acted = Class::of(now.cause).is_some() && Class::of(before.cause).is_none();
        let jump = (now.acceleration - before.acceleration).abs();
        acted.then_some((step, jump, before.acceleration, now))
    });
    let (step, badness, before, now) = jumps.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let who = called(encounter, role);
    Some(Moment {
        kind: Kind::Intervention,
        badness,
        step,
        words: format!(
            "{who} from {before:.1} to {:.1} m/s² after {:.1} s, {}",
            now.acceleration,
            seconds(step),
            words(encounter, role, now.cause)
        ),
    })
}

/// The longest time in which both stand short of the conflict point.
fn face_off(encounter: &Encounter, states: &[[State; 2]]) -> Option<Moment> {
    let waits =
        |role: Role, state: State| state.v < STANDS && state.s < encounter.judged(role).conflict_s;
    let both = |states: &[State; 2]| {
        Role::BOTH
            .into_iter()
            .all(|role| waits(role, states[role as usize]))
    };
    let (mut longest, mut length) = ((0, 0), 0);
    for (step, states) in states.iter().enumerate() {
        length = if both(states) { length + 1 } else { 0 };
        longest = longest.max((length, step));
    }
    let (length, end) = longest;
    (length >= FACE_OFF).then(|| Moment {
        kind: Kind::FaceOff,
        badness: length as f32,
        step: end + 1 - length,
        words: format!(
            "both wait for {:.1} s, from {:.1} s on",
            seconds(length),
            seconds(end + 1 - length)
        ),
    })
}
