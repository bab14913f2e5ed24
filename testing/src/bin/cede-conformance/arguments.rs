//! What the program is told, and the files that are named.

use crate::numbers;
use cede_controller::policy::{embedded, weights};
use cede_controller::{Contract, Policy};
use cede_testing::{Suite, Vehicle};
use clap::Parser;
use std::path::{Path, PathBuf};

const EXAMPLE: &str = "Example:
  cede-conformance --policy driver.cede --contract contract.toml \\
      --vehicle length=4.6,width=1.9,braking=4.2,latency=0.08 --cases 256 --seed 1 --junit conformance.xml

A contract has the fields of cede_controller::Contract; `--print-contract` prints one to begin with.

Exit status: 0 if no check fails, 1 if one does, 2 if an input cannot be used.";

/// Checks a driving policy behind the safety shield, with your contract and your vehicle.
#[derive(Debug, Parser)]
#[command(name = "cede-conformance", version, after_help = EXAMPLE)]
pub(crate) struct Arguments {
    /// Weights file (.cede); the policy that ships, if it is left out.
    #[arg(long, value_name = "FILE.cede")]
    pub(crate) policy: Option<PathBuf>,

    /// Contract, TOML or JSON by the file's ending; the worst case, if it is left out.
    #[arg(long, value_name = "FILE.toml|json")]
    pub(crate) contract: Option<PathBuf>,

    /// What the vehicle is and really achieves: length and width (m), braking and acceleration (m/s²), latency and
    /// jitter (s), position_error (m), speed_error (m/s). What is left out is taken from the contract.
    #[arg(long, value_name = "KEY=VALUE,…", default_value = "length=5,width=2")]
    pub(crate) vehicle: String,

    /// Cases for each check that draws them; 256 take a few seconds.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) cases: u32,

    /// What the cases are drawn from: the same seed gives the same cases.
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,

    /// Share of shielded steps, 0 to 1, above which the check `comfort` fails.
    #[arg(long, default_value_t = 0.5, value_name = "SHARE")]
    pub(crate) most_shielded: f64,

    /// Only this check; may be given several times.
    #[arg(long, value_name = "ID")]
    pub(crate) only: Vec<String>,

    /// Writes the report as JUnit XML.
    #[arg(long, value_name = "OUT.xml")]
    pub(crate) junit: Option<PathBuf>,

    /// Writes the report as JSON.
    #[arg(long, value_name = "OUT.json")]
    pub(crate) json: Option<PathBuf>,

    /// Lists the checks, and checks nothing.
    #[arg(long)]
    pub(crate) list: bool,

    /// Prints the contract that is used, as JSON, and checks nothing.
    #[arg(long)]
    pub(crate) print_contract: bool,

    /// Does not say which inputs are used.
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

/// What the files hold.
pub(crate) struct Input {
    words: Vec<u32>,
    pub(crate) contract: Contract,
    vehicle: Vehicle,
    said: String,
}

impl Input {
    /// Reads what is named.
    ///
    /// # Errors
    /// A sentence with the file, the field and its value.
    pub(crate) fn read(arguments: &Arguments) -> Result<Self, String> {
        let (words, policy) = match &arguments.policy {
            Some(path) => (policy(path)?, path.display().to_string()),
            None => (
                embedded::words().to_vec(),
                "the policy that ships".to_owned(),
            ),
        };
        let (contract, from) = match &arguments.contract {
            Some(path) => (contract(path)?, path.display().to_string()),
            None => (Contract::WORST_CASE, "the worst case".to_owned()),
        };
        if !(0.0..=1.0).contains(&arguments.most_shielded) {
            return Err(format!(
                "--most-shielded: {} is outside [0, 1]",
                arguments.most_shielded
            ));
        }
        let known = cede_testing::checks();
        let unknown = arguments
            .only
            .iter()
            .find(|only| known.iter().all(|(id, _)| id != only));
        if let Some(unknown) = unknown {
            return Err(format!(
                "--only: there is no check `{unknown}`; --list names them"
            ));
        }
        Ok(Self {
            words,
            contract,
            vehicle: numbers::vehicle(&arguments.vehicle)?,
            said: format!(
                "Policy: {policy}. Contract: {from}. Vehicle: {}.",
                arguments.vehicle
            ),
        })
    }

    /// Which inputs are used.
    pub(crate) fn describe(&self) -> &str {
        &self.said
    }

    /// The checks that are asked for.
    ///
    /// # Errors
    /// None after [`Input::read`].
    pub(crate) fn suite(&self, arguments: &Arguments) -> Result<Suite<'_>, String> {
        let policy = Policy::new(&self.words).map_err(|error| error.to_string())?;
        let suite = Suite::new(policy, self.contract)
            .vehicle(self.vehicle)
            .cases(arguments.cases)
            .seed(arguments.seed)
            .most_shielded(arguments.most_shielded);
        Ok(arguments
            .only
            .iter()
            .fold(suite, |suite, id| suite.only(id)))
    }
}

/// The words of a weights file.
fn policy(path: &Path) -> Result<Vec<u32>, String> {
    let said = |error: &dyn std::fmt::Display| format!("--policy {}: {error}", path.display());
    let bytes = std::fs::read(path).map_err(|error| said(&error))?;
    let words: Vec<u32> = weights::words(&bytes).collect();
    Policy::new(&words).map_err(|error| said(&error))?;
    Ok(words)
}

/// The contract of a file.
fn contract(path: &Path) -> Result<Contract, String> {
    let said = |error: &dyn std::fmt::Display| format!("--contract {}: {error}", path.display());
    let text = std::fs::read_to_string(path).map_err(|error| said(&error))?;
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("toml") => toml::from_str(&text).map_err(|error| said(&error)),
        Some("json") => serde_json::from_str(&text).map_err(|error| said(&error)),
        _ => Err(said(&"the file's name ends in neither .toml nor .json")),
    }
}
