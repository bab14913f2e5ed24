//! (i) What one vehicle can do stays within the bounds.

use super::contract::any_contract;
use super::formula::{Formula, all, any};
use super::motion::{
    acceleration, limited, moves, not_negative, number, seconds, speed, state, stops, within,
};
use super::term::Term;
use super::{Claim, Lemma};
use cede_controller::Real;
use cede_controller::shield::reach::Reach;
use cede_controller::shield::{Contract, margin};

pub(super) fn lemmas() -> Vec<Lemma> {
    vec![
        Lemma::new(
            [
                "faster",
                "who starts no nearer, is no slower and accelerates no less, gets no less far and fast",
                "a piece of constant accelerations; who comes to rest stays there",
            ],
            &faster(Term::at_most),
            (
                "an acceleration that is larger",
                &faster(|a, b| b.at_most(a)),
            ),
        ),
        Lemma::new(
            [
                "slower",
                "the same beside the slowest vehicle with a limiter; who is at its cap may do without accelerating",
                "a piece of constant accelerations",
            ],
            &slower(Term::at_most),
            ("a limiter that may hold any speed", &slower(|_, _| all([]))),
        ),
        Lemma::new(
            [
                "most",
                "`at_most` is at least as far and fast as the motion",
                "a constant acceleration, any time, perhaps to rest",
            ],
            &most(Reach::at_most),
            (
                "the acceleration forgotten",
                &most(|from, _, time| from.at_most(number(0.0), time)),
            ),
        ),
        Lemma::new(
            [
                "least",
                "`at_least` is at most as far and fast as the motion with a limiter",
                "a constant acceleration, any time, perhaps to rest or to the cap",
            ],
            &least(Reach::at_least),
            (
                "the limiter forgotten",
                &least(|from, a, _, time| from.at_most(a, time)),
            ),
        ),
        Lemma::new(
            [
                "rush",
                "`rushing` bounds an other that accelerates at â or less, up to v̂_max or the speed that it was seen at",
                "a piece of constant acceleration",
            ],
            &rush(margin::rush),
            (
                "the acceleration forgotten",
                &rush(|_, speed, time| Reach::start(speed).at_most(number(0.0), time)),
            ),
        ),
        Lemma::new(
            [
                "rush-on",
                "`rushing` for a time and then on is `rushing` for both times",
                "any cap, acceleration > 0",
            ],
            &rush_on(Reach::rushing),
            (
                "the cap forgotten in the distance",
                &rush_on(|from, a, cap, time| Reach {
                    distance: from.at_most(a, time).distance,
                    ..from.rushing(a, cap, time)
                }),
            ),
        ),
        Lemma::new(
            [
                "clearing",
                "by `clearing` the slowest ego has gone the target, and is at least as fast as it says",
                "it goes from `least` on, with a limiter",
            ],
            // Of the limiter's speed the solver need not know what it is made of.
            &clears(margin::clearing).whatever(vec![limiter(&any_contract())]),
            (
                "the errors of speed with the wrong sign",
                &clears(|contract, least, target| {
                    let go = Term::of(contract.ego().go);
                    let cap = Term::of(contract.ego().max_speed) + Term::of(contract.speed_error());
                    let (time, speed) = least.until(target, go, cap);
                    (time + first(contract), speed)
                }),
            ),
        ),
        Lemma::new(
            [
                "rest",
                "the ego is at rest by `rest`",
                "from `most` or less, at `go` or less for a time, then braking at b or harder",
            ],
            &rest(margin::rest),
            (
                "the time of going forgotten",
                &rest(|contract, most, _| margin::rest(contract, most, number(0.0))),
            ),
        ),
        Lemma::new(
            [
                "brakes",
                "where the ego comes to rest gets no farther while it brakes at b or harder",
                "a piece of constant acceleration, perhaps to rest",
            ],
            &brakes(|reach, braking| reach.rest(braking)),
            (
                "half the braking distance",
                &brakes(|reach, braking| reach.rest(braking + braking)),
            ),
        ),
        Lemma::new(
            [
                "earliest",
                "where an other is at rest at the earliest gets no nearer, whatever it does",
                "a piece of constant acceleration of -b̂ or more, perhaps to rest",
            ],
            &earliest(margin::earliest_rest),
            (
                "an other that brakes as gently as a follower",
                &earliest(|contract, speed| {
                    Reach::start(speed).rest(Term::of(contract.follower().braking))
                }),
            ),
        ),
    ]
}

fn faster(order: impl Fn(Term, Term) -> Formula) -> Claim {
    let (from, to) = (state(["s", "v"]), state(["s_end", "v_end"]));
    let (bound, end) = (state(["more", "more_v"]), state(["more_end", "more_v_end"]));
    let (a, larger, time) = (acceleration("a"), acceleration("more_a"), seconds("time"));
    Claim::new(
        [
            not_negative([time, from.speed, bound.speed]),
            within(from, bound),
            order(a, larger),
            moves(from, a, time, to),
            moves(bound, larger, time, end),
        ],
        within(to, end),
    )
}

fn slower(holds: impl Fn(Term, Term) -> Formula) -> Claim {
    let (from, to) = (state(["s", "v"]), state(["s_end", "v_end"]));
    let (bound, end) = (state(["less", "less_v"]), state(["less_end", "less_v_end"]));
    let (a, less) = (acceleration("a"), acceleration("less_a"));
    let (time, ramp, cap) = (seconds("time"), seconds("ramp"), speed("cap"));
    let at_the_cap = all([number(0.0).at_most(a), holds(cap, from.speed)]);
    Claim::new(
        [
            not_negative([time, from.speed, bound.speed]),
            within(bound, from),
            any([less.at_most(a), at_the_cap]),
            moves(from, a, time, to),
            limited(bound, (less, cap), (time, ramp), end),
        ],
        within(end, to),
    )
}

fn most(rule: impl Fn(Reach<Term>, Term, Term) -> Reach<Term>) -> Claim {
    let (from, to) = (state(["s", "v"]), state(["s_end", "v_end"]));
    let (a, time) = (acceleration("a"), seconds("time"));
    Claim::new(
        [not_negative([time, from.speed]), moves(from, a, time, to)],
        within(to, rule(from, a, time)),
    )
}

fn least(rule: impl Fn(Reach<Term>, Term, Term, Term) -> Reach<Term>) -> Claim {
    let (from, to) = (state(["s", "v"]), state(["s_end", "v_end"]));
    let (a, cap) = (acceleration("a"), speed("cap"));
    let (time, ramp) = (seconds("time"), seconds("ramp"));
    Claim::new(
        [
            not_negative([time, from.speed]),
            limited(from, (a, cap), (time, ramp), to),
        ],
        within(rule(from, a, cap, time), to),
    )
}

fn rush(rule: impl Fn(&Contract, Term, Term) -> Reach<Term>) -> Claim {
    let contract = any_contract();
    let (from, to) = (state(["t", "v"]), state(["t_end", "v_end"]));
    let (a, time, seen) = (acceleration("a"), seconds("time"), speed("seen"));
    let most = Term::of(contract.other().max_speed);
    Claim::new(
        [
            not_negative([time, from.speed]),
            from.distance.at_most(number(0.0)),
            from.speed.at_most(seen),
            a.at_most(Term::of(contract.other().acceleration)),
            moves(from, a, time, to),
            any([to.speed.at_most(most), to.speed.at_most(seen)]),
        ],
        within(to, rule(&contract, seen, time)),
    )
}

fn rush_on(rule: impl Fn(Reach<Term>, Term, Term, Term) -> Reach<Term>) -> Claim {
    let from = state(["t", "v"]);
    let (a, cap) = (acceleration("a"), speed("cap"));
    let (time, more) = (seconds("time"), seconds("more"));
    let on = rule(rule(from, a, cap, time), a, cap, more);
    let at_once = rule(from, a, cap, time + more);
    Claim::new(
        [
            not_negative([time, more, from.speed, cap]),
            number(0.0).less(a),
        ],
        all([
            on.distance.equal(at_once.distance),
            on.speed.equal(at_once.speed),
        ]),
    )
}

fn clears(rule: impl Fn(&Contract, Reach<Term>, Term) -> (Term, Term)) -> Claim {
    let contract = any_contract();
    let (from, to) = (state(["s", "v"]), state(["s_end", "v_end"]));
    let (target, ramp) = (Term::symbol("target", "m"), seconds("ramp"));
    let (cap, go) = (limiter(&contract), Term::of(contract.ego().go));
    let (clears, least_speed) = rule(&contract, from, target);
    let time = clears - first(&contract);
    Claim::new(
        [
            not_negative([from.speed]),
            number(0.01).at_most(cap),
            limited(from, (go, cap), (time, ramp), to),
        ],
        all([
            number(0.0).at_most(time),
            target.at_most(to.distance),
            least_speed.at_most(to.speed),
        ]),
    )
}

/// The time from a decision until the first command of its plan is certainly in effect.
pub(super) fn first(contract: &Contract) -> Term {
    Term::of(contract.shortest_period()) + Term::of(contract.switching())
}

/// The speed from which on it may do without accelerating: `unlimited` says that its commands go below that, and its
/// limiter only holds it above. It loses some by braking after a command that is reduced.
pub(super) fn limiter(contract: &Contract) -> Term {
    let ego = contract.ego();
    let [error, period, late] = [
        contract.speed_error(),
        contract.period(),
        contract.switching(),
    ]
    .map(Term::of);
    let [most, go] = [ego.max_speed, ego.go].map(Term::of);
    let [acceleration, braking] = [ego.acceleration, ego.braking].map(Term::of);
    most - error - error - (acceleration + braking) * late - go * period
}

fn rest(rule: impl Fn(&Contract, Reach<Term>, Term) -> Term) -> Claim {
    let contract = any_contract();
    let (from, most) = (state(["s", "v"]), state(["most", "most_v"]));
    let (then, end) = (state(["s_then", "v_then"]), state(["s_end", "v_end"]));
    let (a, braking, time) = (acceleration("a"), acceleration("a_then"), seconds("time"));
    Claim::new(
        [
            not_negative([time, from.speed]),
            within(from, most),
            a.at_most(Term::of(contract.ego().go)),
            braking.at_most(-Term::of(contract.ego().braking)),
            moves(from, a, time, then),
            stops(then, braking, end),
        ],
        end.distance.at_most(rule(&contract, most, time)),
    )
}

fn brakes(rule: impl Fn(Reach<Term>, Term) -> Term) -> Claim {
    let contract = any_contract();
    let (from, to) = (state(["s", "v"]), state(["s_end", "v_end"]));
    let (a, time) = (acceleration("a"), seconds("time"));
    let braking = Term::of(contract.ego().braking);
    Claim::new(
        [
            not_negative([time, from.speed]),
            a.at_most(-braking),
            moves(from, a, time, to),
        ],
        rule(to, braking).at_most(rule(from, braking)),
    )
}

fn earliest(rule: impl Fn(&Contract, Term) -> Term) -> Claim {
    let contract = any_contract();
    let (from, to) = (state(["t", "v"]), state(["t_end", "v_end"]));
    let (a, time) = (acceleration("a"), seconds("time"));
    let rests = |at: Reach<Term>| at.distance + rule(&contract, at.speed);
    Claim::new(
        [
            not_negative([time, from.speed]),
            (-Term::of(contract.other().braking)).at_most(a),
            moves(from, a, time, to),
        ],
        rests(from).at_most(rests(to)),
    )
}
