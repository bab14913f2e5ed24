//! The correctly rounded square root of an `f32`.
//!
//! Stable Rust without the standard library has no way to the core's instruction, and `libm` does without it on Arm.
//! IEEE 754 leaves no choice of the result, so both have the same bits; the sign and payload of a NaN aside.
#![no_std]

/// Square root of `x`, correctly rounded.
#[must_use]
#[inline]
pub fn sqrtf(x: f32) -> f32 {
    #[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
    return core_sqrt::cede_sqrt_s0(x);
    #[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
    libm::sqrtf(x)
}

/// Targets whose ABI hands over floats in registers of the FPU: they have the instruction. It is a function, because the
/// registers of an FPU with single precision alone are no operands of inline assembly yet.
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
mod core_sqrt {
    core::arch::global_asm!(
        ".section .text.cede_sqrt_s0,\"ax\",%progbits",
        ".balign 4",
        ".type cede_sqrt_s0,%function",
        ".thumb_func",
        ".global cede_sqrt_s0",
        "cede_sqrt_s0:",
        ".fpu fpv4-sp-d16",
        "vsqrt.f32 s0, s0",
        "bx lr",
        ".size cede_sqrt_s0, . - cede_sqrt_s0",
    );

    // SAFETY: it reads and writes the register of its argument, and nothing else.
    unsafe extern "C" {
        pub(super) safe fn cede_sqrt_s0(x: f32) -> f32;
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn roots_are_those_of_the_portable_library() {
        let mut bits = 1_u32;
        for _ in 0..1_000_000 {
            bits = bits.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            let x = f32::from_bits(bits);
            let (ours, theirs) = (super::sqrtf(x), libm::sqrtf(x));
            assert!(ours.to_bits() == theirs.to_bits() || (ours.is_nan() && theirs.is_nan()));
        }
    }
}
