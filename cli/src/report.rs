//! The report: one HTML file with the table, replays and charts, which needs no network.
//!
//! The page draws its content from the JSON in it ([`model`]) and hides sections
//! without data.

mod around;
mod called;
mod cases;
mod digits;
mod gallery;
mod model;
mod replayed;
mod sweep;
mod why;

pub(crate) use called::called;
pub(crate) use why::{Class, words};

use crate::failure::Failure;
use crate::plural::Count;
use cede_controller::Contract;
use cede_data::{Dataset, Encounter, EncounterId, Split, output};
use cede_sim::evaluate::{Drive, TableRow};
use cede_sim::transparency;
use cede_train::run::curve::Point;
use gallery::Gallery;
use model::{Episodes, Interventions, Page};
use replayed::Case;
use serde::Serialize;
use std::collections::HashMap;
use std::path::Path;
use sweep::Panel;

/// The learning curve of one row's driver.
#[derive(Serialize)]
pub(crate) struct Learned {
    pub(crate) driver: &'static str,
    pub(crate) seed: u64,
    pub(crate) points: Vec<Point>,
}

const PAGE: &str = include_str!("report/page/page.html");
const STYLE: &str = include_str!("report/page/style.css");
const SCRIPT: &str = concat!(
    include_str!("report/page/charts.js"),
    include_str!("report/page/table.js"),
    include_str!("report/page/replay.js"),
    include_str!("report/page/sweep.js"),
    include_str!("report/page/learning.js"),
    include_str!("report/page/gallery.js"),
    include_str!("report/page/save.js"),
    include_str!("report/page/page.js"),
);

/// The command line.
pub(crate) fn command() -> String {
    let arguments = std::env::args_os().skip(1);
    let words = arguments.map(|argument| format!(" {}", argument.to_string_lossy()));
    format!("cede{}", words.collect::<String>())
}

/// Collects the content of the page, row by row.
pub(crate) struct Report {
    page: Page,
    /// Index of each chosen encounter in the page's cases.
    chosen: HashMap<EncounterId, usize>,
    gallery: Gallery,
}

impl Report {
    /// A report on `dataset`; `command` is the command line that writes it.
    pub(crate) fn new(dataset: &Dataset, command: &str) -> Self {
        Self::showing(cases::choose(dataset), dataset, command)
    }

    /// A report that replays these `encounters` of `dataset`.
    pub(crate) fn showing(encounters: Vec<&Encounter>, dataset: &Dataset, command: &str) -> Self {
        let ids = encounters.iter().map(|encounter| encounter.id.clone());
        Self {
            chosen: ids.zip(0..).collect(),
            gallery: Gallery::default(),
            page: Page {
                subtitle: subtitle(dataset),
                provenance: format!("Cede {}. Again: {command}", env!("CARGO_PKG_VERSION")),
                paper: model::paper(&dataset.site.name),
                map: dataset.map.as_ref().map(model::Map::of).unwrap_or_default(),
                cases: encounters.into_iter().map(Case::of).collect(),
                ..Page::default()
            },
        }
    }

    /// Adds a row of the table with its episodes.
    pub(crate) fn add(&mut self, row: &TableRow, drives: &[Drive<'_>]) {
        let driver = match row.shield.as_str() {
            "off" => row.driver.clone(),
            "on" => format!("{} + shield", row.driver),
            contract => format!("{} + shield ({contract})", row.driver),
        };
        self.page.name(&driver);
        for drive in drives {
            let name = match drive.ego {
                None => driver.clone(),
                Some(role) => format!("{driver} as {}", called(drive.encounter, role)),
            };
            self.gallery.add(&name, drive);
            if let Some(&place) = self.chosen.get(&drive.encounter.id) {
                self.page.name(&name);
                self.page.cases[place].add(name, drive);
            }
        }
        let interventions = Interventions::of(&driver, row, drives);
        self.page.interventions.extend(interventions);
        self.page
            .distributions
            .push(Episodes::of(&driver, row, drives));
        self.page.rows.push(row.clone());
    }

    /// Adds the shares of recorded steps in `dataset` that the shield accepts, under variants of `contract`.
    ///
    /// # Errors
    /// If one of the variants is no contract.
    pub(crate) fn sweep(&mut self, dataset: &Dataset, contract: Contract) -> Result<(), Failure> {
        let encounters: Vec<&Encounter> = dataset.encounters.iter().collect();
        let rows = transparency::sweep(&encounters, contract)
            .map_err(|error| Failure::input(error, "choose another contract"))?;
        self.page.sweep = Panel::all(&rows);
        Ok(())
    }

    /// Tells above the results of which of several trainings the rows are.
    pub(crate) fn tell_seed(&mut self, note: &str) {
        note.clone_into(&mut self.page.seed_note);
    }

    /// Adds learning curves.
    pub(crate) fn learned(&mut self, curves: &[Learned]) {
        let curve = |curve: &Learned| model::Curve::of(curve.driver, &curve.points);
        self.page.learning.extend(curves.iter().map(curve));
    }

    /// Writes the page.
    pub(crate) fn write(mut self, path: &Path) -> Result<(), Failure> {
        self.keep_driven();
        self.hang();
        self.page.verdict = crate::verdict::sentence(&self.page.rows).unwrap_or_default();
        let data = serde_json::to_string(&self.page)
            .map_err(|error| Failure::input(error, "report this as a bug"))?;
        // `</` would end the script element.
        let data = data.replace("</", "<\\/");

        let html = PAGE
            .replace("{{title}}", &self.page.subtitle)
            .replace("{{style}}", STYLE)
            .replace("{{script}}", SCRIPT)
            .replace("{{data}}", &data);
        output::write(path, |out| out.write_all(html.as_bytes()))?;
        Ok(())
    }
}

impl Report {
    /// Leaves out cases that nobody drove.
    fn keep_driven(&mut self) {
        let (cases, chosen) = (&mut self.page.cases, &mut self.chosen);
        let driven: Vec<bool> = cases.iter().map(Case::was_driven).collect();
        chosen.retain(|_, place| driven[*place]);
        for place in chosen.values_mut() {
            *place = driven[..*place].iter().filter(|driven| **driven).count();
        }
        cases.retain(Case::was_driven);
    }

    /// Adds the gallery, with the cases that are shown for it alone.
    fn hang(&mut self) {
        let (cases, chosen) = (&mut self.page.cases, &mut self.chosen);
        self.page.gallery = std::mem::take(&mut self.gallery).exhibits(|id, case| {
            if let Some(&place) = chosen.get(id) {
                cases[place].merge(case);
                return place;
            }
            cases.push(case.found());
            chosen.insert(id.clone(), cases.len() - 1);
            cases.len() - 1
        });
    }
}

fn subtitle(dataset: &Dataset) -> String {
    let count = |split| dataset.split(split).count();
    format!(
        "Site {}: {} in {} ({} train, {} validation, {} test)",
        dataset.site.name,
        Count(dataset.encounters.len(), "encounter"),
        Count(dataset.recordings.len(), "recording"),
        count(Split::Train),
        count(Split::Validation),
        count(Split::Test),
    )
}
