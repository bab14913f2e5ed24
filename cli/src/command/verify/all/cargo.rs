//! The tests that the safety file names: run by cargo, or collected from what it printed.

use super::super::checked::{Checked, Finding};
use super::steps::Step;
use crate::child;
use crate::failure::Failure;
use crate::safety::{Kind, SafetyFile};
use miette::{IntoDiagnostic, WrapErr, miette};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

const NAME: &str = "tests";
const ARGUMENTS: [&str; 4] = ["test", "--locked", "--workspace", "--no-fail-fast"];

/// What became of a test.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Ran {
    Passed,
    Failed,
    /// It was ignored, or skipped itself.
    Skipped(String),
}

/// What cargo printed: what became of each function, by the program that it is in. Programs of one name in two packages
/// are taken together.
#[derive(Default)]
struct Results(BTreeMap<(String, String), Vec<Ran>>);

/// Runs the tests of the repository in `root`.
pub(super) fn run(file: &SafetyFile, root: &Path) -> Step {
    let command = format!("cargo {}", ARGUMENTS.join(" "));
    Step::run(NAME, command, || {
        let mut cargo = Command::new("cargo");
        cargo.args(ARGUMENTS).current_dir(root);
        let progress = |line: &str| {
            if line.trim_start().starts_with("Running ") {
                eprintln!("{line}");
            }
        };
        let ran = child::run(cargo, progress);
        let (_, said) =
            ran.map_err(|error| Failure::Input(miette!("cannot run cargo: {error}")))?;
        check(file, root, &said)
    })
}

/// Collects the tests from files of what cargo printed.
pub(super) fn collected(
    file: &SafetyFile,
    root: &Path,
    paths: &[PathBuf],
) -> Result<Step, Failure> {
    let mut said = String::new();
    for path in paths {
        let text = std::fs::read(path).into_diagnostic();
        let text = text.wrap_err_with(|| format!("cannot use {} (--tests)", path.display()));
        said += &String::from_utf8_lossy(&text.map_err(Failure::Input)?);
    }
    let command = "cargo test --workspace, collected".to_owned();
    Ok(Step::run(NAME, command, || check(file, root, &said)))
}

/// The tests that nobody has run.
pub(super) fn left_out() -> Step {
    let why = "--quick runs no test: give what `cargo test --workspace` printed with --tests FILE";
    Step::missing(
        NAME,
        format!("cargo {}", ARGUMENTS.join(" ")),
        why.to_owned(),
    )
}

/// Finds in `said` the tests that `file` names.
fn check(file: &SafetyFile, root: &Path, said: &str) -> Result<Checked, Failure> {
    let results = Results::read(said);
    let named = named(file);
    let (mut findings, mut absent) = (Vec::new(), Vec::new());
    for place in &named {
        match results.of(root, place) {
            Some(Ran::Passed) => findings.push(Finding::new(Kind::Test, *place, true, "passed")),
            Some(Ran::Failed) => findings.push(Finding::new(Kind::Test, *place, false, "failed")),
            Some(Ran::Skipped(why)) => absent.push(format!("{place} was skipped: {why}")),
            None => absent.push(format!("{place} was not run")),
        }
    }
    let failed = results.failed();
    let open = match (failed.is_empty(), absent.is_empty()) {
        (true, true) => None,
        (false, _) => Some(format!("failed: {}", failed.join(", "))),
        (true, false) => Some(some(&absent)),
    };
    let passed = findings.iter().filter(|finding| finding.shown).count();
    Ok(Checked {
        text: String::new(),
        json: serde_json::json!({ "seen": results.0.len(), "failed": failed, "absent": absent }),
        summary: format!(
            "{passed} of {} named tests passed; {} tests in all, {} failed",
            named.len(),
            results.0.len(),
            failed.len()
        ),
        findings,
        open,
    })
}

/// The first few of `lines`, and how many more there are.
fn some(lines: &[String]) -> String {
    const FEW: usize = 3;
    let first = lines[..FEW.min(lines.len())].join("; ");
    match lines.len().saturating_sub(FEW) {
        0 => first,
        more => format!("{first}; and {more} more"),
    }
}

/// The tests that the safety file names, path::function.
fn named(file: &SafetyFile) -> BTreeSet<&str> {
    let requirements = file.requirements.iter();
    let evidence = requirements.flat_map(|requirement| requirement.evidence.each());
    let tests = evidence.filter(|evidence| evidence.kind == Kind::Test);
    let monitors = file.assumptions.iter().flat_map(|it| &it.tests);
    tests
        .map(|test| test.name)
        .chain(monitors.map(String::as_str))
        .collect()
}

impl Results {
    fn read(said: &str) -> Self {
        let mut results = Self::default();
        let mut program = String::new();
        let mut skipped = BTreeMap::new();
        for line in said.lines().map(plain) {
            let line = line.trim();
            if let Some((_, path)) = line
                .strip_prefix("Running ")
                .and_then(|it| it.split_once(" ("))
            {
                program = stem(path.trim_end_matches(')'));
            } else if line.starts_with("Doc-tests ") {
                program.clear();
            } else if let Some((test, why)) = line
                .strip_prefix("skipped: ")
                .and_then(|it| it.split_once(": "))
            {
                skipped.insert(function(test), why.to_owned());
            } else if let Some((test, became)) = line
                .strip_prefix("test ")
                .and_then(|it| it.rsplit_once(" ... "))
            {
                let name = function(test.trim_end_matches(" - should panic"));
                let ran = match (became, skipped.remove(&name)) {
                    ("ok", None) => Ran::Passed,
                    ("ok", Some(why)) => Ran::Skipped(why),
                    (became, _) if became.starts_with("ignored") => Ran::Skipped(became.to_owned()),
                    _ => Ran::Failed,
                };
                results
                    .0
                    .entry((program.clone(), name))
                    .or_default()
                    .push(ran);
            }
        }
        results
    }

    /// What became of the test at `place`; none if it was not run.
    fn of(&self, root: &Path, place: &str) -> Option<Ran> {
        let (path, name) = place.split_once("::")?;
        let ran = self.0.get(&(program(root, path)?, name.to_owned()))?;
        let worst = |wanted: fn(&Ran) -> bool| ran.iter().find(|ran| wanted(ran)).cloned();
        worst(|ran| *ran == Ran::Failed)
            .or_else(|| worst(|ran| matches!(ran, Ran::Skipped(_))))
            .or_else(|| ran.first().cloned())
    }

    fn failed(&self) -> Vec<String> {
        let failed = self.0.iter().filter(|(_, ran)| ran.contains(&Ran::Failed));
        failed
            .map(|((program, name), _)| format!("{program}: {name}"))
            .collect()
    }
}

/// The name of the program that has the tests of the file at `path`.
fn program(root: &Path, path: &str) -> Option<String> {
    let parts: Vec<&str> = path.split('/').collect();
    let package = |place: &usize| {
        ["src", "tests"].contains(&parts[*place])
            && root
                .join(parts[..*place].join("/"))
                .join("Cargo.toml")
                .is_file()
    };
    let place = (0..parts.len()).rev().find(package)?;
    if parts[place] == "tests" {
        return Some(parts.get(place + 1)?.trim_end_matches(".rs").to_owned());
    }
    let manifest = root.join(parts[..place].join("/")).join("Cargo.toml");
    let manifest: toml::Table = std::fs::read_to_string(manifest).ok()?.parse().ok()?;
    let name = manifest.get("package")?.get("name")?.as_str()?;
    Some(name.replace('-', "_"))
}

/// `target/debug/deps/zones-0a1b` is `zones`.
fn stem(path: &str) -> String {
    let file = path.rsplit(['/', '\\']).next().unwrap_or(path);
    file.rsplit_once('-')
        .map_or(file, |(stem, _)| stem)
        .to_owned()
}

/// The last part of a test's name.
fn function(test: &str) -> String {
    test.rsplit("::").next().unwrap_or(test).to_owned()
}

/// A line without colours.
fn plain(line: &str) -> String {
    let mut parts = line.split('\u{1b}');
    let mut plain = parts.next().unwrap_or_default().to_owned();
    plain.extend(parts.map(|part| part.split_once('m').map_or("", |(_, rest)| rest)));
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAID: &str = "\
   Compiling cede v0.1.0
\u{1b}[1m\u{1b}[32m     Running\u{1b}[0m unittests src/lib.rs (target/debug/deps/cede_controller-0a1b)
skipped: shield::tests::without_data: no recorded data (CEDE_INTERACTION_DIR)
test shield::tests::it_holds ... ok
test shield::tests::without_data ... ok
test shield::tests::it_breaks ... FAILED
test shield::tests::it_is_long ... ignored, takes hours
     Running tests/zones.rs (target/debug/deps/zones-2c3d)
test it_holds ... ok
   Doc-tests cede_controller
test controller/src/lib.rs - (line 10) ... ok
";

    #[test]
    fn what_cargo_prints_is_read_by_program_and_function() {
        let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
        let results = Results::read(SAID);
        let of = |place: &str| results.of(root, place);
        assert_eq!(
            of("controller/src/shield/tests.rs::it_holds"),
            Some(Ran::Passed)
        );
        assert_eq!(of("sim/tests/zones.rs::it_holds"), Some(Ran::Passed));
        assert_eq!(
            of("controller/src/shield/tests.rs::it_breaks"),
            Some(Ran::Failed)
        );
        assert_eq!(of("sim/tests/shield.rs::it_holds"), None);
        assert_eq!(of("sim/tests/zones.rs::it_breaks"), None);
        for skipped in ["without_data", "it_is_long"] {
            let ran = of(&format!("controller/src/shield/tests.rs::{skipped}"));
            assert!(matches!(ran, Some(Ran::Skipped(_))), "{skipped}: {ran:?}");
        }
        assert_eq!(results.failed(), ["cede_controller: it_breaks"]);
    }

    #[test]
    fn a_file_belongs_to_the_program_that_cargo_makes_of_it() {
        let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
        for (path, name) in [
            ("controller/src/shield/tests/memory.rs", "cede_controller"),
            ("tests/tests/policy.rs", "policy"),
            ("tests/attack/tests/findings/by_hand.rs", "findings"),
            ("tests/precedence-model/tests/two.rs", "two"),
            ("cli/src/plural.rs", "cede"),
        ] {
            assert_eq!(program(root, path).as_deref(), Some(name), "{path}");
        }
    }
}
