//! `cede verify all`: every check that there is, and what it means for each requirement and assumption.

mod cargo;
mod judged;
mod junit;
mod page;
mod provenance;
mod report;
mod rocq;
mod safety;
mod steps;
#[cfg(test)]
mod tests;

use crate::failure::Failure;
use crate::safety::SafetyFile;
use crate::threads::Threads;
use cede_data::output;
use clap::Args;
use report::Report;
use std::io::Write as _;
use std::path::PathBuf;
use steps::Step;

/// The text below the options in `cede help verify all`.
const HELP: &str = "\
Runs the checks of `cede verify lemmas`, `margins`, `zones`, `policy`, `reach`, `campaign` and `beyond`, the Rocq proofs
(proofs/check.sh, if coqc is on the search path) and the tests that the safety file names, and checks that file
(docs/safety/) itself: gaps, and names of what is not there. Then it says of each requirement whether it is proved,
tested, skipped or open, and of each assumption of use what monitors it. Run it in a clone of the repository.

The tests are run by cargo, or collected: `cargo test --workspace 2>&1 | tee FILE`, then --tests FILE. With --quick
they are only collected. Firmware, attacker, mutants and other checks of their own commands are listed, not run.

Exit code 1 if a check fails, or if one cannot be run: what is not done is a failure.";

/// Options of `cede verify all`.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct All {
    /// Write report.html, report.json and junit.xml to this folder.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Shorter campaigns, coarser bounds on rounding; no test is run. Minutes.
    #[arg(long)]
    quick: bool,
    /// What `cargo test` printed, both streams; may be given several times. No test is run then.
    #[arg(long, value_name = "FILE")]
    tests: Vec<PathBuf>,
    /// The repository's folder.
    #[arg(long, value_name = "DIR", default_value = ".")]
    source: PathBuf,
    #[command(flatten)]
    threads: Threads,
    /// Print one JSON object instead.
    #[arg(long)]
    json: bool,
}

impl All {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let file = SafetyFile::read(&self.source)?;
        self.threads.start()?;
        let mut steps: Vec<Step> = Vec::new();
        for plan in steps::plans(self.quick) {
            steps.push(plan.run());
        }
        steps.push(rocq::step(&self.source));
        steps.push(self.tested(&file)?);
        steps.push(safety::step(&file, &self.source));
        steps.extend(steps::elsewhere());
        let provenance = provenance::of(&self.source, &steps);
        let report = Report::new(&file, steps, provenance, self.quick);
        self.write(&report)?;
        // A closed pipe (`| head`) is not an error.
        let _ = writeln!(std::io::stdout(), "{}", self.told(&report));
        match report.open() {
            None => Ok(()),
            Some(open) => Err(Failure::Check(open)),
        }
    }

    /// The tests that `file` names.
    fn tested(&self, file: &SafetyFile) -> Result<Step, Failure> {
        if !self.tests.is_empty() {
            return cargo::collected(file, &self.source, &self.tests);
        }
        Ok(match self.quick {
            true => cargo::left_out(),
            false => cargo::run(file, &self.source),
        })
    }

    fn write(&self, report: &Report) -> Result<(), Failure> {
        let Some(folder) = &self.report else {
            return Ok(());
        };
        for (name, text) in [
            ("report.html", page::write(report)),
            ("report.json", report.json()),
            ("junit.xml", junit::write(report)),
        ] {
            output::write(&folder.join(name), |out| out.write_all(text.as_bytes()))?;
        }
        eprintln!("written: {}", folder.join("report.html").display());
        Ok(())
    }

    fn told(&self, report: &Report) -> String {
        match self.json {
            true => report.json(),
            false => report.text(),
        }
    }
}
