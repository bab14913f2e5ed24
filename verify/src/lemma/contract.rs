//! A contract whose numbers are names: what is proved with it holds for every contract.

use super::formula::Formula;
use super::symbol::stand_ins;
use super::term::Term;
use cede_controller::dangerous::unchecked;
use cede_controller::{Contract, Real};

/// The contract of which nothing is known but what [`assumed`] says.
///
/// It has no jitter: its period stands for [`Contract::shortest_period`], its latency for [`Contract::switching`]. What is
/// proved for every period and every latency up to it is proved for those of a contract with jitter.
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
        ..,
    ] = stand_ins();
    let symbols = Contract::builder()
        .period(period)
        .latency(latency)
        .position_error(position_error)
        .speed_error(speed_error)
        .slack(slack)
        .ego_max_speed(max_speed)
        .ego_acceleration(acceleration)
        .ego_go(go)
        .ego_braking(braking)
        .other_max_speed(other_max_speed)
        .other_acceleration(other_acceleration)
        .other_braking(other_braking)
        .follower_reaction(reaction)
        .follower_braking(follower_braking);
    unchecked(symbols)
}

/// The same with a drivetrain that is not exact; its lag is a number.
pub(super) fn any_drivetrain(lag: f32) -> Contract {
    let [.., emergency, gain, disturbance] = stand_ins();
    let symbols = any_contract()
        .to_builder()
        .ego_emergency(emergency)
        .ego_gain(gain)
        .ego_disturbance(disturbance)
        .ego_lag(lag);
    unchecked(symbols)
}

/// What [`cede_controller::ContractBuilder::build`] demands of the numbers, but for upper limits that no lemma needs: those
/// that bind ego and others together are given where they are used.
pub(super) fn assumed() -> Vec<Formula> {
    let contract = any_contract();
    let (ego, other, follower) = (contract.ego(), contract.other(), contract.follower());
    let (of, zero) = (Term::of, Term::of(0.0));
    let positive = [
        contract.period(),
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
        contract.latency(),
        contract.position_error(),
        contract.speed_error(),
        contract.slack(),
        follower.reaction,
    ];
    let positive = positive.map(|x| zero.less(of(x)));
    let not_negative = not_negative.map(|x| zero.at_most(of(x)));
    let ordered = [
        (contract.latency(), contract.period()),
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
