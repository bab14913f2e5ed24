//! One test for each finding that broke the shield within its contract before it had junctions, tracks and time.
//!
//! Where the interface refuses what led there, the refusal is the test. Everywhere else the attacker searches: no overlap,
//! no false report, no step without a plan, and enough scenarios that begin with a verified plan.

mod by_hand;
mod precedence;
mod refused;
mod searches;
mod stage;
