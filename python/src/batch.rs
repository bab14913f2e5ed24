//! Thousands of encounters stepped at once, into arrays that the caller owns.

use crate::dataset::Dataset;
use crate::error::{error, named};
use crate::look::{self, FEATURES, Look};
use cede_controller::Footprint;
use cede_controller::kinematics::MAX_ACCELERATION;
use cede_data::{Encounter, Role};
use cede_sim::batch::{Block, LANES, Lanes, Library, Outcome};
use cede_sim::reward::COLLISION;
use numpy::{PyReadonlyArray2, PyReadwriteArray1, PyReadwriteArray2};
use pyo3::prelude::*;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// The two vehicles of an encounter, eight encounters at a time.
type Eight = Block<2>;

/// Blocks that a thread takes at a time at least.
const GRAIN: usize = 16;

/// Who is commanded.
#[derive(Clone, Copy, PartialEq)]
enum Mode {
    /// Both vehicles, by one action.
    Joint,
    /// The one with this number; the other does what it did in the record.
    Ego(usize),
}

const MODES: [(&str, Mode); 3] = [
    ("joint", Mode::Joint),
    ("left", Mode::Ego(0)),
    ("other", Mode::Ego(1)),
];

/// What is rewarded.
#[derive(Clone, Copy, PartialEq)]
enum Reward {
    /// The paper's; what depends on the episode's length is paid at its end.
    Paper,
    /// 1 for an arrival, −10 for a collision, −0.01 a step and up to −0.01 for accelerations.
    Plain,
}

const REWARDS: [(&str, Reward); 2] = [("paper", Reward::Paper), ("plain", Reward::Plain)];

/// When an encounter that has ended begins anew.
#[derive(Clone, Copy, PartialEq)]
enum Autoreset {
    /// With the next step, whose action is ignored.
    NextStep,
    /// At once.
    SameStep,
    /// When it is placed.
    Disabled,
}

const AUTORESETS: [(&str, Autoreset); 3] = [
    ("next-step", Autoreset::NextStep),
    ("same-step", Autoreset::SameStep),
    ("disabled", Autoreset::Disabled),
];

/// What is known of a block beside its vehicles.
#[derive(Clone, Copy, Default)]
struct Memory {
    /// Bit `i`: encounter `i` ended with the last step.
    ended: u32,
    /// What each episode has been paid so far.
    paid: Lanes,
}

/// Where a step reads and writes, all arrays row by row.
struct Arrays<'a> {
    actions: &'a [f32],
    observations: &'a mut [f32],
    rewards: &'a mut [f32],
    terminated: &'a mut [bool],
    truncated: &'a mut [bool],
    /// Last observation and outcome of the episodes that end with this step.
    final_observations: &'a mut [f32],
    outcomes: &'a mut [u8],
}

/// Encounters stepped together.
#[pyclass(module = "cede")]
pub(crate) struct Batch {
    rules: Rules,
    encounters: Vec<Encounter>,
    blocks: Vec<(Eight, Memory)>,
    /// Encounters that are shown; the last block may have more.
    shown: usize,
    pool: Option<ThreadPool>,
}

/// What is the same for all blocks.
struct Rules {
    library: Library,
    looks: Vec<Look>,
    mode: Mode,
    reward: Reward,
    autoreset: Autoreset,
}

#[pymethods]
impl Batch {
    #[new]
    #[pyo3(signature = (dataset, split, shown, *, mode, reward, autoreset, threads = 1))]
    #[allow(
        clippy::too_many_arguments,
        reason = "keywords, from one place in Python"
    )]
    fn new(
        py: Python<'_>,
        dataset: &Dataset,
        split: &str,
        shown: usize,
        mode: &str,
        reward: &str,
        autoreset: &str,
        threads: usize,
    ) -> PyResult<Self> {
        let encounters: Vec<Encounter> = dataset.of(split)?.into_iter().cloned().collect();
        let library = Library::new(&encounters, Footprint::PAPER)
            .map_err(|wrong| error(format!("split = `{split}`: {wrong}")))?;
        if !(1..=1 << 24).contains(&shown) {
            return Err(error(format!(
                "num_envs = {shown} is outside [1, 16777216]"
            )));
        }
        if !(1..=1024).contains(&threads) {
            return Err(error(format!("threads = {threads} is outside [1, 1024]")));
        }
        let pool = || {
            ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .map_err(error)
        };
        let mut batch = Self {
            rules: Rules {
                library,
                looks: py.detach(|| encounters.par_iter().map(Look::of).collect()),
                mode: named("mode", mode, &MODES)?,
                reward: named("reward", reward, &REWARDS)?,
                autoreset: named("autoreset", autoreset, &AUTORESETS)?,
            },
            encounters,
            blocks: Vec::new(),
            shown,
            pool: (threads > 1).then(pool).transpose()?,
        };
        batch.seed(0);
        Ok(batch)
    }

    /// Numbers in an observation, in an action.
    #[getter]
    fn sizes(&self) -> (usize, usize) {
        (FEATURES, self.rules.actions())
    }

    /// The number of encounters to draw from.
    #[getter]
    fn encounters(&self) -> usize {
        self.encounters.len()
    }

    /// Draws all encounters anew, by `seed`.
    fn seed(&mut self, seed: u64) {
        let blocks = (0_u64..).take(self.shown.div_ceil(LANES));
        let block = |stream| {
            (
                Eight::new(&self.rules.library, seed, stream),
                Memory::default(),
            )
        };
        self.blocks = blocks.map(block).collect();
    }

    /// Begins encounter number `encounter` in place `place`.
    fn place(&mut self, place: usize, encounter: usize) -> PyResult<()> {
        let (block, memory) = self.at(place)?;
        self.blocks[block].1.ended &= !(1 << memory);
        self.blocks[block].1.paid[memory] = 0.0;
        self.blocks[block]
            .0
            .place(memory, &self.rules.library, encounter);
        Ok(())
    }

    /// Writes what is seen now.
    fn observe(&self, mut observations: PyReadwriteArray2<'_, f32>) -> PyResult<()> {
        let into = sized(
            observations.as_slice_mut(),
            self.shown * FEATURES,
            "observations",
        )?;
        for ((block, _), rows) in self.blocks.iter().zip(into.chunks_mut(LANES * FEATURES)) {
            self.rules.observe(block, rows);
        }
        Ok(())
    }

    /// One step of 0.1 s of all encounters.
    #[allow(
        clippy::too_many_arguments,
        reason = "the arrays of Gymnasium's step, from one place in Python"
    )]
    fn step(
        &mut self,
        py: Python<'_>,
        actions: PyReadonlyArray2<'_, f32>,
        mut observations: PyReadwriteArray2<'_, f32>,
        mut rewards: PyReadwriteArray1<'_, f32>,
        mut terminated: PyReadwriteArray1<'_, bool>,
        mut truncated: PyReadwriteArray1<'_, bool>,
        mut final_observations: PyReadwriteArray2<'_, f32>,
        mut outcomes: PyReadwriteArray1<'_, u8>,
    ) -> PyResult<()> {
        let n = self.shown;
        let asked = actions.as_slice().ok();
        let asked = asked.filter(|asked| asked.len() == n * self.rules.actions());
        let arrays = Arrays {
            actions: asked
                .ok_or_else(|| error(format!("actions: not {n} contiguous rows of float32")))?,
            observations: sized(observations.as_slice_mut(), n * FEATURES, "observations")?,
            rewards: sized(rewards.as_slice_mut(), n, "rewards")?,
            terminated: sized(terminated.as_slice_mut(), n, "terminated")?,
            truncated: sized(truncated.as_slice_mut(), n, "truncated")?,
            final_observations: sized(
                final_observations.as_slice_mut(),
                n * FEATURES,
                "final_observations",
            )?,
            outcomes: sized(outcomes.as_slice_mut(), n, "outcomes")?,
        };
        py.detach(|| self.advance(arrays));
        Ok(())
    }

    /// Writes what one of the two vehicles in `place` sees.
    fn view(
        &self,
        place: usize,
        vehicle: usize,
        mut observation: PyReadwriteArray1<'_, f32>,
    ) -> PyResult<()> {
        let (block, lane) = self.at(place)?;
        if vehicle > 1 {
            return Err(error(format!("vehicle = {vehicle} is outside [0, 1]")));
        }
        let row = sized(observation.as_slice_mut(), FEATURES, "observation")?;
        self.rules.look(&self.blocks[block].0, lane, vehicle, row);
        Ok(())
    }

    /// For drawing: number of the encounter in `place`, and x, y (m) and heading (rad) of its two vehicles.
    fn scene(&self, place: usize) -> PyResult<(usize, [[f32; 3]; 2])> {
        let (block, lane) = self.at(place)?;
        let block = &self.blocks[block].0;
        let poses = Role::BOTH.map(|role| {
            let pose = block.vehicles()[role as usize].pose(lane);
            let direction = pose.direction;
            [
                pose.position.x,
                pose.position.y,
                direction.y.atan2(direction.x),
            ]
        });
        Ok((block.encounter(lane), poses))
    }

    /// Both vehicles in `place`: arc length (m), speed (m/s), distance to the conflict point (m).
    fn states(&self, place: usize) -> PyResult<[[f32; 3]; 2]> {
        let (block, lane) = self.at(place)?;
        let block = &self.blocks[block].0;
        Ok(Role::BOTH.map(|role| {
            let state = block.vehicles()[role as usize].state(lane);
            [state.s, state.v, block.distance(role)[lane]]
        }))
    }
}

impl Batch {
    /// Block and lane of a place.
    fn at(&self, place: usize) -> PyResult<(usize, usize)> {
        if place < self.shown {
            return Ok((place / LANES, place % LANES));
        }
        Err(error(format!(
            "place = {place} is outside [0, {})",
            self.shown
        )))
    }

    fn advance(&mut self, arrays: Arrays<'_>) {
        let rules = &self.rules;
        let parts = arrays.split(rules.actions());
        match &self.pool {
            None => {
                for ((block, memory), part) in self.blocks.iter_mut().zip(parts) {
                    rules.step(block, memory, part);
                }
            }
            Some(pool) => {
                let work: Vec<_> = self.blocks.iter_mut().zip(parts).collect();
                pool.install(|| {
                    let work = work.into_par_iter().with_min_len(GRAIN);
                    work.for_each(|((block, memory), part)| rules.step(block, memory, part));
                });
            }
        }
    }
}

impl<'a> Arrays<'a> {
    /// The rows of each block.
    fn split(self, actions: usize) -> impl Iterator<Item = Arrays<'a>> {
        let mut observations = self.observations.chunks_mut(LANES * FEATURES);
        let mut rewards = self.rewards.chunks_mut(LANES);
        let mut terminated = self.terminated.chunks_mut(LANES);
        let mut truncated = self.truncated.chunks_mut(LANES);
        let mut finals = self.final_observations.chunks_mut(LANES * FEATURES);
        let mut outcomes = self.outcomes.chunks_mut(LANES);
        self.actions
            .chunks(LANES * actions)
            .map_while(move |actions| {
                Some(Arrays {
                    actions,
                    observations: observations.next()?,
                    rewards: rewards.next()?,
                    terminated: terminated.next()?,
                    truncated: truncated.next()?,
                    final_observations: finals.next()?,
                    outcomes: outcomes.next()?,
                })
            })
    }
}

impl Rules {
    /// Numbers in an action.
    fn actions(&self) -> usize {
        if self.mode == Mode::Joint { 2 } else { 1 }
    }

    /// One step of a block.
    fn step(&self, block: &mut Eight, memory: &mut Memory, arrays: Arrays<'_>) {
        let began = core::mem::take(&mut memory.ended);
        if self.autoreset == Autoreset::NextStep {
            block.restart(&self.library);
        }
        let commands = self.commands(block, arrays.actions);
        block.advance(&self.library, &commands);
        let shown = arrays.rewards.len();
        for lane in 0..LANES {
            if self.autoreset == Autoreset::NextStep && began & (1 << lane) != 0 {
                // It begins with this step: what it was asked does not count.
                block.place(lane, &self.library, block.encounter(lane));
                memory.paid[lane] = 0.0;
            }
            let outcome = block.outcome(lane);
            if outcome != Outcome::Running {
                memory.ended |= 1 << lane;
            }
            if lane < shown {
                let began = began & (1 << lane) != 0 && self.autoreset == Autoreset::NextStep;
                arrays.rewards[lane] = if began {
                    0.0
                } else {
                    self.reward(block, memory, &commands, lane)
                };
                arrays.truncated[lane] = outcome == Outcome::TimedOut;
                arrays.terminated[lane] =
                    matches!(outcome, Outcome::Arrived(_) | Outcome::Collided);
                arrays.outcomes[lane] = code(outcome);
            }
        }
        self.go_on(block, memory, shown, arrays.final_observations);
        self.observe(block, arrays.observations);
    }

    /// Begins anew what has ended, as far as this step does that.
    fn go_on(&self, block: &mut Eight, memory: &mut Memory, shown: usize, finals: &mut [f32]) {
        let mut left = memory.ended;
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            if lane >= shown {
                // Nobody sees it, nobody would begin it anew.
                block.place(lane, &self.library, 0);
                memory.ended &= !(1 << lane);
                continue;
            }
            memory.paid[lane] = 0.0;
            let row = &mut finals[lane * FEATURES..(lane + 1) * FEATURES];
            self.look(block, lane, self.commanded().start, row);
        }
        if self.autoreset == Autoreset::SameStep {
            block.restart(&self.library);
            memory.ended = 0;
        }
    }

    /// Accelerations (m/s²) of both vehicles: what was asked, and what was recorded.
    fn commands(&self, block: &Eight, asked: &[f32]) -> [Lanes; 2] {
        let mut commands = [[0.0; LANES]; 2];
        match self.mode {
            Mode::Joint => {
                for (lane, both) in asked.chunks_exact(2).enumerate() {
                    commands[0][lane] = MAX_ACCELERATION * both[0];
                    commands[1][lane] = MAX_ACCELERATION * both[1];
                }
            }
            Mode::Ego(ego) => {
                block.recorded(&self.library, 0..2, &mut commands);
                for (lane, one) in asked.iter().enumerate() {
                    commands[ego][lane] = MAX_ACCELERATION * one;
                }
            }
        }
        commands
    }

    fn reward(
        &self,
        block: &Eight,
        memory: &mut Memory,
        commands: &[Lanes; 2],
        lane: usize,
    ) -> f32 {
        let outcome = block.outcome(lane);
        match self.reward {
            Reward::Paper => {
                let ended = outcome != Outcome::Running;
                let now = block.reward()[lane];
                let rest = if ended {
                    block.episode_return(lane) - memory.paid[lane]
                } else {
                    now
                };
                memory.paid[lane] += now;
                rest
            }
            Reward::Plain => {
                let asked = self
                    .commanded()
                    .map(|vehicle| commands[vehicle][lane] / MAX_ACCELERATION);
                let effort =
                    asked.map(|a| a.clamp(-1.0, 1.0).powi(2)).sum::<f32>() / self.actions() as f32;
                let end = match outcome {
                    Outcome::Arrived(_) => 1.0,
                    Outcome::Collided => COLLISION,
                    Outcome::Running | Outcome::TimedOut => 0.0,
                };
                end - 0.01 - 0.01 * effort
            }
        }
    }

    fn commanded(&self) -> core::ops::Range<usize> {
        match self.mode {
            Mode::Joint => 0..2,
            Mode::Ego(ego) => ego..ego + 1,
        }
    }

    fn observe(&self, block: &Eight, rows: &mut [f32]) {
        for (lane, row) in rows.chunks_exact_mut(FEATURES).enumerate() {
            self.look(block, lane, self.commanded().start, row);
        }
    }

    /// What vehicle `ego` sees; a joint policy sees what the left-turner does.
    fn look(&self, block: &Eight, lane: usize, ego: usize, row: &mut [f32]) {
        let vehicles = block.vehicles();
        let states = [0, 1].map(|i| vehicles[i].state(lane));
        let poses = [0, 1].map(|i| vehicles[i].pose(lane));
        let pair = self.looks[block.encounter(lane)].pair(ego, states, poses, block.svo()[lane]);
        look::write(&pair, row);
    }
}

/// An outcome as a number: the index of its name in `cede.envs.OUTCOMES`.
fn code(outcome: Outcome) -> u8 {
    match outcome {
        Outcome::Running => 0,
        Outcome::Arrived(Role::Left) => 1,
        Outcome::Arrived(Role::Other) => 2,
        Outcome::Collided => 3,
        Outcome::TimedOut => 4,
    }
}

/// An array that is written to, of this many entries.
fn sized<'a, T, E>(
    slice: Result<&'a mut [T], E>,
    size: usize,
    name: &str,
) -> PyResult<&'a mut [T]> {
    let slice = slice.ok().filter(|slice| slice.len() == size);
    slice.ok_or_else(|| error(format!("{name}: not a contiguous array of {size} entries")))
}
