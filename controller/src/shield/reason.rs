//! Why a command is refused.

use super::contract::Contract;
use super::hazard::{Passage, Who};
use super::lane::safe_gap;
use super::margin;
use super::rules::Rules;
use super::scene::Scene;
use super::verified::{passing, rest};
use crate::decision::Reason;
use crate::junction::PathId;
use crate::real::Real;

impl Scene<'_> {
    /// Why `command` is refused: what stands in the way of the plan that goes farthest.
    pub(super) fn reason<R: Rules>(&self, contract: &Contract, command: f32) -> Reason {
        let departure = R::departure(contract, self.ego.speed, self.inherited, command);
        let mut needs = rest::<R>(contract, departure.braking, 0.0);
        let mut stop = Reason::Stop {
            other: 0,
            available: 0.0,
            needs,
        };
        for hazard in self.hazards.iter() {
            if R::stops_short(contract, hazard.rest, needs) >= 0.0 {
                continue;
            }
            let (clears, ego_speed, passes) =
                passing::<R>(contract, hazard, (&departure, &self.going));
            let other = match hazard.who {
                Who::Watched { number, .. } | Who::Unwatched(number) => number,
                Who::Hidden(_) => 0,
            };
            stop = Reason::Stop {
                other,
                available: hazard.rest,
                needs,
            };
            if passes >= 0.0 {
                needs = rest::<R>(contract, departure.most, clears);
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
                        needs: safe_gap::<R>(contract, rush.speed, ego_speed),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::junction::zone::FAR;
    use crate::shield::actuation::Inherited;
    use crate::shield::hazard::Hazard;
    use crate::shield::hazards::tests::just;
    use crate::shield::margin::Going;
    use crate::shield::own::Own;
    use crate::shield::rules::Sound;

    const CONTRACT: Contract = Contract::WORST_CASE;

    /// Why an ego at 6 m/s, which keeps its speed, does not pass this in a zone from 5 to 15 m ahead, and when it would have
    /// cleared it.
    fn reason(passage: Passage) -> (Reason, f32, f32) {
        let own = Own {
            s: 0.0,
            speed: 6.0,
            least: 0.0,
        };
        let inherited = Inherited::all(&CONTRACT, [0.0; 2]);
        let hazard = Hazard {
            who: Who::Watched {
                number: 7,
                place: 0,
            },
            zone: 0,
            suspect: false,
            yields: false,
            target: 15.0,
            limit: 5.0,
            rest: 5.0,
            rest_beyond: FAR,
            passage,
        };
        let scene = Scene {
            ego: &own,
            hazards: &mut just(&[hazard]),
            inherited: &inherited,
            most: CONTRACT.ego.go,
            going: Going::of(&CONTRACT),
        };
        let departure = Sound::departure(&CONTRACT, 6.0, &inherited, 0.0);
        let (clears, speed) = margin::clearing(&CONTRACT, departure.least, 15.0);
        (scene.reason::<Sound>(&CONTRACT, 0.0), clears, speed)
    }

    #[test]
    fn a_negative_gap_is_told_as_an_overlap() {
        let told = |gap| {
            let entry = Reason::Entry {
                other: 7,
                gap,
                needs: 9.5,
            };
            std::format!("{entry}; {}", entry.naming("the lorry"))
        };
        let near = "may be as near as 4.0 m, entering needs 9.5 m";
        assert_eq!(told(4.0), std::format!("other 7 {near}; the lorry {near}"));
        let overlaps = "may overlap by 5.9 m, entering needs 9.5 m";
        assert_eq!(
            told(-5.9),
            std::format!("other 7 {overlaps}; the lorry {overlaps}")
        );
    }

    #[test]
    fn a_reason_has_the_numbers_of_the_passage_that_is_missed() {
        let (why, clears, speed) = reason(Passage::Ahead {
            gap: 4.0,
            speed: 8.0,
            arrives: FAR,
        });
        let rush = Sound::rush(&CONTRACT, 8.0, clears);
        assert!(rush.distance > 8.0);
        let entry = Reason::Entry {
            other: 7,
            gap: 4.0 - rush.distance,
            needs: Sound::safe_gap(&CONTRACT, rush.speed, speed),
        };
        assert_eq!(why, entry);
        let (distance, speed) = (9.0, 8.0);
        let (why, clears, _) = reason(Passage::Before { distance, speed });
        let arrives = margin::arrival(&CONTRACT, distance, speed);
        let arrival = |arrives, clears| Reason::Arrival {
            other: 7,
            arrives,
            clears,
        };
        assert_eq!(why, arrival(arrives, clears));
        let (distance, speed) = (3.0, 2.0);
        let (why, clears, _) = reason(Passage::Walks { distance, speed });
        assert_eq!(why, arrival(1.5, clears));
        let (why, ..) = reason(Passage::Never);
        let Reason::Stop {
            other: 7,
            available: 5.0,
            needs,
        } = why
        else {
            panic!("{why:?}");
        };
        assert!(needs > 5.0);
    }
}
