//! Which encounters are judged, and which may be learned from.

use cede_data::encounter::Encounter;
use cede_data::{Dataset, Fold, Split};
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
    /// All, every seventh file by drivers fitted on the other files: seven rounds.
    SevenFold,
}

/// What to fit on, and what to judge then.
#[derive(Clone, Debug)]
pub struct Round<'a> {
    /// Encounters to learn from.
    pub training: Vec<&'a Encounter>,
    /// Encounters to judge on.
    pub judged: Vec<&'a Encounter>,
}

impl<'a> From<Fold<'a>> for Round<'a> {
    fn from(fold: Fold<'a>) -> Self {
        Self {
            training: fold.train,
            judged: fold.held_out,
        }
    }
}

/// Rounds of [`Selection::SevenFold`].
const SEVEN: usize = 7;

impl Selection {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Split(Split::Train),
        Self::Split(Split::Validation),
        Self::Split(Split::Test),
        Self::Split(Split::All),
        Self::LeaveOneFileOut,
        Self::SevenFold,
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
            Self::SevenFold => "seven-fold",
        }
    }

    /// The rounds in which `dataset` is judged; one for a split.
    #[must_use]
    pub fn rounds(self, dataset: &Dataset) -> Vec<Round<'_>> {
        let rounds = match self {
            Self::Split(split) => {
                return vec![Round {
                    training: dataset.split(Split::Train).collect(),
                    judged: dataset.split(split).collect(),
                }];
            }
            Self::LeaveOneFileOut => dataset.files().len(),
            Self::SevenFold => SEVEN,
        };
        dataset.folds(rounds).into_iter().map(Round::from).collect()
    }

    /// The rounds of a cross-validation by file of all `sites` together; none for a split. In round i each
    /// site leaves out its i-th file and so on, as in [`Dataset::folds`].
    #[must_use]
    pub fn cross_validation<'d>(self, sites: &'d [Dataset]) -> Vec<Vec<Fold<'d>>> {
        let rounds = match self {
            Self::Split(_) => 0,
            Self::LeaveOneFileOut => {
                let files = sites.iter().map(|site| site.files().len());
                files.max().unwrap_or(0)
            }
            Self::SevenFold => SEVEN,
        };
        let mut of_sites: Vec<_> = sites
            .iter()
            .map(|site| site.folds(rounds).into_iter())
            .collect();
        let round = |_| of_sites.iter_mut().filter_map(Iterator::next).collect();
        (0..rounds).map(round).collect()
    }
}

impl fmt::Display for Selection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// There is no selection of that name.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("no split is called `{0}`: train, validation, test, all, leave-one-file-out, seven-fold")]
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
