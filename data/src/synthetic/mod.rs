//! Synthetic scenarios: a seeded generator of naturalistic traffic at unsignalized intersections.
//!
//! Sites of several classes are laid out with drawn measures (`layout`); people
//! with drawn characters cross them (`traffic`, `human`); what they did is
//! recorded as INTERACTION's tracks are, and goes through the same extraction.
//! No recorded track is used, so what is learned from it may be shipped.

mod description;
mod files;
pub mod human;
mod layout;
mod map;
mod plan;
pub mod profile;
mod rules;
mod traffic;
pub mod zone;

pub use files::{WrittenSite, remove, write};

use crate::encounter::Encounter;
use crate::{Dataset, Files, Recording, Site, extract, lanelet};
use layout::Layout;
use plan::{Control, Purpose, in_test, in_validation, site_of, stream};
use rand::RngExt;
use rayon::prelude::*;
use std::path::Path;
use traffic::Traffic;

/// Length of a recording in steps: one minute.
const STEPS: u32 = 600;
/// Steps before the recording begins, so that it begins in the middle of things.
const WARM_UP: u32 = 400;
/// Recordings that are generated at a time, until there are encounters enough.
const BATCH: u16 = 20;

/// A generated recording with its encounters.
struct Generated {
    layout: Layout,
    recording: Recording,
    encounters: Vec<Encounter>,
}

impl Dataset {
    /// At least `encounters` synthetic encounters (whole recordings), the same for the same
    /// `seed` on any number of threads.
    ///
    /// Its recordings come from many sites; the encounters' names tell which. Files are numbered
    /// through; two of seven are kept for validation and test. At most 65,535 recordings, which is
    /// more than half a million encounters. Cost: about 0.5 ms an encounter.
    #[must_use]
    pub fn synthetic(encounters: usize, seed: u64) -> Self {
        let generated = generate(encounters, seed);
        let last = u16::try_from(generated.len()).unwrap_or(u16::MAX);
        let mut dataset = Self {
            site: Site::by_headings("synthetic"),
            map: None,
            recordings: Vec::new(),
            encounters: Vec::new(),
            passed_over: Vec::new(),
        };
        dataset.site.split = Files {
            validation: (0..last).filter(|&file| in_validation(file)).collect(),
            test: (0..last).filter(|&file| in_test(file)).collect(),
        };
        for item in generated {
            dataset.recordings.push(item.recording);
            dataset.encounters.extend(item.encounters);
        }
        dataset
    }
}

fn generate(encounters: usize, seed: u64) -> Vec<Generated> {
    let mut generated: Vec<Generated> = Vec::new();
    let mut count = 0;
    let mut next = 0;
    while count < encounters && next < u16::MAX - BATCH {
        let batch = (next..next + BATCH)
            .into_par_iter()
            .map(|file| Generated::new(file, seed));
        for item in batch.collect::<Vec<_>>() {
            if count < encounters {
                count += item.encounters.len();
                generated.push(item);
            }
        }
        next += BATCH;
    }
    generated
}

impl Generated {
    fn new(file: u16, seed: u64) -> Self {
        let layout = Layout::draw(site_of(file), seed);
        let mut rng = stream(seed, file, Purpose::Traffic);
        let flow = match layout.control {
            Control::AllWayStop => rng.random_range(0.12..0.7),
            Control::TwoWayStop | Control::Yield => rng.random_range(0.2..0.8),
            Control::Uncontrolled => rng.random_range(0.08..0.3),
        };
        let tracks = Traffic::new(&layout, flow, rng).record(WARM_UP, STEPS);
        let recording = Recording {
            file,
            tracks,
            scene: None,
        };
        // The map is ours and its tests read it; without it nothing would be known of the rights.
        let map = lanelet::parse(Path::new(&layout.name), &layout.osm()).ok();
        let encounters = extract(&layout.site(), map.as_ref(), &recording);
        Self {
            layout,
            recording,
            encounters,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::role::Manoeuvre;
    use cede_controller::ConflictKind;
    use std::collections::HashSet;

    #[test]
    fn the_same_seed_gives_the_same_bits_on_any_number_of_threads() {
        let on = |threads: usize, seed: u64| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            format!("{:?}", pool.install(|| Dataset::synthetic(20, seed)))
        };
        let one = on(1, 7);
        assert_eq!(one, on(3, 7));
        assert_ne!(one, on(1, 8));
    }

    #[test]
    fn fewer_encounters_are_the_beginning_of_more() {
        let (few, many) = (Dataset::synthetic(20, 3), Dataset::synthetic(60, 3));
        assert!((20..60).contains(&few.encounters.len()) && many.encounters.len() >= 60);
        let ids = |data: &Dataset| {
            data.encounters
                .iter()
                .map(|e| e.id.clone())
                .collect::<Vec<_>>()
        };
        assert!(ids(&many).starts_with(&ids(&few)));
    }

    #[test]
    fn every_class_of_site_and_conflict_occurs() {
        let data = Dataset::synthetic(1000, 1);
        let class = |e: &Encounter| e.id.site[4..9].to_owned();
        let classes: HashSet<String> = data.encounters.iter().map(class).collect();
        assert_eq!(classes.len(), 9, "{classes:?}");
        let kinds: HashSet<ConflictKind> = data.encounters.iter().map(|e| e.kind).collect();
        assert_eq!(kinds.len(), 3, "{kinds:?}");
        let manoeuvre = |e: &Encounter| e.participants[0].manoeuvre;
        let left = data
            .encounters
            .iter()
            .filter(|&e| manoeuvre(e) == Manoeuvre::Left)
            .count();
        assert!(left * 3 > data.encounters.len(), "{left} left-turners");
    }
}
