//! Why a command ended badly, and the exit code that says so.

use cede_data::DataError;
use cede_data::output::OutputError;
use std::process::ExitCode;

/// Why a command ended badly. Most usage errors are clap's.
pub(crate) enum Failure {
    /// Options that do not go together: exit code 2.
    Usage(String),
    /// A check ran and did not hold: exit code 1.
    Check(String),
    /// The input or the output cannot be used: exit code 3.
    Input(miette::Report),
    /// Stopped by Ctrl-C after saving what there was: exit code 4.
    Interrupted,
}

impl Failure {
    /// Bad input, and what the user can do about it.
    pub(crate) fn input(problem: impl std::fmt::Display, mend: impl Into<String>) -> Self {
        Self::Input(miette::miette!(help = mend.into(), "{problem}"))
    }

    /// An option that would be ignored beside `other`.
    pub(crate) fn ignored(option: &str, other: &str) -> Self {
        Self::Usage(format!("{option} has no effect with {other}: leave it out"))
    }

    /// Tells the user on stderr and gives the exit code.
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
