//! What the controller decides, and why, as numbers.

use cede_controller::{
    Action, Breach, Cause, Condition, Contract, Decision, Fault, Field, Headroom, InputFault,
    Prediction, Reason, Room, Subject,
};
use core::ffi::CStr;

/// Braking in m/s^2 that is commanded when the approach cannot be used: nothing is known of its contract then.
pub const CEDE_LAST_RESORT_BRAKING: f32 = 3.0;

const _: () = assert!(CEDE_LAST_RESORT_BRAKING == Contract::WORST_CASE.ego().braking);

/// Who decided.
#[repr(u8)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum cede_cause {
    /// Nobody: the approach cannot be used, and the command is CEDE_LAST_RESORT_BRAKING.
    None = 0,
    /// The policy: its proposal is safe.
    Policy = 1,
    /// The shield: the proposal is not; `action` and `reason` say more.
    Shielded = 2,
    /// Neither: `fallback` says why.
    Fallback = 3,
    /// What this version has no number for.
    Other = 255,
}

/// What the shield does instead of what was proposed.
#[repr(u8)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum cede_action {
    /// Nothing.
    None = 0,
    /// The nearest acceleration that is safe.
    Nearest = 1,
    /// The next command of the plan that was verified last.
    Remembered = 2,
    /// What this version has no number for.
    Other = 255,
}

/// Why a proposal is refused.
#[repr(u8)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum cede_reason_kind {
    /// It is not.
    None = 0,
    /// The ego could not clear the zone before the other's earliest arrival; s from now.
    Arrival = 1,
    /// The ego would enter the other's lane without the gap in which the other can stop; m.
    Entry = 2,
    /// The ego could not stop short of the other's zone, or behind the other in its lane; m.
    Stop = 3,
    /// The ego could not clear the zone before somebody arrives who may be out of sight; s from now.
    Hidden = 4,
    /// What this version has no number for.
    Other = 255,
}

/// Why a proposal is refused.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct cede_reason {
    /// What kind of reason.
    pub kind: cede_reason_kind,
    /// 0.
    pub reserved: u8,
    /// Number of the track; with CEDE_REASON_KIND_HIDDEN, of the path that is out of sight.
    pub other: u16,
    /// What there is: seconds to the other's arrival, metres of the gap, metres to where the ego must be at rest.
    pub available: f32,
    /// What is needed: seconds to clear the zone, metres of the gap, metres to stop.
    pub needed: f32,
}

/// What is wrong with an input, or with what is left to do.
#[repr(u8)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum cede_fault_kind {
    /// Nothing.
    None = 0,
    /// No plan keeps the guarantee: the contract was broken, or control was handed over in danger.
    NoPlan = 1,
    /// A number of the observation is out of its range.
    Input = 2,
    /// The call's time is not later than that of the last call.
    Backwards = 3,
    /// The last call is not one period ago: `value` s instead of `high` s.
    OffPeriod = 4,
    /// The proposed acceleration is not a finite number.
    Proposal = 5,
    /// What this version has no number for.
    Other = 255,
}

/// Whose state it is.
#[repr(u8)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum cede_subject {
    /// Nobody's.
    None = 0,
    /// The ego's.
    Ego = 1,
    /// The track's.
    Track = 2,
    /// What this version has no number for.
    Other = 255,
}

/// A number of a vehicle's state.
#[repr(u8)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum cede_field {
    /// None.
    None = 0,
    /// Arc length in m, outside the path.
    ArcLength = 1,
    /// Speed in m/s.
    Speed = 2,
    /// The coordinate (m) that is farther from 0.
    Position = 3,
    /// Length of the direction, which is not a unit vector.
    Direction = 4,
    /// Metres between the pose and where the path is at that arc length.
    Offset = 5,
    /// Cosine of the angle between the direction and that of the path.
    Heading = 6,
    /// Number of a path that the junction does not have, or that has another class than the track.
    Path = 7,
    /// Number of a track that the observation has twice, on one path.
    Number = 8,
    /// What this version has no number for.
    Other = 255,
}

/// A fault, and the number that is out of its range if it is one of an input.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct cede_fault {
    /// What kind of fault.
    pub kind: cede_fault_kind,
    /// Whose state.
    pub subject: cede_subject,
    /// Which number of it.
    pub field: cede_field,
    /// 0.
    pub reserved: u8,
    /// Number of the track, if the subject is one.
    pub track: u16,
    /// 0.
    pub reserved2: u16,
    /// The value; perhaps not a number.
    pub value: f32,
    /// The least that is accepted.
    pub low: f32,
    /// The most that is accepted.
    pub high: f32,
}

/// Whose motion since the last decision exceeds the contract's bounds.
#[repr(u8)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum cede_breach {
    /// Nobody's.
    None = 0,
    /// The ego deviated from the command.
    Ego = 1,
    /// The track's.
    Track = 2,
    /// What this version has no number for.
    Other = 255,
}

/// What the policy thinks of one other.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct cede_prediction {
    /// Number of the track.
    pub other: u16,
    /// 0.
    pub reserved: u16,
    /// The ego's social value orientation towards it in rad, in [0, pi/2].
    pub svo: f32,
    /// The acceleration in m/s^2 that is expected of it.
    pub acceleration: f32,
}

/// A condition of the contract that is monitored.
#[repr(u8)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum cede_condition {
    /// None.
    None = 0,
    /// The ego's arc length, in m: how far it is inside of what its commands lead to.
    EgoPosition = 1,
    /// The ego's speed, in m/s: the same.
    EgoSpeed = 2,
    /// A track's arc length, in m: how far it is inside of what the contract allows since it was seen last.
    OtherPosition = 3,
    /// A track's speed, in m/s: the same.
    OtherSpeed = 4,
    /// The distance (m) between a pose and its place on the path.
    Offset = 5,
    /// The cosine of the angle between a direction and the path.
    Heading = 6,
    /// The time (s) since the last call, against period and jitter.
    Period = 7,
    /// What this version has no number for.
    Other = 255,
}

/// What is left of a tolerance.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct cede_room {
    /// What is left, in the condition's unit; below 0 the condition is broken.
    pub left: f32,
    /// The same as a share of the most that can be left: 1 in the middle of what is allowed, 0 at its end.
    pub share: f32,
    /// Number of the track that has least left.
    pub track: u16,
    /// 1 if there was something to compare.
    pub is_known: u8,
    /// 1 if it is a track's.
    pub has_track: u8,
}

/// How near each monitored condition of the contract is to its limit. A breach is a position or a speed of which less than 0
/// is left.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct cede_headroom {
    /// CEDE_CONDITION_EGO_POSITION.
    pub ego_position: cede_room,
    /// CEDE_CONDITION_EGO_SPEED.
    pub ego_speed: cede_room,
    /// CEDE_CONDITION_OTHER_POSITION.
    pub other_position: cede_room,
    /// CEDE_CONDITION_OTHER_SPEED.
    pub other_speed: cede_room,
    /// CEDE_CONDITION_OFFSET.
    pub offset: cede_room,
    /// CEDE_CONDITION_HEADING.
    pub heading: cede_room,
    /// CEDE_CONDITION_PERIOD.
    pub period: cede_room,
    /// The condition of which the smallest share is left.
    pub least: cede_condition,
    /// 0.
    pub reserved: [u8; 3],
}

/// The ego's acceleration for the period that begins, and why it is what it is.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct cede_decision {
    /// The acceleration in m/s^2: always finite, and within [-braking, acceleration] of the contract's ego.
    pub acceleration: f32,
    /// Metres to spare of the best plan that follows; negative if no plan is safe.
    pub margin: f32,
    /// Who decided.
    pub cause: cede_cause,
    /// What the shield did, if it decided.
    pub action: cede_action,
    /// Whose motion exceeds the contract's bounds.
    pub breach: cede_breach,
    /// 1 if there is a plan that is carried out if nothing better is found; 0 is no guarantee.
    pub has_plan: u8,
    /// For so many periods the plan accelerates at ego_go; then it brakes.
    pub plan_go: u16,
    /// Number of the track whose motion exceeds the contract's bounds.
    pub breach_track: u16,
    /// Number of a track that matters and for which there is no room.
    pub unwatched: u16,
    /// 1 if there is such a track: the ego stays out of its zones.
    pub has_unwatched: u8,
    /// 1 if the policy was asked: `prediction` holds.
    pub has_prediction: u8,
    /// Why the shield refused the proposal, if it decided.
    pub reason: cede_reason,
    /// Why neither policy nor shield decided, if so.
    pub fallback: cede_fault,
    /// What is wrong with the inputs, if something is.
    pub fault: cede_fault,
    /// What the policy thinks of the other that restricts the ego most.
    pub prediction: cede_prediction,
    /// How near each monitored condition of the contract is to its limit.
    pub headroom: cede_headroom,
}

impl cede_reason {
    pub(crate) const NONE: Self = Self {
        kind: cede_reason_kind::None,
        reserved: 0,
        other: 0,
        available: 0.0,
        needed: 0.0,
    };
}

impl From<Reason> for cede_reason {
    fn from(reason: Reason) -> Self {
        use cede_reason_kind as Kind;
        let (kind, other, available, needed) = match reason {
            Reason::Arrival {
                other,
                arrives,
                clears,
            } => (Kind::Arrival, other, arrives, clears),
            Reason::Entry { other, gap, needs } => (Kind::Entry, other, gap, needs),
            Reason::Stop {
                other,
                available,
                needs,
            } => (Kind::Stop, other, available, needs),
            Reason::Hidden {
                path,
                arrives,
                clears,
            } => (Kind::Hidden, path.into(), arrives, clears),
            _ => (Kind::Other, 0, 0.0, 0.0),
        };
        Self {
            kind,
            reserved: 0,
            other,
            available,
            needed,
        }
    }
}

impl cede_fault {
    pub(crate) const NONE: Self = Self::of(cede_fault_kind::None);

    const fn of(kind: cede_fault_kind) -> Self {
        Self {
            kind,
            subject: cede_subject::None,
            field: cede_field::None,
            reserved: 0,
            track: 0,
            reserved2: 0,
            value: 0.0,
            low: 0.0,
            high: 0.0,
        }
    }
}

impl From<Fault> for cede_fault {
    fn from(fault: Fault) -> Self {
        use cede_fault_kind as Kind;
        match fault {
            Fault::NoPlan => Self::of(Kind::NoPlan),
            Fault::Input(input) => input.into(),
            Fault::Backwards => Self::of(Kind::Backwards),
            Fault::OffPeriod { elapsed, period } => Self {
                value: elapsed,
                low: period,
                high: period,
                ..Self::of(Kind::OffPeriod)
            },
            Fault::Proposal => Self::of(Kind::Proposal),
            _ => Self::of(Kind::Other),
        }
    }
}

impl From<InputFault> for cede_fault {
    fn from(input: InputFault) -> Self {
        let (subject, track) = match input.subject {
            Subject::Ego => (cede_subject::Ego, 0),
            Subject::Track(number) => (cede_subject::Track, number),
            _ => (cede_subject::Other, 0),
        };
        Self {
            subject,
            field: field(input.field),
            track,
            value: input.value,
            low: input.low,
            high: input.high,
            ..Self::of(cede_fault_kind::Input)
        }
    }
}

fn field(field: Field) -> cede_field {
    match field {
        Field::ArcLength => cede_field::ArcLength,
        Field::Speed => cede_field::Speed,
        Field::Position => cede_field::Position,
        Field::Direction => cede_field::Direction,
        Field::Offset => cede_field::Offset,
        Field::Heading => cede_field::Heading,
        Field::Path => cede_field::Path,
        Field::Number => cede_field::Number,
        _ => cede_field::Other,
    }
}

impl cede_room {
    const NONE: Self = Self {
        left: 0.0,
        share: 0.0,
        track: 0,
        is_known: 0,
        has_track: 0,
    };
}

impl From<Option<Room>> for cede_room {
    fn from(room: Option<Room>) -> Self {
        room.map_or(Self::NONE, |room| Self {
            left: room.left,
            share: room.share,
            track: room.track.unwrap_or(0),
            is_known: 1,
            has_track: room.track.is_some().into(),
        })
    }
}

impl cede_headroom {
    const NONE: Self = Self {
        ego_position: cede_room::NONE,
        ego_speed: cede_room::NONE,
        other_position: cede_room::NONE,
        other_speed: cede_room::NONE,
        offset: cede_room::NONE,
        heading: cede_room::NONE,
        period: cede_room::NONE,
        least: cede_condition::None,
        reserved: [0; 3],
    };
}

impl From<&Headroom> for cede_headroom {
    fn from(headroom: &Headroom) -> Self {
        let least = headroom.least();
        Self {
            ego_position: headroom.ego_position.into(),
            ego_speed: headroom.ego_speed.into(),
            other_position: headroom.other_position.into(),
            other_speed: headroom.other_speed.into(),
            offset: headroom.offset.into(),
            heading: headroom.heading.into(),
            period: headroom.period.into(),
            least: least.map_or(cede_condition::None, |(condition, _)| of(condition)),
            reserved: [0; 3],
        }
    }
}

fn of(condition: Condition) -> cede_condition {
    match condition {
        Condition::EgoPosition => cede_condition::EgoPosition,
        Condition::EgoSpeed => cede_condition::EgoSpeed,
        Condition::OtherPosition => cede_condition::OtherPosition,
        Condition::OtherSpeed => cede_condition::OtherSpeed,
        Condition::Offset => cede_condition::Offset,
        Condition::Heading => cede_condition::Heading,
        Condition::Period => cede_condition::Period,
        _ => cede_condition::Other,
    }
}

impl cede_prediction {
    const NONE: Self = Self {
        other: 0,
        reserved: 0,
        svo: 0.0,
        acceleration: 0.0,
    };
}

impl From<Prediction> for cede_prediction {
    fn from(prediction: Prediction) -> Self {
        Self {
            other: prediction.other,
            reserved: 0,
            svo: prediction.svo,
            acceleration: prediction.acceleration,
        }
    }
}

impl cede_decision {
    /// There is none.
    pub(crate) const NONE: Self = Self {
        acceleration: -CEDE_LAST_RESORT_BRAKING,
        margin: 0.0,
        cause: cede_cause::None,
        action: cede_action::None,
        breach: cede_breach::None,
        has_plan: 0,
        plan_go: 0,
        breach_track: 0,
        unwatched: 0,
        has_unwatched: 0,
        has_prediction: 0,
        reason: cede_reason::NONE,
        fallback: cede_fault::NONE,
        fault: cede_fault::NONE,
        prediction: cede_prediction::NONE,
        headroom: cede_headroom::NONE,
    };

    fn caused(self, cause: Cause) -> Self {
        match cause {
            Cause::Policy => Self {
                cause: cede_cause::Policy,
                ..self
            },
            Cause::Shielded(intervention) => Self {
                cause: cede_cause::Shielded,
                action: match intervention.action {
                    Action::Nearest => cede_action::Nearest,
                    Action::Remembered => cede_action::Remembered,
                    _ => cede_action::Other,
                },
                reason: intervention.reason.into(),
                ..self
            },
            Cause::Fallback(fault) => Self {
                cause: cede_cause::Fallback,
                fallback: fault.into(),
                ..self
            },
            _ => Self {
                cause: cede_cause::Other,
                ..self
            },
        }
    }
}

impl From<&Decision> for cede_decision {
    fn from(decision: &Decision) -> Self {
        let (breach, breach_track) = match decision.breach {
            None => (cede_breach::None, 0),
            Some(Breach::Ego) => (cede_breach::Ego, 0),
            Some(Breach::Other(track)) => (cede_breach::Track, track),
            Some(_) => (cede_breach::Other, 0),
        };
        Self {
            acceleration: decision.acceleration,
            margin: decision.margin,
            breach,
            breach_track,
            has_plan: decision.plan.is_some().into(),
            plan_go: decision.plan.map_or(0, |plan| plan.go),
            unwatched: decision.unwatched.unwrap_or(0),
            has_unwatched: decision.unwatched.is_some().into(),
            has_prediction: decision.prediction.is_some().into(),
            fault: decision.fault.map_or(cede_fault::NONE, Into::into),
            prediction: decision
                .prediction
                .map_or(cede_prediction::NONE, Into::into),
            headroom: (&decision.headroom).into(),
            ..Self::NONE
        }
        .caused(decision.cause)
    }
}

pub(crate) const CAUSE: &[(u8, &CStr)] = &[
    (cede_cause::None as u8, c"nobody decided"),
    (cede_cause::Policy as u8, c"policy"),
    (cede_cause::Shielded as u8, c"shielded"),
    (cede_cause::Fallback as u8, c"fallback"),
    (cede_cause::Other as u8, c"other"),
];

pub(crate) const ACTION: &[(u8, &CStr)] = &[
    (cede_action::None as u8, c"none"),
    (
        cede_action::Nearest as u8,
        c"the nearest acceleration that is safe",
    ),
    (
        cede_action::Remembered as u8,
        c"the next command of the remembered plan",
    ),
    (cede_action::Other as u8, c"other"),
];

pub(crate) const REASON: &[(u8, &CStr)] = &[
    (cede_reason_kind::None as u8, c"none"),
    (
        cede_reason_kind::Arrival as u8,
        c"the other may arrive before the zone is clear",
    ),
    (
        cede_reason_kind::Entry as u8,
        c"the gap to the other on entry is too small",
    ),
    (cede_reason_kind::Stop as u8, c"too near to stop"),
    (
        cede_reason_kind::Hidden as u8,
        c"somebody out of sight may arrive before the zone is clear",
    ),
    (cede_reason_kind::Other as u8, c"other"),
];

pub(crate) const FAULT: &[(u8, &CStr)] = &[
    (cede_fault_kind::None as u8, c"none"),
    (cede_fault_kind::NoPlan as u8, c"no plan is safe"),
    (
        cede_fault_kind::Input as u8,
        c"a number of the observation is out of its range",
    ),
    (
        cede_fault_kind::Backwards as u8,
        c"the time of the call is before that of the last one",
    ),
    (
        cede_fault_kind::OffPeriod as u8,
        c"the last call was not one period ago",
    ),
    (
        cede_fault_kind::Proposal as u8,
        c"the proposed acceleration is not a finite number",
    ),
    (cede_fault_kind::Other as u8, c"other"),
];

pub(crate) const SUBJECT: &[(u8, &CStr)] = &[
    (cede_subject::None as u8, c"nobody"),
    (cede_subject::Ego as u8, c"the ego"),
    (cede_subject::Track as u8, c"track"),
    (cede_subject::Other as u8, c"other"),
];

pub(crate) const FIELD: &[(u8, &CStr)] = &[
    (cede_field::None as u8, c"none"),
    (cede_field::ArcLength as u8, c"arc length (m)"),
    (cede_field::Speed as u8, c"speed (m/s)"),
    (cede_field::Position as u8, c"coordinate (m)"),
    (cede_field::Direction as u8, c"length of the direction"),
    (
        cede_field::Offset as u8,
        c"distance (m) of the pose from its place on the path",
    ),
    (
        cede_field::Heading as u8,
        c"cosine of the angle to the path",
    ),
    (cede_field::Path as u8, c"path of this class"),
    (cede_field::Number as u8, c"number that is there twice"),
    (cede_field::Other as u8, c"other"),
];

pub(crate) const CONDITION: &[(u8, &CStr)] = &[
    (cede_condition::None as u8, c"none"),
    (
        cede_condition::EgoPosition as u8,
        c"the ego's arc length (m)",
    ),
    (cede_condition::EgoSpeed as u8, c"the ego's speed (m/s)"),
    (
        cede_condition::OtherPosition as u8,
        c"a track's arc length (m)",
    ),
    (cede_condition::OtherSpeed as u8, c"a track's speed (m/s)"),
    (
        cede_condition::Offset as u8,
        c"distance (m) of a pose from its place on the path",
    ),
    (
        cede_condition::Heading as u8,
        c"cosine of the angle to the path",
    ),
    (
        cede_condition::Period as u8,
        c"time (s) since the last call",
    ),
    (cede_condition::Other as u8, c"other"),
];

pub(crate) const BREACH: &[(u8, &CStr)] = &[
    (cede_breach::None as u8, c"none"),
    (cede_breach::Ego as u8, c"the ego deviated from the command"),
    (
        cede_breach::Track as u8,
        c"a track exceeds the contract's motion bounds",
    ),
    (cede_breach::Other as u8, c"other"),
];
