//! A decision as words: every bit of it.

use cede_controller::{
    Action, Breach, Cause, Decision, Fault, Field, InputFault, Intervention, Prediction, Reason,
    Subject,
};

/// Words of a decision.
pub const ANSWER: usize = 8 + FAULT + 5;

/// Words of a fault: what it is, whose number it is, which, and up to three numbers.
const FAULT: usize = 6;

/// Stands for what has no code of its own yet.
const UNKNOWN: u32 = 100;

/// Every field of `decision`, as bit patterns.
#[must_use]
pub fn answer(decision: &Decision) -> [u32; ANSWER] {
    let [cause, who, first, second] = match decision.cause {
        Cause::Policy => [0; 4],
        Cause::Shielded(intervention) => shielded(intervention),
        Cause::Fallback(fault) => {
            let [kind, who, field, value, ..] = self::fault(Some(fault));
            [10 + kind, who, field, value]
        }
        _ => [UNKNOWN, 0, 0, 0],
    };
    let [breach, breaker] = match decision.breach {
        None => [0, 0],
        Some(Breach::Ego) => [1, 0],
        Some(Breach::Other(other)) => [2, other.into()],
        Some(_) => [UNKNOWN, 0],
    };
    let [kind, whose, field, value, low, high] = fault(decision.fault);
    let [asked, svo, expected] = match decision.prediction {
        None => [0; 3],
        Some(Prediction {
            other,
            svo,
            acceleration,
            ..
        }) => [1 + u32::from(other), svo.to_bits(), acceleration.to_bits()],
    };
    let plan = decision.plan.map_or(0, |plan| 1 + u32::from(plan.go));
    let unwatched = decision.unwatched.map_or(0, |other| 1 + u32::from(other));
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
        kind,
        whose,
        field,
        value,
        low,
        high,
        plan,
        unwatched,
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

fn fault(fault: Option<Fault>) -> [u32; FAULT] {
    match fault {
        None => [0; FAULT],
        Some(Fault::NoPlan) => [1, 0, 0, 0, 0, 0],
        Some(Fault::Input(input)) => refused(input),
        Some(Fault::Backwards) => [3, 0, 0, 0, 0, 0],
        Some(Fault::OffPeriod { elapsed, period }) => {
            [4, 0, 0, elapsed.to_bits(), period.to_bits(), 0]
        }
        Some(Fault::Proposal) => [5, 0, 0, 0, 0, 0],
        Some(_) => [UNKNOWN, 0, 0, 0, 0, 0],
    }
}

fn refused(input: InputFault) -> [u32; FAULT] {
    let whose = match input.subject {
        Subject::Ego => 0,
        Subject::Track(number) => 1 + u32::from(number),
        _ => u32::MAX,
    };
    let field = match input.field {
        Field::ArcLength => 1,
        Field::Speed => 2,
        Field::Position => 3,
        Field::Direction => 4,
        Field::Offset => 5,
        Field::Heading => 6,
        Field::Path => 7,
        Field::Number => 8,
        _ => UNKNOWN,
    };
    // The sign and payload of what is no number differ between processors.
    let value = if input.value.is_nan() {
        f32::NAN
    } else {
        input.value
    };
    let [value, low, high] = [value, input.low, input.high].map(f32::to_bits);
    [2, whose, field, value, low, high]
}
