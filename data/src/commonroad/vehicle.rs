//! From dynamic obstacles to tracks.

use super::xml::{Fault, attribute, children, fault, find, number, point, required, word};
use crate::error::DataError;
use crate::tracks::{RawState, Track, TrackRow, Tracks};
use roxmltree::Node;
use std::path::Path;

/// The tracks of all vehicles of a scenario; `told` makes an error of what is wrong.
pub(super) fn read(
    root: Node<'_, '_>,
    path: &Path,
    told: &dyn Fn(Fault) -> DataError,
) -> Result<Vec<Track>, DataError> {
    let step = step(root).map_err(told)?;
    let mut tracks = Tracks::default();
    for obstacle in children(root, "dynamicObstacle") {
        let Some(vehicle) = Vehicle::of(obstacle).map_err(told)? else {
            continue;
        };
        let initial = required(obstacle, &["initialState"]).map_err(told)?;
        let later = find(obstacle, &["trajectory"]).into_iter();
        let later = later.flat_map(|trajectory| children(trajectory, "state"));
        for state in std::iter::once(initial).chain(later) {
            let row = vehicle.row(state, step).map_err(told)?;
            tracks.push(path, &row)?;
        }
    }
    Ok(tracks.finish())
}

/// Seconds of a time step.
fn step(root: Node<'_, '_>) -> Result<f64, Fault> {
    let text = attribute(root, "timeStepSize")?;
    let seconds = text.parse().ok().filter(|s: &f64| *s > 0.0 && *s <= 1.0);
    seconds.ok_or_else(|| fault(root, format!("timeStepSize `{text}` is outside (0, 1] s")))
}

/// What does not change about a vehicle.
struct Vehicle {
    track: u32,
    length: f64,
    width: f64,
}

impl Vehicle {
    /// `None` for who does not drive a vehicle.
    fn of(obstacle: Node<'_, '_>) -> Result<Option<Self>, Fault> {
        if matches!(
            word(required(obstacle, &["type"])?),
            "pedestrian" | "bicycle"
        ) {
            return Ok(None);
        }
        let id = attribute(obstacle, "id")?;
        let whole = || fault(obstacle, format!("the id `{id}` is no whole number"));
        if let Some(set) = find(obstacle, &["occupancySet"]) {
            let problem = format!("obstacle {id} has occupied areas in place of a trajectory");
            return Err(fault(set, problem));
        }
        let shape = required(obstacle, &["shape"])?;
        let [length, width] = match find(shape, &["rectangle"]) {
            Some(rectangle) => [
                number(rectangle, &["length"])?,
                number(rectangle, &["width"])?,
            ],
            None => [2.0 * number(shape, &["circle", "radius"])?; 2],
        };
        if length <= 0.0 || width <= 0.0 {
            let problem = format!("obstacle {id} is {length} m long and {width} m wide");
            return Err(fault(shape, problem));
        }
        Ok(Some(Self {
            track: id.parse().map_err(|_| whole())?,
            length,
            width,
        }))
    }

    /// A state of it; `step` in s.
    fn row(&self, state: Node<'_, '_>, step: f64) -> Result<TrackRow, Fault> {
        let time = number(state, &["time", "exact"])?;
        if !(0.0..=1e9).contains(&time) {
            return Err(fault(
                state,
                format!("the time step {time} is negative or too large"),
            ));
        }
        let [x, y] = point(required(state, &["position", "point"])?)?;
        let heading = number(state, &["orientation", "exact"])?;
        let speed = number(state, &["velocity", "exact"])?;
        Ok(TrackRow {
            line: u64::from(state.document().text_pos_at(state.range().start).row),
            track: self.track,
            // To a microsecond, so that 11 · 0.1 s lies on the 100 ms grid.
            time_ms: (time * step * 1e6).round() / 1e3,
            state: RawState {
                x,
                y,
                vx: speed * heading.cos(),
                vy: speed * heading.sin(),
                heading,
            },
            length: self.length,
            width: self.width,
        })
    }
}
