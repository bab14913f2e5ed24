//! What the shield remembers of the ego from one decision to the next: its plan, its commands, where it was.

use super::actuation::{Commands, Inherited};
use super::bounds::Bounds;
use super::contract::Contract;
use super::margin;
use super::own::Own;
use super::reach::Reach;
use crate::headroom::Room;
use crate::instant::{Instant, micros};
use crate::junction::zone::Span;
use crate::observation::Vehicle;
use crate::plan::Plan;
use crate::real::Real;

/// What is left of the plan that was verified last.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Remembered {
    plan: Plan,
    /// When it was verified.
    at: Instant,
    /// Calls since then.
    calls: u32,
}

/// The plan that was verified last, the commands given, and where the ego was.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    remembered: Option<Remembered>,
    commands: Commands,
    /// Where the ego was seen last: what every observation says, carried on by what its commands lead to; and when.
    last: Option<(Bounds, Instant)>,
    /// Arc length (m), at least, of the ego when it was seen last.
    least: f32,
    /// Calls since `last`.
    blind: u16,
}

impl Memory {
    pub(crate) const fn new() -> Self {
        Self {
            remembered: None,
            commands: Commands::unknown(),
            last: None,
            least: f32::NEG_INFINITY,
            blind: 0,
        }
    }

    /// What is left of the last verified plan. None if there is none, or if it is void.
    pub(crate) fn plan(&self) -> Option<Plan> {
        self.remembered.map(|remembered| remembered.plan)
    }

    /// A plan is verified at `now` against everybody.
    pub(crate) fn verified(&mut self, plan: Plan, now: Instant) {
        self.remembered = Some(Remembered {
            plan,
            at: now,
            calls: 0,
        });
    }

    /// What is left of the plan holds from `now` on, whenever it was verified.
    pub(crate) fn confirmed(&mut self, now: Instant) {
        if let Some(remembered) = &mut self.remembered {
            remembered.at = now;
            remembered.calls = 0;
        }
    }

    pub(crate) fn void(&mut self) {
        self.remembered = None;
    }

    /// One command of the plan was carried out.
    pub(crate) fn shorten(&mut self, tail: impl Fn(Plan) -> Plan) {
        if let Some(remembered) = &mut self.remembered {
            remembered.plan = tail(remembered.plan);
        }
    }

    /// Another call at `now`. Whether the plan's commands have been given at the times that it counts on.
    pub(crate) fn call(&mut self, contract: &Contract, now: Instant) -> bool {
        self.blind = self.blind.saturating_add(1);
        let Some(remembered) = &mut self.remembered else {
            return true;
        };
        remembered.calls = remembered.calls.saturating_add(1);
        let due = u64::from(remembered.calls).saturating_mul(micros(contract.period));
        let away = now.since(remembered.at).abs_diff(due);
        // Half a microsecond a period, from rounding the period.
        // The call that verified it was itself up to one jitter off the grid, and so is this one.
        away <= (2 * micros(contract.jitter)).saturating_add(1 + u64::from(remembered.calls))
    }

    /// What acts on the ego until the command to be given at `now` is followed.
    pub(crate) fn inherited(&self, contract: &Contract, now: Instant) -> Inherited<f32> {
        self.commands.inherited(contract, now)
    }

    pub(crate) fn command(&mut self, contract: &Contract, acceleration: f32, now: Instant) {
        self.commands.give(contract, acceleration, now);
    }

    /// What the commands given so far lead to, `contract` said; what they lead to from now on, another one.
    pub(crate) fn forget_commands(&mut self, contract: &Contract) {
        self.commands.forget(contract);
    }

    /// What was known of the ego says nothing about the next observation.
    pub(crate) fn forget_ego(&mut self) {
        self.last = None;
    }

    /// Notes where the ego is at `now`; and what is left until its commands cannot have brought it there, of its place and
    /// of its speed.
    pub(crate) fn note(
        &mut self,
        contract: &Contract,
        ego: &Vehicle,
        now: Instant,
    ) -> (Own, Option<[Room; 2]>) {
        let seen = Bounds::sensed(contract, ego.s, ego.speed);
        let expected = self.expected(contract, now);
        let common = expected.map(|expected| both(contract, expected, seen));
        let possible = common.filter(|&(_, rooms)| Room::hold(rooms));
        let unknown = common.is_none() || possible.is_some();
        let least = if unknown {
            self.least
        } else {
            f32::NEG_INFINITY
        };
        let own = Own::new(contract, ego, least);
        self.last = Some((possible.map_or(seen, |(bounds, _)| bounds), now));
        self.least = own.least;
        self.blind = 0;
        (own, common.map(|(_, rooms)| rooms))
    }

    /// Where the ego may be at `now`, and how fast, by when it was seen before.
    #[inline(never)] // Once in flash.
    fn expected(&self, contract: &Contract, now: Instant) -> Option<Bounds> {
        let (last, at) = self.last?;
        let time = now.seconds_since(at);
        let [least, most] = self.accelerations(contract);
        let cap = margin::unlimited(contract);
        let slow = Reach::start(last.speed.from).fading(cap, margin::fade::<f32>(contract) * time);
        let least = slow.at_least(least, cap, time);
        let most = Reach::start(last.speed.to).at_most(most, time);
        Some(Bounds {
            s: Span {
                from: last.s.from + least.distance,
                to: last.s.to + most.distance,
            },
            speed: Span {
                from: least.speed,
                to: most.speed,
            },
        })
    }

    /// The ego's speed (m/s), at least, if it is not seen at `now`.
    pub(crate) fn least_speed(&self, contract: &Contract, now: Instant) -> f32 {
        self.expected(contract, now)
            .map_or(0.0, |expected| expected.speed.from)
    }

    /// The ego's acceleration since it was seen last: least and most.
    fn accelerations(&self, contract: &Contract) -> [f32; 2] {
        if self.blind <= 1 {
            self.commands.since_last(contract)
        } else {
            self.commands.unknown_bounds(contract)
        }
    }
}

/// What is in both, and what is left of place and speed until that is empty by more than rounding.
fn both(contract: &Contract, expected: Bounds, seen: Bounds) -> (Bounds, [Room; 2]) {
    let common = |a: Span, b: Span| {
        let (from, to) = (Real::max(b.from, a.from), Real::min(b.to, a.to));
        let rounded = Span {
            from: Real::min(to, from),
            to: Real::max(from, to),
        };
        let most = Real::min(b.to - b.from, a.to - a.from) + contract.slack;
        (rounded, Room::of(to + contract.slack - from, most))
    };
    let (s, place) = common(expected.s, seen.s);
    let (speed, pace) = common(expected.speed, seen.speed);
    (Bounds { s, speed }, [place, pace])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shield::contract::tests::INEXACT;

    fn bounds(s: [f32; 2], speed: [f32; 2]) -> Bounds {
        let span = |[from, to]: [f32; 2]| Span { from, to };
        Bounds {
            s: span(s),
            speed: span(speed),
        }
    }

    fn near(room: Room, left: f32, most: f32) {
        let share = left / most;
        let near = (room.left - left).abs() < 1e-5 && (room.share - share).abs() < 1e-4;
        assert!(near, "{room:?}, {left} of {most}");
    }

    #[test]
    fn two_bounds_have_in_common_what_is_in_both_and_may_miss_each_other_by_the_slack() {
        let contract = Contract::builder().slack(0.05).build().unwrap();
        let common = |a, b| both(&contract, a, b);
        let seen = bounds([2.0, 5.0], [4.0, 6.0]);
        let (found, [place, pace]) = common(bounds([1.0, 3.0], [4.5, 5.0]), seen);
        assert_eq!(found, bounds([2.0, 3.0], [4.5, 5.0]));
        near(place, 1.05, 2.05);
        near(pace, 0.55, 0.55);
        // Apart by 4 cm, and by 6.
        let (found, [place, pace]) = common(bounds([5.04, 9.0], [3.0, 3.94]), seen);
        assert_eq!(found, bounds([5.0, 5.04], [3.94, 4.0]));
        near(place, 0.01, 3.05);
        near(pace, -0.01, 0.99);
        assert!(place.holds() && !pace.holds());
    }

    #[test]
    fn a_plan_is_followed_if_its_calls_come_in_time() {
        let on_time = |jitter: f32, micros: &[u64]| {
            let contract = Contract::builder().jitter(jitter).build().unwrap();
            let mut memory = Memory::new();
            memory.verified(Plan { go: 5 }, Instant::from_micros(1000));
            let calls = micros.iter().map(|&at| Instant::from_micros(1000 + at));
            calls.map(|now| memory.call(&contract, now)).last().unwrap()
        };
        assert!(on_time(0.0, &[100_002]) && on_time(0.0, &[99_998]));
        assert!(!on_time(0.0, &[100_003]) && !on_time(0.0, &[99_997]));
        assert!(on_time(0.0, &[100_000, 200_003]) && !on_time(0.0, &[100_000, 200_004]));
        assert!(on_time(0.01, &[120_002]) && !on_time(0.01, &[120_003]));
        assert!(Memory::new().call(&Contract::WORST_CASE, Instant::from_micros(5)));
    }

    #[test]
    fn a_plan_that_is_confirmed_is_in_time_from_then_on_and_one_that_is_void_is_none() {
        let contract = Contract::WORST_CASE;
        let at = Instant::from_millis;
        let mut memory = Memory::new();
        memory.verified(Plan { go: 5 }, at(0));
        memory.confirmed(at(30));
        memory.shorten(Plan::tail);
        assert_eq!(memory.plan(), Some(Plan { go: 4 }));
        assert!(memory.call(&contract, at(130)));
        memory.confirmed(at(130));
        assert!(memory.call(&contract, at(230)));
        memory.void();
        assert_eq!(memory.plan(), None);
    }

    /// The ego, 10 m along its path.
    fn ego(speed: f32) -> Vehicle {
        Vehicle {
            s: 10.0,
            speed,
            pose: crate::geometry::Pose {
                position: crate::geometry::Point::origin(),
                direction: crate::geometry::unit(1.0, 0.0),
            },
        }
    }

    #[track_caller]
    fn close(a: Bounds, b: Bounds) {
        let near = |a: f32, b: f32| (a - b).abs() < 1e-4;
        let spans = [(a.s, b.s), (a.speed, b.speed)];
        let same = spans
            .iter()
            .all(|(a, b)| near(a.from, b.from) && near(a.to, b.to));
        assert!(same, "{a:?}, {b:?}");
    }

    /// By what was commanded; by anything, if a call was missed.
    #[test]
    fn the_ego_is_expected_where_its_commands_lead() {
        let contract = Contract::builder()
            .position_error(0.5)
            .speed_error(0.2)
            .build()
            .unwrap();
        let at = Instant::from_millis;
        let mut memory = Memory::new();
        assert_eq!(memory.least_speed(&contract, at(0)), 0.0);
        for millis in [0, 100, 200, 300] {
            memory.call(&contract, at(millis));
            memory.command(&contract, 1.0, at(millis));
        }
        memory.note(&contract, &ego(8.0), at(300));
        memory.call(&contract, at(400));
        let expected = memory.expected(&contract, at(400)).unwrap();
        close(expected, bounds([9.5 + 0.785, 10.5 + 0.825], [7.9, 8.3]));
        assert!((memory.least_speed(&contract, at(400)) - 7.9).abs() < 1e-4);
        memory.call(&contract, at(500));
        let expected = memory.expected(&contract, at(500)).unwrap();
        close(expected, bounds([9.5 + 1.5, 10.5 + 1.7], [7.2, 8.8]));
        memory.forget_ego();
        assert_eq!(memory.expected(&contract, at(500)), None);
    }

    /// Faster than it certainly goes, an inexact ego may slow down when it goes: by 4/3 m/s² at most, beside 8 m/s² of brakes.
    #[test]
    fn a_fast_ego_is_expected_to_give_way_to_what_nobody_commands() {
        let mut memory = Memory::new();
        let at = Instant::from_millis;
        memory.note(&INEXACT, &ego(12.0), at(0));
        let expected = memory.expected(&INEXACT, at(100)).unwrap();
        close(
            expected,
            bounds([9.8 + 1.136_67, 10.2 + 1.225], [10.966_67, 12.4]),
        );
    }

    #[test]
    fn what_the_ego_has_passed_it_has_passed_unless_it_is_not_where_its_commands_lead() {
        let contract = Contract::builder().position_error(0.5).build().unwrap();
        let least = |then: Vehicle| {
            let mut memory = Memory::new();
            let at = Instant::from_millis;
            let (first, none) = memory.note(&contract, &ego(0.0), at(0));
            assert_eq!((first.least, none), (9.5, None));
            let (own, rooms) = memory.note(&contract, &then, at(100));
            (own.least, Room::hold(rooms.unwrap()))
        };
        let at = |s, speed| Vehicle { s, ..ego(speed) };
        assert_eq!(least(at(9.75, 0.0)), (9.5, true));
        assert_eq!(least(at(9.75, 5.0)), (9.25, false));
        assert_eq!(least(at(30.0, 0.0)), (29.5, false));
    }
}
