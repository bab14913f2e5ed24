//! `cede verify shield`: the share of recorded steps that the shield accepts.

use crate::contract::{self, Named};
use crate::failure::Failure;
use crate::left_out;
use crate::report::{Report, command};
use crate::source::{self, not_empty};
use cede_controller::{ConflictKind, Contract, ContractBuilder};
use cede_data::{Encounter, output};
use cede_sim::transparency::{Swept, Transparency, sweep, transparency};
use clap::Args;
use std::io::{self, Write};
use std::path::PathBuf;

/// The text below the options in `cede help verify shield`.
const HELP: &str = "\
Exit code 1 if the share of recorded steps that the shield accepts is below 99.5 % at crossings or 99 % at merges
under the worst-case contract.";

/// The contract with a bar.
const WORST_CASE: &str = "worst case";

/// Options of `cede verify shield`.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Shield {
    /// Folder of the recordings.
    #[arg(long)]
    data: PathBuf,
    /// Site of the recordings.
    #[arg(long, default_value = "EP0")]
    site: String,
    /// Only this contract, without a bar; worst-case and three that differ from it in one number, unless it is given
    #[arg(long, value_name = "NAME|FILE")]
    contract: Option<Named>,
    /// Also write the shares for other values of acceleration and braking to this CSV file.
    #[arg(long, value_name = "FILE")]
    sweep: Option<PathBuf>,
    /// Also draw these shares on a page: one HTML file.
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Print one JSON object instead.
    #[arg(long)]
    json: bool,
}

impl Shield {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let contract = contract::or_worst_case(self.contract.as_ref())?;
        let mut outputs = [&self.sweep, &self.report].into_iter().flatten();
        outputs.try_for_each(|file| output::check(file))?;
        let data = source::recorded(&self.data, &self.site)?;
        not_empty(&data)?;
        let encounters: Vec<&Encounter> = data.encounters.iter().collect();
        left_out::tell(&encounters);
        let contracts = match self.contract {
            Some(_) => vec![("as given", contract)],
            None => contracts().to_vec(),
        };
        let judged = |(name, contract)| (name, transparency(&encounters, contract));
        let rows: Vec<(&str, Vec<Transparency>)> = contracts.into_iter().map(judged).collect();
        if self.json {
            let rows: Vec<_> = rows.iter().flat_map(json).collect();
            println!(
                "{}",
                serde_json::json!({ "site": data.site.name, "rows": rows })
            );
        } else {
            print(&rows);
        }
        if let Some(file) = &self.sweep {
            let rows = sweep(&encounters, contract)
                .map_err(|error| Failure::input(error, "report this as a bug"))?;
            output::write(file, |out| csv(out, &rows))?;
        }
        if let Some(file) = &self.report {
            let mut report = Report::showing(Vec::new(), &data, &command());
            report.sweep(&data, contract)?;
            report.write(file)?;
        }
        let worst = rows.iter().find(|(name, _)| *name == WORST_CASE);
        worst.map_or(Ok(()), |(_, rows)| judge(rows))
    }
}

fn print(contracts: &[(&str, Vec<Transparency>)]) {
    println!("contract          kind       role    steps  accepted");
    for (name, rows) in contracts {
        for row in rows {
            let (kind, role) = (format!("{:?}", row.kind), format!("{:?}", row.role));
            let share = 100.0 * row.share();
            println!(
                "{name:17} {kind:10} {role:5} {:>7}  {share:6.2} %",
                row.steps
            );
        }
    }
}

fn json((name, rows): &(&str, Vec<Transparency>)) -> Vec<serde_json::Value> {
    let row = |row: &Transparency| {
        serde_json::json!({
            "contract": name, "kind": format!("{:?}", row.kind).to_lowercase(),
            "role": format!("{:?}", row.role).to_lowercase(), "steps": row.steps, "accepted": row.accepted,
        })
    };
    rows.iter().map(row).collect()
}

fn csv(out: &mut dyn Write, rows: &[Swept]) -> io::Result<()> {
    writeln!(
        out,
        "other_acceleration,ego_braking,kind,role,steps,accepted"
    )?;
    for row in rows {
        let counted = row.counted;
        let kind = format!("{:?}", counted.kind).to_lowercase();
        let role = format!("{:?}", counted.role).to_lowercase();
        let (a, b) = (row.acceleration, row.braking);
        let (steps, accepted) = (counted.steps, counted.accepted);
        writeln!(out, "{a},{b},{kind},{role},{steps},{accepted}")?;
    }
    Ok(())
}

fn contracts() -> [(&'static str, Contract); 4] {
    const fn valid(numbers: ContractBuilder) -> Contract {
        match numbers.build() {
            Ok(contract) => contract,
            Err(_) => panic!("a number is out of its range"),
        }
    }
    const PROMPT: Contract = valid(Contract::builder().latency(0.0));
    const SENSED: Contract = valid(Contract::builder().position_error(0.3).speed_error(0.3));
    const SLOW: Contract = valid(Contract::builder().follower_reaction(1.0));
    [
        (WORST_CASE, Contract::WORST_CASE),
        ("no latency", PROMPT),
        ("errors 0.3", SENSED),
        ("reaction 1 s", SLOW),
    ]
}

fn judge(rows: &[Transparency]) -> Result<(), Failure> {
    for (kind, bar) in [
        (ConflictKind::Crossing, 0.995),
        (ConflictKind::Merging, 0.99),
    ] {
        let of = || rows.iter().filter(|row| row.kind == kind);
        let (accepted, steps) = (
            of().map(|row| row.accepted).sum::<u64>() as f64,
            of().map(|row| row.steps).sum::<u64>() as f64,
        );
        if accepted < bar * steps {
            return Err(Failure::Check(format!(
                "{kind:?}: {accepted} of {steps} steps are accepted, fewer than {bar}"
            )));
        }
    }
    Ok(())
}
