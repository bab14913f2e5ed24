//! Synthetic recordings as files: INTERACTION's tracks, Lanelet2 maps and scene descriptions.

use super::{Generated, generate};
use crate::output::{self, OutputError};
use crate::{RawState, Recording};
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

/// What was written for one site.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenSite {
    /// Its name: that of its folder, its map (`.osm`) and its scene description (`.toml`).
    pub name: String,
    /// Numbers of its recordings.
    pub files: Vec<u16>,
    /// Encounters in them.
    pub encounters: usize,
}

/// Writes at least `encounters` encounters, those of [`crate::Dataset::synthetic`], into `dir`.
///
/// Every site has a folder of `vehicle_tracks_NNN.csv`, and beside it a map and a scene
/// description. `Dataset::load(dir, "dir/SITE.toml")` gives the same encounters, bit for bit:
/// the tracks have three decimals in memory as they have in the files.
///
/// # Errors
/// When a file cannot be written; no file is left half-written.
pub fn write(dir: &Path, encounters: usize, seed: u64) -> Result<Vec<WrittenSite>, OutputError> {
    let generated = generate(encounters, seed);
    let mut sites: BTreeMap<&str, Vec<&Generated>> = BTreeMap::new();
    for item in &generated {
        sites.entry(&item.layout.name).or_default().push(item);
        let folder = dir.join(&item.layout.name);
        let name = format!("vehicle_tracks_{:03}.csv", item.recording.file);
        output::write(&folder.join(name), |out| tracks(out, &item.recording))?;
    }
    let mut written = Vec::new();
    for (name, items) in sites {
        let layout = &items[0].layout;
        let texts = [("osm", layout.osm()), ("toml", layout.description())];
        for (extension, text) in texts {
            let path = dir.join(format!("{name}.{extension}"));
            output::write(&path, |out| out.write_all(text.as_bytes()))?;
        }
        written.push(WrittenSite {
            name: name.to_owned(),
            files: items.iter().map(|item| item.recording.file).collect(),
            encounters: items.iter().map(|item| item.encounters.len()).sum(),
        });
    }
    Ok(written)
}

fn tracks(out: &mut dyn Write, recording: &Recording) -> io::Result<()> {
    writeln!(
        out,
        "track_id,frame_id,timestamp_ms,agent_type,x,y,vx,vy,psi_rad,length,width"
    )?;
    for track in &recording.tracks {
        for (i, state) in (0..).zip(&track.states) {
            let time = track.first_ms + crate::STEP_MS * i;
            let RawState {
                x,
                y,
                vx,
                vy,
                heading,
            } = state;
            writeln!(
                out,
                "{},{},{time},car,{x:.3},{y:.3},{vx:.3},{vy:.3},{heading:.3},{:.3},{:.3}",
                track.id,
                time / crate::STEP_MS,
                track.length,
                track.width,
            )?;
        }
    }
    Ok(())
}
