//! Just outside of the contract: how often encounters end in an overlap, beside a plain rule that assumes less.

use crate::actuator::Weakness;
use crate::outcome::Outcome;
use crate::proposer::Proposer;
use crate::rng::Rng;
use crate::scenario::{Cast, Family, Manners, Terms};
use crate::setup::{Driver, Outside, Setup};
use crate::sight::Sensing;
use crate::world::play;
use cede_controller::dangerous::Sound;
use rayon::prelude::*;
use serde::Serialize;
use std::fmt::Write;

/// A way in which the world is not as the contract says.
#[derive(Clone, Copy, Debug)]
struct Deviation {
    name: &'static str,
    outside: Outside,
    sensing: Sensing,
    /// Sensors err as the contract of the row says.
    errors: [f32; 2],
}

const WITHIN: Deviation = Deviation {
    name: "within the contract",
    outside: Outside::NOT,
    sensing: Sensing::PLAIN,
    errors: [0.0; 2],
};

const fn others(name: &'static str, others: f64) -> Deviation {
    let outside = Outside {
        others,
        ..Outside::NOT
    };
    Deviation {
        name,
        outside,
        ..WITHIN
    }
}

const fn latency(name: &'static str, latency: f64) -> Deviation {
    let outside = Outside {
        latency,
        ..Outside::NOT
    };
    Deviation {
        name,
        outside,
        ..WITHIN
    }
}

const fn weak(name: &'static str, brakes: f64, lag: f64) -> Deviation {
    let outside = Outside {
        weakness: Weakness { brakes, lag },
        ..Outside::NOT
    };
    Deviation {
        name,
        outside,
        ..WITHIN
    }
}

const fn calls(name: &'static str, jitter: f64, missed: f64) -> Deviation {
    let outside = Outside {
        jitter,
        missed,
        ..Outside::NOT
    };
    Deviation {
        name,
        outside,
        ..WITHIN
    }
}

const fn sensors(name: &'static str, sensing: Sensing, errors: [f32; 2]) -> Deviation {
    Deviation {
        name,
        sensing,
        errors,
        ..WITHIN
    }
}

/// The rows of the table.
const DEVIATIONS: [Deviation; 14] = [
    WITHIN,
    others("others accelerate 1.5 ×", 1.5),
    others("others accelerate 2 ×", 2.0),
    latency("latency 2 ×", 2.0),
    latency("latency 3 ×", 3.0),
    weak("brakes −10 %", 0.9, 0.0),
    weak("brakes −20 %", 0.8, 0.0),
    weak("lag 0.1 s", 1.0, 0.1),
    weak("lag 0.3 s", 1.0, 0.3),
    sensors(
        "errors of sensors 2 ×",
        Sensing {
            scale: 2.0,
            ..Sensing::PLAIN
        },
        [0.3; 2],
    ),
    sensors(
        "1 % of tracks missing",
        Sensing {
            gaps: 0.01,
            ..Sensing::PLAIN
        },
        [0.0; 2],
    ),
    sensors(
        "observation frozen for 0.5 s",
        Sensing {
            frozen: 5,
            ..Sensing::PLAIN
        },
        [0.0; 2],
    ),
    calls("calls ± 30 % of a period", 0.3, 0.0),
    calls("5 % of calls missed", 0.0, 0.05),
];

/// What came of one row's encounters with one kind of others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Share {
    /// Encounters that began with a verified plan.
    pub encounters: u64,
    /// Those that ended in an overlap with the shield.
    pub shield: u64,
    /// Overlaps before which a breach, a fault or the lack of a plan had been reported.
    pub flagged: u64,
    /// Those that ended in an overlap with the plain rule.
    pub plain: u64,
}

impl Share {
    fn plus(self, other: Self) -> Self {
        Self {
            encounters: self.encounters + other.encounters,
            shield: self.shield + other.shield,
            flagged: self.flagged + other.flagged,
            plain: self.plain + other.plain,
        }
    }
}

/// A row of the table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Row {
    /// What is not as the contract says.
    pub outside: &'static str,
    /// With others that aim at the ego.
    pub hostile: Share,
    /// With others that do not look.
    pub gentle: Share,
}

/// The table, `encounters` for each row and kind of others.
#[must_use]
pub fn table(seed: u64, encounters: u64) -> Vec<Row> {
    let share = |deviation: &Deviation, manners| {
        let seeds = (seed..seed + encounters).into_par_iter();
        let shares = seeds.map(|seed| encounter(deviation, manners, seed));
        shares.reduce(Share::default, Share::plus)
    };
    let row = |deviation: &Deviation| Row {
        outside: deviation.name,
        hostile: share(deviation, Manners::Hostile),
        gentle: share(deviation, Manners::Gentle),
    };
    DEVIATIONS.iter().map(row).collect()
}

/// Layouts of the encounters: the sites of these families.
const LAYOUTS: [&str; 4] = ["crossroads", "star", "merge", "lane"];

/// One encounter, once with the shield and once with the plain rule.
fn encounter(deviation: &Deviation, manners: Manners, seed: u64) -> Share {
    let layout = LAYOUTS[seed as usize % LAYOUTS.len()];
    let site = Family::named(layout).and_then(|family| family.site(seed / 4 * 32));
    let Some(site) = site else {
        return Share::default();
    };
    let mut rng = Rng::new(seed ^ 0x0715_1DE0);
    let terms = Terms {
        errors: deviation.errors,
        ..Terms::WORST
    };
    let cast = Cast {
        manners,
        ..Cast::one(1 + rng.below(3))
    };
    let Some(contract) = terms.contract() else {
        return Share::default();
    };
    let numbers = crate::numbers::Numbers::of(&contract);
    let Some(cars) = cast.cars(&site, &numbers, &mut rng) else {
        return Share::default();
    };
    let shielded = Setup {
        site: &site,
        contract,
        cars,
        ticks: 3600,
        sensing: deviation.sensing,
        outside: deviation.outside,
        seed,
    };
    let with_shield = play::<Sound>(&shielded, false);
    if !with_shield.verified {
        return Share::default();
    }
    let with_rule = play::<Sound>(&plain(&shielded), false);
    let overlap = |outcome: &Outcome| u64::from(outcome.overlap.is_some());
    Share {
        encounters: 1,
        shield: overlap(&with_shield),
        flagged: u64::from(with_shield.overlap.is_some_and(|overlap| overlap.flagged)),
        plain: overlap(&with_rule),
    }
}

/// The same with the plain rule in place of the shield.
fn plain<'s>(setup: &Setup<'s>) -> Setup<'s> {
    let mut setup = setup.clone();
    for car in &mut setup.cars {
        if let Driver::Shielded { proposer, .. } = car.driver {
            let proposer = match proposer {
                Proposer::Nonsense => Proposer::Random,
                other => other,
            };
            car.driver = Driver::Plain { proposer };
        }
    }
    setup
}

/// As JSON.
///
/// # Panics
/// Never: there are only plain numbers and strings.
#[must_use]
pub fn json(table: &[Row]) -> String {
    serde_json::to_string_pretty(table).expect("plain numbers and strings")
}

/// As a table in Markdown.
#[must_use]
pub fn markdown(table: &[Row]) -> String {
    let mut text = String::from(
        "| | encounters | shield, hostile | flagged | shield, gentle | flagged | plain rule, hostile | plain rule, gentle |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for row in table {
        let Row {
            outside,
            hostile: h,
            gentle: g,
        } = row;
        let share = |part: u64, of: &Share| 100.0 * part as f64 / of.encounters.max(1) as f64;
        let (sh, sg) = (share(h.shield, h), share(g.shield, g));
        let (ph, pg) = (share(h.plain, h), share(g.plain, g));
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "| {outside} | {} | {sh:.1} % | {} of {} | {sg:.1} % | {} of {} | {ph:.1} % | {pg:.1} % |",
            h.encounters, h.flagged, h.shield, g.flagged, g.shield,
        );
    }
    text
}
