use super::report::Report;
use super::steps::{Outcome, Step, elsewhere, plans};
use super::{junit, page, provenance};
use crate::command::verify::checked::Finding;
use crate::safety::{Kind, SafetyFile};
use std::path::Path;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// A report of which the campaign has this outcome; nothing else was run.
fn report(outcome: Outcome, shown: bool) -> Report {
    let root = Path::new(ROOT);
    let file = SafetyFile::read(root).unwrap_or_else(|failure| panic!("{}", failure.words()));
    let campaign = Step {
        outcome,
        summary: "3 steps & <one> overlap".to_owned(),
        findings: vec![Finding::new(Kind::Campaign, "all", shown, "3 steps")],
        ..Step::missing("campaign", "cede verify campaign".to_owned(), String::new())
    };
    let steps: Vec<Step> = [campaign].into_iter().chain(elsewhere()).collect();
    let provenance = provenance::of(root, &steps);
    Report::new(&file, steps, provenance, true)
}

#[test]
fn what_is_not_done_or_not_shown_is_a_failure() {
    assert_eq!(report(Outcome::Passed, true).open(), None);
    let missing = report(Outcome::Missing("no Z3".to_owned()), true).open();
    assert_eq!(missing.as_deref(), Some("campaign not done: no Z3"));
    let failed = report(Outcome::Failed("1 overlap".to_owned()), false)
        .open()
        .unwrap();
    assert!(
        failed.starts_with("campaign failed: 1 overlap\nSR-01 is not shown"),
        "{failed}"
    );
}

#[test]
fn every_form_names_every_requirement_and_assumption() {
    let report = report(Outcome::Passed, true);
    let json: serde_json::Value = serde_json::from_str(&report.json()).unwrap();
    assert_eq!(json["passed"], true);
    let junit = junit::write(&report);
    let document = roxmltree::Document::parse(&junit).unwrap();
    let (page, text) = (page::write(&report), report.text());
    let requirements = report.requirements.iter().map(|it| it.id.as_str());
    let ids: Vec<&str> = requirements
        .chain(report.assumptions.iter().map(|it| it.id.as_str()))
        .collect();
    assert!(ids.len() > 60, "{}", ids.len());
    for id in ids {
        assert!(page.contains(&format!("<tr id=\"{id}\">")), "{id}");
        assert!(text.contains(&format!("\n{id} ")), "{id}");
        let mut cases = document.descendants();
        assert!(cases.any(|case| case.attribute("name") == Some(id)), "{id}");
    }
    // Nothing but the campaign was run.
    assert!(json["counts"]["proved"] == 0 && json["counts"]["skipped"].as_u64() > Some(30));
}

#[test]
fn failures_and_skips_are_those_of_junit() {
    let report = report(Outcome::Failed("1 <overlap>".to_owned()), false);
    let xml = junit::write(&report);
    let document = roxmltree::Document::parse(&xml).unwrap();
    let of = |name: &str| {
        let mut cases = document.descendants();
        let case = cases
            .find(|case| case.attribute("name") == Some(name))
            .unwrap();
        let verdict = case.first_element_child().unwrap();
        (
            verdict.tag_name().name().to_owned(),
            verdict.attribute("message").unwrap_or_default().to_owned(),
        )
    };
    assert_eq!(
        of("campaign"),
        ("failure".to_owned(), "1 <overlap>".to_owned())
    );
    assert_eq!(of("SR-01").0, "failure");
    assert_eq!(of("AOU-01").0, "skipped");
    assert_eq!(of("attacker").0, "skipped");
}

#[test]
fn the_page_is_escaped_and_needs_no_network() {
    let page = page::write(&report(Outcome::Passed, true));
    assert!(page.contains("3 steps &amp; &lt;one&gt; overlap"));
    for outside in ["http", "src=", "url(", "@import", "<script"] {
        assert!(!page.contains(outside), "{outside}");
    }
}

#[test]
fn every_command_line_is_understood() {
    use clap::Parser as _;
    #[derive(clap::Parser)]
    struct Line {
        #[command(subcommand)]
        _verify: crate::command::verify::Verify,
    }
    for quick in [false, true] {
        for plan in plans(quick) {
            let words = ["cede"].into_iter().chain(plan.line().split(' '));
            assert!(Line::try_parse_from(words).is_ok(), "{}", plan.line());
        }
    }
}
