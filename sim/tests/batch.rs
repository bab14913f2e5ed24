//! The batch stepper against the plain, one-vehicle-at-a-time path through the same encounters.

mod scenes;

use cede_controller::Footprint;
use cede_controller::kinematics::{State, advance, clamp_acceleration};
use cede_controller::policy::svo::svo;
use cede_controller::separation::OrientedBox;
use cede_data::{Dataset, Encounter, Role};
use cede_sim::batch::{Batch, Block, LANES, Library, LibraryError, Outcome};
use cede_sim::episode::{End, Episode};
use cede_sim::reward::{COLLISION, EpisodeLength, svo_deviation};
use cede_sim::{Driver, View};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::collections::HashSet;
use std::f32::consts::FRAC_PI_4;

fn library(encounters: &[Encounter]) -> Library {
    Library::new(encounters, Footprint::PAPER).unwrap()
}

/// One encounter, stepped without the batch.
struct Plain<'a> {
    encounter: &'a Encounter,
    states: [State; 2],
    svo: f32,
    recorded_svo: Vec<f32>,
    step: u32,
    earned: f32,
}

impl<'a> Plain<'a> {
    fn new(encounter: &'a Encounter) -> Self {
        let [left, other] = [0, 1].map(|i| &encounter.participants[i]);
        let mut last = FRAC_PI_4;
        let recorded_svo = (0..=encounter.steps as usize)
            .map(|step| {
                let (a, b) = (left.record[step], other.record[step]);
                last = svo(
                    a.v,
                    left.conflict_s - a.s,
                    b.v,
                    other.conflict_s - b.s,
                    last,
                );
                last
            })
            .collect();
        let start = |i: usize| {
            let first = encounter.participants[i].record[0];
            State {
                s: first.s,
                v: first.v,
            }
        };
        let mut plain = Self {
            encounter,
            states: [start(0), start(1)],
            svo: FRAC_PI_4,
            recorded_svo,
            step: 0,
            earned: 0.0,
        };
        plain.svo = plain.current_svo();
        plain
    }

    fn distance(&self, role: usize) -> f32 {
        self.encounter.participants[role].conflict_s - self.states[role].s
    }

    fn current_svo(&self) -> f32 {
        let [a, b] = self.states;
        svo(a.v, self.distance(0), b.v, self.distance(1), self.svo)
    }

    /// The reward and whether the vehicles touch.
    fn advance(&mut self, accelerations: [f32; 2]) -> (f32, bool) {
        self.states = [0, 1].map(|i| advance(self.states[i], clamp_acceleration(accelerations[i])));
        self.step += 1;
        self.svo = self.current_svo();
        let [a, b] = [0, 1].map(|i| {
            let pose = self.encounter.participants[i].route.pose(self.states[i].s);
            OrientedBox::new(pose, Footprint::PAPER)
        });
        let touch = a.overlaps(&b);
        let arrived = self.distance(0) <= 0.0 || self.distance(1) <= 0.0;
        let deviation = if arrived {
            0.0
        } else if self.step < self.encounter.steps {
            svo_deviation(self.svo, self.recorded_svo[self.step as usize])
        } else {
            0.5
        };
        let reward = -deviation + if touch { COLLISION } else { 0.0 };
        self.earned += reward;
        (reward, touch)
    }
}

/// Every state, pose, distance, SVO, reward and outcome, over random accelerations.
#[test]
fn a_block_does_what_the_plain_path_does() {
    let encounters = scenes::encounters(60, 2, 1);
    let library = library(&encounters);
    let mut block = Block::<2>::new(&library, 2, 0);
    let mut random = Pcg64::seed_from_u64(3);
    let mut seen = std::collections::HashMap::<_, u32>::new();
    let mut plain: Vec<_> = (0..LANES)
        .map(|lane| Plain::new(&encounters[block.encounter(lane)]))
        .collect();
    for _ in 0..20_000 {
        let bias: f32 = random.random_range(-1.5..2.0);
        let mut asked = || [0.0; LANES].map(|_: f32| bias + random.random_range(-2.5..2.5));
        let accelerations = [asked(), asked()];
        block.advance(&library, &accelerations);
        for (lane, plain) in plain.iter_mut().enumerate() {
            let (reward, touch) = plain.advance([0, 1].map(|i: usize| accelerations[i][lane]));
            for role in [Role::Left, Role::Other] {
                let (motion, state) = (
                    &block.vehicles()[role as usize],
                    plain.states[role as usize],
                );
                assert_eq!(motion.state(lane), state);
                let route = &plain.encounter.participants[role as usize].route;
                assert_eq!(motion.pose(lane), route.pose(state.s), "the same bits");
                assert_eq!(block.distance(role)[lane], plain.distance(role as usize));
            }
            assert!((block.svo()[lane] - plain.svo).abs() < 1e-6);
            assert!((block.reward()[lane] - reward).abs() < 1e-5);
            let outcome = block.outcome(lane);
            assert_eq!(outcome == Outcome::Collided, touch);
            let arrived = plain.distance(0) <= 0.0 || plain.distance(1) <= 0.0;
            assert_eq!(matches!(outcome, Outcome::Arrived(_)), arrived && !touch);
            let late = plain.step >= 2 * plain.encounter.steps;
            assert_eq!(outcome == Outcome::TimedOut, late && !arrived && !touch);
            assert_eq!(
                block.length(lane),
                EpisodeLength {
                    steps: plain.step,
                    recorded: plain.encounter.steps
                }
            );
            *seen.entry(outcome).or_default() += 1;
        }
        block.restart(&library);
        for (lane, plain) in plain.iter_mut().enumerate() {
            if block.length(lane).steps == 0 {
                *plain = Plain::new(&encounters[block.encounter(lane)]);
            }
        }
    }
    // Every way to end has been seen many times.
    assert_eq!(seen.len(), 5, "{seen:?}");
    assert!(seen.values().all(|&count| count > 50), "{seen:?}");
}

/// Holds one acceleration, whatever happens.
struct Constant(f32);

impl Driver for Constant {
    fn accelerate(&mut self, _: &View<'_>) -> f32 {
        self.0
    }
}

#[test]
fn an_episode_ends_as_it_does_in_the_evaluation() {
    let ends = compare_ends(&scenes::encounters(200, 2, 12));
    assert_eq!(ends.len(), 4, "every end was seen: {ends:?}");
    let synthetic = Dataset::synthetic(100, 3).encounters;
    assert!(compare_ends(&synthetic).len() >= 3);
}

/// The same end, after as many steps, with the same vehicle first; gives the ends that were seen.
fn compare_ends(encounters: &[Encounter]) -> HashSet<Outcome> {
    let library = library(encounters);
    let mut block = Block::<2>::new(&library, 0, 0);
    let mut random = Pcg64::seed_from_u64(13);
    let mut ends = HashSet::new();
    for (number, encounter) in encounters.iter().enumerate() {
        let asked = [0, 1].map(|_| random.random_range(-1.0..2.0_f32));
        let mut drivers = asked.map(|a| -> Box<dyn Driver> { Box::new(Constant(a)) });
        let episode = Episode::run(encounter, &mut drivers, None);
        block.place(0, &library, number);
        while block.outcome(0) == Outcome::Running {
            block.advance(&library, &asked.map(|a| [a; LANES]));
        }
        assert_eq!(block.length(0).steps, episode.steps());
        let expected = match (episode.end, episode.first()) {
            (End::Collision, _) => Outcome::Collided,
            (End::Finished, Some(role)) => Outcome::Arrived(role),
            _ => Outcome::TimedOut,
        };
        assert_eq!(block.outcome(0), expected, "{number}");
        ends.insert(expected);
    }
    ends
}

/// Whoever repeats the record ends where the record does, at no cost beyond rounding.
#[test]
fn repeating_the_record_earns_nothing_and_arrives_in_time() {
    let encounters = scenes::encounters(LANES as u32, 8, 4);
    let library = library(&encounters);
    let mut block = Block::<8>::new(&library, 0, 0);
    for lane in 0..LANES {
        block.place(lane, &library, lane);
    }
    let mut open = [true; LANES];
    while open.contains(&true) {
        let mut accelerations = [[0.0; LANES]; 8];
        block.recorded(&library, 0..8, &mut accelerations);
        block.advance(&library, &accelerations);
        for (lane, open) in open.iter_mut().enumerate().filter(|(_, open)| **open) {
            let EpisodeLength { steps, recorded } = block.length(lane);
            for (number, motion) in block.vehicles().iter().enumerate() {
                let vehicle = &encounters[lane].participants[number];
                if block.present(number, lane) {
                    let record = vehicle.record[(steps - vehicle.appears) as usize];
                    assert_eq!(
                        motion.state(lane),
                        State {
                            s: record.s,
                            v: record.v
                        }
                    );
                }
            }
            if block.outcome(lane) != Outcome::Running {
                *open = false;
                if block.outcome(lane) != Outcome::Collided {
                    assert_eq!(
                        block.outcome(lane),
                        Outcome::Arrived(encounters[lane].first)
                    );
                    assert_eq!(steps, recorded);
                    assert!(block.episode_return(lane).abs() < 1e-4);
                }
            }
        }
    }
}

/// Everything that a caller can read of a batch, as bits.
fn fingerprint(batch: &Batch<'_, 4>) -> Vec<u32> {
    let of = |block: &Block<4>| {
        let mut bits: Vec<u32> = block.reward().iter().map(|r| r.to_bits()).collect();
        for motion in block.vehicles() {
            bits.extend(
                motion
                    .s
                    .iter()
                    .chain(&motion.x)
                    .chain(&motion.y)
                    .map(|x| x.to_bits()),
            );
        }
        bits.extend((0..LANES).map(|lane| block.encounter(lane) as u32));
        bits
    };
    batch.blocks().iter().flat_map(of).collect()
}

fn run(library: &Library, threads: usize, seed: u64) -> Vec<u32> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| {
        let mut batch = Batch::<4>::new(library, 2_000, seed);
        for _ in 0..150 {
            batch.for_each(|library, block| {
                let mut asked = [[0.0; LANES]; 4];
                for (asked, motion) in asked.iter_mut().zip(block.vehicles()) {
                    *asked = motion.v.map(|v| 7.0 - v);
                }
                block.advance(library, &asked);
                block.restart(library);
            });
        }
        fingerprint(&batch)
    })
}

#[test]
fn the_same_seed_gives_the_same_bits_on_any_number_of_threads() {
    let encounters = scenes::encounters(100, 4, 8);
    let library = library(&encounters);
    let alone = run(&library, 1, 5);
    assert_eq!(alone, run(&library, 2, 5));
    assert_eq!(alone, run(&library, 7, 5));
    assert_ne!(alone, run(&library, 1, 6), "the seed matters");
}

#[test]
fn stepping_does_not_allocate() {
    let encounters = scenes::encounters(50, 8, 9);
    let library = library(&encounters);
    let mut block = Block::<8>::new(&library, 1, 0);
    let mut restarts = 0;
    let counted = allocation_counter::measure(|| {
        for _ in 0..2_000 {
            let mut accelerations = [[1.0; LANES]; 8];
            block.recorded(&library, 2..8, &mut accelerations);
            block.advance(&library, &accelerations);
            restarts += (0..LANES)
                .filter(|&lane| block.outcome(lane) != Outcome::Running)
                .count();
            block.restart(&library);
        }
    });
    assert!(restarts > 50, "{restarts}");
    assert_eq!(counted.count_total, 0);
}

#[test]
fn encounters_that_cannot_be_stepped_are_refused() {
    let refuse = |encounters: &[Encounter]| Library::new(encounters, Footprint::PAPER).unwrap_err();
    assert_eq!(refuse(&[]), LibraryError::Empty);
    let mut alone = scenes::encounters(2, 2, 1);
    alone[1].participants.truncate(1);
    assert_eq!(refuse(&alone), LibraryError::TooFewVehicles(1));
    let mut blank = scenes::encounters(1, 2, 1);
    blank[0].participants[1].record.clear();
    assert_eq!(refuse(&blank), LibraryError::NoRecord(0));
}
