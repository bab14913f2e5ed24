//! All checks of one policy, contract and vehicle.

use crate::check::{Context, all};
use crate::report::{Outcome, Report};
use crate::subject::Subject;
use crate::vehicle::Vehicle;
use cede_controller::dangerous::{Rules, Sound};
use cede_controller::{Contract, Footprint, Policy};
use std::marker::PhantomData;
use std::time::Instant;

/// Cases of each check that draws them.
const CASES: u32 = 128;
/// What the cases are drawn from.
const SEED: u64 = 1;
/// Share of shielded steps up to which the policy drives, not the shield.
const MOST_SHIELDED: f64 = 0.5;

/// All checks of one policy, contract and vehicle.
///
/// `R` are the shield's rules: [`Sound`], unless a test plants an error.
#[derive(Clone, Debug)]
#[must_use = "`run` runs it"]
pub struct Suite<'w, R: Rules = Sound> {
    context: Context<'w>,
    only: Option<Vec<String>>,
    rules: PhantomData<R>,
}

impl<'w> Suite<'w> {
    /// All checks of `policy` behind a shield that assumes `contract`. The vehicle is [`Footprint::PAPER`] and achieves
    /// what the contract says until [`Suite::vehicle`] is called; 128 cases a check; seed 1.
    pub fn new(policy: Policy<'w>, contract: Contract) -> Self {
        let vehicle = Vehicle::new(Footprint::PAPER);
        Self {
            context: Context {
                subject: Subject {
                    policy,
                    contract,
                    vehicle,
                },
                cases: CASES,
                seed: SEED,
                most_shielded: MOST_SHIELDED,
            },
            only: None,
            rules: PhantomData,
        }
    }
}

impl<'w, R: Rules + Clone + 'static> Suite<'w, R> {
    /// The vehicle that the contract is for: its footprint, or what it really achieves.
    pub fn vehicle(mut self, vehicle: impl Into<Vehicle>) -> Self {
        self.context.subject.vehicle = vehicle.into();
        self
    }

    /// So many cases for each check that draws them, at least 1. Cost: about 1 ms each on a desktop, in release.
    pub fn cases(mut self, cases: u32) -> Self {
        self.context.cases = cases.max(1);
        self
    }

    /// What the cases are drawn from: the same seed gives the same cases.
    pub fn seed(mut self, seed: u64) -> Self {
        self.context.seed = seed;
        self
    }

    /// The share of shielded steps, in [0, 1], above which the check `comfort` fails; 0.5 unless it is set. 1 makes
    /// of it a number that is no verdict.
    pub fn most_shielded(mut self, share: f64) -> Self {
        self.context.most_shielded = share;
        self
    }

    /// Only the check `id`; called again, that one as well. One that does not exist fails.
    pub fn only(mut self, id: &str) -> Self {
        self.only.get_or_insert_default().push(id.to_owned());
        self
    }

    /// The same checks of a shield with rules that are not proved: to see that the checks find an error that is
    /// planted. See [`cede_controller::dangerous`].
    pub fn with_rules<Q: Rules + Clone + 'static>(self) -> Suite<'w, Q> {
        let Self { context, only, .. } = self;
        Suite {
            context,
            only,
            rules: PhantomData,
        }
    }

    /// Runs the checks, one after the other, and tells `watch` of each outcome as it comes.
    pub fn run_watched(self, mut watch: impl FnMut(&Outcome)) -> Report {
        let wanted = |id: &str| {
            self.only
                .as_ref()
                .is_none_or(|only| only.iter().any(|o| o == id))
        };
        let mut outcomes = Vec::new();
        for check in all::<R>().iter().filter(|check| wanted(check.id)) {
            let start = Instant::now();
            let found = (check.run)(&self.context, check.id);
            let outcome = found.outcome(check, start.elapsed().as_secs_f64());
            watch(&outcome);
            outcomes.push(outcome);
        }
        Report {
            subject: self.named(),
            seed: self.context.seed,
            cases: self.context.cases,
            outcomes,
        }
    }

    /// Runs the checks, one after the other.
    ///
    /// Cost: a few seconds in release for 128 cases.
    pub fn run(self) -> Report {
        self.run_watched(|_| ())
    }

    /// The subject in words.
    fn named(&self) -> String {
        let Subject {
            policy,
            contract,
            vehicle,
        } = &self.context.subject;
        let weights = policy.weights();
        let (width, features) = (weights.network().width(), weights.features().name());
        let Footprint {
            length,
            width: side,
        } = vehicle.footprint;
        format!(
            "A policy of width {width} with the features `{features}`, a contract with ego.braking = {} and latency = {}, \
             a vehicle of {length} m by {side} m",
            contract.ego().braking,
            contract.latency(),
        )
    }
}

/// Id and sentence of every check, in the order in which [`Suite::run`] runs them.
#[must_use]
pub fn checks() -> Vec<(&'static str, &'static str)> {
    all::<Sound>()
        .iter()
        .map(|check| (check.id, check.sentence))
        .collect()
}
