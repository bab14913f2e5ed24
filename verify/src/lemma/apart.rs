//! (iii) A verified plan keeps ego and other apart.

use super::contract::any_contract;
use super::formula::{Formula, all, any};
use super::motion::{
    acceleration, metres, moves, not_negative, number, seconds, speed, state, stops, within,
};
use super::term::Term;
use super::{Claim, Lemma};
use cede_controller::Real;
use cede_controller::dangerous::unchecked;
use cede_controller::shield::reach::Reach;
use cede_controller::shield::{Contract, margin};

pub(super) fn lemmas() -> Vec<Lemma> {
    vec![
        Lemma::new(
            [
                "crossing",
                "an other has not reached its zone before the ego has cleared its own",
                "a margin of `clears_before` that is not negative; the other within its bound; any moment until then",
            ],
            &crossing(margin::rush),
            (
                "the acceleration forgotten",
                &crossing(|_, speed, time| Reach::start(speed).at_most(number(0.0), time)),
            ),
        ),
        Lemma::new(
            [
                "gap",
                "a gap to a leader that closes is closing, and then stays closed: so it is open always if it is open at the end",
                "a piece of constant accelerations, perhaps to rest; the leader brakes at least as hard",
            ],
            &gap(Term::at_most),
            ("a leader that brakes less hard", &gap(|_, _| all([]))),
        ),
        Lemma::new(
            [
                "behind",
                "the gap to a leader is open when both are at rest",
                "a margin of `stops_short` that is not negative; the leader brakes at b̂, the ego rests within `rest`",
            ],
            &behind(margin::earliest_rest),
            (
                "a leader that brakes as gently as a follower",
                &behind(|contract, speed| {
                    Reach::start(speed).rest(Term::of(contract.follower().braking))
                }),
            ),
        ),
        Lemma::new(
            [
                "ahead",
                "with `safe_gap` or more, the gap to a follower is open at first and when both are at rest",
                "it rushes for its reaction time, then brakes at b̂_f; the ego brakes at the larger of b and b̂_f",
            ],
            &ahead(margin::safe_gap),
            (
                "the reaction time forgotten",
                &ahead(|contract, speed, ego_speed| {
                    let at_once = unchecked(contract.to_builder().follower_reaction(0.0));
                    margin::safe_gap(&at_once, speed, ego_speed)
                }),
            ),
        ),
        Lemma::new(
            [
                "merge",
                "of two vehicles that enter a lane as the one ahead, none does so second",
                "a margin of `enters_ahead` against one that is in the lane; the corner of the zone is in its band",
            ],
            &merge(margin::enters_ahead),
            (
                "the other's way until then forgotten",
                &merge(|contract, gap, _, needed| gap - needed - Term::of(contract.slack())),
            ),
        ),
    ]
}

fn crossing(rule: fn(&Contract, Term, Term) -> Reach<Term>) -> Claim {
    let contract = any_contract();
    let (seen, distance) = (speed("seen"), metres("distance"));
    let (clears, time) = (seconds("clears"), seconds("time"));
    let spare = margin::clears_before(&contract, distance, rule(&contract, seen, clears));
    let other = metres("t");
    Claim::new(
        [
            not_negative([seen, time, spare]),
            time.at_most(clears),
            other.at_most(margin::rush(&contract, seen, time).distance),
        ],
        other.at_most(distance - Term::of(contract.slack())),
    )
}

fn gap(order: impl Fn(Term, Term) -> Formula) -> Claim {
    let (ahead, behind) = (state(["t", "t_v"]), state(["s", "s_v"]));
    let (ahead_to, behind_to) = (state(["t_end", "t_v_end"]), state(["s_end", "s_v_end"]));
    let (a, b, time) = (acceleration("a"), acceleration("ahead_a"), seconds("time"));
    let gap = |ahead: Reach<Term>, behind: Reach<Term>| ahead.distance - behind.distance;
    let zero = number(0.0);
    let (first, then) = (gap(ahead, behind), gap(ahead_to, behind_to));
    Claim::new(
        [
            not_negative([time, ahead.speed, behind.speed]),
            b.less(zero),
            order(b, a),
            moves(ahead, b, time, ahead_to),
            moves(behind, a, time, behind_to),
            any([
                all([first.less(zero), ahead.speed.at_most(behind.speed)]),
                all([zero.at_most(first), then.less(zero)]),
            ]),
        ],
        all([then.less(zero), ahead_to.speed.at_most(behind_to.speed)]),
    )
}

fn behind(rule: fn(&Contract, Term) -> Term) -> Claim {
    let contract = any_contract();
    let (gap, rest, seen) = (metres("gap"), metres("rest"), speed("seen"));
    let (other, end) = (state(["t", "v"]), state(["t_end", "v_end"]));
    let spare = margin::stops_short(&contract, gap + rule(&contract, seen), rest);
    let ego = metres("s");
    Claim::new(
        [
            not_negative([spare, seen]),
            other.distance.equal(number(0.0)),
            seen.at_most(other.speed),
            stops(other, -Term::of(contract.other().braking), end),
            ego.at_most(rest),
        ],
        not_negative([end.distance + gap - ego]),
    )
}

fn ahead(rule: fn(&Contract, Term, Term) -> Term) -> Claim {
    let contract = any_contract();
    let gap = metres("gap");
    let [other, then, end] =
        [["t", "t_v"], ["t_then", "t_v_then"], ["t_end", "t_v_end"]].map(state);
    let [ego, ego_end] = [["s", "s_v"], ["s_end", "s_v_end"]].map(state);
    let hardest = Real::max(
        Term::of(contract.ego().braking),
        Term::of(contract.follower().braking),
    );
    let zero = number(0.0);
    Claim::new(
        [
            rule(&contract, other.speed, ego.speed).at_most(gap),
            not_negative([other.speed, ego.speed, then.speed]),
            other.distance.equal(zero),
            ego.distance.equal(zero),
            within(
                then,
                margin::rush(
                    &contract,
                    other.speed,
                    Term::of(contract.follower().reaction),
                ),
            ),
            stops(then, -Term::of(contract.follower().braking), end),
            stops(ego, -hardest, ego_end),
        ],
        not_negative([gap, gap + ego_end.distance - end.distance]),
    )
}

type EntersAhead = fn(&Contract, Term, Reach<Term>, Term) -> Term;

fn merge(rule: EntersAhead) -> Claim {
    let contract = any_contract();
    // The band of the lead that the second has over the first begins at minus the end of the first's.
    let [s_in, t_in, band, seen, s, needed] =
        ["s_in", "t_in", "band", "seen", "s", "needed"].map(metres);
    let (v, time) = (speed("v"), seconds("time"));
    let rush = margin::rush(&contract, v, time);
    let spare = rule(&contract, t_in - seen + band, rush, needed);
    Claim::new(
        [
            band.at_most(s_in - t_in),
            not_negative([spare, needed, v, time]),
            s.at_most(seen + rush.distance),
            number(0.0).less(Term::of(contract.slack())),
        ],
        s.less(s_in),
    )
}
