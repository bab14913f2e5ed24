//! Who has arrived, and who rests for how long, while two vehicles wait for each other.

use super::actuation::{hold, strongest, weakest};
use super::contract::{Contract, Precedence};
use super::own::Own;
use crate::instant::{Instant, micros};
use crate::junction::zone::Span;

/// Whether a vehicle is at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RestState {
    /// It moves, and did so since it was last seen to: nobody takes it for one at rest.
    No,
    /// Somebody may, who sees it otherwise.
    Perhaps,
    /// It is, and nobody takes it for one that moves.
    Surely,
}

impl RestState {
    /// What a vehicle does that is sensed at `speed` (m/s); to be at rest is to be no faster than a quarter of what `go` gains in a period.
    ///
    /// One surely at rest here is faster than that by twice the error at most, and any other
    /// sensor shows one error more: for that one it is perhaps at rest. One that moves could not have been
    /// surely at rest between two calls that both show it.
    #[must_use]
    pub fn of(contract: &Contract, speed: f32) -> Self {
        let (slow, error) = (contract.rest_speed(), contract.speed_error);
        if speed <= slow + error {
            Self::Surely
        } else if speed <= slow + 3.0 * error + dip(contract) {
            Self::Perhaps
        } else {
            Self::No
        }
    }
}

/// By how much (m/s) a vehicle may have been slower, or faster, between two calls than at both.
pub(super) fn dip(contract: &Contract) -> f32 {
    let (up, down) = (contract.other.acceleration, contract.other.braking);
    // It brakes first and then accelerates, or the other way round.
    (contract.period + 2.0 * contract.jitter) * up * down / (up + down)
}

/// Calls in a row that show a vehicle move, after which every other shield had a call in the meantime.
fn calls_in_between(contract: &Contract) -> u8 {
    // Two calls are a period and twice the jitter apart at most, three at least two periods less twice the jitter.
    if contract.jitter > 0.0 { 3 } else { 2 }
}

/// Periods from the end of one vehicle's turn to the beginning of the other's. One seen at rest until then
/// has no plan left that counts on its turn and goes: it would be seen to move.
pub(super) fn grace(contract: &Contract) -> u16 {
    let go = weakest(contract, contract.ego.go);
    let gain = go * contract.period;
    // Truncates towards zero and saturates.
    let hidden = ((contract.rest_speed() + 2.0 * contract.speed_error) / gain) as u16;
    // With jitter two shields may count a period more or less.
    let jitter = u16::from(contract.jitter > 0.0);
    hidden
        .saturating_add(4)
        .saturating_add(jitter)
        .saturating_add(late(contract, go))
}

/// Periods, beyond the first one, until an ego that stands with its brakes applied certainly follows `go` (m/s²).
fn late(contract: &Contract, go: f32) -> u16 {
    let stands = -hold(contract, -strongest(contract, contract.ego.emergency), go) / go;
    let periods = (contract.response() + stands) / contract.period;
    let whole = periods as u16;
    if f32::from(whole) < periods {
        whole
    } else {
        whole.saturating_sub(1)
    }
}

/// When a vehicle arrived: between two moments, whatever its sensors' errors are.
///
/// A vehicle arrives when it comes within [`Precedence::distance`] of its line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Arrival {
    /// It had certainly not arrived yet at this moment; none if it has been seen only since.
    after: Option<Instant>,
    /// It has certainly arrived by this moment; none if it may not have arrived yet.
    by: Option<Instant>,
}

/// Whether a vehicle has arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Arrived {
    Not,
    Perhaps,
    Surely,
}

impl Arrival {
    /// Notes that the vehicle is within `s` (m) at `now`, and where its line is.
    fn note(
        &mut self,
        contract: &Contract,
        rule: Precedence,
        line: f32,
        s: Span,
        now: Instant,
    ) -> Arrived {
        let here = line - rule.distance;
        let jitter = micros(contract.jitter);
        if self.by.is_some() {
            Arrived::Surely
        } else if s.to < here {
            self.after = Some(now.minus(jitter));
            Arrived::Not
        } else if s.from >= here {
            self.by = Some(now.plus(jitter));
            Arrived::Surely
        } else {
            Arrived::Perhaps
        }
    }

    /// Whether this vehicle certainly arrived at least so many microseconds before `other`.
    fn precedes_by(self, other: Self, micros: u64) -> bool {
        let both = self.by.zip(other.after);
        both.is_some_and(|(by, after)| by.plus(micros) <= after)
    }

    /// Whether this vehicle certainly arrived no more than so many microseconds after `other`.
    fn follows_by(self, other: Self, micros: u64) -> bool {
        let both = self.by.zip(other.after);
        both.is_some_and(|(by, after)| by <= after.plus(micros))
    }

    /// Microseconds, at least, by which it arrived before `other`; none if that is not known.
    fn earlier(self, other: Self) -> Option<i64> {
        let (by, after) = self.by.zip(other.after)?;
        let [by, after] = [by, after].map(|at| i64::try_from(at.micros()).unwrap_or(i64::MAX));
        Some(after.saturating_sub(by))
    }

    /// Whether a vehicle that arrived like this goes before `other`, both together at most one of the two: in a tie, of
    /// `tie` microseconds, the one with the right of way.
    pub(super) fn goes_first(self, other: Self, tie: u64, right_of_way: bool) -> bool {
        if right_of_way {
            self.follows_by(other, tie)
        } else {
            self.precedes_by(other, tie)
        }
    }
}

/// For how many periods a vehicle has rested since it arrived.
///
/// It is counted twice, so that two shields can rely on each other: who `surely` rests in one has
/// rested `perhaps` in the other for as long, or for one period less if one of them sees everything a period later.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Standstill {
    pub(super) perhaps: u16,
    pub(super) surely: u16,
    /// In how many of the last calls it was seen to move: perhaps between two calls of somebody else only.
    moved: u8,
}

impl Default for Standstill {
    /// Nothing is known: it may have rested for ever.
    fn default() -> Self {
        Self {
            perhaps: u16::MAX,
            surely: 0,
            moved: 0,
        }
    }
}

impl Standstill {
    /// One more period. It has moved for everybody after so many `calls` in a row that show it.
    fn note(&mut self, rest: RestState, arrived: Arrived, calls: u8) {
        self.moved = match rest {
            RestState::No => self.moved.saturating_add(1).min(calls),
            RestState::Perhaps | RestState::Surely => 0,
        };
        let count = |keeps: bool, periods: u16| {
            if keeps { periods.saturating_add(1) } else { 0 }
        };
        let keeps = arrived != Arrived::Not && self.moved < calls;
        self.perhaps = count(keeps, self.perhaps);
        let sure = rest == RestState::Surely && arrived == Arrived::Surely;
        self.surely = count(sure, self.surely);
    }
}

/// What one shield remembers of how a vehicle came to its line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Presence {
    pub(super) arrival: Arrival,
    pub(super) standstill: Standstill,
}

/// What is sensed of a vehicle in one call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// Bounds on its arc length in m; none without an observation of the vehicle itself.
    pub s: Option<Span>,
    /// Whether it rests; [`RestState::Perhaps`] if it is not seen.
    pub rest: RestState,
}

impl Sighting {
    /// What is sensed of the ego, or that it is not.
    pub(super) fn of_ego(contract: &Contract, ego: Option<&Own>) -> Self {
        Self {
            s: ego.map(|ego| ego.span(contract)),
            rest: ego.map_or(RestState::Perhaps, |ego| RestState::of(contract, ego.speed)),
        }
    }
}

impl Presence {
    /// Notes one more period, at the end of which `sighting` is sensed at `now`; `line` is where the vehicle waits (m).
    pub fn note(
        &mut self,
        contract: &Contract,
        rule: Precedence,
        line: f32,
        sighting: Sighting,
        now: Instant,
    ) {
        let arrived = match sighting.s {
            Some(s) => self.arrival.note(contract, rule, line, s, now),
            None if self.arrival.by.is_some() => Arrived::Surely,
            None => Arrived::Perhaps,
        };
        let calls = calls_in_between(contract);
        self.standstill.note(sighting.rest, arrived, calls);
    }

    /// Notes what is sensed within a period that has been noted already.
    pub fn note_again(&mut self, rest: RestState) {
        if rest != RestState::Surely {
            self.standstill.surely = 0;
        }
    }

    /// Nothing is known any more of how long it has rested.
    pub fn forget(&mut self) {
        self.standstill = Standstill::default();
    }

    /// Periods for which it has perhaps, and for which it has surely rested.
    #[must_use]
    pub fn rested(&self) -> [u16; 2] {
        [self.standstill.perhaps, self.standstill.surely]
    }

    /// Whether this vehicle came before `other` while both rest, so that the other knows it, too: by how much
    /// earlier it arrived and came to rest, both together.
    pub(super) fn first(self, other: Self, period: u64) -> bool {
        let period = i64::try_from(period).unwrap_or(i64::MAX);
        let rested = i64::from(self.standstill.surely) - i64::from(other.standstill.perhaps);
        self.arrival
            .earlier(other.arrival)
            .is_some_and(|arrived| arrived.saturating_add(rested.saturating_mul(period)) > period)
    }
}
