//! A contract from a file: as valid as one that is built.

use super::{Contract, ContractBuilder, ContractError, Follower, Other, Precedence};
use serde::Deserialize;

/// The numbers as they are read, not yet validated.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Numbers {
    period: f32,
    latency: f32,
    #[serde(default)]
    jitter: f32,
    position_error: f32,
    speed_error: f32,
    slack: f32,
    ego: Vehicle,
    other: Other,
    follower: Follower,
    #[serde(default)]
    precedence: Option<Precedence>,
}

/// [`super::Ego`]; without a number for it, emergency braking is `braking`, and the ego follows a command at once and exactly.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Vehicle {
    max_speed: f32,
    acceleration: f32,
    go: f32,
    braking: f32,
    #[serde(default)]
    emergency: Option<f32>,
    #[serde(default)]
    lag: f32,
    #[serde(default)]
    gain: f32,
    #[serde(default)]
    disturbance: f32,
}

impl TryFrom<Numbers> for Contract {
    type Error = ContractError;

    fn try_from(read: Numbers) -> Result<Self, ContractError> {
        ContractBuilder::new(Self {
            period: read.period,
            latency: read.latency,
            jitter: read.jitter,
            position_error: read.position_error,
            speed_error: read.speed_error,
            slack: read.slack,
            ego: super::Ego {
                max_speed: read.ego.max_speed,
                acceleration: read.ego.acceleration,
                go: read.ego.go,
                braking: read.ego.braking,
                emergency: read.ego.emergency.unwrap_or(read.ego.braking),
                lag: read.ego.lag,
                gain: read.ego.gain,
                disturbance: read.ego.disturbance,
            },
            other: read.other,
            follower: read.follower,
            precedence: read.precedence,
        })
        .build()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contract_is_read_back_and_a_wrong_one_is_refused() {
        for contract in [Contract::WORST_CASE, Contract::ALL_WAY_STOP] {
            let written = serde_json::to_string(&contract).unwrap();
            assert_eq!(
                serde_json::from_str::<Contract>(&written).unwrap(),
                contract
            );
            let wrong = written.replace("\"latency\":0.1", "\"latency\":1.2");
            let error = serde_json::from_str::<Contract>(&wrong).unwrap_err();
            let text = std::string::ToString::to_string(&error);
            assert!(
                text.starts_with("latency = 1.2 is outside [0, 1]"),
                "{text}"
            );
        }
    }
}
