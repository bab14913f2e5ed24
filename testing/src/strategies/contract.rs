//! Contracts: valid ones of every size, and those that are refused.

use cede_controller::shield::ContractBuilder;
use cede_controller::{Contract, Precedence};
use proptest::prelude::*;

/// Contracts over the whole range of every number; the simplest is [`Contract::WORST_CASE`].
pub fn contract() -> impl Strategy<Value = Contract> {
    prop_oneof![
        1 => Just(Contract::WORST_CASE),
        1 => Just(Contract::ALL_WAY_STOP),
        8 => any_contract(),
    ]
}

/// A share in (0, 1].
fn share() -> impl Strategy<Value = f32> {
    prop_oneof![
        2 => (1_u8..=100).prop_map(|percent| f32::from(percent) / 100.0),
        1 => Just(1.0_f32),
    ]
}

/// A share that is often 0.
fn error() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0_f32), share().prop_map(|share| share * share)]
}

fn any_contract() -> impl Strategy<Value = Contract> {
    let time = (share(), error(), share());
    let sensing = (error(), error(), error());
    let other = (share(), share(), share());
    let ego = (share(), share(), share(), share());
    let follower = (error(), share());
    let rule = prop::option::of((share(), 0_u16..50, share(), 0_u16..200));
    (time, sensing, other, ego, follower, rule).prop_filter_map(
        "the numbers do not fit each other",
        |(time, sensing, other, ego, follower, rule)| {
            let period = time.0;
            let jitter = 0.33 * period * time.1;
            let (fast, launch, brakes) = (100.0 * other.0, 20.0 * other.1, 20.0 * other.2);
            let (braking, its) = (brakes * ego.0, brakes * follower.1);
            let acceleration = launch.min(braking.max(its)) * ego.1;
            let rule = rule.map(|(distance, tie, share, patience)| {
                let mut rule = Precedence::ALL_WAY_STOP;
                rule.distance = 200.0 * distance;
                rule.braking = braking * share;
                (rule.tie, rule.patience) = (tie, patience);
                rule
            });
            Contract::builder()
                .period(period)
                .jitter(jitter)
                .latency(0.999 * (period - 3.0 * jitter) * time.2)
                .position_error(10.0 * sensing.0)
                .speed_error(10.0 * sensing.1)
                .slack(0.01 + 9.0 * sensing.2)
                .other_max_speed(fast)
                .other_acceleration(launch)
                .other_braking(brakes)
                .ego_max_speed(fast * ego.2)
                .ego_braking(braking)
                .ego_acceleration(acceleration)
                .ego_go(acceleration * ego.3)
                .follower_reaction(10.0 * follower.0)
                .follower_braking(its)
                .precedence(rule)
                .build()
                .ok()
        },
    )
}

/// A contract with one number out of its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refused {
    /// Its numbers: `build` refuses them.
    pub builder: ContractBuilder,
    /// Path of the field that is wrong, as in `ego.braking`.
    pub field: &'static str,
    /// Its value.
    pub value: f32,
}

impl std::fmt::Display for Refused {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { field, value, .. } = self;
        write!(f, "the all-way stop's contract with {field} = {value}")
    }
}

/// The fields, and how each is set.
type Field = (
    &'static str,
    fn(ContractBuilder, f32) -> ContractBuilder,
    f32,
);

/// Every field of a contract with a value above which it is refused.
const FIELDS: [Field; 17] = [
    ("period", ContractBuilder::period, 1.0),
    ("jitter", ContractBuilder::jitter, 0.04),
    ("latency", ContractBuilder::latency, 1.0),
    ("position_error", ContractBuilder::position_error, 10.0),
    ("speed_error", ContractBuilder::speed_error, 10.0),
    ("slack", ContractBuilder::slack, 10.0),
    ("other.max_speed", ContractBuilder::other_max_speed, 100.0),
    (
        "other.acceleration",
        ContractBuilder::other_acceleration,
        20.0,
    ),
    ("other.braking", ContractBuilder::other_braking, 20.0),
    ("ego.max_speed", ContractBuilder::ego_max_speed, 15.0),
    ("ego.acceleration", ContractBuilder::ego_acceleration, 3.0),
    ("ego.go", ContractBuilder::ego_go, 3.0),
    ("ego.braking", ContractBuilder::ego_braking, 8.0),
    (
        "follower.reaction",
        ContractBuilder::follower_reaction,
        10.0,
    ),
    ("follower.braking", ContractBuilder::follower_braking, 8.0),
    (
        "precedence.distance",
        |b, x| stop(b, |rule| rule.distance = x),
        200.0,
    ),
    (
        "precedence.braking",
        |b, x| stop(b, |rule| rule.braking = x),
        20.0,
    ),
];

fn stop(builder: ContractBuilder, change: impl Fn(&mut Precedence)) -> ContractBuilder {
    let mut rule = Precedence::ALL_WAY_STOP;
    change(&mut rule);
    builder.precedence(Some(rule))
}

/// Each contract that is refused for one number: above its range, below it, or no number.
pub fn refused_contract() -> impl Strategy<Value = Refused> {
    let wrong = prop_oneof![Just(0_u8), Just(1), Just(2), Just(3), Just(4)];
    (
        prop::sample::select(FIELDS.to_vec()),
        wrong,
        0.001_f32..1000.0,
    )
        .prop_map(|((field, set, most), wrong, by)| {
            let value = match wrong {
                0 => most + by,
                1 => -by,
                2 => f32::NAN,
                3 => f32::INFINITY,
                _ => f32::NEG_INFINITY,
            };
            // A follower's braking that is no number is named as ego.acceleration, whose range depends on it.
            let odd = field == "follower.braking" && value.is_nan();
            let value = if odd { -by } else { value };
            let builder = set(Contract::ALL_WAY_STOP.to_builder(), value);
            Refused {
                builder,
                field,
                value,
            }
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]

        #[test]
        fn contracts_are_valid(contract in contract()) {
            prop_assert_eq!(contract.to_builder().build(), Ok(contract));
        }

        #[test]
        fn refused_contracts_are_refused_for_their_field(refused in refused_contract()) {
            let error = refused.builder.build().unwrap_err();
            prop_assert_eq!(error.field(), refused.field);
            prop_assert_eq!(error.value().to_bits(), refused.value.to_bits());
        }
    }
}
