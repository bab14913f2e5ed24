//! Synthetic scenarios: a seeded generator of naturalistic traffic at unsignalized intersections.
//!
//! Sites of several classes are laid out with drawn measures (`layout`); people
//! with drawn characters cross them (`traffic`, `human`); what they did is
//! recorded as INTERACTION's tracks are, and goes through the same extraction.
//! No recorded track is used, so what is learned from it may be shipped.

mod description;
mod human;
mod layout;
mod profile;
mod rules;
mod traffic;
mod zone;

use crate::data::{Dataset, Files, Recording, Site, extract};
use crate::encounter::Encounter;
use layout::{Control, Layout};
use rand::RngExt;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use traffic::Traffic;

/// Length of a recording in steps: two minutes.
const STEPS: u32 = 1200;
/// Steps before the recording begins, so that it begins in the middle of things.
const WARM_UP: u32 = 400;
/// Recordings of one site.
const RECORDINGS_PER_SITE: u16 = 4;
/// The classes of sites, in turn: all-way stops, as the recorded sites are, most often.
const CLASSES: [(Control, usize, &str); 10] = [
    (Control::AllWayStop, 3, "T-AWS"),
    (Control::AllWayStop, 4, "X-AWS"),
    (Control::TwoWayStop, 3, "T-TWS"),
    (Control::AllWayStop, 4, "X-AWS"),
    (Control::AllWayStop, 3, "T-AWS"),
    (Control::TwoWayStop, 4, "X-TWS"),
    (Control::Uncontrolled, 3, "T-UNC"),
    (Control::AllWayStop, 3, "T-AWS"),
    (Control::Uncontrolled, 4, "X-UNC"),
    (Control::AllWayStop, 4, "X-AWS"),
];
/// Recordings that are generated at a time, until there are encounters enough.
const BATCH: u16 = 20;

/// A generated recording with its encounters.
struct Generated {
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
        let every_seventh = |rest| (0..last).filter(|file| file % 7 == rest).collect();
        let mut dataset = Self {
            site: Site::by_headings("synthetic"),
            map: None,
            recordings: Vec::new(),
            encounters: Vec::new(),
            passed_over: Vec::new(),
        };
        dataset.site.split = Files {
            validation: every_seventh(5),
            test: every_seventh(6),
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
        let classes = CLASSES.len() as u16;
        let (class, round) = (file % classes, file / (classes * RECORDINGS_PER_SITE));
        let (control, arms, name) = CLASSES[usize::from(class)];
        let number = class + classes * round;
        let layout = Layout::draw(
            format!("SYN-{name}-{number}"),
            control,
            arms,
            &mut stream(seed, number, 0),
        );
        let mut rng = stream(seed, file, 1);
        let flow = match control {
            Control::AllWayStop => rng.random_range(0.1..0.7),
            _ => rng.random_range(0.08..0.3),
        };
        let tracks = Traffic::new(&layout, flow, rng).record(WARM_UP, STEPS);
        let recording = Recording { file, tracks };
        let site = layout
            .site()
            .unwrap_or_else(|_| Site::by_headings(&layout.name));
        let encounters = extract(&site, &recording);
        Self {
            recording,
            encounters,
        }
    }
}

/// The random numbers of one item; none depends on another item.
fn stream(seed: u64, item: u16, purpose: u8) -> Pcg64 {
    Pcg64::new(
        u128::from(seed),
        u128::from(item) << 8 | u128::from(purpose),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encounter::Manoeuvre;
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
        let data = Dataset::synthetic(250, 1);
        let class = |e: &Encounter| e.id.site[4..9].to_owned();
        let classes: HashSet<String> = data.encounters.iter().map(class).collect();
        assert_eq!(classes.len(), 6, "{classes:?}");
        let kinds: HashSet<ConflictKind> = data.encounters.iter().map(|e| e.kind).collect();
        assert_eq!(kinds.len(), 3, "{kinds:?}");
        let manoeuvre = |e: &Encounter| e.participants[0].manoeuvre;
        let left = data
            .encounters
            .iter()
            .filter(|&e| manoeuvre(e) == Manoeuvre::Left)
            .count();
        assert!(left * 2 > data.encounters.len());
    }
}
