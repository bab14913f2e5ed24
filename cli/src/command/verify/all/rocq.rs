//! The theorem in Rocq.

use super::super::checked::{Checked, Finding};
use super::steps::Step;
use crate::child;
use crate::failure::Failure;
use crate::safety::Kind;
use miette::miette;
use std::path::Path;
use std::process::Command;

const NAME: &str = "theorem";
const COMMAND: &str = "proofs/check.sh";
/// The exit code that says that nothing was checked.
const CANNOT_BE_HAD: i32 = 77;

/// Checks the proofs of the repository in `root`, if there is a Rocq prover.
pub(super) fn step(root: &Path) -> Step {
    match version() {
        Some(version) => Step::run(NAME, COMMAND.to_owned(), || check(root, &version)),
        None => {
            let why = "no coqc on the search path: install Rocq (Debian: coq, libcoq-coquelicot)";
            Step::missing(NAME, COMMAND.to_owned(), why.to_owned())
        }
    }
}

/// The prover on the search path, as it calls itself.
fn version() -> Option<String> {
    let output = Command::new("coqc").arg("--print-version").output().ok()?;
    let said = String::from_utf8_lossy(&output.stdout);
    let first = said.split_whitespace().next()?;
    Some(first.to_owned())
}

fn check(root: &Path, version: &str) -> Result<Checked, Failure> {
    let unusable = |error| Failure::Input(miette!("cannot run {COMMAND}: {error}"));
    let path = root.join(COMMAND).canonicalize().map_err(unusable)?;
    let (status, said) = child::run(Command::new(path), |_| {}).map_err(unusable)?;
    let last = said.lines().last().unwrap_or_default().to_owned();
    if status.code() == Some(CANNOT_BE_HAD) {
        return Err(Failure::Input(miette!("{last}")));
    }
    let asked = std::fs::read_to_string(root.join("proofs/Assumptions.v")).map_err(unusable)?;
    let theorems = asked.lines().filter_map(|line| {
        let name = line.strip_prefix("Print Assumptions ")?;
        name.strip_suffix('.')
    });
    let shown = status.success();
    let words = "on the axioms of the real numbers";
    let findings = theorems.map(|name| Finding::new(Kind::Theorem, name, shown, words));
    Ok(Checked {
        text: said,
        json: serde_json::json!({ "coqc": version }),
        summary: format!("{last}; by Rocq {version}"),
        findings: findings.collect(),
        open: (!shown).then_some(last),
    })
}
