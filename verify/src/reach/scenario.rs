//! Scenarios as a readable file.

use cede_controller::{
    Class, ConflictKind, Control, Footprint, Junction, PathId, Point, RightOfWay, Route,
};
use cede_formats::property::{Right, Setting};
use serde::Deserialize;

/// A file of scenarios (TOML, `[[scenario]]`).
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenarios {
    /// The scenarios.
    pub scenario: Vec<Scenario>,
}

/// Where an encounter begins, what the other may do, and what is claimed of the ego.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Identifier, SR-nn as in `docs/safety/`.
    pub id: String,
    /// What it says, in a sentence.
    pub title: String,
    /// Ego's metres to its conflict point at the start, least and most.
    pub ego_distance: [f64; 2],
    /// Ego's speed in m/s.
    pub ego_speed: [f64; 2],
    /// Other's metres to its conflict point.
    pub other_distance: [f64; 2],
    /// Other's speed in m/s.
    pub other_speed: [f64; 2],
    /// Least and most acceleration of the other in m/s², which may change at every step.
    pub other_acceleration: [f64; 2],
    /// Who may go first.
    pub right_of_way: Right,
    /// What obliges the ego and the other to give way.
    #[serde(default)]
    pub controls: [Control; 2],
    /// Whether the policy is asked, or may propose whatever it likes.
    #[serde(default = "yes")]
    pub policy: bool,
    /// Whether the shield is on.
    #[serde(default = "yes")]
    pub shield: bool,
    /// What is claimed of every trajectory.
    pub claim: Claim,
}

fn yes() -> bool {
    true
}

/// What is claimed of every trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Claim {
    /// The ego reaches its conflict point.
    Arrives {
        /// At the latest after so many seconds.
        within: f64,
        /// Never slower on the way than this (m/s).
        at_least: f64,
    },
    /// The ego and the other are never in the conflict zone together, for so many seconds.
    NeverBoth {
        /// How long.
        during: f64,
    },
}

/// A file of scenarios that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScenarioError {
    /// Not TOML, or not of this form.
    #[error("{0}")]
    Form(String),
    /// A number is out of its range.
    #[error("{id}: {what}")]
    Range {
        /// The scenario.
        id: String,
        /// What is wrong.
        what: &'static str,
    },
}

/// Longest scenario in seconds.
const LONGEST: f64 = 60.0;

impl Scenarios {
    /// Reads a file.
    ///
    /// # Errors
    /// With the place in the text, or the scenario whose numbers cannot be.
    pub fn read(text: &str) -> Result<Self, ScenarioError> {
        let scenarios: Self =
            toml::from_str(text).map_err(|e| ScenarioError::Form(e.to_string()))?;
        for scenario in &scenarios.scenario {
            scenario.check().map_err(|what| ScenarioError::Range {
                id: scenario.id.clone(),
                what,
            })?;
        }
        Ok(scenarios)
    }
}

impl Scenario {
    fn check(&self) -> Result<(), &'static str> {
        let within = |[lo, hi]: [f64; 2], least: f64, most: f64| {
            lo.is_finite() && hi.is_finite() && least <= lo && lo <= hi && hi <= most
        };
        if !self.region()[..]
            .iter()
            .step_by(2)
            .all(|&d| within(d, -100.0, 200.0))
        {
            return Err("a distance is empty or beyond -100 to 200 m; give [least, most]");
        }
        if ![self.ego_speed, self.other_speed]
            .iter()
            .all(|&v| within(v, 0.0, 15.0))
        {
            return Err("a speed is empty or beyond 0 to 15 m/s; give [least, most]");
        }
        if !within(self.other_acceleration, -8.0, 3.0) {
            return Err("the other's acceleration is beyond the contract's -8 to 3 m/s²");
        }
        let (Claim::Arrives { within: time, .. } | Claim::NeverBoth { during: time }) = self.claim;
        if !(0.0..=LONGEST).contains(&time) {
            return Err("it lasts longer than 60 s");
        }
        if let Claim::Arrives { at_least, .. } = self.claim
            && !(0.0..=15.0).contains(&at_least)
        {
            return Err("the least speed is beyond 0 to 15 m/s");
        }
        Ok(())
    }

    /// Least and most of the ego's distance and speed, then of the other's.
    #[must_use]
    pub fn region(&self) -> [[f64; 2]; 4] {
        [
            self.ego_distance,
            self.ego_speed,
            self.other_distance,
            self.other_speed,
        ]
    }

    /// What does not vary.
    #[must_use]
    pub fn setting(&self) -> Setting {
        Setting {
            kind: ConflictKind::Crossing,
            right_of_way: match self.right_of_way {
                Right::Ego => RightOfWay::Ego,
                Right::Other => RightOfWay::Other,
                Right::Unsettled => RightOfWay::Unsettled,
            },
            turns: [0.0; 2],
            controls: self.controls,
        }
    }
}

/// The junction of [`geometry`].
pub type Crossing = Junction<2, 4>;

/// The ego's path through it.
pub const EGO: PathId = PathId::new(0);
/// The other's path.
pub const OTHER: PathId = PathId::new(1);

/// Half the length (m) of a route of the crossing.
pub(super) const HALF: f32 = 255.0;

/// The crossing: the ego goes east, the other north; both conflict points are 250 m from the routes' starts, which
/// are followed exactly. Past the routes' ends nothing is left to show.
///
/// # Panics
/// Never: the routes are constants that fit.
#[must_use]
pub fn geometry(setting: &Setting) -> Crossing {
    let Some(junction) = crossing(setting) else {
        unreachable!("two straight routes that cross")
    };
    junction
}

fn crossing(setting: &Setting) -> Option<Crossing> {
    let east = Route::<2>::new([Point::new(-HALF, 0.0), Point::new(HALF, 0.0)]).ok()?;
    let north = Route::<2>::new([Point::new(0.0, -HALF), Point::new(0.0, HALF)]).ok()?;
    let mut builder = Crossing::builder();
    builder.tolerance(0.0);
    for (route, control) in [&east, &north].into_iter().zip(setting.controls) {
        let path = builder.path(route, Class::Car, Footprint::PAPER).ok()?;
        builder.control(path, control).ok()?;
    }
    match setting.right_of_way {
        RightOfWay::Ego => builder.right_of_way(EGO, OTHER).ok()?,
        RightOfWay::Other => builder.right_of_way(OTHER, EGO).ok()?,
        RightOfWay::Unsettled => {}
    }
    builder.build().ok()
}
