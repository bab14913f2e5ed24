//! What a check found: in words, as JSON, and of each thing that the safety file may name as evidence.

use crate::failure::Failure;
use crate::safety::Kind;
use std::io::Write as _;

/// A check that can be part of `cede verify all`. Its fields are the options of its command.
pub(super) trait Check: clap::Args {
    /// Runs it.
    ///
    /// # Errors
    /// If it cannot be run. What it does not show is no error.
    fn check(&self) -> Result<Checked, Failure>;
}

/// The result of a check.
pub(super) struct Checked {
    /// What the command prints.
    pub(super) text: String,
    /// What it prints with `--json`.
    pub(super) json: serde_json::Value,
    /// Its numbers in a sentence.
    pub(super) summary: String,
    /// One for each thing that it is about.
    pub(super) findings: Vec<Finding>,
    /// What was not shown; none if all was.
    pub(super) open: Option<String>,
}

/// What a check found of one thing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Finding {
    pub(super) kind: Kind,
    pub(super) name: String,
    pub(super) shown: bool,
    /// In a few words, with numbers.
    pub(super) said: String,
}

impl Finding {
    pub(super) fn new(
        kind: Kind,
        name: impl Into<String>,
        shown: bool,
        said: impl Into<String>,
    ) -> Self {
        Self {
            kind,
            name: name.into(),
            shown,
            said: said.into(),
        }
    }
}

impl Checked {
    /// Prints the result.
    ///
    /// # Errors
    /// [`Failure::Check`] if something was not shown.
    pub(super) fn tell(self, json: bool) -> Result<(), Failure> {
        let text = if json {
            self.json.to_string()
        } else {
            self.text
        };
        // A closed pipe (`| head`) is not an error.
        let _ = writeln!(std::io::stdout(), "{text}");
        self.open.map_or(Ok(()), |open| Err(Failure::Check(open)))
    }
}

/// `words: a, b`; none if there are no names.
pub(super) fn open<'n>(words: &str, names: impl Iterator<Item = &'n str>) -> Option<String> {
    let names: Vec<&str> = names.collect();
    (!names.is_empty()).then(|| format!("{words}: {}", names.join(", ")))
}
