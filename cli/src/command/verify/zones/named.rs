//! Junctions by name.

use cede_data::{Dataset, Split};
use cede_sim::Meeting;
use cede_sim::campaign::{Scenario, Setup};
use cede_verify::zones::Site;
use cede_verify::zones::example::{bends, crossing, roads};

/// Some junctions.
pub(super) struct Named {
    pub(super) name: String,
    pub(super) sites: Vec<Site>,
}

/// What can be asked for.
pub(super) const NAMES: [&str; 6] = ["crossing", "four-arm", "tee", "bends", "demo", "campaign"];

/// How far (m) the points of the T may be off, as recorded ones are.
const JITTER: f32 = 0.02;

/// Junctions of random bends.
const BENDS: u64 = 8;

/// Scenarios of each set-up of the campaign.
const SCENARIOS: u64 = 4;

/// Encounters of the demo, and their seed: `cargo run` drives those of the test split.
const DEMO: (usize, u64) = (1000, 1);

impl Named {
    /// The junctions that go by `name`.
    pub(super) fn by_name(name: &str) -> Option<Self> {
        let sites = match name {
            "crossing" => crossing().into_iter().collect(),
            "four-arm" => roads(4, 0.0).into_iter().collect(),
            "tee" => roads(3, JITTER).into_iter().collect(),
            "bends" => (0..BENDS).filter_map(bends).collect(),
            "demo" => {
                let demo = Dataset::synthetic(DEMO.0, DEMO.1);
                demo.split(Split::Test).filter_map(meeting).collect()
            }
            "campaign" => campaign(),
            _ => return None,
        };
        let name = name.to_owned();
        Some(Self { name, sites })
    }

    /// The junction that somebody else gives.
    pub(super) fn one(name: impl std::fmt::Display, site: Site) -> Self {
        Self {
            name: name.to_string(),
            sites: vec![site],
        }
    }

    /// The junctions of recorded encounters.
    pub(super) fn recorded(dataset: &Dataset) -> Self {
        Self {
            name: dataset.site.name.clone(),
            sites: dataset.encounters.iter().filter_map(meeting).collect(),
        }
    }
}

fn meeting(encounter: &cede_data::Encounter) -> Option<Site> {
    Some(Site::of(&Meeting::new(encounter).ok()?.junction))
}

fn campaign() -> Vec<Site> {
    let scenarios = Setup::all().into_iter().flat_map(|(_, setup)| {
        (0..SCENARIOS).filter_map(move |seed| Scenario::of_seed(setup, seed))
    });
    scenarios
        .map(|scenario| Site::of(scenario.junction()))
        .collect()
}
