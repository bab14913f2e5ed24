//! Synthetic recordings as files: INTERACTION's tracks, Lanelet2 maps and scene descriptions.

use super::plan::PREFIX;
use super::{Generated, generate};
use crate::output::{self, OutputError};
use crate::{RawState, Recording};
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// How the names of recordings begin.
const TRACKS: &str = "vehicle_tracks_";

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
/// description. `Dataset::load(dir, "SITE")` gives the same encounters, bit for bit:
/// the tracks have three decimals in memory as they have in the files. What another run wrote there stays
/// unless it has the same name: [`remove`] takes it away.
///
/// # Errors
/// When a file cannot be written; no file is left half-written.
pub fn write(dir: &Path, encounters: usize, seed: u64) -> Result<Vec<WrittenSite>, OutputError> {
    let generated = generate(encounters, seed);
    let mut sites: BTreeMap<&str, Vec<&Generated>> = BTreeMap::new();
    for item in &generated {
        sites.entry(&item.layout.name).or_default().push(item);
        let folder = dir.join(&item.layout.name);
        let name = format!("{TRACKS}{:03}.csv", item.recording.file);
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

/// Removes from `dir` what [`write()`] writes: recordings, maps and scene descriptions of synthetic sites. All else stays.
///
/// # Errors
/// When the folder cannot be read, or a file in it not removed.
pub fn remove(dir: &Path) -> Result<(), OutputError> {
    for path in beginning(PREFIX, dir)? {
        if path.is_dir() {
            let mut recordings = beginning(TRACKS, &path)?.into_iter();
            recordings.try_for_each(|file| remove_file(&file))?;
            // It stays if somebody has put something else there.
            let _ = fs::remove_dir(&path);
        } else if path
            .extension()
            .is_some_and(|it| it == "osm" || it == "toml")
        {
            remove_file(&path)?;
        }
    }
    Ok(())
}

/// What is in `dir` under names that begin with `prefix`.
fn beginning(prefix: &str, dir: &Path) -> Result<Vec<PathBuf>, OutputError> {
    let entries = fs::read_dir(dir).and_then(Iterator::collect::<io::Result<Vec<_>>>);
    let mut entries = entries.map_err(failed(dir))?;
    entries.retain(|entry| entry.file_name().to_string_lossy().starts_with(prefix));
    Ok(entries.iter().map(fs::DirEntry::path).collect())
}

fn remove_file(path: &Path) -> Result<(), OutputError> {
    fs::remove_file(path).map_err(failed(path))
}

fn failed(path: &Path) -> impl FnOnce(io::Error) -> OutputError {
    let path = path.to_owned();
    |source| OutputError { path, source }
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
