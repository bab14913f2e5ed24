//! Judges every driver on every split: the rows of the table, with progress on stderr.

use crate::contract::{self, Named};
use crate::drivers::Contender;
use crate::failure::Failure;
use crate::interrupt;
use crate::left_out::LeftOut;
use crate::progress;
use cede_controller::Contract;
use cede_data::Dataset;
use cede_sim::driver::FitError;
use cede_sim::episode::Until;
use cede_sim::evaluate::{
    Drive, Evaluation, Label, Mode, Protocol, Round, Selection, TableRow, evaluate,
};
use clap::ValueEnum;

/// What is judged, and how.
pub(crate) struct Plan {
    /// The drivers to judge.
    pub(crate) contenders: Vec<Contender>,
    /// Whether drivers that cannot be fitted are left out; otherwise they are an error.
    pub(crate) lenient: bool,
    /// The encounters to judge on.
    pub(crate) selections: Vec<Selection>,
    /// Whether both vehicles or one are under test.
    pub(crate) mode: ModeName,
    /// In ego mode, the driver of the other vehicle.
    pub(crate) partner: Contender,
    /// When an episode ends.
    pub(crate) until: UntilName,
    /// The contracts of the shields; `None` is no shield. The vehicle under test carries the shield.
    pub(crate) shields: Vec<Option<Contract>>,
    /// Seed of every random choice.
    pub(crate) seed: u64,
}

/// Which vehicles are under test.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ModeName {
    /// One driver for both vehicles: the paper's protocol
    Joint,
    /// The driver for one vehicle, in either role; another for the other
    Ego,
}

/// When an episode ends.
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
    /// The shields of a [`Plan`], with `contract`; the default is the worst case.
    ///
    /// # Errors
    /// There is a contract but no shield, or its file is not a contract.
    pub(crate) fn shields(
        self,
        contract: Option<&Named>,
    ) -> Result<Vec<Option<Contract>>, Failure> {
        let assumed = || contract::or_worst_case(contract).map(Some);
        match self {
            Self::Off if contract.is_some() => Err(Failure::ignored("--contract", "--shield off")),
            Self::Off => Ok(vec![None]),
            Self::On => Ok(vec![assumed()?]),
            Self::Both => Ok(vec![None, assumed()?]),
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
    /// The rows, ordered by split and driver. Calls `each` with every row and its episodes.
    ///
    /// # Errors
    /// A selection is empty, a named driver cannot be fitted, or the user has interrupted the command.
    pub(crate) fn judge(
        &self,
        dataset: &Dataset,
        mut each: impl FnMut(&TableRow, &[Drive<'_>]),
    ) -> Result<Vec<TableRow>, Failure> {
        let blocks = self.selections.len() * self.shields.len();
        let rows = blocks * self.contenders.len();
        let bar = progress::bar(rows as u64, "{bar:30} {pos}/{len} {msg}");
        let mut rows = Vec::new();
        let mut left_out = LeftOut::default();
        for &selection in &self.selections {
            let rounds = selection.rounds(dataset);
            if rounds.iter().all(|round| round.judged.is_empty()) {
                return Err(Failure::input(
                    format!("no encounters of {} in `{selection}`", dataset.site.name),
                    "name another --split, or add its files to the folder",
                ));
            }
            for (&shield, contender) in product(&self.shields, &self.contenders) {
                interrupt::check()?;
                bar.set_message(format!("{selection}: {}", contender.name()));
                match self.drive(contender, shield, &rounds) {
                    Ok(evaluations) => {
                        let told = evaluations.into_iter().map(|e| left_out.drives(e));
                        let drives: Vec<_> = bar.suspend(|| told.flatten().collect());
                        let row = TableRow::of(
                            self.label(contender, dataset, selection, shield),
                            &drives,
                        );
                        each(&row, &drives);
                        rows.push(row);
                    }
                    Err(error) if self.lenient => {
                        bar.suspend(|| note!("left out of {selection}: {error}"));
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
    ) -> Result<Vec<Evaluation<'a>>, FitError> {
        let mut evaluations = Vec::new();
        for round in rounds {
            let factory = contender.fit(&round.training, shield)?;
            let partner = match self.mode {
                ModeName::Joint => None,
                ModeName::Ego => Some(self.partner.fit(&round.training, None)?),
            };
            let protocol = Protocol {
                mode: partner.as_deref().map_or(Mode::Joint, Mode::Ego),
                until: self.until.into(),
                seed: self.seed,
            };
            evaluations.push(evaluate(&*factory, &round.judged, protocol));
        }
        Ok(evaluations)
    }

    fn label<'l>(
        &self,
        contender: &'l Contender,
        dataset: &'l Dataset,
        selection: Selection,
        shield: Option<Contract>,
    ) -> Label<'l> {
        Label {
            driver: contender.name(),
            site: &dataset.site.name,
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

/// The Cartesian product of `outer` and `inner`.
fn product<'a, A, B>(outer: &'a [A], inner: &'a [B]) -> impl Iterator<Item = (&'a A, &'a B)> {
    outer
        .iter()
        .flat_map(move |a| inner.iter().map(move |b| (a, b)))
}
