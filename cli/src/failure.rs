//! Why a command failed, and its exit code.

use cede_data::DataError;
use cede_data::output::OutputError;
use std::process::ExitCode;

/// Why a command failed. Clap reports most usage errors itself.
pub(crate) enum Failure {
    /// Options that exclude each other: exit code 2.
    Usage(String),
    /// A check failed: exit code 1.
    Check(String),
    /// The input or the output cannot be used: exit code 3.
    Input(miette::Report),
    /// Interrupted by Ctrl-C or SIGTERM, after saving the work done: exit code 4.
    Interrupted,
}

impl Failure {
    /// Unusable input, and how the user can correct it.
    pub(crate) fn input(problem: impl std::fmt::Display, mend: impl Into<String>) -> Self {
        Self::Input(miette::miette!(help = mend.into(), "{problem}"))
    }

    /// `option` would be ignored because of `other`.
    pub(crate) fn ignored(option: &str, other: &str) -> Self {
        Self::Usage(format!("{option} has no effect with {other}: leave it out"))
    }

    /// What failed, in a line, with the mend.
    pub(crate) fn words(&self) -> String {
        match self {
            Self::Usage(what) | Self::Check(what) => what.clone(),
            Self::Input(report) => {
                let mend = report.help().map(|mend| format!("; {mend}"));
                format!("{report}{}", mend.unwrap_or_default())
            }
            Self::Interrupted => "interrupted".to_owned(),
        }
    }

    /// Reports the failure on stderr and returns the exit code.
    pub(crate) fn report(self) -> ExitCode {
        match self {
            Self::Usage(what) => {
                eprintln!("error: {what}\n\nFor more information, try '--help'.");
                ExitCode::from(2)
            }
            Self::Check(what) => {
                eprintln!("check failed: {what}");
                ExitCode::from(1)
            }
            Self::Input(report) => {
                eprintln!("{report:?}");
                ExitCode::from(3)
            }
            Self::Interrupted => {
                eprintln!("interrupted");
                ExitCode::from(4)
            }
        }
    }
}

impl From<DataError> for Failure {
    fn from(error: DataError) -> Self {
        let mend = error.mend();
        Self::input(error, mend)
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        let mend = error.mend();
        Self::input(error, mend)
    }
}
