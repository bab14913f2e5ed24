//! `cede verify lemmas`.

use super::checked::{Check, Checked, Finding, open};
use super::seconds;
use crate::failure::Failure;
use crate::safety::Kind;
use crate::threads::Threads;
use cede_data::output;
use cede_verify::lemma::{Answer, Lemma, Quantity, Settled, Solver, SolverError, lemmas, shipped};
use clap::Args;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The text below the options in `cede help verify lemmas`.
const HELP: &str = "\
Z3 proves the lemmas of the shield's theorem (docs/theorem.md) over the reals, from the margins that the vehicle
computes, and refutes each lemma without one of its premises. Exit code 1 if a lemma is refuted or undecided, or
holds without that premise.";

/// Options of `cede verify lemmas`.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Lemmas {
    /// Prove only this lemma.
    #[arg(long, value_name = "LEMMA", value_parser = known)]
    only: Option<String>,
    /// Path of Z3; by default the one on the search path.
    #[arg(long, value_name = "PATH")]
    solver: Option<PathBuf>,
    /// Time limit per query in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 60, value_parser = seconds())]
    timeout: u64,
    /// Also write the queries to this folder as SMT-LIB files. `--write rocq FILE`: write the bounds and margins to this
    /// file as Rocq definitions, and prove nothing.
    #[arg(long, value_names = ["DIR", "FILE"], num_args = 1..=2)]
    write: Vec<PathBuf>,
    #[command(flatten)]
    threads: Threads,
    /// Print one JSON object instead.
    #[arg(long)]
    json: bool,
}

/// A lemma and the solver's answers.
type SettledLemma = (Lemma, Settled);

impl Lemmas {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        match self.write.as_slice() {
            [form, file] => return self.print(form, file),
            [folder] => write(folder, &self.chosen())?,
            _ => {}
        }
        self.threads.start()?;
        self.check()?.tell(self.json)
    }

    fn chosen(&self) -> Vec<Lemma> {
        let only = |lemma: &Lemma| self.only.as_deref().is_none_or(|only| only == lemma.id);
        lemmas().into_iter().filter(only).collect()
    }

    /// Writes what another prover is asked about.
    fn print(&self, form: &Path, file: &Path) -> Result<(), Failure> {
        if form != Path::new("rocq") {
            let form = form.display();
            return Err(Failure::Usage(format!(
                "--write {form} FILE: the form is rocq"
            )));
        }
        let options = [
            ("--only", self.only.is_some()),
            ("--solver", self.solver.is_some()),
            ("--json", self.json),
        ];
        if let Some((option, _)) = options.into_iter().find(|(_, given)| *given) {
            return Err(Failure::ignored(option, "--write rocq"));
        }
        output::write(file, |file| file.write_all(shipped().as_bytes()))?;
        Ok(())
    }

    fn settle(&self, solver: &Solver) -> Result<Vec<SettledLemma>, Failure> {
        let limit = Duration::from_secs(self.timeout);
        let settle = |lemma: Lemma| {
            let settled = lemma.settle(solver, limit).map_err(unusable)?;
            Ok((lemma, settled))
        };
        self.chosen().into_par_iter().map(settle).collect()
    }
}

impl Check for Lemmas {
    fn check(&self) -> Result<Checked, Failure> {
        let solver = Solver::find(self.solver.as_deref()).map_err(unusable)?;
        let rows = self.settle(&solver)?;
        let unproved = rows.iter().filter(|(_, settled)| !settled.proved());
        let open = open("not proved", unproved.map(|(lemma, _)| lemma.id));
        let proved = rows.iter().filter(|(_, settled)| settled.proved()).count();
        let lines = rows.iter().map(text).collect::<Vec<_>>().join("\n");
        let (version, objects) = (solver.version(), rows.iter().map(json).collect::<Vec<_>>());
        Ok(Checked {
            text: format!("{lines}\nby Z3 {version}"),
            json: serde_json::json!({ "solver": version, "lemmas": objects }),
            summary: format!(
                "{proved} of {} lemmas proved, each refuted with one rule broken, by Z3 {version}",
                rows.len()
            ),
            findings: rows.iter().map(finding).collect(),
            open,
        })
    }
}

fn finding((lemma, settled): &SettledLemma) -> Finding {
    let said = format!("{}: {}", word(settled), lemma.says);
    Finding::new(Kind::Lemma, lemma.id, settled.proved(), said)
}

/// Checks that `name` is the name of a lemma.
fn known(name: &str) -> Result<String, String> {
    let names: Vec<&str> = lemmas().iter().map(|lemma| lemma.id).collect();
    if names.contains(&name) {
        Ok(name.to_owned())
    } else {
        Err(format!(
            "no such lemma; the lemmas are: {}",
            names.join(", ")
        ))
    }
}

fn unusable(error: SolverError) -> Failure {
    let mend = error.mend();
    Failure::input(error, mend)
}

/// Writes `LEMMA.smt2`, which should be `unsat`, and `LEMMA-broken.smt2`, which should be `sat`.
fn write(folder: &Path, lemmas: &[Lemma]) -> Result<(), Failure> {
    for lemma in lemmas {
        for (kind, script) in [("", &lemma.claim), ("-broken", &lemma.broken.claim)] {
            let path = folder.join(format!("{}{kind}.smt2", lemma.id));
            output::write(&path, |file| file.write_all(script.text.as_bytes()))?;
        }
    }
    Ok(())
}

fn word(settled: &Settled) -> &'static str {
    match (&settled.answer, &settled.broken) {
        (Answer::Unsat, Answer::Sat(_)) => "proved",
        (Answer::Unsat, _) => "vacuous",
        (Answer::Sat(_), _) => "refuted",
        (Answer::Unknown(_), _) => "open",
    }
}

fn text((lemma, settled): &SettledLemma) -> String {
    let mut text = format!(
        "{:<12} {:<9} {:>5.1} s  {}\n{:30}given: {}",
        lemma.id,
        word(settled),
        settled.time.as_secs_f64(),
        lemma.says,
        "",
        lemma.given
    );
    let mut add = |what: &str, answer: &Answer| {
        text += &format!("\n{:30}{what}: {}", "", said(answer));
    };
    if settled.answer != Answer::Unsat {
        add("against it", &settled.answer);
    }
    add(lemma.broken.what, &settled.broken);
    text
}

fn said(answer: &Answer) -> String {
    match answer {
        Answer::Unsat => "holds".to_owned(),
        Answer::Unknown(why) => format!("no answer ({why})"),
        Answer::Sat(witness) => {
            let quantity = |q: &Quantity| format!("{} = {:.4} {}", q.name, q.value, q.unit);
            witness.iter().map(quantity).collect::<Vec<_>>().join(", ")
        }
    }
}

fn json((lemma, settled): &SettledLemma) -> serde_json::Value {
    let witness = |answer: &Answer| match answer {
        Answer::Sat(witness) => witness.iter().map(value).collect::<Vec<_>>().into(),
        Answer::Unsat | Answer::Unknown(_) => serde_json::Value::Null,
    };
    serde_json::json!({
        "id": lemma.id, "says": lemma.says, "given": lemma.given,
        "verdict": word(settled), "seconds": settled.time.as_secs_f64(), "witness": witness(&settled.answer),
        "broken": { "what": lemma.broken.what, "witness": witness(&settled.broken) },
    })
}

fn value(quantity: &Quantity) -> serde_json::Value {
    serde_json::json!({ "name": quantity.name, "value": quantity.value, "unit": quantity.unit })
}
