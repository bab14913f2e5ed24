//! Eight encounters in lockstep: the unit that a batch steps, and that vector instructions work on.

mod score;

use super::library::{Library, Scenario};
use super::motion::Motion;
use super::{LANES, Lanes};
use crate::reward::EpisodeLength;
use crate::stepper::{self, Eight, Goal};
use cede_controller::kinematics::{State, clamp_acceleration};
use cede_controller::policy::svo::{self, svo};
use cede_data::encounter::Role;
use core::ops::Range;
use rand::RngExt;
use rand_pcg::Pcg64;

/// How far an episode has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Outcome {
    /// It goes on.
    Running,
    /// This vehicle reached its conflict point first.
    Arrived(Role),
    /// One of the two judged vehicles touched a vehicle.
    Collided,
    /// Nobody arrived within twice the record's length.
    TimedOut,
}

/// Eight encounters of `N` vehicles, stepped together; entry `i` of every array belongs to encounter `i`.
///
/// Vehicles 0 and 1 are the two judged ones, the others the traffic around them, in the order
/// of [`cede_data::Encounter::participants`]; vehicles beyond `N` are left out. Methods panic if they are
/// asked for a lane or a vehicle that there is not; nothing else makes them panic.
#[derive(Clone, Debug)]
pub struct Block<const N: usize> {
    vehicles: [Motion; N],
    /// Steps at which each vehicle appears and leaves.
    presence: [Presence; N],
    conflict_s: [Lanes; 2],
    distance: [Lanes; 2],
    svo: Lanes,
    gap: Lanes,
    reward: Lanes,
    /// Sums over the episode of the immediate rewards and of the two speeds.
    earned: Lanes,
    speeds: Lanes,
    /// Steps taken and recorded; whole numbers, in the registers that they are compared in.
    step: Lanes,
    recorded: Lanes,
    /// Index in the library of the SVO recorded at this step (at l_GT once the record is over).
    reference: [u32; LANES],
    scenario: [u32; LANES],
    outcome: [Outcome; LANES],
    /// Bit `i`: encounter `i` has ended.
    ended: u32,
    random: Pcg64,
}

/// Steps in which a vehicle is there: from the first to before the second; whole numbers.
#[derive(Clone, Copy, Debug)]
struct Presence {
    from: Lanes,
    until: Lanes,
}

impl<const N: usize> Block<N> {
    const VEHICLES: () = assert!(N >= 2 && N <= 8, "an encounter has 2 to 8 vehicles");

    /// Eight encounters drawn from `library` by a generator with this `seed` and `stream`.
    #[must_use]
    pub fn new(library: &Library, seed: u64, stream: u64) -> Self {
        let () = Self::VEHICLES;
        let never = Presence {
            from: [f32::INFINITY; LANES],
            until: [f32::INFINITY; LANES],
        };
        let mut block = Self {
            vehicles: core::array::from_fn(|_| Motion::new()),
            presence: [never; N],
            conflict_s: [[0.0; LANES]; 2],
            distance: [[0.0; LANES]; 2],
            svo: [0.0; LANES],
            gap: [f32::INFINITY; LANES],
            reward: [0.0; LANES],
            earned: [0.0; LANES],
            speeds: [0.0; LANES],
            step: [0.0; LANES],
            recorded: [1.0; LANES],
            reference: [0; LANES],
            scenario: [0; LANES],
            outcome: [Outcome::Running; LANES],
            ended: 0,
            random: Pcg64::new(u128::from(seed), u128::from(stream)),
        };
        for lane in 0..LANES {
            block.restart_lane(lane, library);
        }
        block
    }

    /// All vehicles: state and pose in each encounter.
    #[must_use]
    pub fn vehicles(&self) -> &[Motion; N] {
        &self.vehicles
    }

    /// Whether `vehicle` is there in encounter `lane`.
    #[must_use]
    pub fn present(&self, vehicle: usize, lane: usize) -> bool {
        let Presence { from, until } = &self.presence[vehicle];
        vehicle < 2 || (from[lane]..until[lane]).contains(&self.step[lane])
    }

    /// Metres that the vehicle of this role has still to go to its conflict point.
    #[must_use]
    pub fn distance(&self, role: Role) -> &Lanes {
        &self.distance[role as usize]
    }

    /// SVO (rad) of the left-turner; the other's is π/2 minus it.
    #[must_use]
    pub fn svo(&self) -> &Lanes {
        &self.svo
    }

    /// Least separation (m, as in [`cede_controller::separation::OrientedBox::separation`]) of a judged vehicle from any vehicle
    /// after the last step. Only its sign is meant where all are farther apart than a vehicle's diagonal:
    /// it may be infinite there.
    #[must_use]
    pub fn gap(&self) -> &Lanes {
        &self.gap
    }

    /// What the last step earned at once: −r₁ + r₄ of [`crate::reward`].
    #[must_use]
    pub fn reward(&self) -> &Lanes {
        &self.reward
    }

    /// How far the episode in `lane` has come.
    #[must_use]
    pub fn outcome(&self, lane: usize) -> Outcome {
        self.outcome[lane]
    }

    /// Number of the encounter in `lane`, as in the slice that the library was made of.
    #[must_use]
    pub fn encounter(&self, lane: usize) -> usize {
        self.scenario[lane] as usize
    }

    /// Steps that the episode in `lane` has taken, beside the recorded length.
    #[must_use]
    pub fn length(&self, lane: usize) -> EpisodeLength {
        EpisodeLength {
            steps: self.step[lane] as u32,
            recorded: self.recorded[lane] as u32,
        }
    }

    /// Sum of the rewards of the episode in `lane`, replayed ones included; of use once it has ended.
    #[must_use]
    pub fn episode_return(&self, lane: usize) -> f32 {
        self.earned[lane] + self.length(lane).replayed_total(self.speeds[lane])
    }

    /// Fills in the recorded accelerations (m/s²) of `vehicles`; 0 where the record is silent.
    pub fn recorded(&self, library: &Library, vehicles: Range<usize>, into: &mut [Lanes; N]) {
        for vehicle in vehicles {
            for (lane, asked) in into[vehicle].iter_mut().enumerate() {
                let track = library.track(library.scenario(self.scenario[lane]), vehicle);
                *asked = track.map_or(0.0, |t| library.acceleration(t, self.step[lane] as u32));
            }
        }
    }

    /// One step of 0.1 s under these accelerations, clamped to ±3 m/s², one of each vehicle.
    ///
    /// Encounters that have ended must be restarted first ([`Block::restart`], [`Block::place`]).
    /// Never allocates. NaN is taken as full braking.
    pub fn advance(&mut self, library: &Library, accelerations: &[Lanes; N]) {
        let goal = self.goal();
        let taken = Eight::from(self.step);
        let mut states = self.vehicles.each_ref().map(Motion::states);
        let accelerations = accelerations.map(|asked| clamp_acceleration(Eight::from(asked)));
        self.count();
        let (judged, traffic) = states.split_at_mut(2);
        stepper::advance(traffic, &accelerations[2..]);
        let step = stepper::step(
            &goal,
            taken,
            [judged[0], judged[1]],
            [accelerations[0], accelerations[1]],
            |judged| {
                self.move_to(judged.iter().chain(traffic.iter()), library);
                self.least_gap(library)
            },
        );
        self.score(&step, library);
    }

    /// What ends the episodes: the paper's protocol.
    #[inline]
    fn goal(&self) -> Goal<Eight> {
        let recorded = Eight::from(self.recorded);
        Goal {
            conflict_s: self.conflict_s.map(Eight::from),
            exits: None,
            limit: recorded + recorded,
        }
    }

    /// Counts a step.
    #[inline]
    fn count(&mut self) {
        for lane in 0..LANES {
            self.step[lane] += 1.0;
            self.reference[lane] += u32::from(self.step[lane] <= self.recorded[lane]);
        }
    }

    /// Takes all vehicles on to `states`.
    #[inline]
    fn move_to<'s>(&mut self, states: impl Iterator<Item = &'s State<Eight>>, library: &Library) {
        for (motion, state) in self.vehicles.iter_mut().zip(states) {
            motion.move_to(state, library);
        }
        if N > 2 {
            self.traffic_appears(library);
        }
    }

    /// Starts a new episode, of an encounter drawn at random, wherever one has ended.
    pub fn restart(&mut self, library: &Library) {
        let mut ended = core::mem::take(&mut self.ended);
        while ended != 0 {
            self.restart_lane(ended.trailing_zeros() as usize, library);
            ended &= ended - 1;
        }
    }

    fn restart_lane(&mut self, lane: usize, library: &Library) {
        let drawn = self.random.random_range(0..library.count());
        self.place(lane, library, drawn as usize);
    }

    /// Starts an episode of encounter number `encounter` (modulo their number) in `lane`.
    pub fn place(&mut self, lane: usize, library: &Library, encounter: usize) {
        let index = (encounter % library.len()) as u32;
        let scenario = *library.scenario(index);
        self.scenario[lane] = index;
        self.step[lane] = 0.0;
        self.recorded[lane] = scenario.recorded as f32;
        self.ended &= !(1 << lane);
        self.reference[lane] = scenario.svo;
        self.outcome[lane] = Outcome::Running;
        self.gap[lane] = f32::INFINITY;
        self.reward[lane] = 0.0;
        self.earned[lane] = 0.0;
        self.speeds[lane] = 0.0;
        self.place_vehicles(lane, library, &scenario);
        for (role, conflict_s) in library.conflict_s(&scenario).into_iter().enumerate() {
            self.conflict_s[role][lane] = conflict_s;
            self.distance[role][lane] = conflict_s - self.vehicles[role].s[lane];
        }
        let [d, other_d] = [self.distance[0][lane], self.distance[1][lane]];
        let [v, other_v] = [self.vehicles[0].v[lane], self.vehicles[1].v[lane]];
        self.svo[lane] = svo(v, d, other_v, other_d, svo::FIRST);
    }

    fn place_vehicles(&mut self, lane: usize, library: &Library, scenario: &Scenario) {
        for (number, (motion, presence)) in
            self.vehicles.iter_mut().zip(&mut self.presence).enumerate()
        {
            let track = library.track(scenario, number);
            (presence.from[lane], presence.until[lane]) = track
                .map_or((f32::INFINITY, f32::INFINITY), |t| {
                    (t.appears as f32, t.leaves as f32)
                });
            if let Some(track) = track {
                motion.place(lane, library, track);
            }
        }
    }

    /// Puts vehicles whose first step this is at the start of their record.
    fn traffic_appears(&mut self, library: &Library) {
        for vehicle in 2..N {
            for lane in 0..LANES {
                if self.presence[vehicle].from[lane] == self.step[lane] {
                    let scenario = library.scenario(self.scenario[lane]);
                    if let Some(track) = library.track(scenario, vehicle) {
                        self.vehicles[vehicle].place(lane, library, track);
                    }
                }
            }
        }
    }
}
