//! Drivers on encounters: episodes on all cores, and the rows of the table.
//!
//! Every random choice comes from the seed and the encounter's name, and results are gathered in
//! the encounters' order, so they have the same bits on any number of threads.

mod clearance;
mod row;
mod selection;

pub use clearance::clearance;
pub use row::{ConfidenceInterval, Label, TableRow};
pub use selection::{Round, Selection, UnknownSelection};

use crate::driver::DriverFactory;
use crate::episode::{Episode, Until};
use crate::meeting::{Meeting, NoJunction};
use crate::metrics::Measures;
use cede_data::encounter::{Encounter, EncounterId, Role};
use rayon::prelude::*;

/// Who is under test.
#[derive(Clone, Copy)]
pub enum Mode<'a> {
    /// One driver commands both vehicles: the paper's protocol.
    Joint,
    /// It commands one vehicle, and drivers of this kind the other. Each encounter gives two
    /// episodes, one for each role of the ego.
    Ego(&'a dyn DriverFactory),
}

/// How episodes are driven.
#[derive(Clone, Copy)]
pub struct Protocol<'a> {
    /// Who is under test.
    pub mode: Mode<'a>,
    /// When an episode is over.
    pub until: Until,
    /// Every random choice comes from here.
    pub seed: u64,
}

/// One episode with what was measured on it.
pub struct Drive<'a> {
    /// What was driven.
    pub encounter: &'a Encounter,
    /// The vehicle under test; `None` if both were.
    pub ego: Option<Role>,
    /// What happened.
    pub episode: Episode,
    /// What was measured.
    pub measures: Measures,
}

/// An encounter that nobody drives, with a shield or without, because its routes are no junction.
#[derive(Clone, Copy, Debug)]
pub struct Refused<'a> {
    /// The encounter.
    pub encounter: &'a Encounter,
    /// What is wrong with its routes.
    pub why: NoJunction,
}

/// What came of [`evaluate`].
#[derive(Default)]
pub struct Evaluation<'a> {
    /// The episodes.
    pub drives: Vec<Drive<'a>>,
    /// The encounters without one.
    pub refused: Vec<Refused<'a>>,
}

/// Lets drivers of one kind drive all `encounters`; results come in the encounters' order.
///
/// Runs on the threads of the current rayon pool, with the same bits on any number of them.
#[must_use]
pub fn evaluate<'a>(
    factory: &dyn DriverFactory,
    encounters: &[&'a Encounter],
    protocol: Protocol<'_>,
) -> Evaluation<'a> {
    let egos: &[Option<Role>] = match protocol.mode {
        Mode::Joint => &[None],
        Mode::Ego(_) => &[Some(Role::Left), Some(Role::Other)],
    };
    let drive_all = |&encounter: &&'a Encounter| {
        let meeting = Meeting::new(encounter).map_err(|why| Refused { encounter, why })?;
        let exits = (protocol.until == Until::Cleared).then(|| clearance(&meeting));
        let drives = egos
            .iter()
            .map(|&ego| drive(factory, &meeting, ego, exits, protocol));
        Ok(drives.collect::<Vec<_>>())
    };
    let results: Vec<Result<_, _>> = encounters.par_iter().map(drive_all).collect();
    let mut evaluation = Evaluation::default();
    for result in results {
        match result {
            Ok(drives) => evaluation.drives.extend(drives),
            Err(refused) => evaluation.refused.push(refused),
        }
    }
    evaluation
}

/// Drives one episode; `exits` as [`Episode::run`]'s clearance.
fn drive<'a>(
    factory: &dyn DriverFactory,
    meeting: &Meeting<'a>,
    ego: Option<Role>,
    exits: Option<[f32; 2]>,
    protocol: Protocol<'_>,
) -> Drive<'a> {
    let encounter = meeting.encounter;
    let mut drivers = Role::BOTH.map(|role| {
        let factory = match protocol.mode {
            Mode::Ego(partner) if ego != Some(role) => partner,
            _ => factory,
        };
        let index = role as usize;
        factory.driver(meeting, index, seed(protocol.seed, &encounter.id, index))
    });
    let episode = Episode::run(encounter, &mut drivers, exits);
    let tested = ego.as_ref().map_or(&Role::BOTH[..], std::slice::from_ref);
    Drive {
        encounter,
        ego,
        measures: Measures::of(encounter, &episode, tested),
        episode,
    }
}

/// The seed of one vehicle's driver: the same whatever else is evaluated (FNV-1a over the name).
fn seed(seed: u64, id: &EncounterId, index: usize) -> u64 {
    let numbers = [
        u64::from(id.file),
        u64::from(id.left),
        u64::from(id.other),
        index as u64,
    ];
    let bytes = seed
        .to_le_bytes()
        .into_iter()
        .chain(id.site.bytes())
        .chain(numbers.into_iter().flat_map(u64::to_le_bytes));
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::{Baseline, Replay};
    use crate::fixture::crossing;

    fn encounters() -> Vec<Encounter> {
        (0_u8..12)
            .map(|i| {
                let x = f32::from(i);
                let mut encounter =
                    crossing([20.0 + 3.0 * x, 6.0], [50.0 - 2.0 * x, 4.0 + 0.3 * x]);
                encounter.id.left = u32::from(i);
                encounter
            })
            .collect()
    }

    fn rows(threads: usize, mode: Mode<'_>) -> Vec<TableRow> {
        let encounters = encounters();
        let references: Vec<&Encounter> = encounters.iter().collect();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let row = |baseline: Baseline| {
            let factory = baseline.fit(&references).unwrap();
            let protocol = Protocol {
                mode,
                until: Until::Cleared,
                seed: 1,
            };
            let drives = evaluate(&*factory, &references, protocol).drives;
            TableRow::of(label(baseline.name()), &drives)
        };
        pool.unwrap().install(|| Baseline::ALL.map(row).to_vec())
    }

    fn label(driver: &str) -> Label<'_> {
        Label {
            driver,
            site: "X",
            split: "all",
            mode: "joint",
            until: "cleared",
            shield: "off",
        }
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits() {
        assert_eq!(rows(1, Mode::Joint), rows(4, Mode::Joint));
        assert_eq!(rows(1, Mode::Ego(&Replay)), rows(3, Mode::Ego(&Replay)));
    }

    #[test]
    fn ego_mode_drives_every_encounter_in_both_roles() {
        let row = &rows(2, Mode::Ego(&Replay))[0];
        assert_eq!((row.n, row.encounters), (24, 12));
    }

    #[test]
    fn an_empty_split_has_a_row_without_shares() {
        let row = TableRow::of(label("replay"), &[]);
        assert_eq!((row.n, row.collisions), (0, 0));
        assert_eq!(row.priority_accuracy, None);
        assert_eq!(row.episode_length_error, None);
    }

    #[test]
    fn seeds_differ_between_vehicles_and_encounters() {
        let [a, b] = [0, 1].map(|i| encounters()[i].id.clone());
        assert_ne!(seed(1, &a, 0), seed(1, &a, 1));
        assert_ne!(seed(1, &a, 0), seed(1, &b, 0));
        assert_ne!(seed(1, &a, 0), seed(2, &a, 0));
    }
}
