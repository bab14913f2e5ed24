//! How often the shield corrects the policy.

use super::{Context, Found};
use crate::case::{Case, Noise, Proposals};
use crate::hunt::hunt;
use crate::report::{Failure, Verdict};
use crate::run::{drive, junction};
use crate::strategies;
use cede_controller::Cause;
use cede_controller::dangerous::Rules;
use proptest::strategy::Strategy;
use std::cell::Cell;

/// The share of shielded steps while the ego has yet to meet somebody.
pub(super) fn comfort<R: Rules + Clone>(context: &Context<'_>, id: &'static str) -> Found {
    let subject = &context.subject;
    let ordinary = strategies::case(&subject.contract).prop_map(ordinary);
    let counts = Cell::new([0_u32; 3]);
    let hard = -0.8 * subject.contract.ego().braking;
    let test = |case: &Case| {
        let junction = junction(case, subject)?;
        drive::<R>(
            subject,
            (case, &junction),
            &subject.as_contracted(),
            |call| {
                if call.world.is_through() || call.world.others.is_empty() {
                    return Ok(());
                }
                let [all, shielded, braking] = counts.get();
                let is_shielded = matches!(call.decision.cause, Cause::Shielded(_));
                let brakes = call.decision.acceleration < hard;
                counts.set([
                    all + 1,
                    shielded + u32::from(is_shielded),
                    braking + u32::from(brakes),
                ]);
                Ok(())
            },
        )
        .map(drop)
    };
    let caught = hunt((id, context.seed, context.cases), &ordinary, test);
    let mut found = context.found(caught, ToString::to_string, |_| None);
    let [all, shielded, braking] = counts.get();
    let share = |count: u32| f64::from(count) / f64::from(all.max(1));
    found.numbers = vec![
        ("share of shielded steps".to_owned(), share(shielded)),
        (
            "share of steps with hard braking".to_owned(),
            share(braking),
        ),
    ];
    if share(shielded) > context.most_shielded && found.judged > 0 {
        found.verdict = Verdict::Failed(Failure {
            message: format!(
                "the shield corrects {:.0} % of the steps, more than {:.0} %: it drives, not the policy",
                100.0 * share(shielded),
                100.0 * context.most_shielded
            ),
            mend: Some(
                "replace the policy, or train it within this contract; if it drove well under another contract, the \
                 numbers of `other` may be more cautious than the traffic"
                    .to_owned(),
            ),
            case: None,
        });
    }
    found
}

/// The policy drives, everybody moves gently, and sensors are exact.
fn ordinary(mut case: Case) -> Case {
    case.proposals = Proposals::Policy;
    case.noise = Noise::NONE;
    for other in &mut case.others {
        for push in &mut other.script {
            push.quarters = push.quarters.clamp(-1, 2);
        }
    }
    case
}
