//! Which recorded vehicles met, where and who went first.
//!
//! A left-turner and another vehicle make an encounter if the site says that
//! their movements conflict, both are there at the same time, and their
//! recorded polylines cross. P is the first proper crossing along the
//! left-turner's. Each has *arrived* at its first recorded position within
//! [`NEAR`] of P. The encounter runs from the later of the two first times to
//! the earlier arrival; it counts if that takes a step at least.

use super::crossing::{Point, first_crossing};
use super::lanelet::{Map, Trace};
use super::motion::motion;
use super::rights::{Entry, Party, Rights};
use super::site::Site;
use super::tracks::{Recording, STEP_MS, Track};
use crate::encounter::{Encounter, EncounterId, Participant, Sample, SimRoute};
use crate::role::Role;
use cede_controller::{CONFLICT_RADIUS, ConflictKind, Footprint};
use std::cell::OnceCell;

/// A vehicle has arrived when it is closer (m) to the conflict point than this.
pub const NEAR: f64 = CONFLICT_RADIUS as f64;

/// All encounters of a recording, in the order of its tracks.
///
/// Cost: some milliseconds for each minute of traffic.
#[must_use]
pub fn extract(site: &Site, map: Option<&Map>, recording: &Recording) -> Vec<Encounter> {
    let polylines: Vec<Vec<Point>> = recording
        .tracks
        .iter()
        .map(|track| track.states.iter().map(|s| s.position()).collect())
        .collect();
    let traces: Vec<OnceCell<Trace>> = vec![OnceCell::new(); recording.tracks.len()];
    let mut encounters = Vec::new();
    for (i, left) in recording.tracks.iter().enumerate() {
        for (j, other) in recording.tracks.iter().enumerate() {
            let Some(kind) = site.conflict(left, other) else {
                continue;
            };
            let pair = TrackPair { left, other, kind };
            let paths = [polylines[i].as_slice(), polylines[j].as_slice()];
            let conflict = pair.conflict(paths);
            let Some(mut encounter) = conflict
                .as_ref()
                .and_then(|m| pair.encounter(site, recording, m))
            else {
                continue;
            };
            if let (Some(map), Some(met)) = (map, &conflict) {
                let trace = |i: usize| traces[i].get_or_init(|| map.trace(&recording.tracks[i]));
                pair.read_rights(map, met, [trace(i), trace(j)], &mut encounter);
            }
            encounters.push(encounter);
        }
    }
    encounters
}

struct TrackPair<'r> {
    left: &'r Track,
    other: &'r Track,
    kind: ConflictKind,
}

/// When and where a pair met.
struct ConflictTimes {
    start_ms: u64,
    end_ms: u64,
    point: Point,
    left: Arrival,
    other: Arrival,
}

#[derive(Clone, Copy)]
pub(crate) struct Arrival {
    time_ms: u64,
    /// Index of the first state near the conflict point.
    pub(crate) index: usize,
    /// Share of the last step before it after which the vehicle was near.
    share: f64,
}

impl TrackPair<'_> {
    /// `None` if the two were not there together, did not cross, or had met before both were seen.
    fn conflict(&self, paths: [&[Point]; 2]) -> Option<ConflictTimes> {
        let start_ms = self.left.first_ms.max(self.other.first_ms);
        if start_ms > self.left.last_ms().min(self.other.last_ms()) {
            return None;
        }
        let point = first_crossing(paths[0], paths[1])?;
        let left = arrival(self.left, paths[0], point)?;
        let other = arrival(self.other, paths[1], point)?;
        let end_ms = left.time_ms.min(other.time_ms);
        (end_ms >= start_ms + STEP_MS).then_some(ConflictTimes {
            start_ms,
            end_ms,
            point,
            left,
            other,
        })
    }

    /// Writes to `encounter` what `map` says about who goes first.
    fn read_rights(
        &self,
        map: &Map,
        met: &ConflictTimes,
        traces: [&Trace; 2],
        encounter: &mut Encounter,
    ) {
        let tracks = [(self.left, met.left), (self.other, met.other)];
        let party = |i: usize| Party {
            track: tracks[i].0,
            trace: traces[i],
            manoeuvre: encounter.participants[i].manoeuvre,
            arrival: tracks[i].1.index,
        };
        let parties = [party(0), party(1)];
        let duties = parties.map(|party| map.duty(party));
        encounter.rights = map.rights(parties, [&duties[0], &duties[1]]);
        for (i, duty) in duties.iter().enumerate() {
            let participant = &mut encounter.participants[i];
            let line = |index| arc_length(tracks[i].0, participant, met.start_ms, index);
            participant.entry = Entry {
                control: duty.control,
                line: duty.line.and_then(line),
                limit: map.limit(traces[i]).map(|limit| limit as f32),
            };
        }
    }

    fn encounter(&self, site: &Site, file: &Recording, met: &ConflictTimes) -> Option<Encounter> {
        let left = judged(site, self.left, met.left, met.start_ms)?;
        let other = judged(site, self.other, met.other, met.start_ms)?;
        let steps = (met.end_ms - met.start_ms) / STEP_MS;
        // Until both are gone, or until the longest episode ends.
        let both_gone = self.left.last_ms().max(self.other.last_ms());
        let window = met.start_ms..=both_gone.max(met.end_ms + steps * STEP_MS);
        let bystanders = file
            .tracks
            .iter()
            .filter(|track| track.id != self.left.id && track.id != self.other.id)
            .filter(|track| track.first_ms <= *window.end() && track.last_ms() >= *window.start())
            .filter_map(|track| bystander(site, track, met.start_ms));
        let participants = [left, other].into_iter().chain(bystanders).collect();
        Some(Encounter {
            id: EncounterId {
                site: site.name.clone(),
                file: file.file,
                left: self.left.id,
                other: self.other.id,
            },
            kind: self.kind,
            start_ms: met.start_ms,
            steps: u32::try_from(steps).ok()?,
            conflict_point: cede_controller::Point::new(met.point[0] as f32, met.point[1] as f32),
            first: if met.left.time_ms <= met.other.time_ms {
                Role::Left
            } else {
                Role::Other
            },
            rights: Rights::default(),
            pet: met.left.time_ms.abs_diff(met.other.time_ms) as f32 * 1e-3,
            participants,
        })
    }
}

/// Arc length (m) on the route of `participant` at which `track` crosses the line before state `index`.
pub(crate) fn arc_length(
    track: &Track,
    participant: &Participant,
    start_ms: u64,
    index: usize,
) -> Option<f32> {
    let skipped = usize::try_from(start_ms.saturating_sub(track.first_ms) / STEP_MS).ok()?;
    if let Some(place) = index.checked_sub(skipped) {
        return participant.record.get(place).map(|sample| sample.s);
    }
    let before = track.states.get(index..=skipped)?.windows(2);
    let way = before.map(|w| (w[1].x - w[0].x).hypot(w[1].y - w[0].y));
    Some(-way.sum::<f64>() as f32)
}

pub(crate) fn arrival(track: &Track, path: &[Point], point: Point) -> Option<Arrival> {
    let away = |p: &Point| (p[0] - point[0]).hypot(p[1] - point[1]);
    let index = path.iter().position(|p| away(p) < NEAR)?;
    let share = match index.checked_sub(1).and_then(|i| path.get(i)) {
        Some(before) => share_of_approach(*before, path[index], point),
        None => 0.0,
    };
    Some(Arrival {
        time_ms: track.time_ms(index),
        index,
        share,
    })
}

/// The share of the way from `a` to `b` at which the distance from `p` falls to [`NEAR`].
fn share_of_approach(a: Point, b: Point, p: Point) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let (px, py) = (a[0] - p[0], a[1] - p[1]);
    let square = dx * dx + dy * dy;
    let half = px * dx + py * dy;
    let excess = px * px + py * py - NEAR * NEAR;
    ((-half - (half * half - square * excess).max(0.0).sqrt()) / square).clamp(0.0, 1.0)
}

fn judged(site: &Site, track: &Track, arrival: Arrival, start_ms: u64) -> Option<Participant> {
    let mut participant = bystander(site, track, start_ms)?;
    let skipped = usize::try_from((start_ms - track.first_ms) / STEP_MS).ok()?;
    // Both arrive after the start, so there is a state before the arrival.
    let near = arrival.index.checked_sub(skipped)?;
    let (before, after) = (near.checked_sub(1)?, near);
    let s = |i: usize| participant.record.get(i).map(|sample| f64::from(sample.s));
    let (before, after) = (s(before)?, s(after)?);
    participant.conflict_s = (before + (after - before) * arrival.share) as f32;
    Some(participant)
}

fn bystander(site: &Site, track: &Track, start_ms: u64) -> Option<Participant> {
    let motion = motion(track.states_from(start_ms)).ok()?;
    participant(site, track, start_ms, motion)
}

/// `track` from `start_ms` on, on its way.
pub(crate) fn participant(
    site: &Site,
    track: &Track,
    start_ms: u64,
    (route, record): (SimRoute, Vec<Sample>),
) -> Option<Participant> {
    Some(Participant {
        track: track.id,
        manoeuvre: site.manoeuvre(track),
        entry: Entry::default(),
        route,
        footprint: Footprint {
            length: track.length as f32,
            width: track.width as f32,
        },
        conflict_s: f32::INFINITY,
        appears: u32::try_from(track.first_ms.saturating_sub(start_ms) / STEP_MS).ok()?,
        record,
    })
}
