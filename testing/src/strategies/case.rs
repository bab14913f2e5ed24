//! Whole cases.

use super::{arm, place, script};
use crate::case::{Case, Level, Noise, Other, Proposals};
use crate::place::{Road, Shape};
use cede_controller::Contract;
use proptest::prelude::*;

/// A case whose speeds are within `contract`, with one to three others.
///
/// Some of them do not start within the contract: vehicles overlap, or no plan is safe at the start.
pub fn case(contract: &Contract) -> impl Strategy<Value = Case> + use<> {
    of(contract, 3)
}

/// The same with one other.
pub(crate) fn case_of_two(contract: &Contract) -> impl Strategy<Value = Case> + use<> {
    of(contract, 1)
}

fn of(contract: &Contract, most: usize) -> impl Strategy<Value = Case> + use<> {
    let arm = arm(contract);
    let ego = contract.ego();
    let stop = ego.max_speed * ego.max_speed / (2.0 * ego.braking);
    let before = decimetres(stop + 20.0).min(arm * 10 - 150);
    let speeds = [ego.max_speed, contract.other().max_speed].map(decimetres);
    let others = prop::collection::vec(other(arm, speeds[1]), 1..=most);
    (
        place(arm),
        (rounded(before), rounded(speeds[0])),
        others,
        proposals(),
        noise(),
    )
        .prop_map(|(place, (before, speed), mut others, proposals, noise)| {
            let merges = matches!(place.shape, Shape::Merging(_) | Shape::RightTurn);
            for other in &mut others {
                // Lorries and bicycles of a merging road drive in the ego's lane as well: that is wanted.
                if other.road == Road::Away && merges {
                    other.road = Road::First;
                }
            }
            Case {
                place,
                before,
                speed,
                others,
                proposals,
                noise,
            }
        })
}

fn other(arm: u16, most: u16) -> impl Strategy<Value = Other> {
    let road = prop_oneof![
        6 => Just(Road::First),
        2 => Just(Road::Second),
        1 => Just(Road::FirstLorry),
        1 => Just(Road::SecondBicycle),
        2 => Just(Road::Own),
    ];
    let far = i16::try_from(arm * 10).unwrap_or(i16::MAX) - 100;
    let before = prop_oneof![
        4 => (0_i16..=far / 50).prop_map(|steps| steps * 50),
        4 => 0_i16..=far.min(400),
        1 => -100_i16..=far,
    ];
    (road, before, rounded(most), script()).prop_map(|(road, before, speed, script)| Other {
        road,
        before,
        speed,
        script,
    })
}

/// Up to `most` tenths; whole numbers are simpler.
fn rounded(most: u16) -> impl Strategy<Value = u16> {
    prop_oneof![
        1 => (0..=most / 10).prop_map(|whole| whole * 10),
        1 => 0..=most,
    ]
}

fn decimetres(metres: f32) -> u16 {
    // Saturates.
    (metres * 10.0) as u16
}

fn proposals() -> impl Strategy<Value = Proposals> {
    prop_oneof![
        2 => Just(Proposals::Reckless),
        2 => Just(Proposals::Policy),
        1 => script().prop_map(Proposals::Script),
    ]
}

/// Errors of sensors, delays and gaps; none is the simplest.
pub fn noise() -> impl Strategy<Value = Noise> {
    let level = || {
        prop_oneof![
            3 => Just(Level::None),
            2 => Just(Level::All),
            1 => Just(Level::Some),
            1 => Just(Level::Corners),
        ]
    };
    let missing = prop_oneof![3 => Just(0_u8), 1 => 0_u8..32];
    let levels = (level(), level(), level(), level());
    (any::<u16>(), levels, missing).prop_map(|(seed, (errors, delay, jitter, beside), missing)| {
        Noise {
            seed,
            errors,
            delay,
            jitter,
            beside,
            missing,
        }
    })
}
