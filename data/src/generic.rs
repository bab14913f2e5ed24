//! A plain CSV of tracks from any source.
//!
//! | column | | unit |
//! |---|---|---|
//! | `track` | required | whole number, one for each vehicle |
//! | `t` | required | s, at least 0, any rate; resampled to 10 Hz |
//! | `x`, `y` | required | m, the vehicle's centre, within 8192 m of the origin |
//! | `vx`, `vy` | optional | m/s; from the positions if absent |
//! | `heading` | optional | rad, counter-clockwise from +x; from the motion if absent |
//! | `length`, `width` | optional | m; 4.5 × 1.8 if absent |
//!
//! Other columns are passed over; rows of different tracks may be mixed.

use super::error::DataError;
use super::table::{Format, Place, Table};
use super::tracks::{RawState, STEP_MS, Track, TrackRow, Tracks};
use serde::Deserialize;
use std::path::Path;

const FORMAT: Format = Format {
    required: &["track", "t", "x", "y"],
    mend: "the header needs track,t,x,y (s, m) and may have vx,vy,heading,length,width; INTERACTION's files are told by their name, vehicle_tracks_NNN.csv",
};

/// Below this speed (m/s) the motion does not tell the heading.
const CREEP: f64 = 0.5;

#[derive(Deserialize)]
struct Fields {
    track: u32,
    t: f64,
    x: f64,
    y: f64,
    vx: Option<f64>,
    vy: Option<f64>,
    heading: Option<f64>,
    length: Option<f64>,
    width: Option<f64>,
}

/// The tracks of the file at `path`.
///
/// # Errors
/// On the first row that makes no sense, with its line, column and the mend.
pub fn read(path: &Path) -> Result<Vec<Track>, DataError> {
    let mut tracks = Tracks::default();
    let (mut has_velocity, mut has_heading) = (true, true);
    Table::read(path)?.for_each(&FORMAT, |place, fields: Fields| {
        has_velocity &= fields.vx.is_some() && fields.vy.is_some();
        has_heading &= fields.heading.is_some();
        tracks.push(path, &checked(place, &fields)?)
    })?;
    let mut tracks = tracks.finish();
    for track in &mut tracks {
        if !has_velocity {
            velocities_from_positions(&mut track.states);
        }
        if !has_heading {
            headings_from_motion(&mut track.states);
        }
    }
    Ok(tracks)
}

fn checked(place: Place<'_>, fields: &Fields) -> Result<TrackRow, DataError> {
    let seconds = place.time("t", fields.t)?;
    let finite = |column, value: Option<f64>| place.finite(column, value.unwrap_or(0.0));
    Ok(TrackRow {
        line: place.line,
        track: fields.track,
        // To a microsecond, so that 1.1 s lies on the 100 ms grid.
        time_ms: (seconds * 1e6).round() / 1e3,
        state: RawState {
            x: place.coordinate("x", fields.x)?,
            y: place.coordinate("y", fields.y)?,
            vx: finite("vx", fields.vx)?,
            vy: finite("vy", fields.vy)?,
            heading: finite("heading", fields.heading)?,
        },
        length: place.positive("length", fields.length.unwrap_or(4.5))?,
        width: place.positive("width", fields.width.unwrap_or(1.8))?,
    })
}

/// Central differences; one-sided at the ends.
fn velocities_from_positions(states: &mut [RawState]) {
    let positions: Vec<[f64; 2]> = states.iter().map(RawState::position).collect();
    let last = positions.len() - 1;
    for (i, state) in states.iter_mut().enumerate() {
        let (before, after) = (i.saturating_sub(1), (i + 1).min(last));
        if after > before {
            let seconds = STEP_MS as f64 * 1e-3 * (after - before) as f64;
            let [[ax, ay], [bx, by]] = [positions[before], positions[after]];
            (state.vx, state.vy) = ((bx - ax) / seconds, (by - ay) / seconds);
        }
    }
}

/// The direction of motion; while the vehicle creeps, that of its next motion, or else its last.
fn headings_from_motion(states: &mut [RawState]) {
    let mut known = vec![None; states.len()];
    for (heading, state) in known.iter_mut().zip(states.iter()) {
        if state.vx.hypot(state.vy) > CREEP {
            *heading = Some(state.vy.atan2(state.vx));
        }
    }
    let mut carry = known.iter().rev().find_map(|heading| *heading);
    for (heading, state) in known.iter().zip(states).rev() {
        carry = heading.or(carry);
        state.heading = carry.unwrap_or(0.0);
    }
}
