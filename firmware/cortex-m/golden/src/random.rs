//! A small generator of our own, so that the golden file is the same with every version of every library.

/// PCG-XSH-RR 64/32.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn word(&mut self) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let x = (((self.0 >> 18) ^ self.0) >> 27) as u32;
        x.rotate_right((self.0 >> 59) as u32)
    }

    /// A number within ± `limit`.
    pub(crate) fn within(&mut self, limit: f32) -> f32 {
        ((self.word() >> 8) as f32 / (1 << 23) as f32 - 1.0) * limit
    }

    /// True once in `n` times.
    pub(crate) fn once_in(&mut self, n: u32) -> bool {
        self.word().is_multiple_of(n)
    }
}
