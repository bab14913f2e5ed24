//! Derivatives of the controller's features: what carries a gradient through the closed loop.
//!
//! `cede_controller` computes the features themselves; here is how each answers
//! to the four numbers that an action moves. Where a feature is limited, its
//! derivative is zero, as is that of everything that depends on the route alone.

use cede_controller::policy::features::{CREEP, HORIZON, MAX_FEATURES};
use cede_controller::policy::svo::MIN_DISTANCE;
use cede_controller::{Crosser, Leader, VehicleState};
use cede_controller::{FeatureSet, Pair};

/// Derivatives of one feature with respect to the ego's distance (m) and speed (m/s), then the other's.
pub type Slope = [f32; 4];

/// Below this, (v·d̂)² + (v̂·d)² in m⁴/s² makes the SVO so steep that it would drown every other gradient.
const STEEPEST_SVO: f32 = 1.0;

/// Braking of the stopping distance in the `Route` features (m/s²).
const BRAKING: f32 = 3.0;

/// The derivatives of `set`'s features at `pair`, in the features' order; the places after the last are zero.
#[must_use]
pub fn slopes(set: FeatureSet, pair: &Pair) -> [Slope; MAX_FEATURES] {
    let mut slopes = [[0.0; 4]; MAX_FEATURES];
    match set {
        FeatureSet::Raw => raw(pair, &mut slopes),
        FeatureSet::Route => route(pair, &mut slopes),
        FeatureSet::Traffic => {
            route(pair, &mut slopes);
            leader(&pair.ego, 14, 0, &mut slopes);
            leader(&pair.other, 16, 2, &mut slopes);
        }
        FeatureSet::Scene => {
            route(pair, &mut slopes);
            leader(&pair.ego, 14, 0, &mut slopes);
            crosser(&pair.ego, 16, &mut slopes);
        }
    }
    slopes
}

fn raw(pair: &Pair, slopes: &mut [Slope; MAX_FEATURES]) {
    for (i, vehicle_state) in [&pair.ego, &pair.other].into_iter().enumerate() {
        // Going forward shortens the distance; the heading is constant along a polyline's side.
        slopes[4 * i][2 * i] = -vehicle_state.pose.direction.x;
        slopes[4 * i + 1][2 * i] = -vehicle_state.pose.direction.y;
        slopes[4 * i + 2][2 * i + 1] = 1.0;
    }
}

fn route(pair: &Pair, slopes: &mut [Slope; MAX_FEATURES]) {
    for (i, vehicle_state) in [&pair.ego, &pair.other].into_iter().enumerate() {
        let (distance, speed) = (2 * i, 2 * i + 1);
        slopes[2 * i][distance] = 1.0;
        slopes[2 * i + 1][speed] = 1.0;
        let [by_distance, by_speed] = arrival(vehicle_state);
        slopes[4 + i][distance] = by_distance;
        slopes[4 + i][speed] = by_speed;
        slopes[7 + i][distance] = 1.0;
        slopes[7 + i][speed] = -vehicle_state.speed / BRAKING;
    }
    slopes[6] = svo(pair);
}

fn arrival(vehicle_state: &VehicleState) -> [f32; 2] {
    let speed = vehicle_state.speed.max(CREEP);
    if (vehicle_state.distance / speed).abs() > HORIZON {
        return [0.0; 2];
    }
    let by_speed = if vehicle_state.speed > CREEP {
        -vehicle_state.distance / (speed * speed)
    } else {
        0.0
    };
    [1.0 / speed, by_speed]
}

/// φ = atan2(v̂·d, v·d̂) with floored distances.
fn svo(pair: &Pair) -> Slope {
    let (a, b) = (&pair.ego, &pair.other);
    let (d, other_d) = (a.distance.max(MIN_DISTANCE), b.distance.max(MIN_DISTANCE));
    let (y, x) = (b.speed * d, a.speed * other_d);
    let scale = 1.0 / (x * x + y * y).max(STEEPEST_SVO);
    let floored = |vehicle_state: &VehicleState, slope: f32| {
        if vehicle_state.distance > MIN_DISTANCE {
            slope
        } else {
            0.0
        }
    };
    [
        floored(a, scale * x * b.speed),
        -scale * y * other_d,
        floored(b, -scale * y * a.speed),
        scale * x * d,
    ]
}

/// Gap and speed of `vehicle_state`'s leader at feature `place`; `vehicle_state`'s own distance is variable `by`.
fn leader(
    vehicle_state: &VehicleState,
    place: usize,
    by: usize,
    slopes: &mut [Slope; MAX_FEATURES],
) {
    match vehicle_state.leader {
        Some(Leader { gap, .. }) if gap.abs() <= HORIZON => slopes[place][by] = 1.0,
        Some(_) => {}
        // A leader that is not there is as fast as its follower.
        None => slopes[place + 1][by + 1] = 1.0,
    }
}

fn crosser(vehicle_state: &VehicleState, place: usize, slopes: &mut [Slope; MAX_FEATURES]) {
    if let Some(Crosser { distance, .. }) = vehicle_state.crosser
        && distance.abs() <= HORIZON
    {
        slopes[place][0] = 1.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cede_controller::{ConflictKind, Footprint, Point, Pose};
    use cede_controller::{Part, RightOfWay};

    fn pair([d, v, other_d, other_v]: [f32; 4], surrounded: bool) -> Pair {
        let vehicle_state = |direction: Point, distance: f32, speed: f32| VehicleState {
            pose: Pose {
                position: direction * -distance,
                direction,
            },
            exit: Point::new(0.6, 0.8),
            speed,
            distance,
            footprint: Footprint::PAPER,
            leader: surrounded.then_some(Leader {
                gap: distance - 4.0,
                speed: 3.0,
            }),
            crosser: surrounded.then_some(Crosser {
                distance: distance - 2.0,
                its_distance: 12.0,
                its_speed: 5.0,
            }),
        };
        Pair {
            ego: vehicle_state(Point::new(0.8, 0.6), d, v),
            other: vehicle_state(Point::new(-1.0, 0.0), other_d, other_v),
            kind: ConflictKind::Crossing,
            right_of_way: RightOfWay::Unsettled,
            part: Part::Left,
            last_svo: 0.5,
        }
    }

    #[test]
    fn slopes_agree_with_finite_differences_of_the_controllers_features() {
        let places = [
            [12.0, 6.0, 20.0, 8.0],
            [3.0, 0.2, 9.0, 4.0],
            [-2.0, 5.0, 1.5, 0.9],
            [60.0, 1.0, 25.0, 0.3],
        ];
        for place in places {
            for surrounded in [false, true] {
                for set in FeatureSet::ALL {
                    let slopes = slopes(set, &pair(place, surrounded));
                    for variable in 0..4 {
                        let at = |h: f32| {
                            let mut moved = place;
                            moved[variable] += h;
                            set.of(&pair(moved, surrounded))
                        };
                        let h = 0.01;
                        let (up, down) = (at(h), at(-h));
                        for f in 0..set.count() {
                            let expected = (up[f] - down[f]) / (2.0 * h);
                            let got = slopes[f][variable];
                            let error = (got - expected).abs();
                            assert!(
                                error < 5e-3 * (1.0 + expected.abs()),
                                "{set:?} {place:?}: feature {f} by {variable}: {got} against {expected}"
                            );
                        }
                    }
                }
            }
        }
    }
}
