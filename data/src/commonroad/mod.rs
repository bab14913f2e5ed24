//! CommonRoad scenarios (XML, version 2020a): a road network with its signs, and how vehicles moved on it.
//!
//! | element | becomes |
//! |---|---|
//! | `lanelet`, `trafficSign`, `intersection` | the map: lanelets, limits, who gives way to whom |
//! | `dynamicObstacle` with a `trajectory` | a track, resampled to 10 Hz |
//!
//! Pedestrians, cyclists, static obstacles and planning problems are passed over.

mod road;
mod vehicle;
mod xml;

use super::error::{DataError, Problem};
use super::lanelet::Map;
use super::site::{Files, Site};
use super::tracks::{Recording, Scene, Track};
use super::{Dataset, files};
use rayon::prelude::*;
use roxmltree::{Document, Node};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use xml::{Fault, attribute, fault};

/// The version that is read.
const VERSION: &str = "2020a";

/// A scenario.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Its `benchmarkID`, as in `ZAM_Tjunction-1_97_T-1`.
    pub name: String,
    /// Its road network.
    pub map: Map,
    /// The vehicles' tracks in the order of the file.
    pub tracks: Vec<Track>,
}

/// The scenario in the file at `path`.
///
/// # Errors
/// When the file cannot be read, or on the first element that makes no sense, with its line.
pub fn read(path: &Path) -> Result<Scenario, DataError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| DataError::new(path, Problem::Unreadable(error)))?;
    let wrong = |line: u32, problem| {
        DataError::new(path, Problem::Scenario(problem)).at_line(u64::from(line))
    };
    let document =
        Document::parse(&text).map_err(|error| wrong(error.pos().row, error.to_string()))?;
    let line = |place| document.text_pos_at(place).row;
    let told = |Fault(place, problem)| wrong(line(place), problem);
    let root = document.root_element();
    let name = header(root).map_err(told)?;
    let map = road::read(root).map_err(told)?;
    let tracks = vehicle::read(root, path, &told)?;
    Ok(Scenario { name, map, tracks })
}

/// The name of a scenario of the version that is read.
fn header(root: Node<'_, '_>) -> Result<String, Fault> {
    if !root.has_tag_name("commonRoad") {
        let tag = root.tag_name().name();
        return Err(fault(root, format!("the outermost element is <{tag}>")));
    }
    let version = attribute(root, "commonRoadVersion")?;
    if version != VERSION {
        return Err(fault(root, format!("its version is `{version}`")));
    }
    Ok(attribute(root, "benchmarkID")?.to_owned())
}

/// The scenarios of `files` as one data set: each is a recording with a map of its own, and every two vehicles whose
/// ways cross or merge are an encounter. All are for testing, unless `site` is the path of a site description.
pub(crate) fn dataset(dir: &Path, site: &str, files: &[PathBuf]) -> Result<Dataset, DataError> {
    let scenarios = files.par_iter().map(|file| read(file));
    let scenarios = scenarios.collect::<Result<Vec<_>, _>>()?;
    let too_many = |_| DataError::new(dir, Problem::Scenario("more than 65536 files".to_owned()));
    let numbers = (0..scenarios.len()).map(u16::try_from);
    let numbers = numbers.collect::<Result<Vec<_>, _>>().map_err(too_many)?;
    let map = match scenarios.as_slice() {
        [only] => Some(only.map.clone()),
        _ => None,
    };
    let site = if site.ends_with(".toml") {
        Site::named(site)?
    } else {
        let name = match scenarios.as_slice() {
            [only] => only.name.clone(),
            _ => files::name_of(dir),
        };
        let mut site = Site::by_headings(&name);
        site.every_pair = true;
        site.split = Files {
            validation: Vec::new(),
            test: numbers.clone(),
        };
        site
    };
    let recordings = numbers.into_iter().zip(scenarios);
    let recordings = recordings.map(|(file, scenario)| Recording {
        file,
        tracks: scenario.tracks,
        scene: Some(Arc::new(Scene {
            name: scenario.name,
            map: scenario.map,
        })),
    });
    Ok(Dataset::new(site, recordings.collect(), map))
}
