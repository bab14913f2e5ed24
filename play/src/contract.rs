//! A contract as numbers.

use crate::refusal::Refusal;
use crate::words::{Input, Output};
use cede_controller::{Contract, Precedence};

/// The numbers of `contract` in the order in which [`read`] takes them.
pub(crate) fn write(contract: &Contract, out: &mut Output) {
    let (ego, other, follower) = (contract.ego(), contract.other(), contract.follower());
    out.numbers([
        contract.latency(),
        contract.position_error(),
        contract.speed_error(),
        ego.max_speed,
        ego.acceleration,
        ego.go,
        ego.braking,
        ego.emergency,
        other.max_speed,
        other.acceleration,
        other.braking,
        follower.reaction,
        follower.braking,
        ego.lag,
        ego.gain,
        ego.disturbance,
        contract.jitter(),
    ]);
    out.word(contract.precedence().is_some().into());
}

/// The contract with these numbers: the last word is 1 if others keep the precedence of an all-way stop.
pub(crate) fn read(words: &mut Input<'_>) -> Result<Contract, Refusal> {
    let builder = Contract::builder()
        .latency(words.number()?)
        .position_error(words.number()?)
        .speed_error(words.number()?)
        .ego_max_speed(words.number()?)
        .ego_acceleration(words.number()?)
        .ego_go(words.number()?)
        .ego_braking(words.number()?)
        .ego_emergency(words.number()?)
        .other_max_speed(words.number()?)
        .other_acceleration(words.number()?)
        .other_braking(words.number()?)
        .follower_reaction(words.number()?)
        .follower_braking(words.number()?)
        .ego_lag(words.number()?)
        .ego_gain(words.number()?)
        .ego_disturbance(words.number()?)
        .jitter(words.number()?)
        .precedence((words.word()? != 0).then_some(Precedence::ALL_WAY_STOP));
    Ok(builder.build()?)
}
