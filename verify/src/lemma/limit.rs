//! (i) The ego's own speed limit, which its commands keep: commands come late, and speeds err.

use super::contract::any_contract;
use super::motion::{acceleration, not_negative, number, seconds, speed};
use super::term::Term;
use super::{Claim, Lemma, reach};
use cede_controller::Real;
use cede_controller::shield::{Contract, choice, margin};

pub(super) fn lemmas() -> Vec<Lemma> {
    vec![Lemma::new(
        [
            "limit",
            "the ego gets no faster than its limit, or than it is with what is in effect already, whenever the command takes effect",
            "a command of `choice::most` or less; until the next one, and on for as long as that may come late",
        ],
        &limit(choice::most),
        (
            "the command before forgotten",
            &limit(|contract, speed, _| choice::most(contract, speed, number(0.0))),
        ),
    )]
}

pub(super) fn unlimited_lemmas() -> Vec<Lemma> {
    vec![Lemma::new(
        [
            "unlimited",
            "up to the speed `unlimited`, once its command is in effect, an ego that goes may go: `choice::most` is `go` or more",
            "until the command takes effect the ego brakes at b or less; what is in effect is no harder than may be commanded; speeds err",
        ],
        &unlimited(margin::unlimited),
        (
            "the braking until the command takes effect forgotten",
            &unlimited(|contract| {
                let lost = Term::of(contract.ego().braking) * Term::of(contract.switching());
                margin::unlimited::<Term>(contract) + lost
            }),
        ),
    )]
}

/// The speed after `time` at a constant acceleration; who comes to rest stays there.
fn after(speed: Term, acceleration: Term, time: Term) -> Term {
    Real::max(number(0.0), speed + acceleration * time)
}

fn limit(rule: fn(&Contract, Term, Term) -> Term) -> Claim {
    let contract = any_contract();
    let [now, sensed, limit] = ["v", "sensed", "limit"].map(speed);
    let [previous, bound, command] = ["previous", "previous_most", "command"].map(acceleration);
    let [late, time, left, left_then] = ["late", "time", "left", "left_then"].map(seconds);
    let [period, switching] = [contract.period(), contract.switching()].map(Term::of);
    let then = after(now, previous, late);
    let end = after(then, command, time - late);
    // What is in effect goes on for as long as the command after it may come late.
    let on = |speed: Term, acceleration, left| speed + Real::max(number(0.0), acceleration) * left;
    Claim::new(
        [
            not_negative([now, late, left_then]),
            late.at_most(left),
            left.at_most(switching),
            late.at_most(time),
            left_then.at_most(switching),
            // Together, with the jitter of either call.
            (time + left_then).at_most(period + switching),
            now.at_most(sensed + Term::of(contract.speed_error())),
            previous.at_most(bound),
            Term::of(contract.ego().max_speed).at_most(limit),
            on(now, previous, left).at_most(limit),
            command.at_most(rule(&contract, sensed, bound)),
        ],
        on(end, command, left_then).at_most(limit),
    )
}

fn unlimited(rule: fn(&Contract) -> Term) -> Claim {
    let contract = any_contract();
    let (now, sensed) = (speed("v"), speed("sensed"));
    let (late, before) = (seconds("late"), acceleration("previous"));
    let bound = acceleration("previous_most");
    Claim::new(
        [
            number(0.01).at_most(reach::limiter(&contract)),
            not_negative([now, late]),
            late.at_most(Term::of(contract.switching())),
            (-Term::of(contract.ego().braking)).at_most(before),
            after(now, before, late).at_most(rule(&contract)),
            sensed.at_most(now + Term::of(contract.speed_error())),
            bound.at_most(Term::of(contract.ego().acceleration)),
        ],
        Term::of(contract.ego().go).at_most(choice::most(&contract, sensed, bound)),
    )
}
