//! (i) A vehicle that is not seen stays within `Bounds::after`: one that is within them at some time is within
//! them later, whatever it does meanwhile.

use super::contract::any_contract;
use super::formula::any;
use super::motion::{acceleration, moves, not_negative, number, seconds, speed, state, within};
use super::term::Term;
use super::{Claim, Lemma};
use cede_controller::Real;
use cede_controller::shield::reach::Reach;
use cede_controller::shield::{Contract, margin};

pub(super) fn lemmas() -> Vec<Lemma> {
    vec![
        Lemma::new(
            [
                "coast-least",
                "an other that is not nearer and not slower than it may be stays so",
                "a piece of constant acceleration of -b̂ or more after any time, perhaps to rest",
            ],
            &least(margin::dawdle),
            (
                "an other that is trusted to keep its speed",
                &least(|_, speed, time| Reach::start(speed).at_most(number(0.0), time)),
            ),
        ),
        Lemma::new(
            [
                "coast-most",
                "an other that is not farther and not faster than it may be stays so",
                "a piece of constant acceleration of â or less after any time, up to v̂_max or the speed that it was seen at",
            ],
            &most(margin::rush),
            (
                "the acceleration forgotten",
                &most(|_, speed, time| Reach::start(speed).at_most(number(0.0), time)),
            ),
        ),
    ]
}

type Bound = fn(&Contract, Term, Term) -> Reach<Term>;

fn least(rule: Bound) -> Claim {
    let contract = any_contract();
    let (from, to) = (state(["t", "v"]), state(["t_end", "v_end"]));
    let (a, seen) = (acceleration("a"), speed("seen"));
    let (time, more) = (seconds("time"), seconds("more"));
    Claim::new(
        [
            not_negative([time, more, seen]),
            within(rule(&contract, seen, time), from),
            (-Term::of(contract.other().braking)).at_most(a),
            moves(from, a, more, to),
        ],
        within(rule(&contract, seen, time + more), to),
    )
}

fn most(rule: Bound) -> Claim {
    let contract = any_contract();
    let (from, to) = (state(["t", "v"]), state(["t_end", "v_end"]));
    let (a, seen) = (acceleration("a"), speed("seen"));
    let (time, more) = (seconds("time"), seconds("more"));
    let cap = Term::of(contract.other().max_speed);
    Claim::new(
        [
            not_negative([time, more, seen, from.speed]),
            within(from, rule(&contract, seen, time)),
            a.at_most(Term::of(contract.other().acceleration)),
            moves(from, a, more, to),
            any([to.speed.at_most(cap), to.speed.at_most(seen)]),
        ],
        within(to, rule(&contract, seen, time + more)),
    )
}
