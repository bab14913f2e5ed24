//! Where the closed loop of policy, shield and kinematics can get to, in an encounter with one other.
//!
//! A tube encloses every trajectory from a box of initial states, step by step: the policy's answer
//! on the box ([`crate::policy`]), what the shield may make of it (its own margins, over
//! intervals), and one step of the kinematics with the other doing anything that the scenario
//! allows it. Where a tube is too wide to show the claim, the box of initial states is cut.
//!
//! The two routes cross at a right angle, straight on, as [`geometry`] builds them. **What a proof is about**:
//! an `Approach` with its worst-case contract and exact sensors, a command that is in effect
//! for the whole period, and the simulator's exact kinematics; `f32` rounding is allowed for.

mod scenario;
mod search;
mod shield;
mod states;
mod step;
#[cfg(test)]
mod tests;

pub use scenario::{Claim, Crossing, EGO, OTHER, Scenario, ScenarioError, Scenarios, geometry};
pub use search::{Finding, Settled, settle};
pub use states::Moment;
pub use step::{Loop, Tube};
