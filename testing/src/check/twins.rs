//! Two drivers see the same world, each in its own way, and decide the same.

use super::{Context, Found};
use crate::case::{Case, Level, Proposals};
use crate::pilot::{Pilot, approach as flown};
use crate::place::Road;
use crate::run::{Call, Miss, Verdict, drive, junction};
use crate::world::Seen;
use cede_controller::dangerous::Rules;
use cede_controller::geometry::unit;
use cede_controller::{
    Action, Cause, Decision, Fault, Instant, Intervention, Point, Pose, Track, Vehicle,
};

/// Drives a case with a twin beside; `test` judges both at every call.
fn twins<'w, R: Rules + Clone>(
    context: &Context<'w>,
    id: &'static str,
    test: impl Fn(&mut Pilot<'_, 'w, R>, &Call<'_, '_, '_, R>) -> Verdict,
) -> Found {
    let subject = &context.subject;
    let truth = subject.as_contracted();
    context.cases::<R>(id, &truth, |case| {
        let junction = junction(case, subject)?;
        let twin = Pilot::<R>::enter(subject.policy, subject.contract, &junction);
        let mut twin = twin.map_err(Miss::skip)?;
        drive::<R>(subject, (case, &junction), &truth, |call| {
            test(&mut twin, call)
        })
        .map(drop)
    })
}

/// A twin that sees what `alter` makes of every observation decides the same.
fn unmoved<R: Rules + Clone>(
    context: &Context<'_>,
    id: &'static str,
    alter: impl Fn(&Seen, &Case, u32) -> Seen,
) -> Found {
    twins::<R>(context, id, |twin, call| {
        let seen = alter(call.seen, call.world.case, call.world.step);
        let decision = twin.decide(&seen, call.proposal);
        same(call, call.decision, &decision)
    })
}

/// Whether two decisions are the same but for track numbers and words.
fn same<R: Rules>(call: &Call<'_, '_, '_, R>, one: &Decision, two: &Decision) -> Verdict {
    let kind = |decision: &Decision| {
        let cause = std::mem::discriminant(&decision.cause);
        let fault = decision.fault.map(|fault| std::mem::discriminant(&fault));
        let numbers = [decision.acceleration, decision.margin].map(f32::to_bits);
        (
            numbers,
            decision.plan,
            cause,
            fault,
            decision.breach.is_some(),
            decision.unwatched.is_some(),
        )
    };
    if kind(one) == kind(two) {
        return Ok(());
    }
    Err(differs(call, one, two))
}

/// Whether two decisions are the same to the last bit.
fn identical<R: Rules>(call: &Call<'_, '_, '_, R>, one: &Decision, two: &Decision) -> Verdict {
    // By their words: a fault may quote a number that is none, which equals nothing.
    if format!("{one:?}") == format!("{two:?}") {
        return Ok(());
    }
    Err(differs(call, one, two))
}

fn differs<R: Rules>(call: &Call<'_, '_, '_, R>, one: &Decision, two: &Decision) -> Miss {
    Miss::Broken(format!(
        "after {:.2} s: {} m/s², margin {} m ({one}) becomes {} m/s², margin {} m ({two})",
        call.world.time(),
        one.acceleration,
        one.margin,
        two.acceleration,
        two.margin,
    ))
}

/// The same again.
pub(super) fn deterministic<R: Rules + Clone>(context: &Context<'_>, id: &'static str) -> Found {
    twins::<R>(context, id, |twin, call| {
        let decision = twin.decide(call.seen, call.proposal);
        identical(call, call.decision, &decision)
    })
}

/// What flies is policy and shield. With a rule of precedence the ego does not brake for those who have to wait, whatever
/// the policy says: the rule is left out.
pub(super) fn approach(context: &Context<'_>, id: &'static str) -> Found {
    type Sound = cede_controller::dangerous::Sound;
    let mut context = *context;
    let given = context.subject.contract;
    // What holds with a rule holds without it.
    let alone = given.to_builder().precedence(None).build();
    context.subject.contract = alone.unwrap_or(given);
    let subject = &context.subject;
    let truth = subject.as_contracted();
    context.cases::<Sound>(id, &truth, |case| {
        let case = &Case {
            proposals: Proposals::Policy,
            ..case.clone()
        };
        let junction = junction(case, subject)?;
        let entered = flown(subject.policy, subject.contract, &junction);
        let mut approach = entered.map_err(Miss::skip)?;
        drive::<Sound>(subject, (case, &junction), &truth, |call| {
            let mut decision = approach.decide(call.seen.now, &call.seen.observation());
            decision.prediction = None;
            identical(call, call.decision, &decision)
        })
        .map(drop)
    })
}

/// The same moment again, and an earlier one.
pub(super) fn repeated_call<R: Rules + Clone>(context: &Context<'_>, id: &'static str) -> Found {
    twins::<R>(context, id, |twin, call| {
        let decision = twin.decide(call.seen, call.proposal);
        same(call, call.decision, &decision)?;
        let nobody = Seen {
            tracks: Vec::new(),
            ..call.seen.clone()
        };
        identical(call, &decision, &twin.decide(&nobody, Some(-1.0)))?;
        let before = Instant::from_micros(call.seen.now.micros() - 1);
        let earlier = twin.decide(
            &Seen {
                now: before,
                ..nobody
            },
            None,
        );
        let mut expected = decision;
        expected.fault = Some(Fault::Backwards);
        identical(call, &expected, &earlier)
    })
}

/// Tracks in another order.
pub(super) fn order<R: Rules + Clone>(context: &Context<'_>, id: &'static str) -> Found {
    unmoved::<R>(context, id, |seen, _, step| {
        let mut seen = seen.clone();
        let shift = step as usize % seen.tracks.len().max(1);
        seen.tracks.rotate_left(shift);
        if step % 2 == 1 {
            seen.tracks.reverse();
        }
        seen
    })
}

/// Tracks with other numbers.
pub(super) fn numbers<R: Rules + Clone>(context: &Context<'_>, id: &'static str) -> Found {
    unmoved::<R>(context, id, |seen, _, _| {
        let mut seen = seen.clone();
        for track in &mut seen.tracks {
            track.number = 60_000 - 7 * track.number;
        }
        seen
    })
}

/// Vehicles far away, before and after the others, ever new ones.
pub(super) fn bystanders<R: Rules + Clone>(context: &Context<'_>, id: &'static str) -> Found {
    unmoved::<R>(context, id, |seen, _, step| {
        let mut seen = seen.clone();
        let away = |number: u16, s: f32| {
            let pose = Pose {
                position: Point::new(s - 200.0, 900.0),
                direction: unit(1.0, 0.0),
            };
            Track::on(
                number,
                Road::Away.path(),
                Vehicle {
                    s,
                    speed: 10.0,
                    pose,
                },
            )
        };
        seen.tracks.insert(0, away(2000, 50.0));
        let rest = (0..10).map(|i| away(3000 + (step as u16 % 50) * 10 + i, f32::from(i) * 30.0));
        seen.tracks.extend(rest);
        seen
    })
}

/// Without one of the tracks, the hardest acceleration that passes is no harder.
pub(super) fn missing<R: Rules + Clone>(context: &Context<'_>, id: &'static str) -> Found {
    let most = context.subject.contract.ego().acceleration;
    twins::<R>(context, id, |_, call| {
        if call.world.case.noise.errors != Level::None {
            // An older observation may have been a luckier one.
            return Err(Miss::skip("sensors are not exact"));
        }
        if call.world.step == 0 {
            return Ok(());
        }
        let passes = |seen: &Seen| {
            let decision = call.before.probe(seen, most);
            // The next command of the plan is as safe, and may be harder than what can be verified anew.
            (decision.acceleration, !is_fresh(&decision))
        };
        let (all, _) = passes(call.seen);
        for left_out in 0..call.seen.tracks.len() {
            let mut seen = call.seen.clone();
            let track = seen.tracks.remove(left_out);
            let (acceleration, remembered) = passes(&seen);
            if acceleration > all && !remembered {
                return Err(Miss::Broken(format!(
                    "after {:.2} s: without track {}, {acceleration} m/s² pass, with it {all} m/s²",
                    call.world.time(),
                    track.number,
                )));
            }
        }
        Ok(())
    })
}

/// By so much (m) a margin may differ because of rounding.
const ROUNDING: f32 = 1e-3;

/// Policy and contract are replaced by themselves, now and then.
pub(super) fn replacing<R: Rules + Clone>(context: &Context<'_>, id: &'static str) -> Found {
    let subject = context.subject;
    twins::<R>(context, id, |twin, call| {
        if call.world.step % 7 == 3 && is_fresh(call.decision) {
            twin.set_policy(subject.policy);
            twin.set_contract(subject.contract).map_err(Miss::broken)?;
        }
        let mut decision = twin.decide(call.seen, call.proposal);
        // Who is not seen coasts on in two steps instead of one: the margin may be rounded otherwise.
        if (decision.margin - call.decision.margin).abs() <= ROUNDING {
            decision.margin = call.decision.margin;
        }
        same(call, call.decision, &decision)
    })
}

/// Whether its plan was found anew.
fn is_fresh(decision: &Decision) -> bool {
    match decision.cause {
        Cause::Policy => true,
        Cause::Shielded(Intervention { action, .. }) => action == Action::Nearest,
        _ => false,
    }
}
