//! The report as one page of HTML. It has no scripts and needs no network.

use super::judged::{Item, JudgedAssumption, JudgedRequirement, State, Status};
use super::junit::escaped;
use super::provenance::{Named, Provenance};
use super::report::{NO_CLAIM, Report};
use super::steps::{Outcome, Step};
use crate::safety::Kind;
use std::fmt::Write as _;

const STYLE: &str = include_str!("page.css");

/// The page.
pub(super) fn write(report: &Report) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>Cede: safety evidence</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <header>\n<h1>Cede: safety evidence</h1>\n{}</header>\n<main>\n{}{}{}{}{}</main>\n<footer>{}</footer>\n</body>\n</html>\n",
        head(report),
        requirements(report),
        assumptions(report),
        hazards(report),
        checks(report),
        provenance(&report.provenance),
        footer(report),
    )
}

fn head(report: &Report) -> String {
    let tile = |status: Status| {
        let (count, word) = (report.count(status), status.word());
        format!("<li><b>{count}</b> <span class=\"{word}\">{word}</span></li>\n")
    };
    let tiles: String = Status::ALL.map(tile).concat();
    let quick = match report.quick {
        true => " This was a quick run: its campaigns are short.",
        false => "",
    };
    format!(
        "{}<ul class=\"tiles\">\n{tiles}</ul>\n\
         <p class=\"lead\"><b>Proved</b>: for all inputs of a stated set. <b>Tested</b>: on samples. <b>Assumed</b>: for the integrator to keep. \
         <b>Skipped</b>: not shown in this run. <b>Open</b>: not shown.{quick} {NO_CLAIM}</p>\n",
        verdict(report)
    )
}

fn verdict(report: &Report) -> String {
    let Some(open) = report.open() else {
        return "<p class=\"verdict\">Every check that was to be run has passed.</p>\n".to_owned();
    };
    let lines = open
        .lines()
        .map(|line| format!("<li>{}</li>\n", escaped(line)));
    format!(
        "<p class=\"verdict\">Not everything is shown:</p>\n<ul class=\"missing\">\n{}</ul>\n",
        lines.collect::<String>()
    )
}

fn section(title: &str, lead: &str, columns: &[&str], rows: &str) -> String {
    let columns: String = columns
        .iter()
        .map(|name| format!("<th>{name}</th>"))
        .collect();
    format!(
        "<section>\n<h2>{title}</h2>\n<p class=\"lead\">{lead}</p>\n<table>\n<thead><tr>{columns}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table>\n</section>\n"
    )
}

fn badge(class: &str, word: &str) -> String {
    format!("<span class=\"badge {class}\">{word}</span>")
}

fn requirements(report: &Report) -> String {
    let rows: String = report.requirements.iter().map(requirement).collect();
    section(
        "Requirements",
        "What the item does. Status: where proofs are named, they decide; otherwise tests do. ✓ shown, ✗ not shown, ○ not done, → by a command of its own, which does not count.",
        &["", "status", "requirement, and what is open", "evidence"],
        &rows,
    )
}

fn requirement(it: &JudgedRequirement) -> String {
    let id = &it.id;
    let mut says = escaped(&it.says);
    if let Some(open) = &it.open {
        let _ = write!(says, "<p class=\"small open\">open: {}</p>", escaped(open));
    }
    let mut ties = String::new();
    for (name, values) in [
        ("serves", &it.goals),
        ("takes up", &it.sources),
        ("rests on", &it.rests_on),
    ] {
        if !values.is_empty() {
            let _ = write!(ties, "<p class=\"small\">{name} {}</p>", linked(values));
        }
    }
    for (name, values) in [("code", &it.code), ("diagnostics", &it.diagnostics)] {
        if !values.is_empty() {
            let _ = write!(ties, "<p class=\"small\">{name}: {}</p>", codes(values));
        }
    }
    format!(
        "<tr id=\"{id}\"><td>{id}</td><td>{}</td><td>{says}{ties}</td><td>{}</td></tr>\n",
        badge(it.status.word(), it.status.word()),
        evidence(&it.evidence)
    )
}

fn assumptions(report: &Report) -> String {
    let rows: String = report.assumptions.iter().map(assumption).collect();
    section(
        "Assumptions of use",
        "What the integrator owes. A monitor tells when one is seen to be broken; what it does not see is said, too.",
        &["", "assumption", "how to keep it", "monitors"],
        &rows,
    )
}

fn assumption(it: &JudgedAssumption) -> String {
    let id = &it.id;
    let sources = match it.sources.is_empty() {
        true => String::new(),
        false => format!("<p class=\"small\">from {}</p>", linked(&it.sources)),
    };
    let unseen = it
        .unseen
        .as_ref()
        .map(|unseen| format!("<p class=\"small open\">not seen: {}</p>", escaped(unseen)));
    format!(
        "<tr id=\"{id}\"><td>{id}</td><td>{}{sources}</td><td>{}</td><td>{}{}{}</td></tr>\n",
        escaped(&it.says),
        escaped(&it.keep),
        codes(&it.monitors),
        evidence(&it.tests),
        unseen.unwrap_or_default(),
    )
}

/// Evidence by its kind, and tests by their file: names alone where there are many, with numbers where a check has some.
fn evidence(items: &[Item]) -> String {
    let same = |a: &Item, b: &Item| (a.kind, file(a)) == (b.kind, file(b));
    let groups = items.chunk_by(same);
    groups.map(|group| group_of(&group[0], group)).collect()
}

/// The file of a test; none of other evidence.
fn file(item: &Item) -> Option<&str> {
    let (path, _) = item.name.split_once("::")?;
    Some(path)
}

fn group_of(first: &Item, items: &[Item]) -> String {
    let path = file(first);
    let title = match path {
        Some(path) => format!("{} <code>{}</code>", first.kind, escaped(path)),
        None => first.kind.to_string(),
    };
    let numbers = matches!(
        first.kind,
        Kind::Margin
            | Kind::Zones
            | Kind::Property
            | Kind::Scenario
            | Kind::Campaign
            | Kind::Beyond
    );
    let one = |item: &Item| {
        let name = path.map_or(item.name.as_str(), |path| &item.name[path.len() + 2..]);
        let (class, mark) = mark(item.state);
        let said = match numbers && !item.said.is_empty() {
            true => format!(" ({})", escaped(&item.said)),
            false => String::new(),
        };
        format!(
            "<span class=\"{class}\">{mark}</span>&nbsp;<code>{}</code>{said}",
            escaped(name)
        )
    };
    let all: Vec<String> = items.iter().map(one).collect();
    format!("<p class=\"small\">{title}: {}</p>", all.join(", "))
}

/// A class of the style, and a sign that is read without colours.
const fn mark(state: State) -> (&'static str, &'static str) {
    match state {
        State::Shown => ("shown", "✓"),
        State::NotShown => ("not-shown", "✗"),
        State::NotDone => ("not-done", "○"),
        State::Elsewhere => ("elsewhere", "→"),
    }
}

fn linked(ids: &[String]) -> String {
    let link = |id: &String| match id.contains('-') {
        true => format!("<a href=\"#{0}\">{0}</a>", escaped(id)),
        false => escaped(id),
    };
    ids.iter().map(link).collect::<Vec<_>>().join(", ")
}

fn codes(names: &[String]) -> String {
    let code = |name: &String| format!("<code>{}</code>", escaped(name));
    names.iter().map(code).collect::<Vec<_>>().join(", ")
}

fn hazards(report: &Report) -> String {
    let mut rows = String::new();
    for hazard in &report.hazards.hazard {
        let (id, says) = (&hazard.id, escaped(&hazard.says));
        let _ = writeln!(
            rows,
            "<tr id=\"{id}\"><td>{id}</td><td>{says}<p class=\"small\">answered by {}</p></td></tr>",
            linked(&hazard.goals)
        );
    }
    for goal in &report.hazards.goal {
        let (id, says) = (&goal.id, escaped(&goal.says));
        let serve = report
            .requirements
            .iter()
            .filter(|it| it.goals.contains(id));
        let serve: Vec<String> = serve.map(|it| it.id.clone()).collect();
        let _ = writeln!(
            rows,
            "<tr id=\"{id}\"><td>{id}</td><td>{says}<p class=\"small\">served by {}</p></td></tr>",
            linked(&serve)
        );
    }
    section(
        "Hazards and assumed goals",
        "The goals are assumed of the vehicle; the vehicle’s own analysis has to confirm them.",
        &["", ""],
        &rows,
    )
}

fn checks(report: &Report) -> String {
    let rows: String = report.steps.iter().map(check).collect();
    section(
        "Checks",
        "What was run, with its numbers; and what has a command of its own and was not run.",
        &["", "", "what came of it", "seconds"],
        &rows,
    )
}

fn check(step: &Step) -> String {
    let word = step.outcome.word().text();
    let why = step.outcome.why().map(|why| {
        format!(
            "<p class=\"small open\">{}</p>",
            escaped(why).replace("&#10;", "<br>")
        )
    });
    let seconds = match step.outcome {
        Outcome::Elsewhere | Outcome::Missing(_) => String::new(),
        Outcome::Passed | Outcome::Failed(_) => format!("{:.0}", step.seconds),
    };
    format!(
        "<tr><td class=\"wide\">{}</td><td>{}</td><td>{}{}<p class=\"small\"><code>{}</code></p></td><td class=\"number\">{seconds}</td></tr>\n",
        escaped(step.name),
        badge(&word.replace(' ', "-"), word),
        escaped(&step.summary),
        why.unwrap_or_default(),
        escaped(&step.command),
    )
}

fn provenance(it: &Provenance) -> String {
    let none = || "not a git clone".to_owned();
    let named = |name: &str, value: &str| Named {
        name: name.to_owned(),
        value: value.to_owned(),
    };
    let head = [
        named("cede", it.cede),
        named("git revision", &it.revision.clone().unwrap_or_else(none)),
        named("machine", &it.machine),
    ];
    let all = head.iter().chain(&it.tools).chain(&it.hashes);
    let row = |Named { name, value }: &Named| {
        let (name, value) = (escaped(name), escaped(value));
        format!("<tr><td class=\"wide\">{name}</td><td class=\"hash\">{value}</td></tr>\n")
    };
    let rows: String = all.map(row).collect();
    section(
        "Provenance",
        "Versions of the tools, and SHA-256 of what the evidence is about.",
        &["", ""],
        &rows,
    )
}

fn footer(report: &Report) -> String {
    format!(
        "{}. Written by <code>cede verify all</code>; the safety file is <code>docs/safety/</code>. {NO_CLAIM}",
        report.counts()
    )
}
