//! (ii) The tail of a verified plan stays verified: what was verified holds of whatever may come of it.

use super::contract::any_contract;
use super::formula::{Formula, all};
use super::motion::{limited, metres, moves, not_negative, number, seconds, speed, state, within};
use super::term::Term;
use super::{Claim, Lemma};
use cede_controller::Real;
use cede_controller::shield::reach::Reach;
use cede_controller::shield::{Contract, margin};

pub(super) fn lemmas() -> Vec<Lemma> {
    vec![
        Lemma::new(
            [
                "tail-clearing",
                "`clearing` is no later than the slowest ego: what is left of it suffices an ego that is no nearer and no slower",
                "it goes, with a limiter, and has gone the target at some time",
            ],
            &clearing(margin::clearing).whatever(vec![super::reach::limiter(&any_contract())]),
            (
                "a cap that the limiter may exceed",
                &clearing(|contract, least, target| {
                    let cap = margin::unlimited::<Term>(contract) * number(0.5);
                    let (time, speed) = least.until(target, Term::of(contract.ego().go), cap);
                    (time + super::reach::first(contract), speed)
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
                "having rushed for a while, an other leaves no less to spare before its zone, and arrives no faster",
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
                "it comes no nearer and arrives no faster than was verified: `tail-arrival`; the ego's speed as verified",
            ],
            &entry(margin::safe_gap),
            (
                "the one ahead taken for the one behind",
                &entry(|contract, speed, ego| margin::safe_gap(contract, ego, speed)),
            ),
        ),
    ]
}

fn clearing(rule: fn(&Contract, Reach<Term>, Term) -> (Term, Term)) -> Claim {
    let contract = any_contract();
    let (from, to) = (state(["s", "v"]), state(["s_end", "v_end"]));
    let (time, ramp, target) = (seconds("time"), seconds("ramp"), metres("target"));
    let (cap, go) = (
        super::reach::limiter(&contract),
        Term::of(contract.ego().go),
    );
    let (clears, _) = rule(&contract, from, target);
    let late = super::reach::first(&contract);
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
    let go = Term::of(contract.ego().go);
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

fn arrival(rule: Rush) -> Claim {
    let contract = any_contract();
    let (seen, then, distance) = (speed("seen"), state(["t", "v"]), metres("distance"));
    let (time, left) = (seconds("time"), seconds("left"));
    let spare = |distance, rush| margin::clears_before(&contract, distance, rush);
    let first = rule(&contract, seen, time + left);
    let later = rule(&contract, then.speed, left);
    Claim::new(
        [
            not_negative([time, left, seen, then.speed]),
            within(then, margin::rush(&contract, seen, time)),
        ],
        all([
            spare(distance, first).at_most(spare(distance - then.distance, later)),
            later.speed.at_most(first.speed),
        ]),
    )
}

fn entry(rule: fn(&Contract, Term, Term) -> Term) -> Claim {
    let contract = any_contract();
    let (gap, way, ego) = (metres("gap"), metres("t"), speed("ego_speed"));
    let (first, later) = (state(["first", "first_v"]), state(["later", "later_v"]));
    let spare = |gap, rush: Reach<Term>| {
        let needed = rule(&contract, rush.speed, ego);
        margin::enters_ahead(&contract, gap, rush, needed)
    };
    Claim::new(
        [
            not_negative([ego, later.speed]),
            (way + later.distance).at_most(first.distance),
            later.speed.at_most(first.speed),
        ],
        spare(gap, first).at_most(spare(gap - way, later)),
    )
}
