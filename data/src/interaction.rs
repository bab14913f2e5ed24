//! INTERACTION's `vehicle_tracks_NNN.csv` (Zhan et al., 2019): one row for each vehicle and 100 ms.

use super::error::{DataError, Problem};
use super::table::{Format, Place, Table};
use super::tracks::{RawState, Track, TrackRow, Tracks};
use serde::Deserialize;
use std::path::Path;

const FORMAT: Format = Format {
    required: &[
        "track_id",
        "timestamp_ms",
        "x",
        "y",
        "vx",
        "vy",
        "psi_rad",
        "length",
        "width",
    ],
    mend: "the header should be track_id,frame_id,timestamp_ms,agent_type,x,y,vx,vy,psi_rad,length,width",
};

/// A row as it stands in the file; `frame_id` repeats `timestamp_ms` and is not read.
#[derive(Deserialize)]
struct Fields {
    track_id: u32,
    timestamp_ms: u64,
    #[serde(default)]
    agent_type: AgentType,
    x: f64,
    y: f64,
    vx: f64,
    vy: f64,
    psi_rad: f64,
    length: f64,
    width: f64,
}

#[derive(Default, Deserialize, PartialEq)]
enum AgentType {
    #[serde(rename = "pedestrian/bicycle")]
    PedestrianOrBicycle,
    /// `car`, `truck`, `bus` …: whatever drives.
    #[default]
    #[serde(other)]
    Vehicle,
}

/// The vehicles' tracks of the file at `path`; pedestrians among them are passed over.
///
/// # Errors
/// On the first row that makes no sense, with its line, column and the mend.
pub fn read(path: &Path) -> Result<Vec<Track>, DataError> {
    let table = Table::read(path)?;
    let mut tracks = Tracks::default();
    table
        .for_each(&FORMAT, |place, fields: Fields| {
            if fields.agent_type == AgentType::PedestrianOrBicycle {
                return Ok(());
            }
            let row = checked(place, &fields)?;
            if place.cut && tracks.size(row.track).is_some_and(|(_, w)| w != row.width) {
                return Err(place.error(Problem::Truncated));
            }
            tracks.push(path, &row)
        })
        .map_err(|error| pedestrians_or(&table, error))?;
    Ok(tracks.finish())
}

fn checked(place: Place<'_>, fields: &Fields) -> Result<TrackRow, DataError> {
    Ok(TrackRow {
        line: place.line,
        track: fields.track_id,
        time_ms: fields.timestamp_ms as f64,
        state: RawState {
            x: place.coordinate("x", fields.x)?,
            y: place.coordinate("y", fields.y)?,
            vx: place.finite("vx", fields.vx)?,
            vy: place.finite("vy", fields.vy)?,
            heading: place.finite("psi_rad", fields.psi_rad)?,
        },
        length: place.positive("length", fields.length)?,
        width: place.positive("width", fields.width)?,
    })
}

/// A pedestrian file lacks the last three columns; say so rather than name the first of them.
fn pedestrians_or(table: &Table<'_>, error: DataError) -> DataError {
    let lacks_heading = matches!(
        error.problem,
        Problem::MissingColumn {
            name: "psi_rad",
            ..
        }
    );
    if lacks_heading && table.mentions("pedestrian") {
        return DataError::new(&error.path, Problem::Pedestrians);
    }
    error
}
