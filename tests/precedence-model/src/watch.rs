//! What one shield senses, and what it makes of that: the same calls as in the controller's `Shield::wait`.

use crate::body::Body;
use crate::setting::{ARRIVED, INSIDE, LINE, Setting, UNIT};
use cede_controller::dangerous::Rules;
use cede_controller::dangerous::precedence::{PairMemory, Presence, RestState, Sighting};
use cede_controller::{ConflictKind, Instant, RightOfWay, Span, Zone};

/// Metres that are as good as without end.
const FAR: f32 = 1.0e6;

/// Most calls that are missed in a row.
const MOST_MISSED: u8 = 3;

/// What a shield senses of one vehicle: the errors of place and speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Glance {
    /// Nothing.
    Unseen,
    /// Off by so many places; and what the speed looks like.
    Seen(i8, RestState),
}

/// What a shield does in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Look<const N: usize> {
    /// It is not due, or not switched on.
    Nothing,
    /// It is due and is not called.
    Missed,
    /// It is called.
    Call([Glance; N]),
}

/// One vehicle's shield.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Watch<const N: usize> {
    /// It is switched on.
    pub on: bool,
    /// It has been called in the present period.
    pub called: bool,
    missed: u8,
    /// Whom it does not see since the last call, one bit each.
    dark: u8,
    presence: Presence,
    pairs: [PairMemory; N],
    /// Over whom it claims the zone, one bit each.
    pub claims: u8,
}

impl<const N: usize> Watch<N> {
    /// A shield that has seen nothing.
    #[must_use]
    pub fn new(on: bool) -> Self {
        Self {
            on,
            called: false,
            missed: 0,
            dark: 0,
            presence: Presence::default(),
            pairs: [PairMemory::default(); N],
            claims: 0,
        }
    }

    /// Whether it claims the zone over vehicle `other`.
    #[must_use]
    pub fn claims(&self, other: usize) -> bool {
        self.claims >> other & 1 == 1
    }

    /// Periods, at most, for which anybody of whom number `own` knows that may have rested.
    #[must_use]
    pub fn longest(&self, own: usize) -> u16 {
        let others = (0..N).filter(|&other| other != own);
        let all = others
            .map(|other| self.pairs[other].other)
            .chain([self.presence]);
        let known = all
            .flat_map(|presence| presence.rested())
            .filter(|&periods| periods < u16::MAX);
        known.max().unwrap_or(0)
    }

    /// For how many periods it and `other` have perhaps and surely rested.
    pub(crate) fn rests(&self, other: usize) -> String {
        let [mine, theirs] =
            [self.presence, self.pairs[other].other].map(|presence| presence.rested());
        format!("L {} {} S {} {}", mine[0], theirs[0], mine[1], theirs[1])
    }

    /// Everything that number `own` may sense of the `bodies` when it is called, and what that costs of the disturbances.
    pub fn looks(
        &self,
        setting: &Setting<N>,
        own: usize,
        (bodies, left): (&[Body; N], u8),
    ) -> Vec<(Look<N>, u8)> {
        let mut calls = vec![([Glance::Unseen; N], 0)];
        for (number, body) in bodies.iter().enumerate() {
            let mut all = glances(setting, *body);
            let goes_on = self.dark >> number & 1 == 1;
            if number != own && setting.misses {
                all.push((Glance::Unseen, u8::from(!goes_on)));
            }
            let with = |(call, cost): &([Glance; N], u8)| {
                let (call, cost) = (*call, *cost);
                let extend = move |&(glance, more): &(Glance, u8)| {
                    let mut call = call;
                    call[number] = glance;
                    (call, cost + more)
                };
                all.iter().map(extend).collect::<Vec<_>>()
            };
            calls = calls.iter().flat_map(with).collect();
            calls.retain(|&(_, cost)| cost <= left);
        }
        // Who does not see itself uses nothing of what it sees.
        let blind = u8::from(self.dark.count_ones() < N as u32);
        if setting.misses && blind <= left {
            calls.push(([Glance::Unseen; N], blind));
        }
        let mut looks: Vec<_> = calls
            .into_iter()
            .map(|(call, cost)| (Look::Call(call), cost))
            .collect();
        if setting.misses && self.missed < MOST_MISSED {
            looks.push((Look::Missed, u8::from(self.missed == 0)));
        }
        looks
    }

    /// Number `own` does it at `now`.
    pub fn does<R: Rules>(
        &mut self,
        setting: &Setting<N>,
        own: usize,
        (bodies, now): (&[Body; N], Instant),
        look: Look<N>,
    ) {
        match look {
            Look::Nothing => {}
            Look::Missed => {
                self.called = true;
                self.missed += 1;
            }
            Look::Call(call) => {
                self.called = true;
                self.call::<R>(setting, own, (bodies, now), call);
            }
        }
    }

    fn call<R: Rules>(
        &mut self,
        setting: &Setting<N>,
        own: usize,
        (bodies, now): (&[Body; N], Instant),
        call: [Glance; N],
    ) {
        let (contract, rule) = (&setting.contract, setting.rule);
        let line = UNIT * f32::from(LINE);
        let blind = call[own] == Glance::Unseen;
        for before in (0..=self.missed).rev() {
            let sighting = |number: usize| {
                let seen = sighting(call[number], bodies[number], number == own);
                let rest = if before == 0 {
                    seen.rest
                } else {
                    RestState::Perhaps
                };
                Sighting { rest, ..seen }
            };
            self.presence.note(contract, rule, line, sighting(own), now);
            for other in (0..N).filter(|&other| other != own) {
                let mut right = setting.right_of(own, other);
                if blind {
                    right.in_turns = RightOfWay::Unsettled;
                }
                let pair = &mut self.pairs[other];
                pair.other.note(contract, rule, line, sighting(other), now);
                pair.pass::<R>(contract, rule, right, &self.presence);
            }
        }
        self.missed = 0;
        self.dark = (0..N).fold(0, |dark, number| {
            dark | u8::from(call[number] == Glance::Unseen) << number
        });
        self.claim::<R>(setting, own, (call[own], bodies[own]));
    }

    fn claim<R: Rules>(
        &mut self,
        setting: &Setting<N>,
        own: usize,
        (glance, body): (Glance, Body),
    ) {
        let (contract, rule) = (&setting.contract, setting.rule);
        let zone = zone();
        self.claims = 0;
        for other in (0..N).filter(|&other| other != own) {
            let right = setting.right_of(own, other);
            let pair = &mut self.pairs[other];
            let mut claims = pair.claims(contract, rule, right, &self.presence);
            if let (Glance::Seen(error, _), true) = (glance, claims != u8::MAX) {
                let s = UNIT * f32::from(body.place + error);
                pair.hold::<R>(contract, &self.presence, core::iter::once(&zone), s);
                claims = pair.claims(contract, rule, right, &self.presence);
            }
            self.claims |= (claims & 1) << other;
        }
    }

    /// A shield that is switched on and takes everybody for one that has just moved.
    pub fn assume_motion<const M: usize>(&mut self, setting: &Setting<M>) {
        let moving = Sighting {
            s: None,
            rest: RestState::No,
        };
        let (contract, rule) = (&setting.contract, setting.rule);
        for _ in 0..4 {
            let others = self.pairs.iter_mut().map(|pair| &mut pair.other);
            for presence in others.chain([&mut self.presence]) {
                presence.note(contract, rule, 0.0, moving, Instant::from_micros(0));
            }
        }
    }
}

/// The one zone, a crossing.
fn zone() -> Zone {
    let span = Span {
        from: UNIT * (f32::from(INSIDE) - 0.5),
        to: FAR,
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

/// What may be sensed of a vehicle that is seen: one glance of those that make no difference.
fn glances<const N: usize>(setting: &Setting<N>, body: Body) -> Vec<(Glance, u8)> {
    let speed = f32::from(body.speed) * setting.gain();
    let error = setting.contract.speed_error();
    let mut rests: Vec<_> = [-1.0, 0.0, 1.0]
        .map(|part| RestState::of(&setting.contract, (speed + part * error).max(0.0)))
        .to_vec();
    rests.dedup();
    let errors = -setting.place_error..=setting.place_error;
    // Not arrived, perhaps arrived, arrived, perhaps in the zone.
    let kind = |error: &i8| {
        let place = body.place + error;
        let inside = if place > INSIDE { place } else { 0 };
        (place + 1 >= 0, place > 0, inside)
    };
    let mut errors: Vec<_> = errors.collect();
    errors.dedup_by_key(|error| kind(error));
    let pairs = errors
        .iter()
        .flat_map(|&error| rests.iter().map(move |&rest| Glance::Seen(error, rest)));
    pairs.map(|glance| (glance, 0)).collect()
}

fn sighting(glance: Glance, body: Body, own: bool) -> Sighting {
    let metres = |place: i8| UNIT * f32::from(place);
    match glance {
        Glance::Unseen if own => Sighting {
            s: None,
            rest: RestState::Perhaps,
        },
        // It coasts: the bounds are as wide as they ever matter.
        Glance::Unseen => Sighting {
            s: Some(Span {
                from: metres(body.place - ARRIVED),
                to: metres(body.place + ARRIVED),
            }),
            rest: RestState::Perhaps,
        },
        Glance::Seen(error, rest) => Sighting {
            s: Some(Span {
                from: metres(body.place + error - 1),
                to: metres(body.place + error + 1),
            }),
            rest,
        },
    }
}
