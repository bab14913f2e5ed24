//! A contract whose numbers are names: what is proved with it holds for every contract.
//!
//! The margins read a contract's `f32` and turn each into [`Real::of`]. A NaN is no number that a contract
//! may have, so its payload is free to say which symbol it stands for.

use super::formula::Formula;
use super::term::{Symbol, Term};
use cede_controller::shield::contract::{Ego, Follower, Other};
use cede_controller::shield::{Contract, Real};

/// A quiet NaN; the low bits number the symbol.
const STAND_IN: u32 = 0x7fc0_0000;

const SYMBOLS: [Symbol; 14] = [
    named("period", "s"),
    named("latency", "s"),
    named("position_error", "m"),
    named("speed_error", "m/s"),
    named("slack", "m"),
    named("ego.max_speed", "m/s"),
    named("ego.acceleration", "m/s²"),
    named("ego.go", "m/s²"),
    named("ego.braking", "m/s²"),
    named("other.max_speed", "m/s"),
    named("other.acceleration", "m/s²"),
    named("other.braking", "m/s²"),
    named("follower.reaction", "s"),
    named("follower.braking", "m/s²"),
];

const fn named(name: &'static str, unit: &'static str) -> Symbol {
    Symbol { name, unit }
}

/// What `value` stands for, if it is a stand-in.
pub(super) fn symbol(value: f32) -> Option<Symbol> {
    let number = value.to_bits().checked_sub(STAND_IN)?;
    SYMBOLS.get(usize::try_from(number).ok()?).copied()
}

/// The contract of which nothing is known but what [`assumed`] says.
pub(super) fn any_contract() -> Contract {
    let [
        period,
        latency,
        position_error,
        speed_error,
        slack,
        max_speed,
        acceleration,
        go,
        braking,
        other_max_speed,
        other_acceleration,
        other_braking,
        reaction,
        follower_braking,
    ] = std::array::from_fn(|i| f32::from_bits(STAND_IN + i as u32));
    Contract {
        period,
        latency,
        position_error,
        speed_error,
        slack,
        ego: Ego {
            max_speed,
            acceleration,
            go,
            braking,
        },
        other: Other {
            max_speed: other_max_speed,
            acceleration: other_acceleration,
            braking: other_braking,
        },
        follower: Follower {
            reaction,
            braking: follower_braking,
        },
        precedence: None,
    }
}

/// What [`Contract::checked`] demands of the numbers, but for their upper limits, which no lemma needs.
pub(super) fn assumed() -> Vec<Formula> {
    let contract = any_contract();
    let Contract {
        ego,
        other,
        follower,
        ..
    } = contract;
    let (of, zero) = (Term::of, Term::of(0.0));
    let positive = [
        contract.period,
        ego.max_speed,
        ego.acceleration,
        ego.go,
        ego.braking,
        other.max_speed,
        other.acceleration,
        other.braking,
        follower.braking,
    ];
    let not_negative = [
        contract.latency,
        contract.position_error,
        contract.speed_error,
        contract.slack,
        follower.reaction,
    ];
    let positive = positive.map(|x| zero.less(of(x)));
    let not_negative = not_negative.map(|x| zero.at_most(of(x)));
    let ordered = [
        (contract.latency, contract.period),
        (ego.go, ego.acceleration),
        (ego.braking, other.braking),
        (follower.braking, other.braking),
    ];
    let ordered = ordered.map(|(less, more)| of(less).at_most(of(more)));
    positive
        .into_iter()
        .chain(not_negative)
        .chain(ordered)
        .collect()
}
