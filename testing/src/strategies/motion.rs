//! What other vehicles do, one piece after the other.

use crate::case::Push;
use proptest::prelude::*;

/// Scripts within the contract: up to five pieces of up to 30 periods. The simplest keeps its speed.
pub fn script() -> impl Strategy<Value = Vec<Push>> {
    let quarters = prop_oneof![Just(0_i8), Just(4), Just(-4), -4_i8..=4];
    let push = (1_u8..=30, quarters).prop_map(|(periods, quarters)| Push { periods, quarters });
    prop::collection::vec(push, 0..=5)
}

/// Scripts that exceed the contract at once: first an acceleration of 1¼ to 4 times the hardest.
pub fn script_outside() -> impl Strategy<Value = Vec<Push>> {
    ((5_u8..=30, 5_i8..=16), script()).prop_map(|((periods, quarters), mut rest)| {
        rest.insert(0, Push { periods, quarters });
        rest
    })
}
