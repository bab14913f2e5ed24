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

/// Periods until everybody has seen one move that sets off from rest at `go`.
pub(super) fn sets_off(contract: &Contract) -> u16 {
    let go = weakest(contract, contract.ego.go);
    let seen = contract.rest_speed() + 3.0 * contract.speed_error + dip(contract);
    let periods = (seen / (go * contract.period)) as u16;
    periods
        .saturating_add(1)
        .saturating_add(late(contract, go))
        .saturating_add(calls_in_between(contract).into())
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
pub(super) enum Arrived {
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

    /// So many periods more, one at least, in each of which it perhaps rests.
    fn miss(&mut self, arrived: Arrived, periods: u16) {
        *self = Self {
            perhaps: match arrived {
                Arrived::Not => 0,
                Arrived::Perhaps | Arrived::Surely => self.perhaps.saturating_add(periods),
            },
            surely: 0,
            moved: 0,
        };
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
        let arrived = self.arrive((contract, rule), line, sighting.s, now);
        self.stay(contract, sighting.rest, arrived);
    }

    /// Notes that it is within `s` (m) at `now`, and whether it has arrived: for however many periods are noted then.
    pub(super) fn arrive(
        &mut self,
        (contract, rule): (&Contract, Precedence),
        line: f32,
        s: Option<Span>,
        now: Instant,
    ) -> Arrived {
        match s {
            Some(s) => self.arrival.note(contract, rule, line, s, now),
            None if self.arrival.by.is_some() => Arrived::Surely,
            None => Arrived::Perhaps,
        }
    }

    /// Notes one more period of one that has `arrived`, or not.
    pub(super) fn stay(&mut self, contract: &Contract, rest: RestState, arrived: Arrived) {
        let calls = calls_in_between(contract);
        self.standstill.note(rest, arrived, calls);
    }

    /// Notes so many periods without a call, of one that has `arrived`, or not.
    pub(super) fn miss(&mut self, arrived: Arrived, periods: u16) {
        if periods > 0 {
            self.standstill.miss(arrived, periods);
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn contract(change: impl FnOnce(&mut Contract)) -> Contract {
        let mut contract = Contract::ALL_WAY_STOP;
        change(&mut contract);
        contract
    }

    #[test]
    fn rest_is_sure_up_to_one_error_and_possible_up_to_three_and_a_dip() {
        let errs = contract(|c| c.speed_error = 0.1);
        let of = |speed| RestState::of(&errs, speed);
        assert_eq!([0.0, 0.174].map(of), [RestState::Surely; 2]);
        assert_eq!([0.176, 0.593].map(of), [RestState::Perhaps; 2]);
        assert_eq!(of(0.594), RestState::No);
        let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-5, "{a}, {b}");
        near(dip(&errs), 0.1 * 24.0 / 11.0);
        near(dip(&contract(|c| c.jitter = 0.01)), 0.12 * 24.0 / 11.0);
    }

    #[test]
    fn one_that_moves_was_seen_to_by_everybody_after_two_calls_or_three_with_jitter() {
        assert_eq!(calls_in_between(&Contract::ALL_WAY_STOP), 2);
        assert_eq!(calls_in_between(&contract(|c| c.jitter = 0.01)), 3);
    }

    #[test]
    fn one_that_sets_off_is_seen_to_by_everybody_after_as_many_periods_as_its_speed_takes() {
        let after = |change: fn(&mut Contract)| sets_off(&contract(change));
        // 0.293 m/s are gained in the first period, and two calls show it.
        assert_eq!(after(|_| {}), 1 + 2);
        // 1.793 m/s in six; with jitter more, a response of two periods, and three calls; one of 2.5 is over in the third.
        assert_eq!(after(|c| c.speed_error = 0.5), 6 + 2);
        assert_eq!(after(|c| c.jitter = 0.01), 2 + 1 + 3);
        assert_eq!(after(|c| c.latency = 0.25), 1 + 2 + 2);
    }

    #[test]
    fn a_turn_begins_when_no_plan_of_the_last_one_can_go_unseen() {
        let after = |change: fn(&mut Contract)| grace(&contract(change));
        assert_eq!(after(|_| {}), 4);
        // 1.075 m/s are gained in 3.6 periods; with jitter one period more; a response of 2.5 periods is over in the third.
        assert_eq!(after(|c| c.speed_error = 0.5), 7);
        assert_eq!(after(|c| c.jitter = 0.01), 4 + 1 + 1);
        assert_eq!(after(|c| c.latency = 0.25), 6);
        assert_eq!(after(|c| c.latency = 0.0), 4);
        // With that gain error only half of `go` is certain: twice as many periods.
        assert_eq!(after(|c| (c.speed_error, c.ego.gain) = (0.5, 0.5)), 4 + 7);
        // It lets its brakes go for 0.2 s · 3 / √2 / 3 m/s², after a response of 0.3 s.
        assert_eq!(after(|c| c.ego.lag = 0.2), 4 + 4);
    }

    const NOW: Instant = Instant::from_millis(1000);

    fn span(from: f32, to: f32) -> Span {
        Span { from, to }
    }

    #[test]
    fn one_arrives_between_two_moments() {
        let jitter = contract(|c| c.jitter = 0.01);
        let mut arrival = Arrival::default();
        let mut note = |from, to, now| {
            let rule = Precedence::ALL_WAY_STOP;
            (
                arrival.note(&jitter, rule, 50.0, span(from, to), now),
                arrival,
            )
        };
        let after = Some(Instant::from_millis(990));
        let by = Some(Instant::from_millis(1210));
        let at = |after, by| Arrival { after, by };
        assert_eq!(note(36.0, 37.9, NOW), (Arrived::Not, at(after, None)));
        assert_eq!(
            note(37.0, 38.0, NOW.plus(100_000)),
            (Arrived::Perhaps, at(after, None))
        );
        assert_eq!(
            note(38.0, 40.0, NOW.plus(200_000)),
            (Arrived::Surely, at(after, by))
        );
        assert_eq!(
            note(30.0, 31.0, NOW.plus(300_000)),
            (Arrived::Surely, at(after, by))
        );
    }

    #[test]
    fn who_goes_first_has_arrived_before_by_more_than_a_tie_or_has_the_right_of_way() {
        let between = |after: u64, by: u64| Arrival {
            after: Some(Instant::from_micros(after)),
            by: Some(Instant::from_micros(by)),
        };
        let first = between(50, 100);
        let goes = |other, right| first.goes_first(other, 10, right);
        assert!(goes(between(110, 120), false) && !goes(between(109, 120), false));
        assert!(goes(between(90, 120), true) && !goes(between(89, 120), true));
        let unseen = Arrival::default();
        assert!(!goes(unseen, true) && !goes(unseen, false) && !unseen.goes_first(first, 10, true));
        assert_eq!(first.earlier(between(130, 140)), Some(30));
        assert_eq!(first.earlier(between(70, 140)), Some(-30));
        assert_eq!(first.earlier(unseen), None);
    }

    #[test]
    fn rest_is_counted_since_arrival_and_ends_when_everybody_saw_a_move() {
        let mut rests = Standstill::default();
        let mut note = |rest, arrived| {
            rests.note(rest, arrived, 2);
            (rests.perhaps, rests.surely)
        };
        use {Arrived::*, RestState as Rest};
        assert_eq!(note(Rest::Surely, Arrived::Surely), (u16::MAX, 1));
        assert_eq!(note(Rest::Surely, Not), (0, 0));
        assert_eq!(note(Rest::Surely, Arrived::Perhaps), (1, 0));
        assert_eq!(note(Rest::Surely, Arrived::Surely), (2, 1));
        assert_eq!(note(Rest::Perhaps, Arrived::Surely), (3, 0));
        assert_eq!(note(Rest::Surely, Arrived::Surely), (4, 1));
        assert_eq!(note(Rest::No, Arrived::Surely), (5, 0));
        assert_eq!(note(Rest::No, Arrived::Surely), (0, 0));
        assert_eq!(note(Rest::No, Arrived::Surely), (0, 0));
        assert_eq!(note(Rest::Perhaps, Arrived::Surely), (1, 0));
    }

    #[test]
    fn a_second_look_within_a_period_takes_away_what_was_sure() {
        let rested = |rest| {
            let mut presence = Presence::default();
            presence.standstill.surely = 7;
            presence.note_again(rest);
            presence.rested()
        };
        assert_eq!(rested(RestState::Surely), [u16::MAX, 7]);
        assert_eq!(rested(RestState::Perhaps), [u16::MAX, 0]);
    }

    proptest::proptest! {
        /// So that where somebody is need be noted only once for all periods without a call.
        #[test]
        fn a_place_that_is_noted_again_changes_nothing(
            places in proptest::collection::vec((0.0_f32..80.0, 0.0_f32..2.0), 1..8),
        ) {
            let mut presence = Presence::default();
            for (i, (s, error)) in (1_u64..).zip(places) {
                let (s, now) = (Some(span(s - error, s + error)), Instant::from_millis(100 * i));
                let rule = Precedence::ALL_WAY_STOP;
                let mut note = || {
                    let arrived = presence.arrive((&Contract::ALL_WAY_STOP, rule), 50.0, s, now);
                    (arrived, presence)
                };
                proptest::prop_assert_eq!(note(), note());
            }
        }
    }

    #[test]
    fn one_that_is_not_seen_has_arrived_if_it_had_before() {
        let unseen = Sighting {
            s: None,
            rest: RestState::Surely,
        };
        let noted = |mut presence: Presence| {
            presence.note(
                &Contract::ALL_WAY_STOP,
                Precedence::ALL_WAY_STOP,
                50.0,
                unseen,
                NOW,
            );
            presence.rested()
        };
        assert_eq!(noted(Presence::default()), [u16::MAX, 0]);
        let mut there = Presence::default();
        there.arrival.by = Some(NOW);
        assert_eq!(noted(there), [u16::MAX, 1]);
    }

    /// By what it arrived earlier and what it has rested longer, both together more than a period.
    #[test]
    fn who_came_first_has_arrived_and_rested_a_period_before() {
        let presence = |after: u64, by: u64, perhaps, surely| Presence {
            arrival: Arrival {
                after: Some(Instant::from_micros(after)),
                by: Some(Instant::from_micros(by)),
            },
            standstill: Standstill {
                perhaps,
                surely,
                moved: 0,
            },
        };
        let other = presence(1000, 1100, 3, 2);
        let first = |by, surely| presence(0, by, 9, surely).first(other, 100);
        assert!(first(899, 3) && !first(900, 3));
        assert!(first(1099, 5) && !first(1100, 5));
        assert!(first(699, 1) && !first(700, 1));
    }
}
