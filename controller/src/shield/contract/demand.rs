//! What is demanded of each number of a contract.

use super::{Contract, FLIGHTS, Precedence};

/// The first number of a [`Contract`] that is out of its range. Prints as `ego.braking = 9 is outside (0, 8]`, with
/// a reason where the range depends on other numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContractError {
    field: &'static str,
    value: f32,
    range: Range,
    why: &'static str,
}

impl ContractError {
    /// Path of the field in [`Contract`], as in `ego.braking`.
    #[must_use]
    pub const fn field(&self) -> &'static str {
        self.field
    }

    /// The value that it has.
    #[must_use]
    pub const fn value(&self) -> f32 {
        self.value
    }

    /// The lower and the upper end of its range.
    #[must_use]
    pub const fn range(&self) -> [f32; 2] {
        [self.range.low, self.range.high]
    }

    /// Whether the lower end is outside the range; the upper end is always inside.
    #[must_use]
    pub const fn excludes_low(&self) -> bool {
        self.range.open
    }
}

impl core::fmt::Display for ContractError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Range { open, low, high } = self.range;
        let bracket = if open { '(' } else { '[' };
        let Self {
            field, value, why, ..
        } = self;
        write!(
            f,
            "{field} = {value} is outside {bracket}{low}, {high}]{why}"
        )
    }
}

impl core::error::Error for ContractError {}

/// From `low` to `high`, without `low` where it is `open`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Range {
    open: bool,
    low: f32,
    high: f32,
}

/// `(low, high]`.
const fn above(low: f32, high: f32) -> Range {
    let open = true;
    Range { open, low, high }
}

/// `[low, high]`.
const fn from(low: f32, high: f32) -> Range {
    let open = false;
    Range { open, low, high }
}

/// A number of a contract, its range, and what the range comes from where it depends on other numbers.
type Demand = (&'static str, f32, Range, &'static str);

/// The first number that is out of its range. NaN is in none.
pub(super) const fn first_fault(contract: &Contract) -> Option<ContractError> {
    if let Some(error) = first(&everywhere(contract)) {
        return Some(error);
    }
    let Some(rule) = contract.precedence else {
        return None;
    };
    match (first(&of_precedence(contract, rule)), rule.patience) {
        (Some(error), _) => Some(error),
        (None, 0) => None,
        (None, _) => match first(&of_turns(contract, rule)) {
            Some(error) => Some(error),
            None => match unseen(contract) {
                Some(error) => Some(error),
                None => creeps(contract),
            },
        },
    }
}

const fn first(demands: &[Demand]) -> Option<ContractError> {
    let mut rest = demands;
    while let [(field, value, range, why), others @ ..] = rest {
        let low = *value > range.low || (*value == range.low && !range.open);
        if !(low && *value <= range.high) {
            return Some(ContractError {
                field,
                value: *value,
                range: *range,
                why,
            });
        }
        rest = others;
    }
    None
}

const fn everywhere(contract: &Contract) -> [Demand; 19] {
    let (ego, other, follower) = (contract.ego, contract.other, contract.follower);
    let late = ": so many commands are in flight at most, each up to two jitters early or late";
    // Whoever enters a lane ahead of another may do so sooner, and then slower, than planned.
    let keeps = ": it accelerates no harder than other.acceleration, and no harder than it or its follower brakes";
    let fastest = ": it is no faster than the others, and goes as planned at 0.01 m/s at least, in spite of its limit";
    let commanded = ": it goes no harder than ego.acceleration, the hardest that is commanded";
    // The gap to a leader is smallest at the end only if the leader can brake harder.
    let leader = ": it brakes no harder than other.braking, the hardest braking of a vehicle ahead";
    let hardest = ": it brakes no harder than other.braking, the hardest of all the others";
    let (tolerance, reaction) = (from(0.0, 10.0), from(0.0, 10.0));
    let (speed, acceleration) = (above(0.0, 100.0), above(0.0, 20.0));
    let brakes = larger(strongest(contract, ego.braking), follower.braking);
    let launch = above(0.0, leads_to(contract, smaller(other.acceleration, brakes)));
    let go = from(needs(contract, 0.01), ego.acceleration);
    let hardest_braking = leads_to(contract, other.braking);
    let braking = Range {
        open: contract.is_exact(),
        low: if contract.is_exact() {
            0.0
        } else {
            needs(contract, 0.01)
        },
        high: hardest_braking,
    };
    let flights = FLIGHTS as f32 * contract.period;
    [
        ("period", contract.period, from(0.01, 1.0), ""),
        (
            "jitter",
            contract.jitter,
            from(0.0, 0.35 * contract.period),
            "",
        ),
        (
            "latency",
            contract.latency,
            from(0.0, flights - 6.0 * contract.jitter),
            late,
        ),
        ("ego.lag", ego.lag, from(0.0, 1.0), ""),
        ("ego.gain", ego.gain, from(0.0, 0.5), ""),
        ("ego.disturbance", ego.disturbance, from(0.0, 5.0), ""),
        ("position_error", contract.position_error, tolerance, ""),
        ("speed_error", contract.speed_error, tolerance, ""),
        ("slack", contract.slack, from(0.01, 10.0), ""),
        ("other.max_speed", other.max_speed, speed, ""),
        ("other.acceleration", other.acceleration, acceleration, ""),
        ("other.braking", other.braking, acceleration, ""),
        ("follower.reaction", follower.reaction, reaction, ""),
        (
            "follower.braking",
            follower.braking,
            above(0.0, other.braking),
            hardest,
        ),
        ("ego.braking", ego.braking, braking, leader),
        (
            "ego.emergency",
            ego.emergency,
            from(ego.braking, hardest_braking),
            ": it is no weaker than ego.braking, and no harder than other.braking",
        ),
        ("ego.acceleration", ego.acceleration, launch, keeps),
        ("ego.go", ego.go, go, commanded),
        (
            "ego.max_speed",
            ego.max_speed,
            from(held(contract) + 0.01, other.max_speed),
            fastest,
        ),
    ]
}

/// What may be commanded so that `most` (m/s²) is the most to which it leads.
const fn leads_to(contract: &Contract, most: f32) -> f32 {
    (most - contract.ego.disturbance) / (1.0 + contract.ego.gain)
}

/// What is to be commanded so that `least` (m/s²) is the least to which it leads.
const fn needs(contract: &Contract, least: f32) -> f32 {
    (least + contract.ego.disturbance) / (1.0 - contract.ego.gain)
}

/// The most (m/s²) to which `command` > 0 leads.
const fn strongest(contract: &Contract, command: f32) -> f32 {
    command + (contract.ego.gain * command + contract.ego.disturbance)
}

/// The least (m/s²) to which `command` > 0 leads.
const fn weakest(contract: &Contract, command: f32) -> f32 {
    command - (contract.ego.gain * command + contract.ego.disturbance)
}

const fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

const fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

const fn of_precedence(contract: &Contract, rule: Precedence) -> [Demand; 3] {
    [
        (
            "jitter",
            contract.jitter,
            from(0.0, contract.period / 8.0),
            ": with a rule of precedence, periods are counted",
        ),
        ("precedence.distance", rule.distance, above(0.0, 200.0), ""),
        ("precedence.braking", rule.braking, above(0.0, 20.0), ""),
    ]
}

const fn of_turns(contract: &Contract, rule: Precedence) -> [Demand; 2] {
    let turns = "; 0 leaves out the turns";
    let patience = from(5.0, u16::MAX as f32);
    // A vehicle whose turn is past stops where the other expects it.
    let stops =
        ": who takes turns stops as hard as it is expected to, and has ego.braking to do so";
    let braking = above(0.0, weakest(contract, contract.ego.braking));
    [
        ("precedence.patience", rule.patience as f32, patience, turns),
        ("precedence.braking", rule.braking, braking, stops),
    ]
}

/// How far (m/s) below its limit the ego may be held back: what [`unlimited`](crate::shield::margin::unlimited) leaves.
const fn held(contract: &Contract) -> f32 {
    let ego = contract.ego;
    let switched = strongest(contract, ego.acceleration) + strongest(contract, ego.emergency);
    let disturbed = 2.0 * ego.disturbance / (1.0 - ego.gain);
    2.0 * contract.speed_error
        + switched * contract.response()
        + (strongest(contract, ego.go) + disturbed) * contract.period
}

/// The fastest (m/s) that one may be that is taken for one at rest.
const fn slow(contract: &Contract) -> f32 {
    contract.rest_speed() + 2.0 * contract.speed_error
}

/// One that goes is seen: it gets faster, in spite of its limit, than one that may be taken for one at rest.
const fn unseen(contract: &Contract) -> Option<ContractError> {
    let ego = contract.ego;
    let rest = slow(contract);
    let held = held(contract);
    if rest < ego.max_speed - held {
        return None;
    }
    Some(ContractError {
        field: "ego.max_speed",
        value: ego.max_speed,
        range: above(rest + held, contract.other.max_speed),
        why: ": who takes turns must be seen to go, in spite of speed_error",
    })
}

/// One that is taken for one at rest still brakes by a plan that is past, behind one that enters a lane ahead of it: it stops
/// no later than a follower does that reacts and brakes as the contract says.
const fn creeps(contract: &Contract) -> Option<ContractError> {
    let (follower, rest) = (contract.follower, slow(contract));
    let own = rest / (2.0 * weakest(contract, contract.ego.braking));
    let least = own - rest / (2.0 * follower.braking) - contract.slack / rest;
    if follower.reaction >= least {
        return None;
    }
    Some(ContractError {
        field: "follower.reaction",
        value: follower.reaction,
        range: from(least, 10.0),
        why: ": who takes turns stops behind one ahead as a follower does, in spite of speed_error",
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shield::contract::tests::INEXACT;
    use crate::shield::margin::unlimited;

    /// Up to this speed (m/s) the slowest ego goes that the changed worst case allows.
    fn goes_up_to(change: impl FnOnce(&mut Contract)) -> f32 {
        let mut contract = Contract::WORST_CASE;
        change(&mut contract);
        contract.ego.max_speed = held(&contract) + 0.01;
        assert_eq!(first_fault(&contract), None);
        unlimited(&contract)
    }

    #[test]
    fn every_contract_lets_the_ego_go_at_a_centimetre_a_second() {
        let slowest = [
            goes_up_to(|_| {}),
            goes_up_to(|c| c.speed_error = 0.3),
            goes_up_to(|c| (c.ego.braking, c.ego.emergency) = (7.0, 7.0)),
            goes_up_to(|c| (c.latency, c.jitter) = (0.03, 0.01)),
            goes_up_to(|c| (c.period, c.latency) = (1.0, 1.0)),
            goes_up_to(|c| (c.latency, c.ego.lag) = (0.3, 0.2)),
            goes_up_to(|c| {
                (c.ego.gain, c.ego.disturbance) = (0.1, 0.3);
                (c.ego.acceleration, c.ego.go) = (2.0, 2.0);
            }),
        ];
        for speed in slowest {
            assert!((speed - 0.01).abs() < 1e-5, "{speed} m/s");
        }
    }

    /// What is said of [`INEXACT`] after `change`: the number, whether the lower end is outside, and both ends.
    fn fault(change: impl FnOnce(&mut Contract)) -> Option<(&'static str, bool, [f32; 2])> {
        let mut contract = INEXACT;
        change(&mut contract);
        let error = first_fault(&contract)?;
        Some((error.field(), error.excludes_low(), error.range()))
    }

    #[track_caller]
    fn named(field: &str, open: bool, [low, high]: [f32; 2], change: impl FnOnce(&mut Contract)) {
        let (name, excludes, [from, to]) = fault(change).expect(field);
        assert_eq!((name, excludes), (field, open));
        let near = |a: f32, b: f32| (a - b).abs() <= 1e-5 * (1.0 + b.abs());
        assert!(near(from, low) && near(to, high), "{field}: {from}, {to}");
    }

    #[test]
    fn each_number_that_is_none_is_named_with_its_range() {
        const NAN: f32 = f32::NAN;
        assert_eq!(fault(|_| {}), None);
        named("period", false, [0.01, 1.0], |c| c.period = NAN);
        named("jitter", false, [0.0, 0.035], |c| c.jitter = NAN);
        named("latency", false, [0.0, 0.94], |c| c.latency = NAN);
        named("ego.lag", false, [0.0, 1.0], |c| c.ego.lag = NAN);
        named("ego.gain", false, [0.0, 0.5], |c| c.ego.gain = NAN);
        named("ego.disturbance", false, [0.0, 5.0], |c| {
            c.ego.disturbance = NAN;
        });
        named("position_error", false, [0.0, 10.0], |c| {
            c.position_error = NAN;
        });
        named("speed_error", false, [0.0, 10.0], |c| c.speed_error = NAN);
        named("slack", false, [0.01, 10.0], |c| c.slack = NAN);
        named("other.max_speed", true, [0.0, 100.0], |c| {
            c.other.max_speed = NAN;
        });
        named("other.acceleration", true, [0.0, 20.0], |c| {
            c.other.acceleration = NAN;
        });
        named("other.braking", true, [0.0, 20.0], |c| {
            c.other.braking = NAN;
        });
        named("follower.reaction", false, [0.0, 10.0], |c| {
            c.follower.reaction = NAN;
        });
        named("follower.braking", true, [0.0, 9.0], |c| {
            c.follower.braking = NAN;
        });
        // From (0.01 + 0.5)/0.75 to (9 − 0.5)/1.25.
        named("ego.braking", false, [0.68, 6.8], |c| c.ego.braking = NAN);
        named("ego.emergency", false, [5.0, 6.8], |c| {
            c.ego.emergency = NAN;
        });
        // What 4 m/s² are at most.
        named("ego.acceleration", true, [0.0, 2.8], |c| {
            c.ego.acceleration = NAN;
        });
        named("ego.go", false, [0.68, 2.0], |c| c.ego.go = NAN);
        // Twice an error of 0.1, 3 and 8 m/s² for 0.54 s, and 1.75 + 1 / 0.75 m/s² for a period.
        named("ego.max_speed", false, [6.458_333, 20.0], |c| {
            c.ego.max_speed = NAN;
        });
    }

    #[test]
    fn an_exact_ego_brakes_as_gently_as_it_likes() {
        named("ego.braking", true, [0.0, 9.0], |c| {
            (c.ego.gain, c.ego.disturbance) = (0.0, 0.0);
            c.ego.braking = f32::NAN;
        });
    }

    #[test]
    fn an_ego_accelerates_no_harder_than_it_or_its_follower_brakes() {
        // 1.2 m/s² lead to 2 at most.
        let by = |braking: f32, follower: f32| {
            move |c: &mut Contract| {
                (c.ego.braking, c.follower.braking) = (braking, follower);
                c.ego.acceleration = f32::NAN;
            }
        };
        named("ego.acceleration", true, [0.0, 1.2], by(1.2, 1.0));
        named("ego.acceleration", true, [0.0, 1.2], by(1.0, 2.0));
    }

    #[test]
    fn each_number_of_the_rule_is_named_with_its_range() {
        let by = |change: fn(&mut Contract, &mut Precedence)| {
            move |c: &mut Contract| {
                let mut rule = c.precedence.unwrap();
                change(c, &mut rule);
                c.precedence = Some(rule);
            }
        };
        named("jitter", false, [0.0, 0.0125], by(|c, _| c.jitter = 0.02));
        named(
            "precedence.distance",
            true,
            [0.0, 200.0],
            by(|_, rule| rule.distance = f32::NAN),
        );
        named(
            "precedence.braking",
            true,
            [0.0, 20.0],
            by(|_, rule| rule.braking = f32::NAN),
        );
        // With turns, what 5 m/s² are at least.
        named(
            "precedence.braking",
            true,
            [0.0, 3.25],
            by(|_, rule| rule.braking = 3.3),
        );
        assert_eq!(
            fault(by(|_, rule| (rule.braking, rule.patience) = (3.3, 0))),
            None
        );
        named(
            "precedence.patience",
            false,
            [5.0, 65535.0],
            by(|_, rule| rule.patience = 4),
        );
        // 0.225 m/s may be taken for rest.
        named(
            "ego.max_speed",
            true,
            [6.673_333, 20.0],
            by(|c, _| c.ego.max_speed = 6.67),
        );
        assert_eq!(fault(by(|c, _| c.ego.max_speed = 6.68)), None);
        // 1.025 m/s may be taken for rest; the ego brakes at 3.25 m/s² at least, a follower at 4.
        named(
            "follower.reaction",
            false,
            [0.010_055, 10.0],
            by(|c, _| (c.speed_error, c.follower.reaction) = (0.5, 0.01)),
        );
        assert_eq!(
            fault(by(
                |c, _| (c.speed_error, c.follower.reaction) = (0.5, 0.011)
            )),
            None
        );
        let without_turns = by(|c, rule| {
            (c.speed_error, c.follower.reaction, rule.patience) = (0.5, 0.0, 0);
        });
        assert_eq!(fault(without_turns), None);
    }

    #[test]
    fn a_range_has_its_upper_end_and_its_lower_one_unless_it_is_open() {
        let fault = |value, range| first(&[("it", value, range, "")]).map(|error| error.value());
        for (value, open, closed) in [
            (1.0, Some(1.0), None),
            (2.0, None, None),
            (0.5, Some(0.5), Some(0.5)),
            (1.5, None, None),
            (2.5, Some(2.5), Some(2.5)),
        ] {
            assert_eq!(fault(value, above(1.0, 2.0)), open, "{value}");
            assert_eq!(fault(value, from(1.0, 2.0)), closed, "{value}");
        }
    }
}
