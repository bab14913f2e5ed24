//! Of what, and with what, the checks were done.

use super::steps::Step;
use cede_controller::policy::embedded;
use serde::Serialize;
use sha2::{Digest as _, Sha256};
use std::path::Path;
use std::process::Command;

/// Files whose content the evidence is about, beside the code.
const FILES: [&str; 12] = [
    "contracts/worst-case.toml",
    "contracts/all-way-stop.toml",
    "contracts/queues.toml",
    "contracts/passenger-car.toml",
    "contracts/passenger-car-wet.toml",
    "contracts/lorry.toml",
    "docs/safety/hazards.toml",
    "docs/safety/requirements.toml",
    "docs/safety/assumptions.toml",
    "docs/safety/policy.toml",
    "docs/safety/reach.toml",
    "proofs/Shipped.v",
];

/// Of what, and with what, the checks were done.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Provenance {
    pub(super) cede: &'static str,
    /// Of the repository; none if it is no clone.
    pub(super) revision: Option<String>,
    /// Where the checks ran.
    pub(super) machine: String,
    pub(super) tools: Vec<Named>,
    /// SHA-256.
    pub(super) hashes: Vec<Named>,
}

/// A value with its name.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Named {
    pub(super) name: String,
    pub(super) value: String,
}

/// What is known of the repository in `root` and of the programs that the steps used.
pub(super) fn of(root: &Path, steps: &[Step]) -> Provenance {
    Provenance {
        cede: env!("CARGO_PKG_VERSION"),
        revision: revision(root),
        machine: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        tools: tools(steps),
        hashes: hashes(root),
    }
}

/// The commit, and whether files differ from it.
fn revision(root: &Path) -> Option<String> {
    let git = |arguments: &[&str]| {
        let output = Command::new("git")
            .arg("-C")
            .arg(root)
            .args(arguments)
            .output();
        let output = output.ok().filter(|output| output.status.success())?;
        Some(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let commit = git(&["rev-parse", "HEAD"])?;
    let changed = git(&["status", "--porcelain"])?.lines().count();
    Some(match changed {
        0 => commit,
        _ => format!("{commit}, and {changed} files that differ from it"),
    })
}

fn tools(steps: &[Step]) -> Vec<Named> {
    let versions = steps.iter().flat_map(|step| {
        let version = |name: &str, key| {
            let value = step.detail[key].as_str()?.to_owned();
            let name = name.to_owned();
            Some(Named { name, value })
        };
        [version("Z3", "solver"), version("Rocq (coqc)", "coqc")]
    });
    versions.flatten().collect()
}

fn hashes(root: &Path) -> Vec<Named> {
    let weights: Vec<u8> = embedded::words()
        .iter()
        .flat_map(|word| word.to_le_bytes())
        .collect();
    let policy = Named {
        name: "the embedded policy's weights".to_owned(),
        value: hash(&weights),
    };
    let file = |path: &&str| {
        let bytes = std::fs::read(root.join(path)).ok()?;
        Some(Named {
            name: (*path).to_owned(),
            value: hash(&bytes),
        })
    };
    [policy]
        .into_iter()
        .chain(FILES.iter().filter_map(file))
        .collect()
}

fn hash(bytes: &[u8]) -> String {
    let digest = Sha256::digest(bytes);
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
