//! Everybody in a recording, and who goes first where their ways cross.

use crate::crossing::{Point, first_crossing};
use crate::encounter::Participant;
use crate::extract::{arc_length, arrival, participant};
use crate::lanelet::{Map, Trace};
use crate::motion::smooth_motion;
use crate::rights::{Duty, Entry, Party, Rights};
use crate::role::Role;
use crate::tracks::{Recording, Track};
use crate::{Dataset, Site};
use std::collections::HashMap;

/// Two vehicles may meet if they were there within this time (ms) of each other.
const TOGETHER_MS: u64 = 60_000;

/// Who goes no farther (m) than this is parked, and no traffic.
const PARKED: f32 = 10.0;

/// All vehicles of a recording that drive. Its step 0 is at time 0 of the recording.
#[derive(Clone, Debug)]
pub struct Traffic {
    /// The site's name.
    pub site: String,
    /// The recording's number.
    pub file: u16,
    /// The vehicles, in the order of the recording's tracks; each appears with its first state.
    pub vehicles: Vec<Participant>,
    /// Who goes first whatever the order in which two arrive, of those for whom a rule says so.
    first: HashMap<[usize; 2], usize>,
}

impl Traffic {
    /// The traffic of `recording` at the site of `dataset`, with the rights that the map gives.
    ///
    /// Cost: some tenths of a second for five minutes of traffic.
    #[must_use]
    pub fn of(dataset: &Dataset, recording: &Recording) -> Self {
        let site = &dataset.site;
        let found = recording.tracks.iter().filter_map(|track| {
            let motion = smooth_motion(&track.states).ok()?;
            let drives = motion.0.length() >= PARKED;
            Some((track, participant(site, track, 0, motion)?)).filter(|_| drives)
        });
        let (tracks, vehicles): (Vec<&Track>, Vec<Participant>) = found.unzip();
        let mut traffic = Self {
            site: (recording.scene.as_ref())
                .map_or(&site.name, |scene| &scene.name)
                .clone(),
            file: recording.file,
            vehicles,
            first: HashMap::new(),
        };
        if let Some(map) = dataset.map_of(recording.file) {
            traffic.read_rights(map, site, &tracks);
        }
        traffic
    }

    /// Whether vehicle `a` goes before vehicle `b` whatever the order in which they arrive; `None` if no rule says so.
    #[must_use]
    pub fn goes_first(&self, a: usize, b: usize) -> Option<bool> {
        let first = self.first.get(&[a.min(b), a.max(b)])?;
        Some(*first == a)
    }

    fn read_rights(&mut self, map: &Map, site: &Site, tracks: &[&Track]) {
        let traces: Vec<Trace> = tracks.iter().map(|track| map.trace(track)).collect();
        let party = |index: usize, arrival: usize| Party {
            track: tracks[index],
            trace: &traces[index],
            manoeuvre: site.manoeuvre(tracks[index]),
            arrival,
        };
        for (index, track) in tracks.iter().enumerate() {
            let duty = map.duty(party(index, track.states.len() - 1));
            let vehicle = &mut self.vehicles[index];
            let line = |state| arc_length(track, vehicle, 0, state);
            vehicle.entry = Entry {
                control: duty.control,
                line: duty.line.and_then(line),
                limit: map.limit(&traces[index]).map(|limit| limit as f32),
            };
        }
        let paths: Vec<Vec<Point>> = tracks
            .iter()
            .map(|track| track.states.iter().map(|state| state.position()).collect())
            .collect();
        for b in 1..tracks.len() {
            for a in (0..b).filter(|&a| together(tracks[a], tracks[b])) {
                let Some(point) = first_crossing(&paths[a], &paths[b]) else {
                    continue;
                };
                let reached = [a, b].map(|i| arrival(tracks[i], &paths[i], point));
                let [Some(of_a), Some(of_b)] = reached else {
                    continue;
                };
                let parties = [party(a, of_a.index), party(b, of_b.index)];
                let duties: [Duty; 2] = parties.map(|party| map.duty(party));
                let rights: Rights = map.rights(parties, [&duties[0], &duties[1]]);
                if let Some(first) = rights.settled() {
                    let first = if first == Role::Left { a } else { b };
                    self.first.insert([a, b], first);
                }
            }
        }
    }
}

/// Whether two were there at about the same time.
fn together(a: &Track, b: &Track) -> bool {
    a.first_ms <= b.last_ms() + TOGETHER_MS && b.first_ms <= a.last_ms() + TOGETHER_MS
}
