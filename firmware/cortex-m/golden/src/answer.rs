//! A decision as words: every bit of it.

use cede_controller::{Action, Breach, Cause, Decision, Fault, Intervention, Prediction, Reason};

/// Words of a decision.
pub const ANSWER: usize = 11;

/// Stands for what has no code of its own yet.
const UNKNOWN: u32 = 100;

/// Every field of `decision`, as bit patterns.
#[must_use]
pub fn answer(decision: &Decision) -> [u32; ANSWER] {
    let [cause, who, first, second] = match decision.cause {
        Cause::Policy => [0; 4],
        Cause::Shielded(intervention) => shielded(intervention),
        Cause::Fallback(fault) => match fault {
            Fault::Ego => [10, 0, 0, 0],
            Fault::Other(other) => [11, other.into(), 0, 0],
            Fault::Proposal => [12, 0, 0, 0],
            Fault::Unverified => [13, 0, 0, 0],
            _ => [UNKNOWN, 0, 0, 0],
        },
        _ => [UNKNOWN, 0, 0, 0],
    };
    let [breach, breaker] = match decision.breach {
        None => [0, 0],
        Some(Breach::Ego) => [1, 0],
        Some(Breach::Other(other)) => [2, other.into()],
        Some(_) => [UNKNOWN, 0],
    };
    let [asked, svo, expected] = match decision.prediction {
        None => [0; 3],
        Some(Prediction {
            other,
            svo,
            acceleration,
            ..
        }) => [1 + u32::from(other), svo.to_bits(), acceleration.to_bits()],
    };
    let (acceleration, margin) = (decision.acceleration.to_bits(), decision.margin.to_bits());
    [
        acceleration,
        margin,
        cause,
        who,
        first,
        second,
        breach,
        breaker,
        asked,
        svo,
        expected,
    ]
}

fn shielded(Intervention { action, reason, .. }: Intervention) -> [u32; 4] {
    let action = match action {
        Action::Nearest => 1,
        Action::Remembered => 4,
        _ => UNKNOWN,
    };
    let (reason, other, numbers) = match reason {
        Reason::Arrival {
            other,
            arrives,
            clears,
        } => (0, other, [arrives, clears]),
        Reason::Entry { other, gap, needs } => (1, other, [gap, needs]),
        Reason::Stop {
            other,
            available,
            needs,
        } => (2, other, [available, needs]),
        _ => (UNKNOWN, 0, [0.0; 2]),
    };
    let [first, second] = numbers.map(f32::to_bits);
    [action + reason, other.into(), first, second]
}
