//! Junctions of every shape.

use crate::place::{Place, Right, Shape};
use cede_controller::Contract;
use proptest::prelude::*;

/// Any [`Shape`]; the right angle is the simplest.
fn shape() -> impl Strategy<Value = Shape> {
    prop_oneof![
        3 => Just(Shape::RightAngle),
        2 => (20_u8..=160).prop_map(Shape::Skew),
        2 => Just(Shape::Following),
        2 => (10_u8..=60).prop_map(Shape::Merging),
        2 => Just(Shape::LeftTurn),
        2 => Just(Shape::RightTurn),
        1 => Just(Shape::SBend),
    ]
}

/// A junction with arms of `arm` metres, 40 to 230.
pub fn place(arm: u16) -> impl Strategy<Value = Place> {
    let right = prop_oneof![Just(Right::Nobody), Just(Right::Ego), Just(Right::Others)];
    let tolerance = prop_oneof![Just(0_u8), Just(10), 0_u8..=30];
    (shape(), tolerance, right).prop_map(move |(shape, tolerance, right)| Place {
        shape,
        arm: arm.clamp(40, 230),
        tolerance,
        right,
    })
}

/// Metres of road before the middle with which a vehicle at the contract's speed can still stop, 80 to 230.
#[must_use]
pub fn arm(contract: &Contract) -> u16 {
    let (ego, period) = (contract.ego(), contract.period());
    let stop = ego.max_speed * ego.max_speed / (2.0 * ego.braking);
    // Saturates.
    let arm = (stop + 3.0 * period * ego.max_speed + 30.0) as u16;
    arm.clamp(80, 230)
}
