//! Never do two have precedence over each other, whatever their shields sense within the contract; and who has it when.

mod stories;
mod watcher;

use super::super::rules::Sound;
use super::super::waiting::{Arrival, Arrived, RestState, Sighting};
use super::*;
use crate::instant::Instant;
use crate::junction::zone::Span;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use std::string::String;
use stories::{Fault, both, story};
use watcher::{LINE, Watcher, contract};

/// A vehicle that certainly arrived between these two moments (ms), or is not known to.
fn arrival(after: Option<u64>, by: Option<u64>) -> Arrival {
    let contract = contract(0, 0);
    let rule = contract.precedence.unwrap();
    let mut presence = Presence::default();
    for (at, s) in [(after, 0.0), (by, LINE)] {
        if let Some(at) = at {
            let sighting = Sighting {
                s: Some(Span { from: s, to: s }),
                rest: RestState::No,
            };
            presence.note(&contract, rule, LINE, sighting, Instant::from_millis(at));
        }
    }
    presence.arrival
}

#[test]
fn the_first_goes_first_and_a_tie_is_the_right_of_ways() {
    let first = |one: Arrival, two, right| one.goes_first(two, 500_000, right);
    let at = |after, by| arrival(Some(after), Some(by));
    assert!(first(at(900, 1000), at(1500, 1600), false));
    assert!(!first(at(900, 1000), at(1499, 1600), false));
    // In a tie only the one with the right of way goes.
    assert!(first(at(1200, 1300), at(1000, 1100), true));
    assert!(!first(at(1000, 1100), at(1200, 1300), false));
    assert!(!first(at(1400, 1600), at(1000, 1100), true));
    // Without both moments nothing is known.
    assert!(!first(arrival(Some(900), None), at(1500, 1600), true));
    assert!(!first(at(900, 1000), arrival(None, Some(9000)), true));
    assert!(first(
        arrival(None, Some(1000)),
        arrival(Some(2000), None),
        false
    ));
}

#[test]
fn a_pair_takes_fifty_six_bytes_at_most() {
    assert!(size_of::<PairMemory>() <= 56);
}

/// Who claims precedence, period by period, while the first rests at its line from the beginning and the
/// second from period `later` on; `.` is nobody.
fn turns(patience: u16, rights: [RightOfWay; 2], later: u16, periods: u32) -> String {
    let contract = contract(patience, 5);
    let mut watchers = rights.map(|right| Watcher::new(contract, right));
    // Both are seen on their way at first.
    let states = |period: u32| {
        let second = if period < u32::from(later) { 1.0 } else { 0.0 };
        [[LINE, 0.0], [LINE - 5.0, second]]
    };
    let away = [[LINE - 40.0, 9.0]; 2];
    let mut claims = |states: [[f32; 2]; 2], period: u32| {
        let now = Instant::from_millis(1000 + 100 * u64::from(period));
        [0, 1].map(|i| {
            watchers[i].call::<Sound>(states.map(Some), i, now);
            watchers[i].claims == ALL
        })
    };
    claims(away, 0);
    let mut said = |period| match claims(states(period), period + 1) {
        [true, false] => 'a',
        [false, true] => 'b',
        [false, false] => '.',
        [true, true] => '!',
    };
    (0..periods).map(&mut said).collect()
}

#[test]
fn while_both_rest_precedence_goes_round() {
    use RightOfWay::{Ego, Other, Unsettled};
    assert_eq!(
        turns(8, [Ego, Other], 3, 44),
        "aaaaaaaa......bb......bbbbbbbbbb......aaaaaa"
    );
    // Who arrived together and rests since the same period has nothing to go by.
    assert_eq!(turns(8, [Unsettled; 2], 0, 60), ".".repeat(60));
    assert_eq!(
        turns(8, [Unsettled; 2], 3, 28),
        "..............bb......bbbbbb"
    );
    assert_eq!(turns(0, [Ego, Other], 3, 30), "a".repeat(30));
}

#[test]
fn who_rests_to_the_end_of_its_turn_does_not_set_off_any_more() {
    use RightOfWay::{Ego, Other};
    // The last three periods are nobody's, of what an arrival gives, 14, and of a turn, 11; with a patience of 40, all in
    // which others might not have seen it move yet.
    let first = |patience| turns(patience, [Ego, Other], 0, 3 * u32::from(patience));
    let count = |said: &str, whose| said.matches(whose).count();
    let (short, long) = (first(15), first(40));
    assert_eq!(
        [count(&short, "a"), count(&short, "b")],
        [14 - 3, 11 - 3 + 12]
    );
    let sets_off = usize::from(sets_off(&contract(40, 5)));
    assert_eq!(count(&long, "a"), 39 - sets_off);
}

#[test]
fn who_has_set_off_keeps_its_turn_to_the_end() {
    let contract = contract(8, 5);
    let mut ego = Watcher::new(contract, RightOfWay::Ego);
    let now = |period: u64| Instant::from_millis(1000 + 100 * period);
    ego.call::<Sound>([Some([LINE - 40.0, 9.0]); 2], 0, now(0));
    let mut claims = |speed, period| {
        ego.call::<Sound>(
            [Some([LINE, speed]), Some([LINE - 5.0, 0.0])],
            0,
            now(period),
        );
        ego.claims == ALL
    };
    let speeds = [0.0, 0.0, 0.0, 0.0, 0.0, 0.9, 1.2, 1.5, 1.8];
    assert!(
        speeds
            .into_iter()
            .zip(1..)
            .all(|(speed, period)| claims(speed, period))
    );
    // Had it rested, it would have nothing left.
    assert!(!turns(8, [RightOfWay::Ego, RightOfWay::Other], 0, 8).ends_with('a'));
}

#[test]
fn who_stands_in_the_zone_keeps_it() {
    let contract = contract(8, 5);
    let mut watchers =
        [RightOfWay::Ego, RightOfWay::Other].map(|right| Watcher::new(contract, right));
    let mut turned = false;
    for period in 0..40 {
        let now = Instant::from_millis(1000 + 100 * period);
        let states = match period {
            0 => [[LINE - 40.0, 9.0]; 2],
            _ => [[LINE + 1.0, 0.0], [LINE - 0.1, 0.0]],
        };
        let [one, two] = [0, 1].map(|i| {
            watchers[i].call::<Sound>(states.map(Some), i, now);
            watchers[i].claims
        });
        turned |= two == ALL;
        // The other has its turn, but there is no way for it.
        assert!(period < 6 || has(one, 0), "{period}");
    }
    assert!(turned);
}

#[test]
fn when_the_periods_are_not_counted_any_more_nobody_has_precedence() {
    let long = turns(15, [RightOfWay::Unsettled; 2], 3, 70_000);
    assert!(!long.contains('!'));
    assert!(long.ends_with(&".".repeat(4000)));
    let long = turns(15, [RightOfWay::Ego, RightOfWay::Other], 3, 70_000);
    assert!(!long.contains('!'));
    assert!(long.ends_with(&".".repeat(4000)));
}

#[test]
fn who_starts_at_rest_takes_no_turns() {
    let contract = contract(8, 5);
    let mut watcher = Watcher::new(contract, RightOfWay::Ego);
    for period in 0..300 {
        let now = Instant::from_millis(1000 + 100 * period);
        watcher.call::<Sound>([Some([LINE, 0.0]); 2], 0, now);
        assert_eq!(watcher.claims, 0);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn never_both_have_precedence(story in story()) {
        prop_assert!(!both::<Sound>(&story, Fault::None));
    }
}

fn arrived() -> impl Strategy<Value = Arrived> {
    prop_oneof![
        Just(Arrived::Not),
        Just(Arrived::Perhaps),
        Just(Arrived::Surely)
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn periods_without_a_call_count_as_if_each_was_noted(
        patience in prop_oneof![Just(0_u16), 5_u16..40],
        before in prop::collection::vec((0_usize..3, 0_usize..3), 0..60),
        unknown in any::<bool>(),
        (here, there) in (arrived(), arrived()),
        periods in 0_u16..20,
        right in 0_usize..3,
    ) {
        let contract = contract(patience, 5);
        let rule = contract.precedence.unwrap();
        let right = Right {
            of_way: [RightOfWay::Ego, RightOfWay::Other, RightOfWay::Unsettled][right],
            priority: [Priority::FirstCome, Priority::Unsigned, Priority::Signed][right],
            in_turns: RightOfWay::Ego,
        };
        let rests = [RestState::No, RestState::Perhaps, RestState::Surely];
        let (mut ego, mut pair) = (Presence::default(), PairMemory::default());
        let note = |ego: &mut Presence, pair: &mut PairMemory, [mine, its]: [RestState; 2], [here, there]: [Arrived; 2]| {
            ego.stay(&contract, mine, here);
            pair.other.stay(&contract, its, there);
            pair.pass::<Sound>(&contract, rule, right, ego);
        };
        if !unknown {
            note(&mut ego, &mut pair, [RestState::No; 2], [Arrived::Not; 2]);
        }
        for (mine, its) in before {
            note(&mut ego, &mut pair, [rests[mine], rests[its]], [Arrived::Surely; 2]);
        }
        let (mut missed, mut each, own) = (pair, pair, ego);
        missed.miss::<Sound>(rule, right, (&own, here), there, periods);
        for _ in 0..periods {
            note(&mut ego, &mut each, [RestState::Perhaps; 2], [here, there]);
        }
        let mut own = own;
        own.miss(here, periods);
        prop_assert_eq!(missed, each);
        prop_assert_eq!(own, ego);
    }
}

struct NoGrace;
impl Rules for NoGrace {
    fn grace(_: &Contract) -> u16 {
        0
    }
}

struct Endless;
impl Rules for Endless {
    fn ends(_: u16, _: u16, _: u16, _: u16) -> bool {
        false
    }
}

fn caught<R: Rules>(fault: Fault) -> bool {
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let mut story = || story().new_tree(&mut runner).unwrap().current();
    (0..6000).any(|_| both::<R>(&story(), fault))
}

#[test]
fn a_turn_that_begins_when_the_other_ends_is_caught() {
    assert!(caught::<NoGrace>(Fault::None));
}

#[test]
fn a_turn_that_does_not_end_is_caught() {
    assert!(caught::<Endless>(Fault::None));
}

#[test]
fn errors_of_sensed_places_beyond_the_contract_are_caught() {
    assert!(caught::<Sound>(Fault::Places));
}

#[test]
fn errors_of_sensed_speeds_beyond_the_contract_are_caught() {
    assert!(caught::<Sound>(Fault::Speeds));
}

#[test]
fn a_late_shield_that_takes_everybody_for_one_that_just_moved_is_caught() {
    assert!(caught::<Sound>(Fault::Late));
}

#[test]
fn periods_without_a_call_that_are_not_counted_are_caught() {
    assert!(caught::<Sound>(Fault::Missed));
}

#[test]
fn motion_that_may_have_been_a_rest_in_between_is_caught() {
    assert!(caught::<Sound>(Fault::Motion));
}

#[test]
fn a_set_has_the_zones_of_its_bits() {
    assert_eq!(
        [0, 1, 2, 7, 8, 255].map(|zone| has(0b1000_0101, zone)),
        [true, false, true, true, false, false]
    );
}

/// It has stood for five periods, one more than the grace, in each of which it may have crept 0.384 m/s.
#[test]
fn who_stands_in_a_crossing_holds_it() {
    use crate::junction::ConflictKind;
    let contract = Contract::ALL_WAY_STOP
        .to_builder()
        .speed_error(0.1)
        .position_error(0.3);
    let contract = contract.build().unwrap();
    let span = |from, to| Span { from, to };
    let zone = |from, kind| Zone {
        ego: span(from, from + 8.0),
        other: span(40.0, 48.0),
        lead: span(-20.0, 20.0),
        kind,
    };
    let zones = [
        zone(50.0, ConflictKind::Merging),
        zone(50.0, ConflictKind::Crossing),
        zone(54.0, ConflictKind::Crossing),
    ];
    let held = |s: f32, [mine, theirs]: [u16; 2]| {
        let mut pair = PairMemory::default();
        let mut ego = Presence::default();
        (ego.standstill.surely, pair.other.standstill.surely) = (mine, theirs);
        pair.hold::<Sound>(&contract, &ego, zones.iter(), s);
        let right = Right {
            of_way: RightOfWay::Other,
            priority: Priority::FirstCome,
            in_turns: RightOfWay::Other,
        };
        pair.claims(&contract, Precedence::ALL_WAY_STOP, right, &ego)
    };
    let crept = 0.5 * (0.075 + 0.2 + 0.5 * 0.1 * 24.0 / 11.0) + 0.3;
    assert_eq!(held(50.0 + crept - 0.002, [5, 5]), 0);
    assert_eq!(held(50.0 + crept + 0.002, [5, 5]), 0b010);
    assert_eq!(held(56.0, [5, 5]), 0b110);
    assert_eq!(held(57.99, [9, 5]), 0b110);
    assert_eq!(held(58.0, [5, 9]), 0b100);
    assert_eq!(held(62.0, [5, 5]), 0);
    assert_eq!([held(56.0, [4, 5]), held(56.0, [5, 4])], [0, 0]);
}

/// A tie is up to six periods, one more than the rule says.
#[test]
fn who_came_first_has_precedence_and_in_a_tie_whoever_has_the_right_of_way() {
    let contract = contract(0, 5);
    let goes = |of_way, mine: [u64; 2], theirs: [u64; 2]| {
        let [mine, theirs] = [mine, theirs].map(|[after, by]| arrival(Some(after), Some(by)));
        let (mut pair, mut ego) = (PairMemory::default(), Presence::default());
        pair.turn = Turn::First;
        (ego.arrival, pair.other.arrival) = (mine, theirs);
        let right = Right {
            of_way,
            priority: Priority::FirstCome,
            in_turns: RightOfWay::Unsettled,
        };
        pair.claims(&contract, contract.precedence.unwrap(), right, &ego) == ALL
    };
    use RightOfWay::{Ego, Other, Unsettled};
    for right in [Other, Unsettled] {
        assert!(goes(right, [900, 1000], [1600, 1700]));
        assert!(!goes(right, [900, 1000], [1599, 1700]));
    }
    assert!(goes(Ego, [1500, 1600], [1000, 1100]));
    assert!(!goes(Ego, [1500, 1601], [1000, 1100]));
}

/// Whether the ego, which comes second, gets the turn that begins after it has surely rested for so many periods, if the
/// two have perhaps rested for these.
fn gets_its_turn(in_turns: RightOfWay, surely: u16, perhaps: [u16; 2]) -> bool {
    let contract = contract(8, 5);
    let (mut pair, mut ego) = (PairMemory::default(), Presence::default());
    pair.turn = Turn::First;
    let [mine, theirs] = perhaps;
    (ego.arrival, pair.other.arrival) = (
        arrival(Some(80_000_000), Some(80_000_100)),
        arrival(Some(1000), Some(1100)),
    );
    for (standstill, perhaps) in [
        (&mut ego.standstill, mine),
        (&mut pair.other.standstill, theirs),
    ] {
        (standstill.perhaps, standstill.surely) = (perhaps, surely);
    }
    let right = Right {
        of_way: RightOfWay::Other,
        priority: Priority::FirstCome,
        in_turns,
    };
    pair.pass::<Sound>(&contract, contract.precedence.unwrap(), right, &ego);
    pair.turn == Turn::Ego
}

#[test]
fn turns_are_counted_from_a_rest_that_is_known() {
    use RightOfWay::{Other, Unsettled};
    const NEVER: u16 = u16::MAX;
    // A patience of eight periods, and a grace of four.
    for in_turns in [Other, Unsettled] {
        assert!(gets_its_turn(in_turns, 12, [12, 12]));
        assert!(!gets_its_turn(in_turns, 11, [12, 12]) && !gets_its_turn(in_turns, 13, [13, 13]));
        // Of either, if there is an order; without one, of both.
        for perhaps in [[12, NEVER], [NEVER, 12]] {
            assert_eq!(
                gets_its_turn(in_turns, 12, perhaps),
                in_turns == Other,
                "{perhaps:?}"
            );
        }
        // 65535 periods are in the turn that begins after 32768.
        assert!(!gets_its_turn(in_turns, 32_772, [NEVER; 2]));
    }
}
