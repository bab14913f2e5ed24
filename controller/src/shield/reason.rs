//! Why a command is refused.

use super::contract::Contract;
use super::hazard::{Passage, Who};
use super::margin::{self, Going};
use super::rules::Rules;
use super::scene::Scene;
use super::verified::passage_margin;
use crate::decision::Reason;
use crate::junction::PathId;
use crate::real::Real;

impl Scene<'_> {
    /// Why `command` is refused: what stands in the way of the plan that goes farthest.
    pub(super) fn reason<R: Rules>(&self, contract: &Contract, command: f32) -> Reason {
        let departure = R::departure(contract, self.ego.speed, self.inherited, command);
        let mut needs = R::rest(contract, departure.braking, 0.0);
        let mut stop = Reason::Stop {
            other: 0,
            available: 0.0,
            needs,
        };
        let going = Going::of(contract);
        for hazard in self.hazards.iter() {
            if R::stops_short(contract, hazard.rest, needs) >= 0.0 {
                continue;
            }
            let (clears, ego_speed) = going.clearing(departure.least, hazard.target);
            let other = match hazard.who {
                Who::Watched { number, .. } | Who::Unwatched(number) => number,
                Who::Hidden(_) => 0,
            };
            stop = Reason::Stop {
                other,
                available: hazard.rest,
                needs,
            };
            if passage_margin::<R>(contract, hazard, clears, ego_speed) >= 0.0 {
                needs = R::rest(contract, departure.most, clears);
                continue;
            }
            if let Who::Hidden(path) = hazard.who {
                return hidden_reason(contract, path, hazard.passage, clears);
            }
            return match hazard.passage {
                Passage::Before { distance, speed } => Reason::Arrival {
                    other,
                    arrives: margin::arrival(contract, distance, speed),
                    clears,
                },
                Passage::Ahead { gap, speed, .. } => {
                    let rush = R::rush(contract, speed, clears);
                    Reason::Entry {
                        other,
                        gap: gap - rush.distance,
                        needs: R::safe_gap(contract, rush.speed, ego_speed),
                    }
                }
                Passage::Walks { distance, speed } => Reason::Arrival {
                    other,
                    arrives: Real::max(distance, 0.0) / speed,
                    clears,
                },
                Passage::Never => stop,
            };
        }
        stop
    }
}

/// Why the ego does not pass somebody out of sight on `path`, whom it would have passed after `clears` (s).
fn hidden_reason(contract: &Contract, path: PathId, passage: Passage, clears: f32) -> Reason {
    let (distance, speed) = match passage {
        Passage::Before { distance, speed } => (distance, speed),
        Passage::Ahead { gap, speed, .. } => (gap, speed),
        Passage::Walks { .. } | Passage::Never => (0.0, 0.0),
    };
    Reason::Hidden {
        path: u8::try_from(path.index()).unwrap_or(u8::MAX),
        arrives: margin::arrival(contract, distance, speed),
        clears,
    }
}
