//! (i) What the ego does until the first command of a plan is in effect: commands come late.

use super::contract::any_contract;
use super::formula::{Formula, all, any, not};
use super::motion::{acceleration, moves, not_negative, number, seconds, speed, state, within};
use super::term::Term;
use super::{Claim, Lemma};
use cede_controller::Real;
use cede_controller::shield::Contract;
use cede_controller::shield::actuation::Inherited;
use cede_controller::shield::margin::{self, Departure};
use cede_controller::shield::reach::Reach;

pub(super) fn lemmas() -> Vec<Lemma> {
    vec![
        Lemma::new(
            [
                "late",
                "a vehicle is between `at_least` of the smaller and `at_most` of the larger of two commands",
                "the first command for any part of a time, then the second; perhaps to rest",
            ],
            &late(|a, b| [Real::min(a, b), Real::max(a, b)]),
            ("the second command alone", &late(|_, b| [b, b])),
        ),
        Lemma::new(
            [
                "monotone",
                "`at_least` is no farther and no faster for who starts and accelerates no more",
                "any two vehicles, one cap, one time",
            ],
            &monotone(Term::at_most),
            ("a start with more speed", &monotone(|_, _| all([]))),
        ),
        Lemma::new(
            [
                "braking",
                "`departure.braking` bounds the ego when the brakes are certainly on",
                "within the bounds of `late` in each interval, from its true state on; speeds err",
            ],
            &departs(margin::departure, brakes),
            (
                "the brakes' latency forgotten",
                &departs(
                    |contract, speed, inherited, command| Departure {
                        braking: Reach::start(speed + Term::of(contract.speed_error())).at_most(
                            Real::max(inherited.bounds()[1], command),
                            Term::of(contract.shortest_period()),
                        ),
                        ..margin::departure(contract, speed, inherited, command)
                    },
                    brakes,
                ),
            ),
        ),
        Lemma::new(
            [
                "going",
                "`departure.most` bounds the ego when `go` is certainly in effect",
                "within the bounds of `late` in each interval, from its true state on; speeds err",
            ],
            &departs(margin::departure, goes_at_most),
            (
                "the command before forgotten",
                &departs(forgetful, goes_at_most),
            ),
        ),
        Lemma::new(
            [
                "going-least",
                "`departure.least` bounds the ego from below when `go` is certainly in effect",
                "the same, with a limiter; `monotone` for each interval",
            ],
            &departs(margin::departure, goes_at_least),
            (
                "the command before forgotten",
                &departs(forgetful, goes_at_least),
            ),
        ),
    ]
}

fn late(ends: impl Fn(Term, Term) -> [Term; 2]) -> Claim {
    let from = state(["s", "v"]);
    let then = state(["s_then", "v_then"]);
    let to = state(["s_end", "v_end"]);
    let (first, second) = (acceleration("first"), acceleration("second"));
    let (late, time, cap) = (seconds("late"), seconds("time"), speed("cap"));
    let [less, more] = ends(first, second);
    Claim::new(
        [
            not_negative([late, from.speed]),
            late.at_most(time),
            moves(from, first, late, then),
            moves(then, second, time - late, to),
        ],
        all([
            within(from.at_least(less, cap, time), to),
            within(to, from.at_most(more, time)),
        ]),
    )
}

fn monotone(speeds: impl Fn(Term, Term) -> Formula) -> Claim {
    let pair = Pair {
        less: state(["s", "v"]),
        more: state(["more", "more_v"]),
        accelerations: ["a", "more_a"].map(acceleration),
        cap: speed("cap"),
        time: seconds("time"),
    };
    Claim::new([pair.premise(speeds)], pair.conclusion())
}

/// Two vehicles for a time, of which one starts and accelerates no less than the other.
struct Pair {
    less: Reach<Term>,
    more: Reach<Term>,
    accelerations: [Term; 2],
    cap: Term,
    time: Term,
}

impl Pair {
    fn premise(&self, speeds: impl Fn(Term, Term) -> Formula) -> Formula {
        let [less, more] = self.accelerations;
        all([
            not_negative([self.time, self.less.speed, self.more.speed]),
            self.less.distance.at_most(self.more.distance),
            speeds(self.less.speed, self.more.speed),
            less.at_most(more),
        ])
    }

    fn ends(&self) -> [Reach<Term>; 2] {
        let [less, more] = self.accelerations;
        [
            self.less.at_least(less, self.cap, self.time),
            self.more.at_least(more, self.cap, self.time),
        ]
    }

    fn conclusion(&self) -> Formula {
        let [less, more] = self.ends();
        all([within(less, more), not_negative([less.speed])])
    }

    /// What the lemma says of them.
    fn lemma(&self) -> Formula {
        any([not(self.premise(Term::at_most)), self.conclusion()])
    }
}

type Rule = fn(&Contract, Term, &Inherited<Term>, Term) -> Departure<Term>;

fn forgetful(
    contract: &Contract,
    speed: Term,
    _: &Inherited<Term>,
    command: Term,
) -> Departure<Term> {
    margin::departure(
        contract,
        speed,
        &Inherited::all(contract, [command; 2]),
        command,
    )
}

/// The ego from now, when a command is given, until the next one is certainly in effect.
struct First {
    contract: Contract,
    departure: Departure<Term>,
    /// As it is sensed.
    speed: Term,
    command: Term,
    /// The command that is in effect now, and the bounds on it that the shield knows.
    previous: Term,
    bounds: [Term; 2],
    /// Now; after the latency; after the period; after both.
    states: [Reach<Term>; 4],
    times: [Term; 3],
}

/// What is said of it: what is given, the conclusion, and what need not be known for it.
fn departs(rule: Rule, say: impl Fn(&First) -> Claim) -> Claim {
    let contract = any_contract();
    let sensed = speed("sensed");
    let [previous, least, most, command] =
        ["previous", "previous_least", "previous_most", "command"].map(acceleration);
    let (error, latency) = (
        Term::of(contract.speed_error()),
        Term::of(contract.switching()),
    );
    let states = [
        ["s", "v"],
        ["s_latency", "v_latency"],
        ["s_period", "v_period"],
        ["s_end", "v_end"],
    ]
    .map(state);
    let first = First {
        contract,
        departure: rule(
            &contract,
            sensed,
            &Inherited::all(&contract, [least, most]),
            command,
        ),
        speed: sensed,
        command,
        previous,
        bounds: [least, most],
        states,
        times: [
            latency,
            Term::of(contract.shortest_period()) - latency,
            latency,
        ],
    };
    let [start, ..] = states;
    let mut claim = say(&first);
    claim.given.extend([
        start.distance.equal(number(0.0)),
        not_negative(states.map(|state| state.speed)),
        (sensed - error).at_most(start.speed),
        start.speed.at_most(sensed + error),
        least.at_most(previous),
        previous.at_most(most),
        (-Term::of(contract.ego().braking)).at_most(command),
    ]);
    claim
}

fn brakes(first: &First) -> Claim {
    let braking = -Term::of(first.contract.ego().braking);
    let last = Real::max(first.command, braking);
    Claim::new(
        first.at_most(last),
        within(first.states[3], first.departure.braking),
    )
}

fn goes_at_most(first: &First) -> Claim {
    let last = Real::max(first.command, Term::of(first.contract.ego().go));
    Claim::new(
        first.at_most(last),
        within(first.states[3], first.departure.most),
    )
}

impl First {
    /// In the last interval the acceleration is at most `last`.
    fn at_most(&self, last: Term) -> Vec<Formula> {
        let most = [Real::max(self.previous, self.command), self.command, last];
        (0..3)
            .map(|i| {
                let bound = self.states[i].at_most(most[i], self.times[i]);
                within(self.states[i + 1], bound)
            })
            .collect()
    }
}

fn goes_at_least(first: &First) -> Claim {
    let last = Real::min(first.command, Term::of(first.contract.ego().go));
    let known = Real::min(first.bounds[0], first.command);
    let least = [known, first.command, last];
    let truth = [
        Real::min(first.previous, first.command),
        first.command,
        last,
    ];
    let error = Term::of(first.contract.speed_error());
    let mut bound = Reach::start(first.speed - error);
    let (mut given, mut opaque) = (Vec::new(), Vec::new());
    for i in 0..3 {
        let pair = Pair {
            less: bound,
            more: first.states[i],
            accelerations: [least[i], truth[i]],
            cap: margin::unlimited(&first.contract),
            time: first.times[i],
        };
        let [less, more] = pair.ends();
        given.extend([pair.lemma(), within(more, first.states[i + 1])]);
        opaque.extend([less.distance, less.speed, more.distance, more.speed]);
        bound = less;
    }
    Claim::new(given, within(first.departure.least, first.states[3])).whatever(opaque)
}
