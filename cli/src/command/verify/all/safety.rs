//! The check of the safety file itself.

use super::super::beyond::{REPORTED, WITHIN};
use super::super::campaign;
use super::super::checked::Checked;
use super::super::zones::NAMES;
use super::super::{policy, reach};
use super::steps::{Step, records};
use crate::safety::{Known, SafetyFile, defects};
use cede_sim::campaign::Setup;
use cede_verify::lemma::{lemmas, shipped};
use cede_verify::margin::Predicate;
use std::path::Path;

/// Checks `file`, of the repository in `root`.
pub(super) fn step(file: &SafetyFile, root: &Path) -> Step {
    Step::run(
        "safety file",
        "cargo test -p cede safety".to_owned(),
        || {
            let defects = defects(file, root, &known());
            let lines: Vec<String> = defects.iter().map(ToString::to_string).collect();
            Ok(Checked {
                text: lines.join("\n"),
                summary: format!(
                    "{} requirements, {} assumptions of use; {} defects",
                    file.requirements.len(),
                    file.assumptions.len(),
                    defects.len()
                ),
                findings: Vec::new(),
                open: (!lines.is_empty()).then(|| lines.join("\n")),
                json: serde_json::json!({ "defects": lines }),
            })
        },
    )
}

/// What the program knows by name.
pub(super) fn known() -> Known {
    let owned = |name: &str| name.to_owned();
    let setups = Setup::all();
    let setups = setups.iter().map(|(name, _)| *name).chain([campaign::ALL]);
    Known {
        lemmas: lemmas().iter().map(|lemma| owned(lemma.id)).collect(),
        margins: Predicate::ALL.map(|it| owned(it.name())).to_vec(),
        zones: NAMES.map(owned).to_vec(),
        campaign: setups.map(owned).collect(),
        beyond: [WITHIN, REPORTED].map(owned).to_vec(),
        records: records(),
        carried: vec![
            ("docs/safety/policy.toml", owned(policy::PROPERTIES)),
            ("docs/safety/reach.toml", owned(reach::SCENARIOS)),
            ("proofs/Shipped.v", shipped()),
        ],
    }
}

#[cfg(test)]
mod tests;
