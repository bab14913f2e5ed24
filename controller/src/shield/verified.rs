//! The search for a plan that keeps the guarantee.

use super::contract::Contract;
use super::hazard::{Hazard, Passage};
use super::hazards::Hazards;
use super::margin::{self, Departure};
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
pub(crate) fn best<R: Rules>(
    contract: &Contract,
    hazards: &Hazards,
    departure: &Departure<f32>,
) -> Verified {
    let rest = R::rest(contract, departure.braking, 0.0);
    let mut best = Verified {
        plan: Plan { go: 0 },
        margin: R::stops_short(contract, hazards.nearest_rest(), rest),
        passes: -FAR - FAR,
    };
    let mut passed = FAR;
    for hazard in hazards.iter() {
        let (clears, speed) = margin::clearing(contract, departure.least, hazard.target);
        passed = Real::min(passed, passage_margin::<R>(contract, hazard, clears, speed));
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

/// Metres to spare of a given plan, after one period at the command of `departure`, against one hazard: it is passed in
/// time, or the ego stops before it.
pub(crate) fn spare<R: Rules>(
    contract: &Contract,
    hazard: &Hazard,
    departure: &Departure<f32>,
    plan: Plan,
) -> f32 {
    let time = f32::from(plan.go) * contract.period;
    let rest = if plan.go > 0 {
        R::rest(contract, departure.most, time)
    } else {
        R::rest(contract, departure.braking, 0.0)
    };
    let stops = R::stops_short(contract, hazard.limit, rest);
    let (clears, speed) = margin::clearing(contract, departure.least, hazard.target);
    if clears <= HORIZON && margin::periods(contract, clears) <= plan.go {
        Real::max(stops, passage_margin::<R>(contract, hazard, clears, speed))
    } else {
        stops
    }
}

/// Metres to spare when the ego has cleared `hazard` at `clears` (s from now) with `ego_speed`.
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
