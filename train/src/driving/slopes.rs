//! Derivatives of the controller's features: what carries a gradient through the closed loop.
//!
//! The features are the controller's own, computed on [`Dual`] numbers. Here is how what they are
//! made of answers to the four numbers that an action moves. What depends on the route alone is constant.

use crate::driving::dual::{Dual, VARIABLES};
use cede_controller::policy::features::MAX_FEATURES;
use cede_controller::{Crosser, FeatureSet, Leader, Pair, Point, Pose, Real, VehicleState};

/// Derivatives of one feature with respect to the ego's distance (m) and speed (m/s), then the other's.
pub type Slope = [f32; VARIABLES];

/// The derivatives of `set`'s features at `pair`, in the features' order; the places after the last are zero.
#[must_use]
pub fn slopes(set: FeatureSet, pair: &Pair) -> [Slope; MAX_FEATURES] {
    let pair = Pair {
        ego: moving(&pair.ego, 0),
        other: moving(&pair.other, 2),
        kind: pair.kind,
        right_of_way: pair.right_of_way,
        part: pair.part,
        last_svo: Dual::of(pair.last_svo),
    };
    set.of(&pair).map(|feature| feature.slopes)
}

/// A vehicle whose distance is variable `distance` and whose speed is the next one.
fn moving(vehicle: &VehicleState, distance: usize) -> VehicleState<Dual> {
    let along = |value: f32, slope: f32| Dual::variable(value, distance, slope);
    let Pose {
        position,
        direction,
    } = vehicle.pose;
    VehicleState {
        // Going forward shortens the distance; the heading is constant along a polyline's side.
        pose: Pose {
            position: Point::new(
                along(position.x, -direction.x),
                along(position.y, -direction.y),
            ),
            direction,
        },
        exit: vehicle.exit,
        speed: Dual::variable(vehicle.speed, distance + 1, 1.0),
        distance: along(vehicle.distance, 1.0),
        footprint: vehicle.footprint,
        leader: vehicle.leader.map(|leader| Leader {
            gap: along(leader.gap, 1.0),
            speed: Dual::of(leader.speed),
        }),
        crosser: vehicle.crosser.map(|crosser| Crosser {
            distance: along(crosser.distance, 1.0),
            its_distance: Dual::of(crosser.its_distance),
            its_speed: Dual::of(crosser.its_speed),
        }),
        control: vehicle.control,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cede_controller::geometry::{UnitVector, unit};
    use cede_controller::{ConflictKind, Control, Footprint, Part, Point, Pose, RightOfWay};

    fn pair([d, v, other_d, other_v]: [f32; 4], surrounded: bool) -> Pair {
        let vehicle_state = |direction: UnitVector, distance: f32, speed: f32| VehicleState {
            pose: Pose {
                position: Point::from(direction.into_inner() * -distance),
                direction,
            },
            exit: unit(0.6, 0.8),
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
            control: Control::Stop,
        };
        Pair {
            ego: vehicle_state(unit(0.8, 0.6), d, v),
            other: vehicle_state(unit(-1.0, 0.0), other_d, other_v),
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
