//! Recordings as they were read: vehicles' tracks at 10 Hz, in the site's own frame.

use super::error::{DataError, Problem};
use super::lanelet::Map;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Milliseconds from one state of a track to the next.
pub const STEP_MS: u64 = 100;

/// Holes in a track up to this length (ms) are bridged by interpolation.
const LONGEST_HOLE_MS: f64 = 1000.0;

/// One recording file.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Its number, as in `vehicle_tracks_NNN.csv`.
    pub file: u16,
    /// The vehicles' tracks in the order of the file.
    pub tracks: Vec<Track>,
    /// The place of this recording alone; `None` if it is the data set's site.
    pub scene: Option<Arc<Scene>>,
}

/// A place that is not the data set's site: that of a scenario.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Its name; its encounters are named by it.
    pub name: String,
    /// Its map.
    pub map: Map,
}

/// One vehicle's track: a state every 100 ms without a hole.
#[derive(Clone, Debug)]
pub struct Track {
    /// Its number in the recording.
    pub id: u32,
    /// Time of `states[0]` in ms, a multiple of 100.
    pub first_ms: u64,
    /// Metres from bumper to bumper.
    pub length: f64,
    /// Metres from side to side.
    pub width: f64,
    /// The recorded states, at least one.
    pub states: Vec<RawState>,
}

/// A recorded state, in the precision of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawState {
    /// Centre of the vehicle, metres east.
    pub x: f64,
    /// Centre of the vehicle, metres north.
    pub y: f64,
    /// Velocity in m/s to the east.
    pub vx: f64,
    /// Velocity in m/s to the north.
    pub vy: f64,
    /// Heading in rad, counter-clockwise from +x.
    pub heading: f64,
}

impl RawState {
    /// Position in metres.
    pub(crate) fn position(&self) -> [f64; 2] {
        [self.x, self.y]
    }

    /// The state a share `f` of the way to `next`; the heading takes the shorter way round.
    fn towards(&self, next: &Self, f: f64) -> Self {
        let mix = |a: f64, b: f64| a + (b - a) * f;
        Self {
            x: mix(self.x, next.x),
            y: mix(self.y, next.y),
            vx: mix(self.vx, next.vx),
            vy: mix(self.vy, next.vy),
            heading: self.heading + wrap(next.heading - self.heading) * f,
        }
    }
}

/// An angle in rad, brought into (−π, π].
#[must_use]
pub(crate) fn wrap(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    PI - (PI - angle).rem_euclid(TAU)
}

impl Track {
    /// The first recorded state.
    #[must_use]
    pub fn first(&self) -> RawState {
        self.states[0]
    }

    /// The last recorded state.
    #[must_use]
    pub fn last(&self) -> RawState {
        self.states[self.states.len() - 1]
    }

    /// Time of the last state in ms.
    #[must_use]
    pub fn last_ms(&self) -> u64 {
        self.first_ms + STEP_MS * (self.states.len() as u64 - 1)
    }

    /// Time of state `index` in ms.
    pub(crate) fn time_ms(&self, index: usize) -> u64 {
        self.first_ms + STEP_MS * index as u64
    }

    /// The states from `from_ms` on; all of them if the track begins later.
    pub(crate) fn states_from(&self, from_ms: u64) -> &[RawState] {
        let skip = from_ms.saturating_sub(self.first_ms) / STEP_MS;
        let skip = usize::try_from(skip).unwrap_or(usize::MAX);
        self.states.get(skip..).unwrap_or(&[])
    }

    /// Change of heading from the first state to the last in rad, in (−π, π]; left is positive.
    #[must_use]
    pub fn turn(&self) -> f64 {
        wrap(self.last().heading - self.first().heading)
    }
}

/// A row of a file, whatever its format.
pub(crate) struct TrackRow {
    pub(crate) line: u64,
    pub(crate) track: u32,
    pub(crate) time_ms: f64,
    pub(crate) state: RawState,
    pub(crate) length: f64,
    pub(crate) width: f64,
}

/// Sorts rows into tracks and checks the order of time within each.
#[derive(Default)]
pub(crate) struct Tracks {
    index: HashMap<u32, usize>,
    tracks: Vec<Timed>,
}

struct Timed {
    id: u32,
    length: f64,
    width: f64,
    times: Vec<f64>,
    states: Vec<RawState>,
}

impl Tracks {
    /// The size given for `track` before, if it occurred.
    pub(crate) fn size(&self, track: u32) -> Option<(f64, f64)> {
        let timed = &self.tracks[*self.index.get(&track)?];
        Some((timed.length, timed.width))
    }

    pub(crate) fn push(&mut self, path: &Path, row: &TrackRow) -> Result<(), DataError> {
        let next = self.tracks.len();
        let i = *self.index.entry(row.track).or_insert(next);
        if i == next {
            self.tracks.push(Timed {
                id: row.track,
                length: row.length,
                width: row.width,
                times: Vec::new(),
                states: Vec::new(),
            });
        }
        let timed = &mut self.tracks[i];
        if let Some(&before) = timed.times.last() {
            check_order(row.track, before, row.time_ms)
                .map_err(|problem| DataError::new(path, problem).at_line(row.line))?;
        }
        timed.times.push(row.time_ms);
        timed.states.push(row.state);
        Ok(())
    }

    /// All tracks that have a state on the 100 ms grid, at 10 Hz.
    pub(crate) fn finish(self) -> Vec<Track> {
        self.tracks
            .into_iter()
            .filter_map(Timed::into_track)
            .collect()
    }
}

fn check_order(track: u32, before: f64, now: f64) -> Result<(), Problem> {
    let ms = |time: f64| time.round() as u64;
    if now == before {
        let time = ms(now);
        return Err(Problem::Duplicate { track, time });
    }
    let (hole, before, now) = (now - before, ms(before), ms(now));
    if hole < 0.0 {
        return Err(Problem::TimeBackwards { track, before, now });
    }
    if hole > LONGEST_HOLE_MS {
        return Err(Problem::Hole { track, before, now });
    }
    Ok(())
}

impl Timed {
    /// The track on the grid of 100 ms; states that are on it already keep their bits.
    fn into_track(self) -> Option<Track> {
        let step = STEP_MS as f64;
        let (begin, end) = (*self.times.first()?, *self.times.last()?);
        let ticks = (begin / step).ceil() as u64..=(end / step).floor() as u64;
        let mut i = 0;
        let mut states = Vec::with_capacity(self.times.len());
        for tick in ticks.clone() {
            let time = tick as f64 * step;
            while self.times.get(i + 1).is_some_and(|&t| t <= time) {
                i += 1;
            }
            states.push(match (self.states.get(i + 1), self.times.get(i + 1)) {
                (Some(next), Some(&after)) if self.times[i] < time => {
                    let share = (time - self.times[i]) / (after - self.times[i]);
                    self.states[i].towards(next, share)
                }
                _ => self.states[i],
            });
        }
        (!states.is_empty()).then_some(Track {
            id: self.id,
            first_ms: ticks.start() * STEP_MS,
            length: self.length,
            width: self.width,
            states,
        })
    }
}
