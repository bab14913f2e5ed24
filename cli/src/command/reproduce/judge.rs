//! Judges the trained policies, without and with the shield, and the baselines.

use super::job::{Job, Trained};
use super::plan::splits;
use crate::drivers::Contender;
use crate::failure::Failure;
use crate::interrupt;
use crate::judge::{ModeName, Plan, UntilName};
use crate::left_out::LeftOut;
use cede_controller::{Contract, Policy};
use cede_data::{Dataset, Encounter};
use cede_sim::driver::{Baseline, Cede, DriverFactory, PolicyAlone};
use cede_sim::episode::Until;
use cede_sim::evaluate::{Drive, Evaluation, Label, Mode, Protocol, Selection, TableRow, evaluate};
use cede_train::run::Algorithm;

/// No shield, and one with each contract; by their names in the table.
const SHIELDS: [(&str, Option<Contract>); 3] = [
    ("off", None),
    ("all-way stop", Some(Contract::ALL_WAY_STOP)),
    ("worst case", Some(Contract::WORST_CASE)),
];

/// The episodes of one row and seed on one split.
pub(super) struct Judged<'d> {
    pub(super) seed: u64,
    pub(super) drives: Vec<Drive<'d>>,
    pub(super) row: TableRow,
}

/// What tells one [`Judged`] from another.
#[derive(Clone, PartialEq)]
struct Key<'j> {
    algorithm: Algorithm,
    seed: u64,
    site: &'j str,
    split: &'j str,
    /// Its name in [`SHIELDS`].
    shield: &'static str,
}

impl Key<'_> {
    fn label(&self) -> Label<'_> {
        Label {
            driver: self.algorithm.name(),
            site: self.site,
            split: self.split,
            mode: "joint",
            until: "conflict",
            shield: self.shield,
        }
    }
}

/// Judges the policy of every job with every shield. The rounds of a cross-validation are merged
/// into one row.
///
/// # Errors
/// The user has interrupted the command.
pub(super) fn policies<'d>(
    jobs: &[Job<'d>],
    trained: &[Trained],
) -> Result<Vec<Judged<'d>>, Failure> {
    let mut all: Vec<(Key<'_>, Vec<Drive<'d>>)> = Vec::new();
    let mut left_out = LeftOut::default();
    for (job, trained) in jobs.iter().zip(trained) {
        for judged in &job.judged {
            for (shield, contract) in SHIELDS {
                interrupt::check()?;
                let driven = drive(trained.policy, contract, &judged.encounters, job.seed);
                let drives = left_out.drives(driven);
                let key = Key {
                    algorithm: job.row.algorithm,
                    seed: job.seed,
                    site: judged.site,
                    split: judged.split,
                    shield,
                };
                match all.iter_mut().find(|(known, _)| *known == key) {
                    Some((_, known)) => known.extend(drives),
                    None => all.push((key, drives)),
                }
            }
        }
    }
    let judged = all.into_iter().map(|(key, drives)| Judged {
        seed: key.seed,
        row: TableRow::of(key.label(), &drives),
        drives,
    });
    Ok(judged.collect())
}

fn drive<'d>(
    policy: Policy<'static>,
    contract: Option<Contract>,
    encounters: &[&'d Encounter],
    seed: u64,
) -> Evaluation<'d> {
    let protocol = Protocol {
        mode: Mode::Joint,
        until: Until::Conflict,
        seed,
    };
    let factory = factory(policy, contract);
    evaluate(&*factory, encounters, protocol)
}

fn factory(policy: Policy<'static>, contract: Option<Contract>) -> Box<dyn DriverFactory> {
    match contract {
        None => Box::new(PolicyAlone::new(policy)),
        Some(contract) => Box::new(Cede::new(policy, contract)),
    }
}

/// How the baselines are judged.
pub(super) fn baselines(dataset: &Dataset, held_out: Option<Selection>) -> Plan {
    let splits = splits(dataset).into_iter().map(Selection::Split);
    Plan {
        contenders: Baseline::ALL.map(Contender::Baseline).into(),
        lenient: true,
        selections: splits.chain(held_out).collect(),
        mode: ModeName::Joint,
        partner: Contender::Baseline(Baseline::Replay),
        until: UntilName::Conflict,
        shields: vec![None],
        seed: 0,
    }
}
