//! Encounters that are not driven.

use cede_data::{Encounter, EncounterId};
use cede_sim::Meeting;
use cede_sim::evaluate::{Drive, Evaluation, Refused};
use std::collections::BTreeSet;

/// The encounters of which the user has been told that they are left out.
#[derive(Default)]
pub(crate) struct LeftOut(BTreeSet<EncounterId>);

impl LeftOut {
    /// The episodes of `evaluation`. What is left out is told on stderr, each encounter once.
    pub(crate) fn drives<'d>(&mut self, evaluation: Evaluation<'d>) -> Vec<Drive<'d>> {
        for refused in &evaluation.refused {
            if self.0.insert(refused.encounter.id.clone()) {
                note!("left out: {}", words(refused));
            }
        }
        evaluation.drives
    }
}

/// Tells on stderr which of `encounters` are left out.
pub(crate) fn tell(encounters: &[&Encounter]) {
    for &encounter in encounters {
        if let Err(why) = Meeting::new(encounter) {
            note!("left out: {}", words(&Refused { encounter, why }));
        }
    }
}

/// Which encounter it is, and why nobody drives it.
pub(crate) fn words(refused: &Refused<'_>) -> String {
    let id = &refused.encounter.id;
    format!(
        "encounter {},{} of {}, file {}, is no junction: {}",
        id.left, id.other, id.site, id.file, refused.why
    )
}
