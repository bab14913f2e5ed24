//! The checks, each with an id and a sentence.

mod bits;
mod bolder;
mod closed;
mod comfort;
mod live;
mod outside;
mod policy;
mod twins;

use crate::case::Case;
use crate::hunt::{Catch, hunt};
use crate::report::{Failure, Outcome, Verdict};
use crate::run::{self, explain};
use crate::strategies;
use crate::subject::Subject;
use crate::vehicle::Truth;
use cede_controller::dangerous::Rules;

/// What is checked, and how thoroughly.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Context<'w> {
    pub(crate) subject: Subject<'w>,
    pub(crate) cases: u32,
    pub(crate) seed: u64,
    /// Share of shielded steps above which the policy does not fit the contract.
    pub(crate) most_shielded: f64,
}

/// A check, behind a shield of the rules `R`.
pub(crate) struct Check {
    pub(crate) id: &'static str,
    pub(crate) sentence: &'static str,
    pub(crate) run: fn(&Context<'_>, &'static str) -> Found,
}

/// What a check found.
pub(crate) struct Found {
    pub(crate) verdict: Verdict,
    pub(crate) judged: u32,
    pub(crate) skipped: u32,
    /// Numbers that are no verdict, with their names and units.
    pub(crate) numbers: Vec<(String, f64)>,
}

impl Found {
    fn new(verdict: Verdict, judged: u32) -> Self {
        Self {
            verdict,
            judged,
            skipped: 0,
            numbers: Vec::new(),
        }
    }

    pub(crate) fn outcome(self, check: &Check, seconds: f64) -> Outcome {
        Outcome {
            id: check.id,
            sentence: check.sentence,
            verdict: self.verdict,
            cases: self.judged,
            skipped_cases: self.skipped,
            numbers: self.numbers,
            seconds,
        }
    }
}

/// All checks, in the order in which a person wants to read them.
pub(crate) fn all<R: Rules + Clone + 'static>() -> Vec<Check> {
    let check = |id, sentence, run| Check { id, sentence, run };
    vec![
        check(
            "contract-fits-vehicle",
            "No number of the contract is bolder than what the vehicle achieves.",
            bolder::fits,
        ),
        check(
            "no-overlap",
            "With the vehicle's own numbers, and others within the contract, no footprints overlap.",
            closed::no_overlap::<R>,
        ),
        check(
            "no-overlap-contracted",
            "A vehicle that just keeps the contract never overlaps another that keeps it.",
            closed::no_overlap_contracted::<R>,
        ),
        check(
            "plan",
            "After a start with a safe plan, no decision is without one.",
            closed::plan::<R>,
        ),
        check(
            "no-false-breach",
            "Nobody who keeps the contract is reported to have broken it.",
            closed::no_false_breach::<R>,
        ),
        check(
            "vehicle-keeps-contract",
            "The vehicle as it was measured is never seen to deviate from its commands.",
            closed::vehicle_keeps_contract::<R>,
        ),
        check(
            "speed-limit",
            "As long as its own state is seen, the ego never exceeds the contract's ego.max_speed.",
            closed::speed_limit::<R>,
        ),
        check(
            "breach-named",
            "Another that accelerates harder than the contract allows is reported within three calls.",
            outside::breach_named::<R>,
        ),
        check(
            "door",
            "Whatever the bits of the input: no panic, a finite and admissible acceleration, and the fault is named.",
            bits::door::<R>,
        ),
        check(
            "deterministic",
            "The same inputs give the same decisions, to the bit.",
            twins::deterministic::<R>,
        ),
        check(
            "approach",
            "Without a rule of precedence, Approach::decide is the policy's proposal through the shield, to the bit.",
            twins::approach,
        ),
        check(
            "repeated-call",
            "The same moment again gives the same decision, whatever is seen; an earlier one is a fault. Neither leaves a trace.",
            twins::repeated_call::<R>,
        ),
        check(
            "order",
            "The order of the tracks changes nothing.",
            twins::order::<R>,
        ),
        check(
            "numbers",
            "Other track numbers change nothing.",
            twins::numbers::<R>,
        ),
        check(
            "bystanders",
            "Vehicles that cannot meet the ego change nothing.",
            twins::bystanders::<R>,
        ),
        check(
            "missing",
            "With exact sensors, a track that is missing never lets the ego go harder.",
            twins::missing::<R>,
        ),
        check(
            "replacing",
            "Replacing policy and contract by themselves, while a plan can be found anew, changes nothing.",
            twins::replacing::<R>,
        ),
        check(
            "policy-answers",
            "The policy answers to what it sees: it proposes to go in some encounters and to brake in others.",
            policy::answers,
        ),
        check(
            "gets-through-alone",
            "The ego gets through an empty junction in time.",
            live::alone::<R>,
        ),
        check(
            "gets-through-after",
            "The ego gets through after another that goes first, in time.",
            live::after::<R>,
        ),
        check(
            "gets-through-courteous",
            "The ego gets through in time where another waits for it.",
            live::courteous::<R>,
        ),
        check(
            "comfort",
            "The shield seldom corrects the policy in ordinary traffic.",
            comfort::comfort::<R>,
        ),
    ]
}

impl Context<'_> {
    /// Runs `test` on cases of the contract; a failure is told in words and as a picture.
    fn cases<R: Rules + Clone>(
        &self,
        id: &'static str,
        truth: &Truth,
        test: impl Fn(&Case) -> run::Verdict,
    ) -> Found {
        let caught = self.hunted(id, test);
        self.found(
            caught,
            |case| explain::<R>(&self.subject, case, truth),
            |_| None,
        )
    }

    /// What `test` catches; of two vehicles, if that can be.
    fn hunted(&self, id: &'static str, test: impl Fn(&Case) -> run::Verdict) -> Catch<Case> {
        let contract = &self.subject.contract;
        let mut caught = hunt(
            (id, self.seed, self.cases),
            &strategies::case(contract),
            &test,
        );
        if caught
            .failure
            .as_ref()
            .is_some_and(|(case, _)| case.others.len() > 1)
        {
            let many = self.cases.saturating_mul(4);
            let two = hunt(
                (id, self.seed, many),
                &strategies::case_of_two(contract),
                &test,
            );
            caught.failure = two.failure.or(caught.failure);
        }
        caught
    }

    /// The verdict of what was caught.
    fn found<T>(
        &self,
        caught: Catch<T>,
        explain: impl Fn(&T) -> String,
        mend: impl Fn(&T) -> Option<String>,
    ) -> Found {
        let Catch {
            judged,
            skipped,
            why,
            failure,
        } = caught;
        let verdict = match failure {
            Some((value, message)) => Verdict::Failed(Failure {
                message,
                mend: mend(&value),
                case: Some(explain(&value)),
            }),
            None if judged == 0 => Verdict::Failed(Failure {
                message: format!(
                    "no case could be judged, so nothing is known: most often, {}",
                    why.unwrap_or_else(|| "no case could be drawn".to_owned())
                ),
                mend: Some(
                    "change the contract or the vehicle so that a drive can begin".to_owned(),
                ),
                case: None,
            }),
            None => Verdict::Passed,
        };
        Found {
            verdict,
            judged,
            skipped,
            numbers: Vec::new(),
        }
    }
}
