//! From recorded tracks to encounters: readers, site descriptions, extraction; and synthetic traffic.
#![forbid(unsafe_code)]

pub mod commonroad;
mod crossing;
mod draft;
pub mod encounter;
mod error;
mod extract;
mod files;
pub mod generic;
pub mod interaction;
pub mod lanelet;
mod motion;
pub mod output;
pub mod projection;
mod rights;
mod role;
mod site;
mod summary;
pub mod synthetic;
mod table;
mod tracks;
mod traffic;

pub use draft::draft;
pub use encounter::{Encounter, EncounterId, Participant, Sample, SimRoute};
pub use error::{DataError, Problem};
pub use extract::{NEAR, extract};
pub use rights::{Entry, Rights, Rule};
pub use role::{Manoeuvre, Role};
pub use site::{Files, Site};
pub use summary::{Distribution, FileSummary, REST, RightsSummary, Summary};
pub use tracks::{RawState, Recording, STEP_MS, Scene, Track};
pub use traffic::Traffic;

use lanelet::{ConflictArea, Map};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// A site's recordings and the encounters in them.
#[derive(Clone, Debug)]
pub struct Dataset {
    /// The site.
    pub site: Site,
    /// The recordings, ordered by number; a folder may lack some.
    pub recordings: Vec<Recording>,
    /// The encounters, ordered by file and, within it, by the recorded tracks.
    pub encounters: Vec<Encounter>,
    /// The site's map, if there is one beside the recordings.
    pub map: Option<Map>,
    /// Files that were passed over because they hold pedestrians.
    pub passed_over: Vec<PathBuf>,
}

/// A share of a data set; what is there of it, if the folder lacks some files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Split {
    /// To learn from.
    Train,
    /// To stop and to compare on.
    Validation,
    /// To judge by.
    Test,
    /// Everything.
    All,
}

/// One round of a cross-validation by file: learn from `train`, judge on `held_out`.
#[derive(Clone, Debug)]
pub struct Fold<'d> {
    /// The encounters of the files that are kept.
    pub train: Vec<&'d Encounter>,
    /// The encounters of the files that are left out; none if there are fewer files than rounds.
    pub held_out: Vec<&'d Encounter>,
}

impl Dataset {
    /// The recordings of the site called `site` (see [`Site::named`]) in the folder `dir`. If nothing describes a site
    /// of that name, `NAME.toml` beside the folder of its files does, where [`synthetic::write`] puts it.
    ///
    /// `dir` is the folder of the site's files, or one that holds it (also under
    /// `recorded_trackfiles`, as INTERACTION is shipped), or a single file. In a
    /// folder with `vehicle_tracks_NNN.csv` those are read ([`interaction`]); in
    /// any other, all `*.csv` ([`generic`]), numbered by the digits at the end of
    /// their names, or else in alphabetical order. The map is the `.osm` file of the
    /// folder's name, beside it or under `maps`. The files are read and searched
    /// in parallel; the result does not depend on the number of threads.
    ///
    /// If `dir` is a CommonRoad scenario (`.xml`), or a folder with scenarios and no CSV, those are read
    /// ([`commonroad`]), numbered in alphabetical order. Each brings its own map and name; every two
    /// vehicles whose ways cross or merge are an encounter, and all encounters are for testing. There
    /// `site` counts only if it is the path of a site description.
    ///
    /// # Errors
    /// When the folder holds no recording, or a file is malformed.
    pub fn load(dir: &Path, site: &str) -> Result<Self, DataError> {
        let scenarios = files::scenarios(dir)?;
        if !scenarios.is_empty() {
            return commonroad::dataset(dir, site, &scenarios);
        }
        let site = described(dir, Site::named(site)?)?;
        let found = files::find(dir, &site)?;
        let recordings = found
            .recordings
            .par_iter()
            .map(|file| file.read())
            .collect::<Result<Vec<_>, _>>()?;
        let map = found.map.as_deref().map(lanelet::read).transpose()?;
        Ok(Self {
            passed_over: found.passed_over,
            ..Self::new(site, recordings, map)
        })
    }

    /// The sites whose folders are in `dir`, or in its `recorded_trackfiles`, by their folders' names in
    /// alphabetical order: what [`Dataset::load`] takes. Scenarios together are one.
    ///
    /// # Errors
    /// `dir` cannot be read, or there is no folder with recordings in it.
    pub fn sites(dir: &Path) -> Result<Vec<String>, DataError> {
        files::sites(dir)
    }

    /// The encounters of `recordings` at `site`, with the rights that its `map` gives them. A recording with a
    /// [`Scene`] of its own is judged by the rules of `site` on the scene's map.
    #[must_use]
    pub fn new(site: Site, recordings: Vec<Recording>, map: Option<Map>) -> Self {
        let encounters = |recording: &Recording| match &recording.scene {
            None => extract(&site, map.as_ref(), recording),
            Some(scene) => {
                let mut named = site.clone();
                named.name.clone_from(&scene.name);
                extract(&named, Some(&scene.map), recording)
            }
        };
        let encounters = recordings.par_iter().flat_map_iter(encounters).collect();
        Self {
            site,
            recordings,
            encounters,
            map,
            passed_over: Vec::new(),
        }
    }

    /// The same recordings, with the encounters of every two vehicles whose ways cross or merge
    /// ([`Site::every_pair`]).
    #[must_use]
    pub fn every_pair(&self) -> Self {
        let mut site = self.site.clone();
        site.every_pair = true;
        Self::new(site, self.recordings.clone(), self.map.clone())
    }

    /// The map on which `file` was recorded.
    #[must_use]
    pub fn map_of(&self, file: u16) -> Option<&Map> {
        let scene = self.recording(file).and_then(|r| r.scene.as_deref());
        scene.map(|scene| &scene.map).or(self.map.as_ref())
    }

    /// Where the lanes of the judged vehicles of `encounter` overlap. `None` if they do not, or without a map.
    ///
    /// Cost: the matching of two tracks to the map.
    #[must_use]
    pub fn conflict_area(&self, encounter: &Encounter) -> Option<ConflictArea> {
        let map = self.map_of(encounter.id.file)?;
        let tracks = &self.recording(encounter.id.file)?.tracks;
        let trace = |id| Some(map.trace(tracks.iter().find(|track| track.id == id)?));
        let [left, other] = [trace(encounter.id.left)?, trace(encounter.id.other)?];
        map.conflict_area([&left, &other])
    }

    fn recording(&self, file: u16) -> Option<&Recording> {
        self.recordings
            .iter()
            .find(|recording| recording.file == file)
    }

    /// The encounters of `split`, in order.
    pub fn split(&self, split: Split) -> impl Iterator<Item = &Encounter> {
        let files = &self.site.split;
        self.encounters.iter().filter(move |encounter| {
            let file = encounter.id.file;
            let of = if files.test.contains(&file) {
                Split::Test
            } else if files.validation.contains(&file) {
                Split::Validation
            } else {
                Split::Train
            };
            split == Split::All || split == of
        })
    }

    /// The numbers of the files that have encounters, in order.
    #[must_use]
    pub fn files(&self) -> Vec<u16> {
        let mut files: Vec<u16> = self.encounters.iter().map(|e| e.id.file).collect();
        files.dedup();
        files
    }

    /// Cross-validation by file in this number of `rounds`: of the files that have encounters, round i leaves
    /// out the i-th and every `rounds`-th after it. With as many rounds as files it is leave-one-file-out.
    #[must_use]
    pub fn folds(&self, rounds: usize) -> Vec<Fold<'_>> {
        let files = self.files();
        let fold = |round: usize| {
            let out: Vec<u16> = files.iter().copied().skip(round).step_by(rounds).collect();
            let of_those = |e: &&Encounter| out.contains(&e.id.file);
            let (held_out, train) = self.encounters.iter().partition(of_those);
            Fold { train, held_out }
        };
        (0..rounds).map(fold).collect()
    }
}

/// `site` by the scene description beside its recordings, if it has none yet and there is one.
fn described(dir: &Path, site: Site) -> Result<Site, DataError> {
    match files::description(dir, &site) {
        Some(path) if site.is_by_headings() => Site::read(&path),
        _ => Ok(site),
    }
}
