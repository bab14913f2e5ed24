//! The search for a plan that keeps the guarantee.

use super::contract::Contract;
use super::hazard::{Hazard, Passage};
use super::hazards::Hazards;
use super::margin::{self, Departure, Going};
use super::reach::Reach;
use super::rules::Rules;
use crate::junction::zone::FAR;
use crate::plan::Plan;
use crate::real::Real;

/// Clearing that takes longer than this (s) is not planned.
const HORIZON: f32 = 60.0;

/// A plan that keeps the guarantee, and by how much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Verified {
    pub(crate) plan: Plan,
    /// The least of the plan's margins in m, not negative if the plan is verified.
    pub(crate) margin: f32,
    /// The hazards with targets up to this (m) are passed.
    pub(crate) passes: f32,
}

/// The best plan after one period at a given acceleration: stop before every hazard, or go until the
/// first k are cleared and stop before all others, for every k.
///
/// Cost: one clearing time for each hazard.
#[inline(never)]
pub(crate) fn best<R: Rules>(
    contract: &Contract,
    hazards: &Hazards,
    (departure, going): (&Departure<f32>, &Going<f32>),
) -> Verified {
    let rest = rest::<R>(contract, departure.braking, 0.0);
    let mut best = Verified {
        plan: Plan { go: 0 },
        margin: R::stops_short(contract, hazards.nearest_rest(), rest),
        passes: -FAR - FAR,
    };
    let mut passed = FAR;
    for hazard in hazards.iter() {
        let (clears, _, passes) = passing::<R>(contract, hazard, (departure, going));
        passed = Real::min(passed, passes);
        // Whatever comes after it cannot mend a hazard that is not passed in time.
        if passed <= best.margin || clears > HORIZON {
            break;
        }
        let plan = Plan {
            go: margin::periods(contract, clears),
        };
        let time = f32::from(plan.go) * contract.period;
        let rest = R::rest(contract, departure.most, time);
        let margin = Real::min(passed, R::stops_short(contract, hazard.rest_beyond, rest));
        if margin > best.margin {
            let passes = hazard.target;
            best = Verified {
                plan,
                margin,
                passes,
            };
        }
    }
    best
}

/// Metres to spare of a given plan, after one period at the command of `departure`, against each hazard: it is passed in
/// time, or the ego stops before it.
pub(crate) fn spare<R: Rules>(
    contract: &Contract,
    (departure, going): (Departure<f32>, Going<f32>),
    plan: Plan,
) -> impl Fn(&Hazard) -> f32 {
    let time = f32::from(plan.go) * contract.period;
    let from = if plan.go > 0 {
        departure.most
    } else {
        departure.braking
    };
    let rest = rest::<R>(contract, from, time);
    move |hazard| spare_of::<R>(contract, hazard, (&departure, &going), (plan, rest))
}

/// [`spare`] of a plan by which the ego comes to rest after `rest` metres.
#[inline(never)] // Once in flash.
fn spare_of<R: Rules>(
    contract: &Contract,
    hazard: &Hazard,
    motion: (&Departure<f32>, &Going<f32>),
    (plan, rest): (Plan, f32),
) -> f32 {
    let stops = R::stops_short(contract, hazard.limit, rest);
    let (clears, _, passes) = passing::<R>(contract, hazard, motion);
    if clears <= HORIZON && margin::periods(contract, clears) <= plan.go {
        Real::max(stops, passes)
    } else {
        stops
    }
}

/// [`Rules::rest`] outside of loops.
#[inline(never)] // Once in flash.
pub(crate) fn rest<R: Rules>(contract: &Contract, from: Reach<f32>, time: f32) -> f32 {
    R::rest(contract, from, time)
}

/// When the ego has cleared a hazard (s from now), if it goes, how fast it then is (m/s), and metres to spare.
#[inline(never)] // Once in flash.
pub(crate) fn passing<R: Rules>(
    contract: &Contract,
    hazard: &Hazard,
    (departure, going): (&Departure<f32>, &Going<f32>),
) -> (f32, f32, f32) {
    let (clears, speed) = going.clearing(departure.least, hazard.target);
    let margin = passage_margin::<R>(contract, hazard, clears, speed);
    (clears, speed, margin)
}

/// Metres to spare when the ego has cleared `hazard` at `clears` (s from now) with `ego_speed`.
#[inline(always)]
pub(crate) fn passage_margin<R: Rules>(
    contract: &Contract,
    hazard: &Hazard,
    clears: f32,
    ego_speed: f32,
) -> f32 {
    let rush = |speed| R::rush(contract, speed, clears);
    match hazard.passage {
        Passage::Before { distance, speed } => {
            margin::clears_before(contract, distance, rush(speed))
        }
        Passage::Ahead {
            gap,
            speed,
            arrives,
        } => {
            let rush = rush(speed);
            let needed = R::safe_gap(contract, rush.speed, ego_speed);
            let enters = margin::enters_ahead(contract, gap, rush, needed);
            Real::min(enters, margin::clears_before(contract, arrives, rush))
        }
        Passage::Walks { distance, speed } => {
            margin::walks_clear(contract, distance, speed, clears)
        }
        Passage::Never => -FAR,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shield::hazard::Who;
    use crate::shield::hazards::tests::just;
    use crate::shield::rules::Sound;

    const WORST: Contract = Contract::WORST_CASE;

    const DEPARTURE: Departure<f32> = {
        const fn reach(distance: f32, speed: f32) -> Reach<f32> {
            Reach { distance, speed }
        }
        Departure {
            braking: reach(1.0, 6.0),
            most: reach(1.5, 6.5),
            least: reach(1.0, 5.5),
        }
    };

    fn hazard(target: f32, limit: f32, passage: Passage) -> Hazard {
        Hazard {
            who: Who::Unwatched(0),
            zone: 0,
            suspect: false,
            yields: false,
            target,
            limit,
            rest: limit,
            rest_beyond: FAR,
            passage,
        }
    }

    const FREE: Passage = Passage::Before {
        distance: 100.0,
        speed: 5.0,
    };

    fn best_of(all: &[Hazard]) -> Verified {
        best::<Sound>(&WORST, &just(all), (&DEPARTURE, &Going::of(&WORST)))
    }

    #[track_caller]
    fn near(a: f32, b: f32) {
        assert!((a - b).abs() < 1e-2, "{a}, {b}");
    }

    /// Braking at once ends after 1 m + 6 m; going on for 2.3 s after 54.31 m.
    #[test]
    fn the_best_plan_stops_before_a_zone_or_passes_it_in_time() {
        let stops = best_of(&[hazard(FAR, 10.0, Passage::Never)]);
        assert_eq!((stops.plan.go, stops.passes), (0, -2.0 * FAR));
        near(stops.margin, 2.99);
        // The other comes 20.28 m nearer in 2.37 s.
        let passes = best_of(&[hazard(20.0, 5.0, FREE)]);
        assert_eq!((passes.plan.go, passes.passes), (23, 20.0));
        near(passes.margin, 79.71);
        // A wall beyond.
        let before = best_of(&[hazard(20.0, 5.0, FREE), hazard(FAR, 60.0, Passage::Never)]);
        assert_eq!(before.plan.go, 23);
        near(before.margin, 5.678);
        let neither = best_of(&[hazard(20.0, 5.0, FREE), hazard(FAR, 50.0, Passage::Never)]);
        assert_eq!(neither.plan.go, 0);
        near(neither.margin, -2.01);
        // Of two that are as good, the shorter one.
        let both = best_of(&[
            hazard(20.0, 5.0, FREE),
            hazard(
                30.0,
                500.0,
                Passage::Before {
                    distance: 1000.0,
                    speed: 5.0,
                },
            ),
        ]);
        assert_eq!(
            (both.plan.go, both.passes, both.margin),
            (23, 20.0, passes.margin)
        );
        // Not within a minute.
        assert_eq!(best_of(&[hazard(1000.0, 5.0, FREE)]).plan.go, 0);
        assert_eq!(best_of(&[]).plan.go, 0);
    }

    #[test]
    fn a_plan_has_to_spare_what_it_stops_short_by_or_passes_by() {
        let spare = |go, target| {
            let hazard = hazard(target, 5.0, FREE);
            spare::<Sound>(&WORST, (DEPARTURE, Going::of(&WORST)), Plan { go })(&hazard)
        };
        near(spare(23, 20.0), 79.71);
        near(spare(22, 20.0), -46.67);
        near(spare(0, 20.0), -2.01);
        assert!(spare(650, 1000.0) < 0.0, "farther than a plan goes");
    }

    #[test]
    fn a_passage_has_to_spare_what_the_other_has_not_come() {
        let margin =
            |passage| passage_margin::<Sound>(&WORST, &hazard(0.0, 0.0, passage), 2.0, 4.0);
        // In 2 s it comes 16 m nearer and gets 11 m/s, from which it needs 5.875 + 12.5²/8 − 2 m.
        let ahead = |gap, arrives| Passage::Ahead {
            gap,
            speed: 5.0,
            arrives,
        };
        near(margin(ahead(50.0, FAR)), 34.0 - 23.406 - 0.01);
        near(margin(ahead(50.0, 20.0)), 4.0 - 0.01);
        let walks = Passage::Walks {
            distance: 9.0,
            speed: 3.0,
        };
        near(margin(walks), 2.99);
        assert_eq!(margin(Passage::Never), -FAR);
    }
}
