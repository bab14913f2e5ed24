//! One shield's memory of itself and one other, fed as `Shield::wait` feeds it.

use super::super::super::bounds::Bounds;
use super::super::super::contract::{Contract, Precedence};
use super::super::super::rules::Rules;
use super::super::super::waiting::{Presence, RestState, Sighting};
use super::super::{ALL, PairMemory, Right, ZoneSet};
use crate::instant::Instant;
use crate::junction::kind::ConflictKind;
use crate::junction::zone::{FAR, Span, Zone};
use crate::junction::{Priority, RightOfWay};

/// Where both wait (m); the zone begins right behind it.
pub(super) const LINE: f32 = 60.0;

/// Arc length (m) and speed (m/s).
pub(super) type State = [f32; 2];

/// An all-way stop with exact sensors.
pub(super) fn contract(patience: u16, tie: u16) -> Contract {
    let rule = Precedence {
        patience,
        tie,
        ..Precedence::ALL_WAY_STOP
    };
    Contract {
        latency: 0.02,
        precedence: Some(rule),
        ..Contract::WORST_CASE
    }
}

pub(super) fn zone() -> Zone {
    let span = Span {
        from: LINE,
        to: LINE + 10.0,
    };
    Zone {
        ego: span,
        other: span,
        lead: Span {
            from: -FAR,
            to: FAR,
        },
        kind: ConflictKind::Crossing,
    }
}

#[derive(Clone, Debug)]
pub(super) struct Watcher {
    contract: Contract,
    right: Right,
    pub(super) presence: Presence,
    pub(super) pair: PairMemory,
    /// As the other was seen last, and when.
    seen: Option<(State, Instant)>,
    /// Calls missed since the last one.
    pub(super) missed: u16,
    /// Takes whoever is faster than one at rest for one that moves throughout, for a fault.
    pub(super) hasty: bool,
    pub(super) claims: ZoneSet,
}

impl Watcher {
    pub(super) fn new(contract: Contract, right: RightOfWay) -> Self {
        Self::under(contract, right, Priority::FirstCome)
    }

    /// One whose right of way counts as `priority` says.
    pub(super) fn under(contract: Contract, right: RightOfWay, priority: Priority) -> Self {
        let right = Right {
            of_way: right,
            priority,
            in_turns: right,
        };
        Self {
            contract,
            right,
            presence: Presence::default(),
            pair: PairMemory::default(),
            seen: None,
            missed: 0,
            hasty: false,
            claims: 0,
        }
    }

    /// Takes both for vehicles that have just moved.
    pub(super) fn assume_motion(&mut self) {
        let rule = self.contract.precedence.unwrap();
        let moving = Sighting {
            s: None,
            rest: RestState::No,
        };
        for presence in [&mut self.presence, &mut self.pair.other] {
            for _ in 0..4 {
                presence.note(&self.contract, rule, LINE, moving, Instant::default());
            }
        }
    }

    fn rest(&self, speed: f32) -> RestState {
        let contract = &self.contract;
        let moves = contract.rest_speed() + 3.0 * contract.speed_error;
        if self.hasty && speed > moves {
            RestState::No
        } else {
            RestState::of(contract, speed)
        }
    }

    fn mine(&self, state: Option<State>) -> Sighting {
        let error = self.contract.position_error;
        Sighting {
            s: state.map(|[s, _]| Span {
                from: s - error,
                to: s + error,
            }),
            rest: state.map_or(RestState::Perhaps, |[_, speed]| self.rest(speed)),
        }
    }

    /// The other coasts while it is not seen.
    fn its(&mut self, state: Option<State>, now: Instant) -> Option<Sighting> {
        if let Some(state) = state {
            self.seen = Some((state, now));
        }
        let ([s, speed], at) = self.seen?;
        let bounds =
            Bounds::sensed(&self.contract, s, speed).after(&self.contract, now.seconds_since(at));
        let rest = state.map_or(RestState::Perhaps, |[_, speed]| self.rest(speed));
        Some(Sighting {
            s: Some(bounds.s),
            rest,
        })
    }

    /// A call of number `own` that senses both, or not.
    pub(super) fn call<R: Rules>(&mut self, sensed: [Option<State>; 2], own: usize, now: Instant) {
        let contract = self.contract;
        let rule = contract.precedence.unwrap();
        let mine = self.mine(sensed[own]);
        // Who does not see itself uses nothing of what it sees.
        let other = sensed[own].and(sensed[1 - own]);
        let its = self.its(other, now);
        // The first call after a missed one is not on time.
        let on_time = self.missed == 0;
        for last in (0..=self.missed).map(|k| k == self.missed && on_time) {
            let seen = |sighting: Sighting| Sighting {
                rest: if last {
                    sighting.rest
                } else {
                    RestState::Perhaps
                },
                ..sighting
            };
            self.presence.note(&contract, rule, LINE, seen(mine), now);
            if let Some(its) = its {
                let pair = &mut self.pair;
                pair.other.note(&contract, rule, LINE, seen(its), now);
                pair.pass::<R>(&contract, rule, self.right, &self.presence);
            }
        }
        self.missed = 0;
        self.claims = self.claim::<R>(sensed[own], rule);
    }

    fn claim<R: Rules>(&mut self, own: Option<State>, rule: Precedence) -> ZoneSet {
        let (contract, ego) = (&self.contract, &self.presence);
        let claims = self.pair.claims(contract, rule, self.right, ego);
        match own {
            Some([s, _]) if claims != ALL => {
                self.pair
                    .hold::<R>(contract, ego, core::iter::once(&zone()), s);
                self.pair.claims(contract, rule, self.right, ego)
            }
            _ => claims,
        }
    }
}
