//! Properties of a policy as a readable file: what the verifier proves and training can aim at.

use cede_controller::geometry::unit;
use cede_controller::policy::svo;
use cede_controller::{
    ConflictKind, Control, Elementary, Footprint, Pair, Part, Point, Pose, RightOfWay, VehicleState,
};
use serde::{Deserialize, Serialize};

/// Ego's metres to its conflict point and speed in m/s, then the other's.
pub type Place = [f64; 4];

/// What does not vary within a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// How the routes conflict.
    pub kind: ConflictKind,
    /// Who may go first.
    pub right_of_way: RightOfWay,
    /// Sines of the turns still to come, the ego's and the other's; positive to the left.
    pub turns: [f32; 2],
    /// What obliges the ego and the other to give way where they enter the junction.
    pub controls: [Control; 2],
}

impl Setting {
    /// The pair of vehicles at a place (rounded to `f32`), nobody around them, as a left-turner sees it.
    #[must_use]
    pub fn pair(&self, place: Place) -> Pair {
        self.pair_of(place.map(|value| value as f32))
    }

    /// The same pair, its place in any number.
    #[must_use]
    pub fn pair_of<R: Elementary>(&self, [d, v, other_d, other_v]: [R; 4]) -> Pair<R> {
        let vehicle_state = |distance, speed, turn: f32, control| VehicleState {
            pose: Pose {
                position: Point::new(R::of(0.0), R::of(0.0)),
                direction: unit(1.0, 0.0),
            },
            // The feature is the sine of the angle from the direction to the exit.
            exit: unit((1.0 - turn * turn).max(0.0).sqrt(), turn),
            speed,
            distance,
            footprint: Footprint::PAPER,
            leader: None,
            crosser: None,
            control,
        };
        Pair {
            ego: vehicle_state(d, v, self.turns[0], self.controls[0]),
            other: vehicle_state(other_d, other_v, self.turns[1], self.controls[1]),
            kind: self.kind,
            right_of_way: self.right_of_way,
            part: Part::Left,
            last_svo: R::of(svo::FIRST),
        }
    }
}

/// A file of properties (TOML, `[[property]]`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Properties {
    /// The properties.
    pub property: Vec<StateProperty>,
}

/// A property: a region of states and what is claimed there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StateProperty {
    /// Identifier, SR-nn as in `docs/safety/`.
    pub id: String,
    /// What it says, in a sentence.
    pub title: String,
    /// Ego's metres to its conflict point, least and most.
    pub ego_distance: [f64; 2],
    /// Ego's speed in m/s.
    pub ego_speed: [f64; 2],
    /// Other's metres to its conflict point; negative once past it.
    pub other_distance: [f64; 2],
    /// Other's speed in m/s.
    pub other_speed: [f64; 2],
    /// Kinds of conflict.
    pub conflicts: Vec<Kind>,
    /// Who may go first.
    pub right_of_way: Vec<Right>,
    /// Sines of the turns still to come, ego's and other's.
    #[serde(default = "straight_on")]
    pub turns: Vec<[f32; 2]>,
    /// What obliges the ego and the other to give way.
    #[serde(default = "unknown")]
    pub controls: Vec<[Control; 2]>,
    /// What is claimed on all of it.
    pub claim: Claim,
}

fn straight_on() -> Vec<[f32; 2]> {
    vec![[0.0, 0.0]]
}

fn unknown() -> Vec<[Control; 2]> {
    vec![[Control::Unknown; 2]]
}

/// See [`ConflictKind`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Crossing.
    Crossing,
    /// Merging.
    Merging,
}

/// See [`RightOfWay`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Right {
    /// The ego's.
    Ego,
    /// The other's.
    Other,
    /// Not settled.
    Unsettled,
}

/// A variable of the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Variable {
    /// Ego's distance.
    EgoDistance,
    /// Ego's speed.
    EgoSpeed,
    /// Other's distance.
    OtherDistance,
    /// Other's speed.
    OtherSpeed,
}

impl Variable {
    /// Its place in the state.
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }
}

/// What is claimed of the acceleration a (m/s²) that the policy proposes for the ego.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Claim {
    /// a ≤ this.
    AccelerationAtMost(f64),
    /// a ≥ this.
    AccelerationAtLeast(f64),
    /// a rises by at least `slope` for each unit of the variable (m/s² per m or m/s).
    RisesAtLeast {
        /// Which variable.
        with: Variable,
        /// The least slope; 0 for a response that never falls.
        slope: f64,
    },
    /// a changes by at most `slope` for each unit of the variable.
    ChangesAtMost {
        /// Which variable.
        with: Variable,
        /// The largest slope.
        slope: f64,
    },
}

impl Claim {
    fn number(self) -> f64 {
        match self {
            Self::AccelerationAtMost(a) | Self::AccelerationAtLeast(a) => a,
            Self::RisesAtLeast { slope, .. } | Self::ChangesAtMost { slope, .. } => slope,
        }
    }
}

/// A file of properties that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PropertyError {
    /// Not TOML, or not of this form.
    #[error("{0}")]
    Form(String),
    /// A range is empty, not finite or a negative speed.
    #[error("{id}: {what}")]
    Range {
        /// The property.
        id: String,
        /// What is wrong.
        what: &'static str,
    },
}

impl Properties {
    /// Reads a file.
    ///
    /// # Errors
    /// With the place in the text, or the property whose range cannot be.
    pub fn read(text: &str) -> Result<Self, PropertyError> {
        let properties: Self =
            toml::from_str(text).map_err(|e| PropertyError::Form(e.to_string()))?;
        for property in &properties.property {
            let fault = |what| {
                Err(PropertyError::Range {
                    id: property.id.clone(),
                    what,
                })
            };
            if !property.region().iter().all(|[lo, hi]| {
                lo <= hi && lo.is_finite() && hi.is_finite() && lo.abs().max(hi.abs()) < 1e4
            }) {
                return fault("a range is empty or beyond ± 10 km; give [least, most]");
            }
            if property.ego_speed[0] < 0.0 || property.other_speed[0] < 0.0 {
                return fault("a speed is negative");
            }
            if property.conflicts.is_empty()
                || property.right_of_way.is_empty()
                || property.turns.is_empty()
                || property.controls.is_empty()
            {
                return fault(
                    "conflicts, right_of_way, turns and controls must each name something",
                );
            }
            if !property
                .turns
                .iter()
                .flatten()
                .all(|turn| turn.abs() <= 1.0)
            {
                return fault("a turn is a sine: give -1 to 1");
            }
            if !property.claim.number().is_finite() {
                return fault("a claim of what is not a number is no claim");
            }
        }
        Ok(properties)
    }
}

impl StateProperty {
    /// Least and most of each of a place's numbers.
    #[must_use]
    pub fn region(&self) -> [[f64; 2]; 4] {
        [
            self.ego_distance,
            self.ego_speed,
            self.other_distance,
            self.other_speed,
        ]
    }

    /// The same claim on a region whose widths are scaled about its centre.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let about = |[lo, hi]: [f64; 2], least: f64| {
            let (centre, half) = (0.5 * (lo + hi), 0.5 * factor * (hi - lo));
            [(centre - half).max(least), centre + half]
        };
        Self {
            ego_distance: about(self.ego_distance, f64::NEG_INFINITY),
            ego_speed: about(self.ego_speed, 0.0),
            other_distance: about(self.other_distance, f64::NEG_INFINITY),
            other_speed: about(self.other_speed, 0.0),
            ..self.clone()
        }
    }

    /// Every combination of what does not vary within the region.
    #[must_use]
    pub fn settings(&self) -> Vec<Setting> {
        let mut settings = Vec::new();
        for kind in &self.conflicts {
            for right in &self.right_of_way {
                for &turns in &self.turns {
                    settings.extend(self.controls.iter().map(|&controls| Setting {
                        kind: match kind {
                            Kind::Crossing => ConflictKind::Crossing,
                            Kind::Merging => ConflictKind::Merging,
                        },
                        right_of_way: match right {
                            Right::Ego => RightOfWay::Ego,
                            Right::Other => RightOfWay::Other,
                            Right::Unsettled => RightOfWay::Unsettled,
                        },
                        turns,
                        controls,
                    }));
                }
            }
        }
        settings
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_damaged_file_is_read_or_refused(at in 0_usize..4000, with in "[a-z0-9.=\\[\\]\"\n-]{0,4}") {
            let mut text = include_str!("../../docs/safety/policy.toml").to_owned();
            while !text.is_char_boundary(at.min(text.len())) {
                text.pop();
            }
            let at = at.min(text.len());
            text.insert_str(at, &with);
            if let Ok(properties) = Properties::read(&text) {
                prop_assert!(properties.property.iter().all(|p| p.claim.number().is_finite()));
            }
        }
    }

    #[test]
    fn property_files_are_read_or_refused_with_a_reason() {
        let text = r#"
            [[property]]
            id = "SR-20"
            title = "Yields"
            ego_distance = [5, 30]
            ego_speed = [0, 8]
            other_distance = [-2, 10]
            other_speed = [4, 10]
            conflicts = ["crossing", "merging"]
            right_of_way = ["other"]
            claim = { acceleration_at_most = -0.5 }
        "#;
        let read = Properties::read(text).expect("well formed");
        assert_eq!(read.property[0].settings().len(), 2);
        assert_eq!(read.property[0].claim, Claim::AccelerationAtMost(-0.5));
        let slope = text.replace(
            "{ acceleration_at_most = -0.5 }",
            r#"{ rises_at_least = { with = "other_distance", slope = 0 } }"#,
        );
        assert!(Properties::read(&slope).is_ok());
        for (from, to) in [
            ("[5, 30]", "[30, 5]"),
            ("[0, 8]", "[-1, 8]"),
            ("[\"other\"]", "[]"),
            ("acceleration", "velocity"),
            ("-0.5", "nan"),
            ("claim", "turns = [[0, nan]]\n claim"),
        ] {
            assert!(Properties::read(&text.replace(from, to)).is_err(), "{to}");
        }
    }
}
