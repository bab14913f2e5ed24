//! Proofs about Cede's networks and shield, and the adversarial campaigns against them.
//!
//! Three words are never mixed here: *proved* (for all inputs of a stated set), *tested* (on
//! samples) and *assumed*.
#![forbid(unsafe_code)]

mod interval;
pub mod lemma;
pub mod margin;
pub mod policy;
pub mod reach;
pub mod zones;
