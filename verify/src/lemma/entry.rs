//! (iii) for an ego that enters a lane ahead of an other: the gap is verified for the last moment at which
//! it may enter, and it may enter sooner, and then slower.
//!
//! Let it enter a time sooner. If it needs a gap then at all, it is slow beside the other (`entry-speed`). In the time
//! that is left it gets faster, and needs less of a gap; but the other's way until it rests has grown by no less:
//! until it is at its highest speed (`entry-ramp`), and from then on (`entry-cap`; `rush-on` joins the two).

use super::contract::any_contract;
use super::formula::{Formula, all, any};
use super::motion::{not_negative, number, seconds, speed, state};
use super::term::Term;
use super::{Claim, Lemma};
use cede_controller::Contract;
use cede_controller::Real;
use cede_controller::shield::margin;
use cede_controller::shield::reach::Reach;

pub(super) fn lemmas() -> Vec<Lemma> {
    vec![
        Lemma::new(
            [
                "entry-speed",
                "an ego for which there is a gap to keep is not much faster than its follower when that has reacted",
                "others accelerate as hard as the ego, and the brakes are no weaker; the other is below its highest speed",
            ],
            &slow(false),
            ("an other that accelerates less", &slow(true)),
        ),
        Lemma::new(
            [
                "entry-ramp",
                "an other's way until it rests grows by no less than the ego's braking distance",
                "such an ego and such an other, which does not reach its highest speed meanwhile",
            ],
            &later(ramp, false),
            ("an other that accelerates less", &later(ramp, true)),
        ),
        Lemma::new(
            [
                "entry-cap",
                "an other's way until it rests grows by no less than the ego's braking distance",
                "the other is at its highest speed, or above; the ego does not accelerate beyond that",
            ],
            &later(capped, false),
            ("a faster ego", &later(capped, true)),
        ),
    ]
}

/// The numbers of a contract in which others accelerate, brake and drive at least as hard and fast as the ego.
struct Numbers {
    contract: Contract,
    a: Term,
    other_a: Term,
    braking: Term,
    hardest: Term,
    most: Term,
    other_most: Term,
}

fn numbers() -> Numbers {
    let contract = any_contract();
    let of = Term::of;
    let braking = of(contract.follower().braking);
    Numbers {
        contract,
        a: of(contract.ego().acceleration),
        other_a: of(contract.other().acceleration),
        braking,
        hardest: Real::max(of(contract.ego().braking), braking),
        most: of(contract.ego().max_speed),
        other_most: of(contract.other().max_speed),
    }
}

impl Numbers {
    fn at_least_as_capable(&self, weaker: bool) -> Formula {
        let Self {
            a,
            other_a,
            hardest,
            most,
            other_most,
            ..
        } = *self;
        let order = if weaker { all([]) } else { a.at_most(other_a) };
        all([order, a.at_most(hardest), most.at_most(other_most)])
    }

    /// An ego at `ego_speed` and a follower that reaches `speed` before it brakes.
    fn slow(&self, ego_speed: Term, speed: Term) -> Formula {
        let Self {
            a,
            other_a,
            braking,
            hardest,
            other_most,
            ..
        } = *self;
        any([
            other_most.at_most(speed),
            (ego_speed * a * braking).at_most(hardest * speed * (braking + other_a)),
        ])
    }
}

fn slow(weaker: bool) -> Claim {
    let n = numbers();
    let (seen, ego) = (speed("t_v"), speed("s_v"));
    let reacted = margin::rush(&n.contract, seen, Term::of(n.contract.follower().reaction));
    let gap = margin::safe_gap(&n.contract, seen, ego);
    Claim::new(
        [
            n.at_least_as_capable(weaker),
            not_negative([seen, ego]),
            number(0.0).less(gap),
        ],
        n.slow(ego, reacted.speed),
    )
}

/// The other is no faster than that at the end.
fn ramp(n: &Numbers, from: Reach<Term>, ego: Term, time: Term, weaker: bool) -> Vec<Formula> {
    vec![
        n.at_least_as_capable(weaker),
        n.slow(ego, from.speed),
        from.speed.less(n.other_most),
        (from.speed + n.other_a * time).at_most(n.other_most),
    ]
}

fn capped(n: &Numbers, from: Reach<Term>, _: Term, _: Term, weaker: bool) -> Vec<Formula> {
    let order = if weaker {
        all([])
    } else {
        n.most.at_most(n.other_most)
    };
    vec![
        order,
        n.a.at_most(n.hardest),
        n.other_most.at_most(from.speed),
    ]
}

type Given = fn(&Numbers, Reach<Term>, Term, Term, bool) -> Vec<Formula>;

fn later(given: Given, weaker: bool) -> Claim {
    let n = numbers();
    let from = state(["t", "t_v"]);
    let (ego, ego_then, time) = (speed("s_v"), speed("s_v_then"), seconds("time"));
    let then = from.rushing(n.other_a, n.other_most, time);
    let gained = ego_then * ego_then - ego * ego;
    let grown = then.rest(n.braking) - from.rest(n.braking);
    let given = given(&n, from, ego, time, weaker).into_iter().chain([
        not_negative([from.speed, ego, ego_then, time]),
        ego_then.at_most(ego + n.a * time),
        any([ego_then.at_most(ego), ego_then.at_most(n.most)]),
    ]);
    Claim::new(given, gained.at_most(grown * (n.hardest + n.hardest)))
}
