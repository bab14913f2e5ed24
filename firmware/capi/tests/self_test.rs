//! The self-test finds every mode of the FPU but the usual one.
#![cfg(all(target_arch = "x86_64", target_os = "linux"))]

use cede::{cede_self_test, cede_status};
use std::arch::asm;

/// What the self-test says with these bits of the vector unit's control register.
fn with(bits: u32) -> cede_status {
    let mut usual = 0_u32;
    // SAFETY: the register is as it was before anything else is computed.
    unsafe {
        asm!("stmxcsr [{}]", in(reg) &raw mut usual);
        let mode = usual | bits;
        asm!("ldmxcsr [{}]", in(reg) &raw const mode);
        let status = cede_self_test();
        asm!("ldmxcsr [{}]", in(reg) &raw const usual);
        status
    }
}

#[test]
fn only_the_usual_mode_passes() {
    assert_eq!(with(0), cede_status::Ok);
    let (down, up, to_zero) = (0x2000, 0x4000, 0x6000);
    let (flush_to_zero, subnormals_are_zero) = (0x8000, 0x0040);
    for bits in [down, up, to_zero, flush_to_zero, subnormals_are_zero] {
        assert_eq!(with(bits), cede_status::FloatEnvironment, "{bits:#x}");
    }
}
