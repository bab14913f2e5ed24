use super::super::hazard::{Passage, granted};
use super::super::rules::Sound;
use super::*;
use crate::geometry::{Footprint, Point, Pose, unit};
use crate::junction::route::Route;
use crate::junction::scene::Path;
use crate::junction::zone::MAX_ZONES;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use std::vec::Vec;

#[test]
fn the_first_goes_first_and_a_tie_is_the_right_of_ways() {
    use RightOfWay::{Ego, Other, Unsettled};
    let first = |ego, other, right_of_way| precedes(ego, other, 5, right_of_way);
    assert!(first(17, 10, Other));
    assert!(!first(10, 17, Ego));
    assert!(first(10, 12, Ego));
    assert!(!first(12, 10, Unsettled));
    assert!(first(90, 0, Unsettled));
    assert!(!first(0, 0, Ego));
    // One period beyond a tie is the right of way's if it came first, and nobody's if it came second.
    assert!(first(16, 10, Ego) && !first(10, 16, Other));
    assert!(!first(10, 16, Ego) && !first(16, 10, Other));
}

#[test]
fn a_pair_takes_eighteen_bytes() {
    assert_eq!(size_of::<PairMemory>(), 18);
}

const ROAD: [(f32, f32); 2] = [(-60.0, 0.0), (60.0, 0.0)];
const CROSSROAD: [(f32, f32); 2] = [(0.0, -60.0), (0.0, 60.0)];
/// Where both come to the crossing.
const LINE: f32 = 60.0 - 3.52;

fn scene(ego: [(f32, f32); 2], other: [(f32, f32); 2], right_of_way: RightOfWay) -> Scene<1> {
    let route =
        |points: [(f32, f32); 2]| Route::<2>::new(points.map(|(x, y)| Point::new(x, y))).unwrap();
    let (ego, other) = (route(ego), route(other));
    let path = |route| Path {
        route,
        footprint: Footprint::PAPER,
    };
    let mut scene = Scene::new(path(&ego), &[path(&other)]).unwrap();
    scene.set_right_of_way(0, right_of_way);
    scene
}

fn vehicle([s, speed]: [f32; 2]) -> Vehicle {
    let pose = Pose {
        position: Point::new(0.0, 0.0),
        direction: unit(1.0, 0.0),
    };
    Vehicle { s, speed, pose }
}

/// Two shields that watch the same two vehicles.
struct Watchers {
    contract: Contract,
    scenes: [Scene<1>; 2],
    memories: [Precedences<1>; 2],
}

impl Watchers {
    fn new(contract: Contract, [one, two]: [RightOfWay; 2]) -> Self {
        Self {
            contract,
            scenes: [scene(ROAD, CROSSROAD, one), scene(CROSSROAD, ROAD, two)],
            memories: [Precedences::new(), Precedences::new()],
        }
    }

    /// What each claims, when number `i` sees the arc lengths and speeds `seen[i]` of both, or nothing.
    fn claims<R: Rules>(&mut self, seen: [Option<[[f32; 2]; 2]>; 2]) -> [Claim; 2] {
        let rule = self.contract.precedence.unwrap();
        [0, 1].map(|i| {
            let memory = &mut self.memories[i];
            let Some(states) = seen[i] else {
                memory.blind::<R>(&self.contract, rule);
                return Claim::default();
            };
            let (ego, other) = (vehicle(states[i]), vehicle(states[1 - i]));
            let seen = Observation {
                ego,
                others: [Some(other)],
            };
            let claims = memory.note::<R>(&self.contract, rule, &self.scenes[i], &seen);
            let zone = self.scenes[i].conflicts()[0].zones().next().unwrap();
            let passage = Passage::Before {
                distance: 0.0,
                speed: 0.0,
            };
            let granted = granted(&self.contract, passage, zone, (&ego, &other));
            Claim {
                turn: claims.has(0, MAX_ZONES as u8),
                relies: claims.has(0, 0) && granted,
            }
        })
    }
}

/// What one of the two claims.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Claim {
    /// Every zone, because it goes first or has its turn.
    turn: bool,
    /// The one zone that there is, into which the other need not go: nobody else may rely on it.
    relies: bool,
}

fn contract(patience: u16) -> Contract {
    let mut contract = Contract::ALL_WAY_STOP;
    contract.precedence = contract.precedence.map(|p| Precedence { patience, ..p });
    contract
}

/// Who claims precedence, period by period, while the first rests at its line from the beginning and the
/// second from period `later` on; `.` is nobody.
fn turns(patience: u16, rights: [RightOfWay; 2], later: u16, periods: u16) -> std::string::String {
    let mut watchers = Watchers::new(contract(patience), rights);
    (0..periods)
        .map(|k| {
            let second = if k < later { 1.0 } else { 0.0 };
            let states = [[LINE, 0.0], [LINE - 5.0, second]];
            match watchers.claims::<Sound>([Some(states); 2]).map(|c| c.turn) {
                [true, false] => 'a',
                [false, true] => 'b',
                [false, false] => '.',
                [true, true] => '!',
            }
        })
        .collect()
}

#[test]
fn while_both_rest_precedence_goes_round() {
    use RightOfWay::{Ego, Other, Unsettled};
    assert_eq!(
        turns(8, [Ego, Other], 3, 44),
        "aaaaaaaaaa....bbbb....aaaaaaaaaaaa....bbbbbb"
    );
    // Who arrived together and rests since the same period has nothing to go by.
    assert_eq!(turns(8, [Unsettled; 2], 0, 60), ".".repeat(60));
    assert_eq!(
        turns(8, [Unsettled; 2], 3, 28),
        "..............bbbb....aaaaaa"
    );
    assert_eq!(turns(0, [Ego, Other], 3, 30), "a".repeat(30));
}

#[test]
fn who_stands_in_the_zone_keeps_it() {
    let mut watchers = Watchers::new(contract(8), [RightOfWay::Ego, RightOfWay::Other]);
    let claims: Vec<[Claim; 2]> = (0..30)
        .map(|_| watchers.claims::<Sound>([Some([[LINE + 1.0, 0.0], [LINE - 0.1, 0.0]]); 2]))
        .collect();
    // The other has its turn, but there is no way for it.
    assert!(claims.iter().all(|[one, two]| one.relies && !two.relies));
    assert!(claims.iter().any(|[one, two]| !one.turn && two.turn));
}

#[test]
fn when_the_periods_are_not_counted_any_more_nobody_has_precedence() {
    let long = turns(15, [RightOfWay::Unsettled; 2], 3, u16::MAX);
    assert!(!long.contains('!') && long.len() == 65_535);
    let mut watchers = Watchers::new(contract(15), [RightOfWay::Ego, RightOfWay::Other]);
    let last = (0..70_000)
        .map(|_| watchers.claims::<Sound>([Some([[LINE, 0.0]; 2]); 2]))
        .last();
    assert_eq!(last, Some([Claim::default(); 2]));
}

/// What a vehicle does for how many periods.
type Manner = (u16, f32);

fn manners() -> impl Strategy<Value = Vec<Manner>> {
    let rests = (1_u16..60, Just(-3.0_f32));
    let drives = (1_u16..4, -3.0_f32..3.0);
    prop::collection::vec(prop_oneof![rests, drives], 1..25)
}

/// States after each period.
fn motion(start: f32, manners: &[Manner]) -> Vec<[f32; 2]> {
    let (mut s, mut v) = (start, 0.0_f32);
    let mut states = Vec::new();
    for &(periods, a) in manners {
        for _ in 0..periods {
            let next = (v + 0.1 * a).max(0.0);
            s += 0.05 * (v + next);
            v = next;
            states.push([s, v]);
        }
    }
    states
}

#[derive(Debug)]
struct Story {
    contract: Contract,
    rights: [RightOfWay; 2],
    motions: [Vec<[f32; 2]>; 2],
    seed: u64,
}

prop_compose! {
    fn story()(
        patience in 5_u16..30, error in prop_oneof![Just(0.0_f32), 0.0_f32..0.5],
        right in 0_usize..3, starts in [-25.0_f32..3.0, -25.0_f32..3.0],
        manners in [manners(), manners()], seed in any::<u64>(),
    ) -> Story {
        use RightOfWay::{Ego, Other, Unsettled};
        Story {
            contract: Contract { speed_error: error, ..contract(patience) },
            rights: [[Ego, Other], [Other, Ego], [Unsettled; 2]][right],
            motions: [0, 1].map(|i| motion(LINE + starts[i], &manners[i])),
            seed,
        }
    }
}

/// Whether at some time both have precedence, or both rely on it, or one does though the other, seen at rest all the while,
/// did so within the last two periods. The second one sees everything up to a period late, and now and then
/// not at all what the first one sees in between; both err about speeds.
fn both<R: Rules>(story: &Story) -> bool {
    let mut watchers = Watchers::new(story.contract, story.rights);
    let mut random = story.seed | 1;
    let mut draw = move || {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        (random >> 40) as f32 / (1_u32 << 24) as f32
    };
    let length = story.motions[0].len().min(story.motions[1].len());
    let (mut turns, mut reliance) = (History::new(), History::new());
    (0..length).any(|k| {
        let mut see = |k: usize| {
            let error = story.contract.speed_error;
            [0, 1].map(|i| {
                let [s, v] = story.motions[i][k];
                [s, (v + error * (2.0 * draw() - 1.0)).max(0.0)]
            })
        };
        let (prompt, fresh, stale) = (see(k), see(k), see(k.saturating_sub(1)));
        let late = if draw() < 0.5 { fresh } else { stale };
        let claims = watchers.claims::<R>([Some(prompt), Some(late)]);
        let clash = turns.clashes(claims.map(|claim| claim.turn));
        reliance.clashes(claims.map(|claim| claim.relies)) || clash
    })
}

/// What each of two has had.
struct History {
    had: [bool; 2],
    /// Periods since each has lost it.
    lost: [u16; 2],
}

impl History {
    fn new() -> Self {
        Self {
            had: [false; 2],
            lost: [u16::MAX; 2],
        }
    }

    /// Whether both have it, or one gets what the other has just lost.
    fn clashes(&mut self, has: [bool; 2]) -> bool {
        for i in [0, 1] {
            self.lost[i] = match (self.had[i], has[i]) {
                (_, true) => 0,
                (true, false) => 1,
                (false, false) => self.lost[i].saturating_add(1),
            };
        }
        let gained = [0, 1].map(|i| has[i] && !self.had[i]);
        self.had = has;
        has == [true; 2] || (gained[0] && self.lost[1] < 3) || (gained[1] && self.lost[0] < 3)
    }
}

proptest! {
    #[test]
    fn at_most_one_goes_first(a in 0_u16..40, b in 0_u16..40, skew in 0_u16..2, tie in 0_u16..10) {
        let one = precedes(a, b, tie, RightOfWay::Ego);
        // The other one may count a period more.
        let b = if b > 0 { b + skew } else { 0 };
        prop_assert!(!(one && precedes(b, a, tie, RightOfWay::Other)));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn never_both_have_precedence(story in story()) {
        prop_assert!(!both::<Sound>(&story));
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

fn caught<R: Rules>() -> bool {
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let mut story = || story().new_tree(&mut runner).unwrap().current();
    (0..3000).any(|_| both::<R>(&story()))
}

#[test]
fn a_turn_that_begins_when_the_other_ends_is_caught() {
    assert!(caught::<NoGrace>());
}

#[test]
fn a_turn_that_does_not_end_is_caught() {
    assert!(caught::<Endless>());
}
