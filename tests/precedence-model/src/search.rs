//! The search through all states, breadth first.

use crate::world::{NEVER_BOTH, NOT_AT_ONCE, SOMEBODY, Watched, World};
use cede_controller::dangerous::Rules;
use core::fmt;
use stateright::{Checker, Model};
use std::time::{Duration, Instant};

/// What came out of a search.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Different states.
    pub states: usize,
    /// Steps of the longest way, at least, from the beginning to a state.
    pub depth: usize,
    /// How long it took.
    pub time: Duration,
    /// Every state within the bounds was reached.
    pub complete: bool,
    /// A shortest way to two that rely on precedence over each other.
    pub both: Option<String>,
    /// A shortest way to one that relies on what the other could rely on just before.
    pub at_once: Option<String>,
    /// Somebody relies on precedence at some time.
    pub somebody: bool,
}

impl Outcome {
    /// Nothing is wrong, everything was seen, and the model is not empty.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.both.is_none() && self.at_once.is_none() && self.complete && self.somebody
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let found = |way: &Option<String>| if way.is_some() { "FOUND" } else { "none" };
        write!(
            f,
            "{} states, depth {}, {:.1} s, {}; both: {}, at once: {}, somebody: {}",
            self.states,
            self.depth,
            self.time.as_secs_f64(),
            if self.complete {
                "complete"
            } else {
                "cut short"
            },
            found(&self.both),
            found(&self.at_once),
            self.somebody,
        )
    }
}

/// Searches up to `depth` steps, for at most `limit`; 0 steps are as many as there are.
pub fn search<const N: usize, R>(model: Watched<N, R>, depth: usize, limit: Duration) -> Outcome
where
    R: Rules + Send + Sync + 'static,
{
    let begin = Instant::now();
    let mut checker = model.checker().threads(2).timeout(limit);
    if depth > 0 {
        checker = checker.target_max_depth(depth);
    }
    let checker = checker.spawn_bfs().join();
    let way = |name| {
        let path = checker.discovery(name)?;
        let mut text = String::new();
        for (world, step) in path.into_vec() {
            text += &line(&world);
            if step.is_none() {
                text += &format!("{world:#?}");
            }
        }
        Some(text)
    };
    let time = begin.elapsed();
    Outcome {
        states: checker.unique_state_count(),
        depth: checker.max_depth(),
        time,
        complete: checker.is_done() && time < limit && (depth == 0 || checker.max_depth() < depth),
        both: way(NEVER_BOTH),
        at_once: way(NOT_AT_ONCE),
        somebody: checker.discovery(SOMEBODY).is_some(),
    }
}

/// One state of a trace: each vehicle's place and speed, what its shield claims, and how long it takes each pair to have rested.
fn line<const N: usize>(world: &World<N>) -> String {
    let vehicle = |i: usize| {
        let (body, watch) = (world.bodies[i], &world.watches[i]);
        let rested: Vec<_> = (0..N).filter(|&j| j != i).map(|j| watch.rests(j)).collect();
        format!(
            "[{} v{} claims {:b} {}]",
            body.place,
            body.speed,
            watch.claims,
            rested.join(" ")
        )
    };
    let all: Vec<_> = (0..N).map(vehicle).collect();
    format!("{}\n", all.join(" "))
}
