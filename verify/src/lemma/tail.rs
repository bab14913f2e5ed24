//! (ii) The tail of a verified plan stays verified: what was verified holds of whatever may come of it.

use super::contract::any_contract;
use super::formula::{Formula, all};
use super::motion::{limited, metres, moves, not_negative, number, seconds, speed, state, within};
use super::term::Term;
use super::{Claim, Lemma};
use cede_controller::shield::reach::Reach;
use cede_controller::shield::{Contract, Real, margin};

pub(super) fn lemmas() -> Vec<Lemma> {
    vec![
        Lemma::new(
            [
                "tail-clearing",
                "`clearing` is no later than the slowest ego: what is left of it suffices an ego that is no nearer and no slower",
                "it goes, with a limiter, and has gone the target at some time",
            ],
            &clearing(margin::clearing),
            (
                "a cap that the limiter may exceed",
                &clearing(|contract, least, target| {
                    let cap = margin::unlimited::<Term>(contract) * number(0.5);
                    let (time, speed) = least.until(target, Term::of(contract.ego.go), cap);
                    let late = Term::of(contract.period) + Term::of(contract.latency);
                    (time + late, speed)
                }),
            ),
        ),
        Lemma::new(
            [
                "tail-stopping",
                "having gone for a while, the ego rests no farther than was verified",
                "it goes from `most` on; then it is no farther and no faster",
            ],
            &stopping(Term::at_most),
            (
                "an ego that may have got farther",
                &stopping(|_, _| all([])),
            ),
        ),
        Lemma::new(
            [
                "tail-arrival",
                "having rushed for a while, an other leaves no less to spare before its zone",
                "it is within its bound, and rushes for what is left of the time",
            ],
            &arrival(margin::rush),
            (
                "the acceleration forgotten",
                &arrival(|_, speed, time| Reach::start(speed).at_most(number(0.0), time)),
            ),
        ),
        Lemma::new(
            [
                "tail-entry",
                "having rushed for a while, an other leaves no less to spare behind an ego that enters ahead",
                "it is within its bound, and rushes for what is left of the time; the ego's speed at entry as verified",
            ],
            &entry(margin::rush),
            (
                "the acceleration forgotten",
                &entry(|_, speed, time| Reach::start(speed).at_most(number(0.0), time)),
            ),
        ),
    ]
}

fn clearing(rule: fn(&Contract, Reach<Term>, Term) -> (Term, Term)) -> Claim {
    let contract = any_contract();
    let (from, to) = (state(["s", "v"]), state(["s_end", "v_end"]));
    let (time, ramp, target) = (seconds("time"), seconds("ramp"), metres("target"));
    let (cap, go) = (super::reach::limiter(&contract), Term::of(contract.ego.go));
    let (clears, _) = rule(&contract, from, target);
    let late = Term::of(contract.period) + Term::of(contract.latency);
    Claim::new(
        [
            not_negative([time, from.speed]),
            number(0.01).at_most(cap),
            limited(from, (go, cap), (time, ramp), to),
            target.at_most(to.distance),
        ],
        clears.at_most(time + late),
    )
}

fn stopping(order: impl Fn(Term, Term) -> Formula) -> Claim {
    let contract = any_contract();
    let (from, bound, to) = (
        state(["s", "v"]),
        state(["more", "more_v"]),
        state(["s_end", "v_end"]),
    );
    let (time, rest) = (seconds("time"), seconds("left"));
    let go = Term::of(contract.ego.go);
    Claim::new(
        [
            not_negative([time, rest, from.speed, to.speed]),
            moves(from, go, time, bound),
            order(to.distance, bound.distance),
            to.speed.at_most(bound.speed),
        ],
        margin::rest(&contract, to, rest).at_most(margin::rest(&contract, from, time + rest)),
    )
}

type Rush = fn(&Contract, Term, Term) -> Reach<Term>;

/// An other that is seen now, and may be anywhere within its bound later.
struct Other {
    contract: Contract,
    seen: Term,
    then: Reach<Term>,
    time: Term,
    left: Term,
    given: Vec<Formula>,
}

fn other() -> Other {
    let contract = any_contract();
    let (seen, then) = (speed("seen"), state(["t", "v"]));
    let (time, left) = (seconds("time"), seconds("left"));
    let given = vec![
        not_negative([time, left, seen, then.speed]),
        within(then, margin::rush(&contract, seen, time)),
    ];
    Other {
        contract,
        seen,
        then,
        time,
        left,
        given,
    }
}

fn arrival(rule: Rush) -> Claim {
    let Other {
        contract,
        seen,
        then,
        time,
        left,
        given,
    } = other();
    let distance = metres("distance");
    let margin = |distance, rush| margin::clears_before(&contract, distance, rush);
    let first = margin(distance, rule(&contract, seen, time + left));
    let later = margin(distance - then.distance, rule(&contract, then.speed, left));
    Claim::new(given, first.at_most(later))
}

fn entry(rule: Rush) -> Claim {
    let Other {
        contract,
        seen,
        then,
        time,
        left,
        given,
    } = other();
    let (gap, ego) = (metres("gap"), speed("ego_speed"));
    let margin = |gap, rush: Reach<Term>| {
        let needed = margin::safe_gap(&contract, rush.speed, ego);
        margin::enters_ahead(&contract, gap, rush, needed)
    };
    let first = margin(gap, rule(&contract, seen, time + left));
    let later = margin(gap - then.distance, rule(&contract, then.speed, left));
    let given = given.into_iter().chain([not_negative([ego])]);
    Claim::new(given, first.at_most(later))
}
