//! Every driver on every split: the rows of the table, with progress on stderr.

use crate::drivers::Contender;
use crate::failure::Failure;
use crate::interrupt;
use cede_controller::Contract;
use cede_data::Dataset;
use cede_sim::driver::{Baseline, FitError};
use cede_sim::episode::Until;
use cede_sim::evaluate::{Drive, Label, Mode, Protocol, Round, Selection, TableRow, evaluate};
use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressStyle};

/// What is judged, and how.
pub(crate) struct Plan {
    /// Who drives.
    pub(crate) contenders: Vec<Contender>,
    /// Whether those that cannot be fitted are left out, instead of a failure.
    pub(crate) lenient: bool,
    /// On what.
    pub(crate) selections: Vec<Selection>,
    /// Whether both vehicles or one are under test.
    pub(crate) mode: ModeName,
    /// In ego mode, who drives the other vehicle.
    pub(crate) partner: Baseline,
    /// When an episode is over.
    pub(crate) until: UntilName,
    /// Without the shield (`None`), or with the one that assumes this; the vehicle under test carries it.
    pub(crate) shields: Vec<Option<Contract>>,
    /// Every random choice comes from here.
    pub(crate) seed: u64,
}

/// Who is under test.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ModeName {
    /// One driver for both vehicles: the paper's protocol
    Joint,
    /// The driver for one vehicle, in either role; another for the other
    Ego,
}

/// When an episode is over.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum UntilName {
    /// When the first reaches its conflict point: the paper's protocol
    Conflict,
    /// When both have left the conflict zone: the count of collisions that matters
    Cleared,
}

/// Whether the vehicle under test carries the shield.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShieldName {
    /// Without it
    Off,
    /// With it
    On,
    /// Once without, once with it
    Both,
}

impl ShieldName {
    /// The shields of a [`Plan`], which assume `contract`, by default the worst case.
    ///
    /// # Errors
    /// A contract is named and no shield is on.
    pub(crate) fn shields(
        self,
        contract: Option<ContractName>,
    ) -> Result<Vec<Option<Contract>>, Failure> {
        let assumed = Some(contract.unwrap_or_default().into());
        match self {
            Self::Off if contract.is_some() => Err(Failure::ignored("--contract", "--shield off")),
            Self::Off => Ok(vec![None]),
            Self::On => Ok(vec![assumed]),
            Self::Both => Ok(vec![None, assumed]),
        }
    }
}

/// What the shield assumes of the others.
#[derive(Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ContractName {
    /// Nobody's courtesy where routes cross
    #[default]
    WorstCase,
    /// Who arrived first goes first
    AllWayStop,
}

impl From<ContractName> for Contract {
    fn from(name: ContractName) -> Self {
        match name {
            ContractName::WorstCase => Self::WORST_CASE,
            ContractName::AllWayStop => Self::ALL_WAY_STOP,
        }
    }
}

impl From<UntilName> for Until {
    fn from(name: UntilName) -> Self {
        match name {
            UntilName::Conflict => Self::Conflict,
            UntilName::Cleared => Self::Cleared,
        }
    }
}

impl Plan {
    /// The rows, split by split and driver by driver; `each` sees every row with its episodes.
    ///
    /// # Errors
    /// A selection is empty, a named driver cannot be fitted, or the user has asked to stop.
    pub(crate) fn judge(
        &self,
        dataset: &Dataset,
        mut each: impl FnMut(&TableRow, &[Drive<'_>]),
    ) -> Result<Vec<TableRow>, Failure> {
        let blocks = self.selections.len() * self.shields.len();
        let bar = progress(blocks * self.contenders.len());
        let mut rows = Vec::new();
        for &selection in &self.selections {
            let rounds = selection.rounds(dataset);
            if rounds.iter().all(|round| round.judged.is_empty()) {
                return Err(Failure::input(
                    format!("there is nothing to judge on: no encounters in `{selection}`"),
                    "name another --split, or add its files to the folder",
                ));
            }
            for (&shield, contender) in product(&self.shields, &self.contenders) {
                interrupt::check()?;
                bar.set_message(format!("{selection}: {}", contender.name()));
                match self.drive(contender, shield, &rounds) {
                    Ok(drives) => {
                        let row = TableRow::of(self.label(contender, selection, shield), &drives);
                        each(&row, &drives);
                        rows.push(row);
                    }
                    Err(error) if self.lenient => {
                        bar.suspend(|| eprintln!("left out of {selection}: {error}"));
                    }
                    Err(error) => {
                        return Err(Failure::input(
                            error,
                            "add the training files to the folder, or name other drivers",
                        ));
                    }
                }
                bar.inc(1);
            }
        }
        bar.finish_and_clear();
        Ok(rows)
    }

    fn drive<'a>(
        &self,
        contender: &Contender,
        shield: Option<Contract>,
        rounds: &[Round<'a>],
    ) -> Result<Vec<Drive<'a>>, FitError> {
        let mut drives = Vec::new();
        for round in rounds {
            let factory = contender.fit(&round.training, shield)?;
            let partner = match self.mode {
                ModeName::Joint => None,
                ModeName::Ego => Some(self.partner.fit(&round.training)?),
            };
            let protocol = Protocol {
                mode: partner.as_deref().map_or(Mode::Joint, Mode::Ego),
                until: self.until.into(),
                seed: self.seed,
            };
            drives.extend(evaluate(&*factory, &round.judged, protocol));
        }
        Ok(drives)
    }

    fn label(
        &self,
        contender: &Contender,
        selection: Selection,
        shield: Option<Contract>,
    ) -> Label<'static> {
        Label {
            driver: contender.name(),
            split: selection.name(),
            mode: match self.mode {
                ModeName::Joint => "joint",
                ModeName::Ego => "ego",
            },
            until: match self.until {
                UntilName::Conflict => "conflict",
                UntilName::Cleared => "cleared",
            },
            shield: if shield.is_some() { "on" } else { "off" },
        }
    }
}

/// Every one of `outer` with every one of `inner`.
fn product<'a, A, B>(outer: &'a [A], inner: &'a [B]) -> impl Iterator<Item = (&'a A, &'a B)> {
    outer
        .iter()
        .flat_map(move |a| inner.iter().map(move |b| (a, b)))
}

/// A bar on stderr, unseen where that is no terminal.
fn progress(rows: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}");
    let bar = ProgressBar::new(rows as u64);
    style.map_or_else(|_| bar.clone(), |style| bar.clone().with_style(style))
}
