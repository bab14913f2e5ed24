//! What the files say.

use crate::failure::Failure;
use cede_formats::property::{Properties, StateProperty};
use cede_verify::reach::{Scenario, Scenarios};
use miette::{IntoDiagnostic, WrapErr};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::fmt;
use std::path::Path;

/// The folder of the safety file in the repository.
pub(crate) const FOLDER: &str = "docs/safety";

/// The safety file.
#[derive(Clone, Debug)]
pub(crate) struct SafetyFile {
    pub(crate) hazards: Hazards,
    pub(crate) requirements: Vec<Requirement>,
    pub(crate) assumptions: Vec<Assumption>,
    /// The names of the claims of `policy.toml`, and of `reach.toml`.
    pub(crate) properties: Vec<String>,
    pub(crate) scenarios: Vec<String>,
}

/// `hazards.toml`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Hazards {
    pub(crate) hazard: Vec<Hazard>,
    pub(crate) goal: Vec<Goal>,
}

/// A hazard, H-nn.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Hazard {
    pub(crate) id: String,
    pub(crate) says: String,
    /// The goals that answer it.
    pub(crate) goals: Vec<String>,
}

/// A safety goal that is assumed of the vehicle, SG-nn.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Goal {
    pub(crate) id: String,
    pub(crate) says: String,
}

/// `requirements.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Requirements {
    requirement: Vec<Requirement>,
}

/// A requirement on the item, SR-nn.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Requirement {
    pub(crate) id: String,
    pub(crate) says: String,
    /// The goals that it serves.
    pub(crate) goals: Vec<String>,
    /// The conditions of the theorem, contract and manual that it takes up: A4, C2, U3.
    #[serde(default)]
    pub(crate) sources: Vec<String>,
    /// The assumptions of use without which it does not hold.
    #[serde(default)]
    pub(crate) rests_on: Vec<String>,
    /// Where it is implemented: path::item.
    #[serde(default)]
    pub(crate) code: Vec<String>,
    /// What tells of it while it runs: Enum::Variant of the controller.
    #[serde(default)]
    pub(crate) diagnostics: Vec<String>,
    /// What shows it.
    #[serde(default)]
    pub(crate) evidence: EvidenceNames,
    /// What is not shown.
    pub(crate) open: Option<String>,
}

/// `assumptions.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Assumptions {
    assumption: Vec<Assumption>,
}

/// An assumption of use, AOU-nn: what the item does not ensure itself.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Assumption {
    pub(crate) id: String,
    pub(crate) says: String,
    /// The conditions that it takes up.
    pub(crate) sources: Vec<String>,
    /// How the integrator keeps it or shows it.
    pub(crate) keep: String,
    /// What tells that it is broken: Enum::Variant of the controller.
    #[serde(default)]
    pub(crate) monitors: Vec<String>,
    /// The tests of what is done then.
    #[serde(default)]
    pub(crate) tests: Vec<String>,
    /// What no monitor tells.
    pub(crate) unseen: Option<String>,
}

/// Evidence by its kind.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct EvidenceNames {
    /// In `proofs/`.
    theorems: Vec<String>,
    /// Of `cede verify lemmas`.
    lemmas: Vec<String>,
    /// Of `cede verify margins`.
    margins: Vec<String>,
    /// Junctions of `cede verify zones`.
    zones: Vec<String>,
    /// In `policy.toml`.
    properties: Vec<String>,
    /// In `reach.toml`.
    scenarios: Vec<String>,
    /// Set-ups of `cede verify campaign`.
    campaign: Vec<String>,
    /// Claims of `cede verify beyond`.
    beyond: Vec<String>,
    /// Of `cargo test`: path::function.
    tests: Vec<String>,
    /// Results of a command of their own, where a document has them: path#heading.
    records: Vec<String>,
}

/// A kind of evidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Kind {
    Theorem,
    Lemma,
    Margin,
    Zones,
    Property,
    Scenario,
    Campaign,
    Beyond,
    Test,
    Record,
}

/// A piece of evidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Evidence<'f> {
    pub(crate) kind: Kind,
    pub(crate) name: &'f str,
}

impl Kind {
    /// Whether it holds for all of a stated set, not for samples.
    pub(crate) const fn is_proof(self) -> bool {
        matches!(
            self,
            Self::Theorem
                | Self::Lemma
                | Self::Margin
                | Self::Zones
                | Self::Property
                | Self::Scenario
        )
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Theorem => "theorem",
            Self::Lemma => "lemma",
            Self::Margin => "margin",
            Self::Zones => "zones of junctions",
            Self::Property => "property",
            Self::Scenario => "scenario",
            Self::Campaign => "campaign",
            Self::Beyond => "beyond the contract",
            Self::Test => "test",
            Self::Record => "record",
        })
    }
}

impl EvidenceNames {
    /// One by one.
    pub(crate) fn each(&self) -> impl Iterator<Item = Evidence<'_>> {
        let kinds = [
            (Kind::Theorem, &self.theorems),
            (Kind::Lemma, &self.lemmas),
            (Kind::Margin, &self.margins),
            (Kind::Zones, &self.zones),
            (Kind::Property, &self.properties),
            (Kind::Scenario, &self.scenarios),
            (Kind::Campaign, &self.campaign),
            (Kind::Beyond, &self.beyond),
            (Kind::Test, &self.tests),
            (Kind::Record, &self.records),
        ];
        kinds.into_iter().flat_map(|(kind, names)| {
            let names = names.iter();
            names.map(move |name| Evidence { kind, name })
        })
    }
}

impl SafetyFile {
    /// The safety file of the repository in `root`.
    ///
    /// # Errors
    /// If a file cannot be read.
    pub(crate) fn read(root: &Path) -> Result<Self, Failure> {
        let folder = root.join(FOLDER);
        let hazards = read(&folder.join("hazards.toml"))?;
        let Requirements { mut requirement } = read(&folder.join("requirements.toml"))?;
        let Assumptions { assumption } = read(&folder.join("assumptions.toml"))?;
        let Properties { property } = read(&folder.join("policy.toml"))?;
        let Scenarios { scenario } = read(&folder.join("reach.toml"))?;
        let properties = property.iter().map(|it| it.id.clone()).collect();
        let scenarios = scenario.iter().map(|it| it.id.clone()).collect();
        requirement.extend(property.into_iter().map(of_property));
        requirement.extend(scenario.into_iter().map(of_scenario));
        requirement.sort_by(|a, b| a.id.cmp(&b.id));
        Ok(Self {
            hazards,
            requirements: requirement,
            assumptions: assumption,
            properties,
            scenarios,
        })
    }
}

/// The goals that the claims of `policy.toml` and `reach.toml` serve: to keep apart, and not to hold up for nothing.
const APART: &str = "SG-01";
const FLOW: &str = "SG-04";

/// A claim of `policy.toml` as a requirement: it is its own evidence.
fn of_property(property: StateProperty) -> Requirement {
    Requirement {
        id: property.id.clone(),
        says: property.title,
        goals: vec![FLOW.to_owned()],
        code: vec!["controller/src/policy/embedded.rs::words".to_owned()],
        evidence: EvidenceNames {
            properties: vec![property.id],
            ..EvidenceNames::default()
        },
        ..Requirement::default()
    }
}

/// A claim of `reach.toml` as a requirement. Where the policy is not asked it is about the shield.
fn of_scenario(scenario: Scenario) -> Requirement {
    let (goal, code) = match scenario.policy {
        true => (FLOW, "controller/src/approach/mod.rs::Approach::decide"),
        false => (APART, "controller/src/shield/mod.rs::Shield::filter"),
    };
    Requirement {
        id: scenario.id.clone(),
        says: scenario.title,
        goals: vec![goal.to_owned()],
        code: vec![code.to_owned()],
        evidence: EvidenceNames {
            scenarios: vec![scenario.id],
            ..EvidenceNames::default()
        },
        ..Requirement::default()
    }
}

fn read<T: DeserializeOwned>(path: &Path) -> Result<T, Failure> {
    let text = std::fs::read_to_string(path).into_diagnostic();
    let parsed = text.and_then(|text| toml::from_str(&text).into_diagnostic());
    parsed
        .wrap_err_with(|| {
            format!(
                "cannot use {}: run the command in a clone of the repository, or name that with --source",
                path.display()
            )
        })
        .map_err(Failure::Input)
}
