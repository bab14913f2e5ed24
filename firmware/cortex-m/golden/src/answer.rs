//! A decision as words: every bit of it.

use cede_controller::{
    Action, Breach, Cause, Decision, Fault, Field, InputFault, Intervention, Prediction, Reason,
    Subject,
};

/// Words of a decision.
pub const ANSWER: usize = 18;

/// Words of a fault.
const FAULT: usize = 4;

/// Stands for what has no code of its own yet.
const UNKNOWN: u32 = 100;

/// Every field of `decision`, as bit patterns.
#[must_use]
pub fn answer(decision: &Decision) -> [u32; ANSWER] {
    let mut words = [0; ANSWER];
    let mut places = words.iter_mut();
    let mut put = |word: u32| {
        // There is a place for each: `ANSWER` counts them.
        if let Some(place) = places.next() {
            *place = word;
        }
    };
    put(decision.acceleration.to_bits());
    put(decision.margin.to_bits());
    cause(decision.cause).into_iter().for_each(&mut put);
    let fault = decision.fault.map_or([0; FAULT], fault);
    fault.into_iter().for_each(&mut put);
    put(decision.plan.map_or(0, |plan| 1 + u32::from(plan.go)));
    put(decision.unwatched.map_or(0, |other| 1 + u32::from(other)));
    breach(decision.breach).into_iter().for_each(&mut put);
    prediction(decision.prediction)
        .into_iter()
        .for_each(&mut put);
    words
}

/// What decided, and the fault or the reason.
fn cause(cause: Cause) -> [u32; 1 + FAULT] {
    let [first, rest @ ..] = match cause {
        Cause::Policy => return [0; 1 + FAULT],
        Cause::Shielded(intervention) => shielded(intervention),
        Cause::Fallback(which) => {
            let [kind, subject, field, value] = fault(which);
            [10 + kind, subject, field, value]
        }
        _ => [UNKNOWN; FAULT],
    };
    let [a, b, c] = rest;
    [first, a, b, c, 0]
}

fn fault(fault: Fault) -> [u32; FAULT] {
    match fault {
        Fault::NoPlan => [1, 0, 0, 0],
        Fault::Proposal => [2, 0, 0, 0],
        Fault::Backwards => [3, 0, 0, 0],
        Fault::OffPeriod { elapsed, period } => [4, elapsed.to_bits(), period.to_bits(), 0],
        Fault::Input(input) => of_input(input),
        _ => [UNKNOWN; FAULT],
    }
}

fn of_input(input: InputFault) -> [u32; FAULT] {
    let subject = match input.subject {
        Subject::Ego => 0,
        Subject::Track(number) => 1 + u32::from(number),
        _ => UNKNOWN,
    };
    let field = match input.field {
        Field::ArcLength => 0,
        Field::Speed => 1,
        Field::Position => 2,
        Field::Direction => 3,
        Field::Offset => 4,
        Field::Heading => 5,
        Field::Path => 6,
        Field::Number => 7,
        _ => UNKNOWN,
    };
    // Of what is no number, targets may keep different bits.
    let value = if input.value.is_nan() {
        f32::NAN.to_bits()
    } else {
        input.value.to_bits()
    };
    [5, subject, field, value]
}

fn breach(breach: Option<Breach>) -> [u32; 2] {
    match breach {
        None => [0, 0],
        Some(Breach::Ego) => [1, 0],
        Some(Breach::Other(other)) => [2, other.into()],
        Some(_) => [UNKNOWN, 0],
    }
}

fn prediction(prediction: Option<Prediction>) -> [u32; 3] {
    match prediction {
        None => [0; 3],
        Some(Prediction {
            other,
            svo,
            acceleration,
            ..
        }) => [1 + u32::from(other), svo.to_bits(), acceleration.to_bits()],
    }
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
