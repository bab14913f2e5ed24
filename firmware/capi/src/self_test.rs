//! Whether the FPU computes as it does where decisions were tested.

use crate::status::cede_status;
use cede_controller::Vector;
use cede_controller::geometry::length;
use core::hint::black_box;

/// Whether the FPU rounds to nearest and keeps subnormal numbers, as every decision assumes. To be called at start-up by the
/// task that decides: the mode may differ from task to task. cede_approach_decide() looks at it in every call. Takes no time to
/// speak of.
#[unsafe(no_mangle)]
pub extern "C" fn cede_self_test() -> cede_status {
    float_environment().into()
}

/// What [`cede_self_test`] says.
pub(crate) fn float_environment() -> Result<(), cede_status> {
    if rounds_to_nearest() && keeps_subnormals() && extracts_roots() {
        Ok(())
    } else {
        Err(cede_status::FloatEnvironment)
    }
}

/// A tie goes to the even neighbour, what is beyond it to the nearer one, on both sides of 0.
fn rounds_to_nearest() -> bool {
    let half = black_box(f32::EPSILON / 2.0);
    let beyond = black_box(f32::EPSILON * 0.75);
    [1.0_f32, -1.0].map(black_box).into_iter().all(|one| {
        let next = one * (1.0 + f32::EPSILON);
        one + half * one == one && one + beyond * one == next
    })
}

/// By their bits: a comparison might take them for 0 as well.
fn keeps_subnormals() -> bool {
    let least = black_box(f32::from_bits(1));
    let normal = black_box(f32::MIN_POSITIVE);
    (least + least).to_bits() == 2 && (normal * 0.5).to_bits() == 1 << 22
}

fn extracts_roots() -> bool {
    length(&black_box(Vector::new(1.0, 1.0))) == core::f32::consts::SQRT_2
}
