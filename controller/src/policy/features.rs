//! What the network is told about a [`Pair`], and how it is scaled.

use crate::junction::Control;
use crate::junction::conflict::RightOfWay;
use crate::junction::kind::ConflictKind;
use crate::policy::pair::{Crosser, Leader, Pair, VehicleState};
use crate::real::{Elementary, atan2};

/// Most features that a set has.
pub const MAX_FEATURES: usize = 22;

/// A normalised feature is limited to ± this, so that no input whatsoever overflows the network.
pub const LIMIT: f32 = 8.0;

/// Arrival times (s) and gaps (m) are counted up to here: beyond it nothing depends on them.
pub const HORIZON: f32 = 30.0;

/// Speed (m/s) below which an arrival time is that of a vehicle at this speed.
pub const CREEP: f32 = 0.5;

/// Braking (m/s²) of the stopping distance in the `Route` features: the paper's limit.
const BRAKING: f32 = 3.0;

const RAW_LABELS: [&str; 8] = [
    "ego_x",
    "ego_y",
    "ego_speed",
    "ego_heading",
    "other_x",
    "other_y",
    "other_speed",
    "other_heading",
];

const ROUTE_LABELS: [&str; 14] = [
    "ego_distance",
    "ego_speed",
    "other_distance",
    "other_speed",
    "ego_arrival",
    "other_arrival",
    "ego_svo",
    "ego_spare",
    "other_spare",
    "crossing",
    "merging",
    "right_of_way",
    "ego_turn",
    "other_turn",
];

const TRAFFIC_LABELS: [&str; 4] = [
    "ego_leader_gap",
    "ego_leader_speed",
    "other_leader_gap",
    "other_leader_speed",
];

const SCENE_LABELS: [&str; 5] = [
    "ego_leader_gap",
    "ego_leader_speed",
    "crosser_distance",
    "crosser_its_distance",
    "crosser_its_speed",
];

const RIGHTS_LABELS: [&str; 8] = [
    "ego_leader_gap",
    "ego_leader_speed",
    "crosser_distance",
    "crosser_its_distance",
    "crosser_its_speed",
    "all_way_stop",
    "ego_gives_way",
    "other_gives_way",
];

/// Which features a network is told; the order of the values is part of the weights file's format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum FeatureSet {
    /// The paper's eight: x, y (m, map frame), speed (m/s) and heading (rad) of the ego, then of the other.
    Raw,
    /// Fourteen that do not depend on the site's frame:
    /// 0, 1: the ego's distance to the conflict point (m), speed (m/s);
    /// 2, 3: the other's;
    /// 4, 5: arrival times of both at their present speeds (s, within ± [`HORIZON`]);
    /// 6: the ego's SVO (rad);
    /// 7, 8: metres to spare between each one's stopping distance and the conflict point;
    /// 9, 10: 1 if the routes cross, 1 if they merge, else 0;
    /// 11: right of way: 1 the ego's, −1 the other's, 0 unsettled;
    /// 12, 13: sine of the turn still to come of each, positive to the left.
    Route,
    /// `Route`, then gap (m, at most [`HORIZON`]) and speed (m/s) of the ego's leader and of the
    /// other's; a leader that is not there is far ahead and as fast as its follower.
    Traffic,
    /// `Route`, then what the ego alone knows of its traffic: gap and speed of its leader as in
    /// `Traffic`; its distance (m) to where a third vehicle's route meets its own, that vehicle's
    /// distance (m) and speed (m/s), distances within ± [`HORIZON`]; a third vehicle that is not there
    /// is far away and at rest.
    Scene,
    /// `Scene`, then what the signs say: 1 at an all-way stop, else 0; and for the ego and for the other 1 if it
    /// has to stop, 0.5 if it gives way without a stop, 0 if it is free or nothing is known.
    Rights,
}

impl FeatureSet {
    /// Every set, in the order of their codes in the weights file.
    pub const ALL: [Self; 5] = [
        Self::Raw,
        Self::Route,
        Self::Traffic,
        Self::Scene,
        Self::Rights,
    ];

    /// Number of features, at most [`MAX_FEATURES`].
    #[must_use]
    pub const fn count(self) -> usize {
        match self {
            Self::Raw => 8,
            Self::Route => 14,
            Self::Traffic => 18,
            Self::Scene => 19,
            Self::Rights => 22,
        }
    }

    /// Name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Raw => "raw",
            Self::Route => "route",
            Self::Traffic => "traffic",
            Self::Scene => "scene",
            Self::Rights => "rights",
        }
    }

    /// What the features are called in files that other programs read, in their order.
    pub fn labels(self) -> impl Iterator<Item = &'static str> {
        let (first, rest): (&[&str], &[&str]) = match self {
            Self::Raw => (&RAW_LABELS, &[]),
            Self::Route => (&ROUTE_LABELS, &[]),
            Self::Traffic => (&ROUTE_LABELS, &TRAFFIC_LABELS),
            Self::Scene => (&ROUTE_LABELS, &SCENE_LABELS),
            Self::Rights => (&ROUTE_LABELS, &RIGHTS_LABELS),
        };
        first.iter().chain(rest).copied()
    }

    /// The features of `pair`, in their own units; the places after [`FeatureSet::count`] are zero.
    ///
    /// Cost: constant, with at most two `atan2`. Finite for finite input.
    #[must_use]
    #[inline]
    pub fn of<R: Elementary>(self, pair: &Pair<R>) -> [R; MAX_FEATURES] {
        let mut features = [R::of(0.0); MAX_FEATURES];
        let (ego, other) = (&pair.ego, &pair.other);
        match self {
            Self::Raw => fill(&mut features, raw(pair)),
            Self::Route => fill(&mut features, route(pair)),
            Self::Traffic => fill(
                &mut features,
                route(pair)
                    .into_iter()
                    .chain(leader(ego))
                    .chain(leader(other)),
            ),
            Self::Scene => fill(
                &mut features,
                route(pair)
                    .into_iter()
                    .chain(leader(ego))
                    .chain(crosser(ego)),
            ),
            Self::Rights => fill(
                &mut features,
                route(pair)
                    .into_iter()
                    .chain(leader(ego))
                    .chain(crosser(ego))
                    .chain(signs(pair)),
            ),
        }
        features
    }
}

/// A feature as the network is told it: (feature − centre) · scale, within ± [`LIMIT`].
#[must_use]
#[inline]
pub fn normalised<R: Elementary>(feature: R, centre: R, scale: R) -> R {
    ((feature - centre) * scale).within(LIMIT)
}

fn fill<R>(features: &mut [R; MAX_FEATURES], values: impl IntoIterator<Item = R>) {
    for (place, value) in features.iter_mut().zip(values) {
        *place = value;
    }
}

fn raw<R: Elementary>(pair: &Pair<R>) -> [R; 8] {
    let heading = |p: &VehicleState<R>| {
        let direction = p.pose.direction;
        R::of(atan2(direction.y, direction.x))
    };
    let (a, b) = (&pair.ego, &pair.other);
    let (at, bt) = (a.pose.position, b.pose.position);
    [
        at.x,
        at.y,
        a.speed,
        heading(a),
        bt.x,
        bt.y,
        b.speed,
        heading(b),
    ]
}

fn route<R: Elementary>(pair: &Pair<R>) -> [R; 14] {
    let flag = |kind| R::of(if pair.kind == kind { 1.0 } else { 0.0 });
    let turn = |p: &VehicleState<R>| R::of(p.pose.direction.perp(&p.exit));
    let (a, b) = (&pair.ego, &pair.other);
    [
        a.distance,
        a.speed,
        b.distance,
        b.speed,
        arrival(a),
        arrival(b),
        pair.svo(),
        spare(a),
        spare(b),
        flag(ConflictKind::Crossing),
        flag(ConflictKind::Merging),
        R::of(match pair.right_of_way {
            RightOfWay::Ego => 1.0,
            RightOfWay::Other => -1.0,
            RightOfWay::Unsettled => 0.0,
        }),
        turn(a),
        turn(b),
    ]
}

/// Seconds to the conflict point at the present speed.
pub(crate) fn arrival<R: Elementary>(vehicle: &VehicleState<R>) -> R {
    let speed = R::of(CREEP).max(vehicle.speed);
    (vehicle.distance / speed).within(HORIZON)
}

/// Metres between where the vehicle can stop and the conflict point; negative if it cannot stop before it.
fn spare<R: Elementary>(vehicle: &VehicleState<R>) -> R {
    vehicle.distance - (vehicle.speed * vehicle.speed).scaled(0.5, BRAKING)
}

fn leader<R: Elementary>(vehicle: &VehicleState<R>) -> [R; 2] {
    let Leader { gap, speed } = vehicle.leader.unwrap_or(Leader {
        gap: R::of(HORIZON),
        speed: vehicle.speed,
    });
    [gap.within(HORIZON), speed]
}

fn crosser<R: Elementary>(vehicle: &VehicleState<R>) -> [R; 3] {
    let Crosser {
        distance,
        its_distance,
        its_speed,
    } = vehicle.crosser.unwrap_or(Crosser {
        distance: R::of(HORIZON),
        its_distance: R::of(HORIZON),
        its_speed: R::of(0.0),
    });
    [
        distance.within(HORIZON),
        its_distance.within(HORIZON),
        its_speed,
    ]
}

fn signs<R: Elementary>(pair: &Pair<R>) -> [R; 3] {
    let controls = [pair.ego.control, pair.other.control];
    let gives_way = controls.map(|control| {
        R::of(match control {
            Control::Unknown | Control::Free => 0.0,
            Control::Yield => 0.5,
            Control::Stop | Control::AllWayStop => 1.0,
        })
    });
    let all = controls
        .iter()
        .all(|&control| control == Control::AllWayStop);
    let [ego, other] = gives_way;
    [R::of(if all { 1.0 } else { 0.0 }), ego, other]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::policy::pair::testing::pair;

    #[test]
    fn every_set_fills_its_length() {
        for set in FeatureSet::ALL {
            let features = set.of(&pair());
            assert!(features[set.count()..].iter().all(|&f| f == 0.0));
            assert!(features.iter().all(|f| f.is_finite()));
            assert_eq!(set.labels().count(), set.count());
        }
    }

    #[test]
    fn route_features_have_their_documented_places() {
        let f = FeatureSet::Route.of(&pair());
        assert_eq!(f[..4], [12.0, 6.0, 20.0, 8.0]);
        assert_eq!(f[4..6], [2.0, 2.5]);
        assert_eq!(f[7..9], [12.0 - 6.0, 20.0 - 64.0 / 6.0]);
        assert_eq!(f[9..12], [1.0, 0.0, -1.0]);
        assert_eq!(f[12..14], [1.0, 0.0]);
    }

    #[test]
    fn signs_have_their_documented_places() {
        let signs = |ego, other| {
            let mut pair = pair();
            (pair.ego.control, pair.other.control) = (ego, other);
            let f = FeatureSet::Rights.of(&pair);
            [f[19], f[20], f[21]]
        };
        use Control::{AllWayStop, Free, Stop, Unknown, Yield};
        assert_eq!(signs(AllWayStop, AllWayStop), [1.0, 1.0, 1.0]);
        assert_eq!(signs(AllWayStop, Free), [0.0, 1.0, 0.0]);
        assert_eq!(signs(Yield, Stop), [0.0, 0.5, 1.0]);
        assert_eq!(signs(Unknown, Free), [0.0; 3]);
    }

    #[test]
    fn raw_features_are_the_papers() {
        let f = FeatureSet::Raw.of(&pair());
        assert_eq!(f[..4], [-12.0, 0.0, 6.0, 0.0]);
        assert_eq!(f[4..7], [20.0, 3.0, 8.0]);
        assert_eq!(f[7], core::f32::consts::PI);
    }

    #[test]
    fn a_missing_leader_is_far_and_as_fast() {
        let mut pair = pair();
        pair.ego.leader = Some(Leader {
            gap: 4.0,
            speed: 1.0,
        });
        let f = FeatureSet::Traffic.of(&pair);
        assert_eq!(f[14..18], [4.0, 1.0, HORIZON, 8.0]);
    }

    #[test]
    fn a_vehicle_at_rest_has_a_bounded_arrival_time() {
        let mut pair = pair();
        pair.ego.speed = 0.0;
        assert_eq!(FeatureSet::Route.of(&pair)[4], 24.0);
        pair.ego.distance = -200.0;
        assert_eq!(FeatureSet::Route.of(&pair)[4], -HORIZON);
    }
}
