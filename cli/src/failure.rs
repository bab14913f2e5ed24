//! Why a command ended badly, and the exit code that says so.

use std::process::ExitCode;

/// Why a command ended badly. Usage errors (exit code 2) are clap's.
pub enum Failure {
    /// A check ran and did not hold: exit code 1.
    Check(String),
    /// The input or the output cannot be used: exit code 3.
    Input(miette::Report),
    /// Stopped by Ctrl-C after saving what there was: exit code 4.
    Interrupted,
}

impl Failure {
    /// Tells the user on stderr and gives the exit code.
    pub fn report(self) -> ExitCode {
        match self {
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

impl<E: miette::Diagnostic + Send + Sync + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Input(error.into())
    }
}
