//! Which encounters the report replays.

use cede_controller::ConflictKind;
use cede_data::{Dataset, Encounter, Role, Split};

/// The paper's case studies at its site EP0: file, left-turner, other.
const PAPER: [(u16, u32, u32); 3] = [(7, 25, 26), (7, 49, 48), (7, 57, 61)];

/// Number of encounters for each split, kind and outcome.
const OF_EACH: usize = 2;
/// Minimum length (steps).
const SHORTEST: u32 = 50;
/// Maximum length (steps); longer encounters consist mostly of waiting.
const LONGEST: u32 = 200;

/// The paper's cases in the data, and the closest encounters of each class.
pub(super) fn choose(dataset: &Dataset) -> Vec<&Encounter> {
    let mut chosen: Vec<&Encounter> = Vec::new();
    if dataset.site.name == "EP0" {
        let named = |case| move |e: &&Encounter| (e.id.file, e.id.left, e.id.other) == case;
        chosen.extend(
            PAPER
                .iter()
                .filter_map(|&case| dataset.encounters.iter().find(named(case))),
        );
    }
    for split in [Split::Test, Split::Validation, Split::Train] {
        for kind in [ConflictKind::Crossing, ConflictKind::Merging] {
            for first in Role::BOTH {
                let of_class = |e: &&Encounter| e.kind == kind && e.first == first;
                let mut class: Vec<&Encounter> = dataset.split(split).filter(of_class).collect();
                class.retain(|e| (SHORTEST..=LONGEST).contains(&e.steps));
                class.sort_by(|a, b| a.pet.total_cmp(&b.pet).then_with(|| a.id.cmp(&b.id)));
                let new = class
                    .into_iter()
                    .filter(|e| chosen.iter().all(|c| c.id != e.id));
                let new: Vec<&Encounter> = new.take(OF_EACH).collect();
                chosen.extend(new);
            }
        }
    }
    chosen
}
