use super::known;
use crate::safety::{Known, SafetyFile, defects};
use std::path::Path;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

fn file() -> SafetyFile {
    let read = SafetyFile::read(Path::new(ROOT));
    read.unwrap_or_else(|failure| panic!("{}", failure.words()))
}

fn found(file: &SafetyFile, known: &Known) -> Vec<String> {
    let defects = defects(file, Path::new(ROOT), known);
    defects.iter().map(ToString::to_string).collect()
}

#[test]
fn the_safety_file_has_no_defect() {
    let found = found(&file(), &known());
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Breaks the file in one way, and expects to be told so.
fn caught(expected: &str, breaks: impl FnOnce(&mut SafetyFile, &mut Known)) {
    let (mut file, mut known) = (file(), known());
    breaks(&mut file, &mut known);
    let found = found(&file, &known);
    assert!(
        found.iter().any(|it| it.contains(expected)),
        "{expected}: {found:#?}"
    );
}

fn evidence(text: &str) -> crate::safety::EvidenceNames {
    toml::from_str(text).unwrap()
}

#[test]
fn a_requirement_without_evidence_is_found() {
    caught("SR-01: has no evidence", |file, _| {
        file.requirements[0].evidence = evidence("");
        file.requirements[0].open = None;
    });
    caught("SR-01: names no code", |file, _| {
        file.requirements[0].code.clear();
    });
    caught("SR-01: serves no goal", |file, _| {
        file.requirements[0].goals.clear();
    });
}

#[test]
fn evidence_that_does_not_exist_is_found() {
    for (names, expected) in [
        (
            "tests = ['sim/tests/zones.rs::gone']",
            "no function gone in sim/tests/zones.rs",
        ),
        (
            "tests = ['sim/tests/gone.rs::gone']",
            "no file sim/tests/gone.rs",
        ),
        (
            "tests = ['sim/tests/shield.rs::ten_million_adversarial_steps_without_an_overlap']",
            "is a test that is not run",
        ),
        (
            "tests = ['controller/src/shield/tests/door.rs::refused']",
            "is no test",
        ),
        ("lemmas = ['gone']", "there is no lemma of this name"),
        ("margins = ['gone']", "there is no margin of this name"),
        ("campaign = ['gone']", "there is no campaign of this name"),
        (
            "beyond = ['gone']",
            "there is no beyond the contract of this name",
        ),
        (
            "properties = ['SR-99']",
            "there is no property of this name",
        ),
        ("scenarios = ['SR-20']", "there is no scenario of this name"),
        (
            "theorems = ['gone']",
            "proofs/Assumptions.v does not ask what it rests on",
        ),
        (
            "records = ['docs/evidence.md#gone']",
            "no heading #gone in docs/evidence.md",
        ),
        ("records = ['docs/gone.md']", "no file docs/gone.md"),
    ] {
        caught(expected, |file, _| {
            file.requirements[0].evidence = evidence(names);
        });
    }
}

#[test]
fn names_of_code_and_diagnostics_that_do_not_exist_are_found() {
    let gone = "controller/src/shield/mod.rs::Shield::gone";
    caught("no item gone in controller/src/shield/mod.rs", |file, _| {
        file.requirements[0].code.push(gone.to_owned());
    });
    caught("the controller has no Breach::Gone", |file, _| {
        file.requirements[0]
            .diagnostics
            .push("Breach::Gone".to_owned());
    });
    caught("the controller has no Fault::NoPlans", |file, _| {
        file.assumptions[0]
            .monitors
            .push("Fault::NoPlans".to_owned());
    });
}

#[test]
fn identifiers_that_are_not_defined_or_defined_twice_are_found() {
    caught("SR-01, goals: SG-99 is not defined", |file, _| {
        file.requirements[0].goals.push("SG-99".to_owned());
    });
    caught("SR-01, rests_on: AOU-99 is not defined", |file, _| {
        file.requirements[0].rests_on.push("AOU-99".to_owned());
    });
    caught("SR-02: is defined twice", |file, _| {
        file.requirements[0].id = "SR-02".to_owned();
    });
    caught("SR1: is not of the form SR-nn", |file, _| {
        file.requirements[0].id = "SR1".to_owned();
    });
    // The documents still use it.
    caught("docs/safety/README.md: SR-54 is not defined", |file, _| {
        file.requirements
            .retain(|requirement| requirement.id != "SR-54");
    });
    caught("docs/safety/README.md: AOU-04 is not defined", |file, _| {
        file.assumptions
            .retain(|assumption| assumption.id != "AOU-04");
    });
}

#[test]
fn gaps_between_hazards_goals_requirements_and_assumptions_are_found() {
    caught("H-01: has no goal", |file, _| {
        file.hazards.hazard[0].goals.clear();
    });
    caught("SG-02: no requirement serves it", |file, _| {
        for requirement in &mut file.requirements {
            requirement.goals.retain(|goal| goal != "SG-02");
        }
    });
    caught("AOU-04: says nothing of how a breach is seen", |file, _| {
        let assumption = file.assumptions.iter_mut().find(|it| it.id == "AOU-04");
        assumption.unwrap().unseen = None;
    });
    caught("AOU-01: its monitors have no test", |file, _| {
        file.assumptions[0].tests.clear();
    });
    caught("AOU-01: no requirement rests on it", |file, _| {
        for requirement in &mut file.requirements {
            requirement.rests_on.retain(|id| id != "AOU-01");
        }
    });
}

#[test]
fn a_condition_of_the_theorem_that_nothing_takes_up_is_found() {
    caught("C6: nothing takes up this condition", |file, _| {
        for assumption in &mut file.assumptions {
            assumption.sources.retain(|source| source != "C6");
        }
    });
    caught("no table of theorem and manual states C9", |file, _| {
        file.assumptions[0].sources.push("C9".to_owned());
    });
}

#[test]
fn a_program_of_another_tree_is_found() {
    caught("no heading #gone in README.md", |_, known| {
        known.records.push("README.md#gone".to_owned());
    });
    caught(
        "proofs/Shipped.v: differs from what the program has",
        |_, known| {
            known.carried.push(("proofs/Shipped.v", String::new()));
        },
    );
}
