//! How vehicles really move, written down independently of the shield: as relations of two states.
//!
//! A motion is made of pieces of constant acceleration; what holds along any piece that begins as the one
//! before it ended holds along the motion, by induction.

use super::formula::{Formula, all, any};
use super::term::Term;
use cede_controller::Real;
use cede_controller::shield::reach::Reach;

/// A symbol for a distance travelled and one for a speed.
pub(super) fn state([distance, speed]: [&'static str; 2]) -> Reach<Term> {
    Reach {
        distance: metres(distance),
        speed: self::speed(speed),
    }
}

/// A length, in m.
pub(super) fn metres(name: &'static str) -> Term {
    Term::symbol(name, "m")
}

/// A time, in s.
pub(super) fn seconds(name: &'static str) -> Term {
    Term::symbol(name, "s")
}

/// A speed, in m/s.
pub(super) fn speed(name: &'static str) -> Term {
    Term::symbol(name, "m/s")
}

/// An acceleration, in m/s².
pub(super) fn acceleration(name: &'static str) -> Term {
    Term::symbol(name, "m/s²")
}

/// A number that is known.
pub(super) fn number(value: f32) -> Term {
    Term::of(value)
}

/// 0 ≤ each of them.
pub(super) fn not_negative<const N: usize>(terms: [Term; N]) -> Formula {
    all(terms.map(|term| number(0.0).at_most(term)))
}

/// No farther and no faster.
pub(super) fn within(less: Reach<Term>, more: Reach<Term>) -> Formula {
    all([
        less.distance.at_most(more.distance),
        less.speed.at_most(more.speed),
    ])
}

/// From `from` to `to` at a constant speed.
fn keeps(from: Reach<Term>, time: Term, to: Reach<Term>) -> Formula {
    all([
        to.speed.equal(from.speed),
        to.distance.equal(from.distance + from.speed * time),
    ])
}

/// From `from` to `to` at a constant acceleration of either sign, never at rest on the way.
fn steadily(from: Reach<Term>, acceleration: Term, time: Term, to: Reach<Term>) -> Formula {
    let gained = acceleration * time * time * number(0.5);
    all([
        to.speed.equal(from.speed + acceleration * time),
        to.distance
            .equal(from.distance + from.speed * time + gained),
    ])
}

/// From `from` to `to` at a constant acceleration of either sign; who comes to rest stays there.
pub(super) fn moves(from: Reach<Term>, acceleration: Term, time: Term, to: Reach<Term>) -> Formula {
    let zero = number(0.0);
    let end = from.speed + acceleration * time;
    any([
        all([zero.at_most(end), steadily(from, acceleration, time, to)]),
        all([end.less(zero), stops(from, acceleration, to)]),
    ])
}

/// From `from` to rest at `to`, at a constant `acceleration` < 0.
pub(super) fn stops(from: Reach<Term>, acceleration: Term, to: Reach<Term>) -> Formula {
    let way = to.distance - from.distance;
    let square = from.speed * from.speed;
    all([
        to.speed.equal(number(0.0)),
        (way * (acceleration + acceleration)).equal(-square),
    ])
}

/// From `from` to `to` at a constant acceleration of either sign, but none beyond the speed `cap`, which is
/// reached after `ramp`, a symbol of its own. Who is faster already keeps the speed.
pub(super) fn limited(
    from: Reach<Term>,
    (acceleration, cap): (Term, Term),
    (time, ramp): (Term, Term),
    to: Reach<Term>,
) -> Formula {
    let zero = number(0.0);
    let end = from.speed + acceleration * time;
    let mean = (from.speed + cap) * number(0.5);
    let reaches = [
        from.speed.less(cap),
        cap.less(end),
        (from.speed + acceleration * ramp).equal(cap),
        to.speed.equal(cap),
        to.distance
            .equal(from.distance + mean * ramp + cap * (time - ramp)),
    ];
    any([
        all([acceleration.less(zero), moves(from, acceleration, time, to)]),
        all([
            zero.at_most(acceleration),
            cap.at_most(from.speed),
            keeps(from, time, to),
        ]),
        all([
            zero.at_most(acceleration),
            end.at_most(cap),
            steadily(from, acceleration, time, to),
        ]),
        all(reaches),
    ])
}
