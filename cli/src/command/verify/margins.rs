//! `cede verify margins`.

use super::checked::{Check, Checked, Finding};
use crate::contract::{self, Named};
use crate::failure::Failure;
use crate::safety::Kind;
use crate::threads::Threads;
use cede_controller::Contract;
use cede_controller::junction::zone::INFLATION;
use cede_verify::margin::{Bound, Predicate, bound, shortfall};
use clap::Args;

/// The text below the options in `cede help verify margins`.
const HELP: &str = "\
Bounds the difference between f32 and real arithmetic in the shield's predicates. Exit code 1 if the slack is not
shown to cover the difference.";

/// The contracts whose margins are bounded. The rule of precedence has no margins.
const CONTRACTS: [(&str, Contract); 2] = [
    ("worst case", Contract::WORST_CASE),
    (
        "sensors that err by 0.3 m and 0.3 m/s",
        match Contract::builder()
            .position_error(0.3)
            .speed_error(0.3)
            .build()
        {
            Ok(contract) => contract,
            Err(_) => panic!("a number is out of its range"),
        },
    ),
];

/// Maximum speed (m/s) of the ego at the end of a plan to go.
const FASTEST: f64 = 20.0;

/// Options of `cede verify margins`.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Margins {
    /// Maximum number of input boxes per predicate; more boxes give sharper bounds.
    #[arg(long, default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1..))]
    boxes: u64,
    /// Only the predicates of this contract.
    #[arg(long, value_name = "NAME|FILE")]
    contract: Option<Named>,
    #[command(flatten)]
    threads: Threads,
    /// Print one JSON object instead.
    #[arg(long)]
    json: bool,
}

/// What to do about a bound that is larger than the slack.
const MEND: &str = "more --boxes sharpen the bounds, a larger `slack` of the contract covers them";

/// What to do where there is no bound.
const UNBOUNDED: &str = "more --boxes may find one; no `slack` stands in for it";

/// A predicate under a contract, with its bound.
struct MarginRow {
    contract: &'static str,
    predicate: Predicate,
    slack: f32,
    bound: Bound,
}

impl Margins {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.start()?;
        self.check()?.tell(self.json)
    }

    fn rows(&self, contract: Contract) -> Vec<MarginRow> {
        let contracts = match self.contract {
            Some(_) => vec![("as given", contract)],
            None => CONTRACTS.to_vec(),
        };
        let all = contracts
            .iter()
            .flat_map(|contract| Predicate::ALL.map(|predicate| (contract, predicate)));
        all.map(|((name, contract), predicate)| {
            note!("{}, {name} …", predicate.name());
            MarginRow {
                contract: name,
                predicate,
                slack: contract.slack(),
                bound: bound(predicate, contract, self.boxes),
            }
        })
        .collect()
    }
}

impl Check for Margins {
    fn check(&self) -> Result<Checked, Failure> {
        let contract = contract::or_worst_case(self.contract.as_ref())?;
        let short = shortfall(&contract);
        let rows = self.rows(contract);
        let mut open = not_shown(&rows);
        if short * FASTEST > f64::from(INFLATION) {
            open.push(format!("plans go {short:e} s too short"));
        }
        let largest = rows.iter().map(|row| row.bound.error).fold(0.0, f64::max);
        let objects: Vec<_> = rows.iter().map(MarginRow::json).collect();
        Ok(Checked {
            text: table(&rows, short),
            json: serde_json::json!({ "margins": objects, "going_short_s": short }),
            summary: format!("rounding moves a margin by at most {:.2} mm", 1e3 * largest),
            findings: rows.iter().map(MarginRow::finding).collect(),
            open: (!open.is_empty()).then(|| open.join("; ")),
        })
    }
}

/// What is not shown, and what to do about it.
fn not_shown(rows: &[MarginRow]) -> Vec<String> {
    let open = rows.iter().filter(|row| !row.shown());
    let (large, none): (Vec<_>, Vec<_>) = open.partition(|row| row.bound.error.is_finite());
    [
        ("not shown", large, MEND),
        ("no bound in so many boxes", none, UNBOUNDED),
    ]
    .into_iter()
    .filter(|(_, rows, _)| !rows.is_empty())
    .map(|(what, rows, mend)| {
        let rows: Vec<String> = rows.into_iter().map(MarginRow::open).collect();
        format!("{what}: {}; {mend}", rows.join("; "))
    })
    .collect()
}

fn table(rows: &[MarginRow], short: f64) -> String {
    let mut lines = vec![format!(
        "{:<27} {:<38} {:>9} {:>11} {:>8} {:>9}",
        "predicate", "contract", "boxes", "at most, mm", "met, mm", "slack, mm"
    )];
    lines.extend(rows.iter().map(MarginRow::text));
    let (micros, mm) = (1e6 * short, 1e3 * short * FASTEST);
    lines.push(format!(
        "Plans go at most {micros:.1} µs too short, for every f32 up to a minute: {mm:.3} mm at {FASTEST} m/s, of {:.0} mm by which footprints are inflated.",
        1e3 * INFLATION
    ));
    lines.join("\n")
}

impl MarginRow {
    fn shown(&self) -> bool {
        self.bound.covered_by(self.slack)
    }

    fn verdict(&self) -> &'static str {
        if self.shown() { "proved" } else { "not shown" }
    }

    fn text(&self) -> String {
        format!(
            "{:<27} {:<38} {:>9} {:>11.3} {:>8.3} {:>9.0}  {}",
            self.predicate.name(),
            self.contract,
            self.bound.boxes,
            1e3 * self.bound.error,
            1e3 * self.bound.seen,
            1e3 * self.slack,
            self.verdict()
        )
    }

    fn finding(&self) -> Finding {
        let said = format!(
            "{}: at most {:.3} mm, {}",
            self.verdict(),
            1e3 * self.bound.error,
            self.contract
        );
        Finding::new(Kind::Margin, self.predicate.name(), self.shown(), said)
    }

    /// The inputs with the largest error.
    fn open(&self) -> String {
        let inputs = self.predicate.inputs().iter().zip(self.bound.worst);
        let ranges: Vec<String> = inputs
            .map(|(input, [lo, hi])| format!("{} {lo} to {hi}", input.name()))
            .collect();
        format!(
            "{} ({}) for {}",
            self.predicate.name(),
            self.contract,
            ranges.join(", ")
        )
    }

    fn json(&self) -> serde_json::Value {
        let inputs = self.predicate.inputs().iter().zip(self.bound.worst);
        let worst: serde_json::Map<_, _> = inputs
            .map(|(input, range)| (input.name().to_owned(), serde_json::json!(range)))
            .collect();
        serde_json::json!({
            "predicate": self.predicate.name(), "contract": self.contract, "boxes": self.bound.boxes,
            "at_most_m": self.bound.error, "met_m": self.bound.seen, "slack_m": self.slack,
            "verdict": self.verdict(), "worst": worst,
        })
    }
}
