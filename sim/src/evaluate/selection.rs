//! Which encounters are judged, and which may be learned from.

use cede_data::encounter::Encounter;
use cede_data::{Dataset, Split};
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// The encounters on which drivers are judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Selection {
    /// Those of a split, by drivers fitted on the training split.
    Split(Split),
    /// All, each file by drivers fitted on the other files.
    LeaveOneFileOut,
}

/// What to fit on, and what to judge then.
#[derive(Clone, Debug)]
pub struct Round<'a> {
    /// Encounters to learn from.
    pub training: Vec<&'a Encounter>,
    /// Encounters to judge on.
    pub judged: Vec<&'a Encounter>,
}

impl Selection {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Split(Split::Train),
        Self::Split(Split::Validation),
        Self::Split(Split::Test),
        Self::Split(Split::All),
        Self::LeaveOneFileOut,
    ];

    /// Name on the command line and in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Split(Split::Train) => "train",
            Self::Split(Split::Validation) => "validation",
            Self::Split(Split::Test) => "test",
            Self::Split(Split::All) => "all",
            Self::LeaveOneFileOut => "leave-one-file-out",
        }
    }

    /// The rounds in which `dataset` is judged; one for a split, one a file for leave-one-file-out.
    #[must_use]
    pub fn rounds(self, dataset: &Dataset) -> Vec<Round<'_>> {
        match self {
            Self::Split(split) => vec![Round {
                training: dataset.split(Split::Train).collect(),
                judged: dataset.split(split).collect(),
            }],
            Self::LeaveOneFileOut => dataset
                .folds()
                .into_iter()
                .map(|fold| Round {
                    training: fold.train,
                    judged: fold.held_out,
                })
                .collect(),
        }
    }
}

impl fmt::Display for Selection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// There is no selection of that name.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("no split is called `{0}`: train, validation, test, all, leave-one-file-out")]
pub struct UnknownSelection(String);

impl FromStr for Selection {
    type Err = UnknownSelection;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .into_iter()
            .find(|selection| selection.name() == name)
            .ok_or_else(|| UnknownSelection(name.to_owned()))
    }
}
