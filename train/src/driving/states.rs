//! Serialises the states of two vehicles as four numbers, for checkpoints.

use cede_controller::kinematics::State;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub(crate) fn serialize<S: Serializer>(states: &[State; 2], to: S) -> Result<S::Ok, S::Error> {
    states.map(|state| (state.s, state.v)).serialize(to)
}

pub(crate) fn deserialize<'d, D: Deserializer<'d>>(from: D) -> Result<[State; 2], D::Error> {
    let states = <[(f32, f32); 2]>::deserialize(from)?;
    Ok(states.map(|(s, v)| State { s, v }))
}
