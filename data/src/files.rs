//! Where a site's files are.

use super::error::{DataError, Problem};
use super::site::Site;
use super::tracks::Recording;
use super::{generic, interaction};
use std::path::{Path, PathBuf};

/// What a folder holds.
pub(crate) struct Found {
    pub(crate) recordings: Vec<RecordingFile>,
    pub(crate) passed_over: Vec<PathBuf>,
    pub(crate) map: Option<PathBuf>,
}

/// A file that is to be read.
pub(crate) struct RecordingFile {
    path: PathBuf,
    number: u16,
}

impl RecordingFile {
    pub(crate) fn read(&self) -> Result<Recording, DataError> {
        let tracks = if starts_with(&self.path, "vehicle_tracks") {
            interaction::read(&self.path)?
        } else {
            generic::read(&self.path)?
        };
        Ok(Recording {
            file: self.number,
            tracks,
            scene: None,
        })
    }
}

/// The recordings of `site` in or below `dir`.
pub(crate) fn find(dir: &Path, site: &Site) -> Result<Found, DataError> {
    if dir.is_file() {
        let map = dir.parent().and_then(|folder| map_of(folder, site));
        return Ok(Found {
            map,
            ..sort(vec![dir.to_owned()])
        });
    }
    for place in places(dir, site) {
        let found = sort(csv_files(&place)?);
        if !found.recordings.is_empty() {
            let map = map_of(&place, site);
            return Ok(Found { map, ..found });
        }
    }
    let site = site.name.clone();
    Err(DataError::new(dir, Problem::NoRecordings { site }))
}

/// The scene description that lies beside the recordings of `site`, called like it.
pub(crate) fn description(dir: &Path, site: &Site) -> Option<PathBuf> {
    let dir = match dir.canonicalize().ok()? {
        file if file.is_file() => file.parent()?.to_owned(),
        folder => folder,
    };
    places(&dir, site).find_map(|place| {
        let beside = place.parent()?;
        let names = [&site.folder, &site.name].map(|name| format!("{name}.toml"));
        let mut candidates = names.iter().map(|name| beside.join(name));
        candidates.find(|path| path.is_file())
    })
}

/// Where the recordings of `site` may be, in the order in which they are looked for.
fn places(dir: &Path, site: &Site) -> impl Iterator<Item = PathBuf> {
    let named = [
        folder_of(dir, site),
        folder_of(&dir.join("recorded_trackfiles"), site),
    ];
    named.into_iter().flatten().chain([dir.to_owned()])
}

/// The names of the folders with recordings in `dir` or in its `recorded_trackfiles`, in alphabetical order.
pub(crate) fn sites(dir: &Path) -> Result<Vec<String>, DataError> {
    if !scenarios(dir)?.is_empty() {
        return Ok(vec![name_of(dir)]);
    }
    let inner = dir.join("recorded_trackfiles");
    let dir = if inner.is_dir() { &inner } else { dir };
    let unreadable = |error| DataError::new(dir, Problem::Unreadable(error));
    let mut names = Vec::new();
    for entry in std::fs::read_dir(dir).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.is_dir() && !sort(csv_files(&path)?).recordings.is_empty() {
            names.extend(
                path.file_name()
                    .map(|name| name.to_string_lossy().into_owned()),
            );
        }
    }
    if names.is_empty() {
        return Err(DataError::new(dir, Problem::NoSites));
    }
    names.sort();
    Ok(names)
}

/// The folder in `dir` that is called like the site, or ends in `_` and the site's name.
fn folder_of(dir: &Path, site: &Site) -> Option<PathBuf> {
    let exact = dir.join(&site.folder);
    if exact.is_dir() {
        return Some(exact);
    }
    let ending = format!("_{}", site.name);
    let mut matching: Vec<PathBuf> = std::fs::read_dir(dir)
        .ok()?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.is_dir() && path.to_string_lossy().ends_with(&ending))
        .collect();
    matching.sort();
    matching.into_iter().next()
}

/// The map in the folder of the recordings, beside it, or where INTERACTION has it.
fn map_of(recordings: &Path, site: &Site) -> Option<PathBuf> {
    let recordings = recordings.canonicalize().ok()?;
    let folder = recordings.file_name()?.to_string_lossy().into_owned();
    let places = ["", "..", "../maps", "../../maps"].map(|way| recordings.join(way));
    let names = [folder, site.folder.clone(), site.name.clone()].map(|name| name + ".osm");
    let candidates = places
        .iter()
        .flat_map(|place| names.iter().map(move |name| place.join(name)));
    candidates.into_iter().find(|path| path.is_file())
}

/// The CommonRoad scenarios at `dir`: itself, or those in a folder that holds no CSV. None in any other place.
pub(crate) fn scenarios(dir: &Path) -> Result<Vec<PathBuf>, DataError> {
    if dir.extension().is_some_and(|extension| extension == "xml") {
        return Ok(vec![dir.to_owned()]);
    }
    if !dir.is_dir() || !csv_files(dir)?.is_empty() {
        return Ok(Vec::new());
    }
    files_in(dir, "xml")
}

/// The last part of a path: what a folder is called.
pub(crate) fn name_of(dir: &Path) -> String {
    let whole = dir.canonicalize().unwrap_or_else(|_| dir.to_owned());
    let name = whole.file_name().unwrap_or(whole.as_os_str());
    name.to_string_lossy().into_owned()
}

fn csv_files(dir: &Path) -> Result<Vec<PathBuf>, DataError> {
    files_in(dir, "csv")
}

fn files_in(dir: &Path, ending: &str) -> Result<Vec<PathBuf>, DataError> {
    let unreadable = |error| DataError::new(dir, Problem::Unreadable(error));
    let mut files = Vec::new();
    for entry in std::fs::read_dir(dir).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path
            .extension()
            .is_some_and(|extension| extension == ending)
        {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// Pedestrians are passed over; where there are INTERACTION files, nothing else is read.
fn sort(files: Vec<PathBuf>) -> Found {
    let of_pedestrians = |path: &PathBuf| starts_with(path, "pedestrian_tracks");
    let (passed_over, mut files): (Vec<_>, Vec<_>) = files.into_iter().partition(of_pedestrians);
    if files.iter().any(|path| starts_with(path, "vehicle_tracks")) {
        files.retain(|path| starts_with(path, "vehicle_tracks"));
    }
    let numbered = files.into_iter().zip(0..);
    let mut recordings: Vec<RecordingFile> = numbered
        .map(|(path, place)| RecordingFile {
            number: number(&path).unwrap_or(place),
            path,
        })
        .collect();
    recordings.sort_by_key(|file| file.number);
    Found {
        recordings,
        passed_over,
        map: None,
    }
}

fn starts_with(path: &Path, beginning: &str) -> bool {
    path.file_name()
        .is_some_and(|name| name.to_string_lossy().starts_with(beginning))
}

/// The digits at the end of a file's stem, as in `vehicle_tracks_007.csv`.
fn number(path: &Path) -> Option<u16> {
    let stem = path.file_stem()?.to_string_lossy();
    let digits = stem.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    stem[digits..].parse().ok()
}
