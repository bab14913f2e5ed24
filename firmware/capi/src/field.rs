//! The fields of a contract, as refusals name them.

use core::ffi::CStr;

/// A field of cede_contract. The numbers are stable.
#[repr(u8)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "fields of cede_contract")]
pub enum cede_contract_field {
    None = 0,
    Period = 1,
    Latency = 2,
    Jitter = 3,
    PositionError = 4,
    SpeedError = 5,
    Slack = 6,
    EgoMaxSpeed = 7,
    EgoAcceleration = 8,
    EgoGo = 9,
    EgoBraking = 10,
    OtherMaxSpeed = 11,
    OtherAcceleration = 12,
    OtherBraking = 13,
    FollowerReaction = 14,
    FollowerBraking = 15,
    PrecedenceDistance = 16,
    PrecedenceBraking = 17,
    PrecedencePatience = 18,
    EgoEmergency = 19,
    EgoLag = 20,
    EgoGain = 21,
    EgoDisturbance = 22,
    Other = 255,
}

/// Fields, and their names in the controller.
pub(crate) const CONTRACT_FIELD: &[(u8, &CStr)] = {
    use cede_contract_field as Field;
    &[
        (Field::None as u8, c"none"),
        (Field::Period as u8, c"period"),
        (Field::Latency as u8, c"latency"),
        (Field::Jitter as u8, c"jitter"),
        (Field::PositionError as u8, c"position_error"),
        (Field::SpeedError as u8, c"speed_error"),
        (Field::Slack as u8, c"slack"),
        (Field::EgoMaxSpeed as u8, c"ego.max_speed"),
        (Field::EgoAcceleration as u8, c"ego.acceleration"),
        (Field::EgoGo as u8, c"ego.go"),
        (Field::EgoBraking as u8, c"ego.braking"),
        (Field::OtherMaxSpeed as u8, c"other.max_speed"),
        (Field::OtherAcceleration as u8, c"other.acceleration"),
        (Field::OtherBraking as u8, c"other.braking"),
        (Field::FollowerReaction as u8, c"follower.reaction"),
        (Field::FollowerBraking as u8, c"follower.braking"),
        (Field::PrecedenceDistance as u8, c"precedence.distance"),
        (Field::PrecedenceBraking as u8, c"precedence.braking"),
        (Field::PrecedencePatience as u8, c"precedence.patience"),
        (Field::EgoEmergency as u8, c"ego.emergency"),
        (Field::EgoLag as u8, c"ego.lag"),
        (Field::EgoGain as u8, c"ego.gain"),
        (Field::EgoDisturbance as u8, c"ego.disturbance"),
        (Field::Other as u8, c"other"),
    ]
};

/// The field that the controller calls `name`.
pub(crate) fn field(name: &str) -> cede_contract_field {
    use cede_contract_field as Field;
    match name {
        "period" => Field::Period,
        "latency" => Field::Latency,
        "jitter" => Field::Jitter,
        "position_error" => Field::PositionError,
        "speed_error" => Field::SpeedError,
        "slack" => Field::Slack,
        "ego.max_speed" => Field::EgoMaxSpeed,
        "ego.acceleration" => Field::EgoAcceleration,
        "ego.go" => Field::EgoGo,
        "ego.braking" => Field::EgoBraking,
        "other.max_speed" => Field::OtherMaxSpeed,
        "other.acceleration" => Field::OtherAcceleration,
        "other.braking" => Field::OtherBraking,
        "follower.reaction" => Field::FollowerReaction,
        "follower.braking" => Field::FollowerBraking,
        "precedence.distance" => Field::PrecedenceDistance,
        "precedence.braking" => Field::PrecedenceBraking,
        "precedence.patience" => Field::PrecedencePatience,
        "ego.emergency" => Field::EgoEmergency,
        "ego.lag" => Field::EgoLag,
        "ego.gain" => Field::EgoGain,
        "ego.disturbance" => Field::EgoDisturbance,
        _ => Field::Other,
    }
}
