//! Faults on purpose, by feature, that the checks on a linked library must find.

/// A panic that the compiler cannot rule out, what stands for an allocation, or a function of the C library.
pub(crate) fn fault() {
    #[cfg(feature = "planted-panic")]
    core::hint::black_box([0_u8][core::hint::black_box(1)]);
    #[cfg(feature = "planted-allocation")]
    core::hint::black_box(allocation::__rust_alloc(1));
    #[cfg(feature = "planted-libm")]
    libm::call();
}

#[cfg(feature = "planted-allocation")]
mod allocation {
    /// Stands for the symbol that every allocation goes through.
    #[unsafe(no_mangle)]
    #[inline(never)]
    pub(super) extern "C" fn __rust_alloc(size: usize) -> usize {
        core::hint::black_box(size)
    }
}

#[cfg(feature = "planted-libm")]
mod libm {
    pub(super) fn call() {
        unsafe extern "C" {
            fn sinf(x: f32) -> f32;
        }
        // SAFETY: a function of every mathematical library.
        core::hint::black_box(unsafe { sinf(core::hint::black_box(1.0)) });
    }
}
