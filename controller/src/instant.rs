//! Moments of a monotone clock.

/// A moment, in microseconds of a clock of the caller's that never goes back; where it begins does not matter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Instant {
    micros: u64,
}

impl Instant {
    /// So many microseconds after the clock's beginning.
    #[must_use]
    pub const fn from_micros(micros: u64) -> Self {
        Self { micros }
    }

    /// So many milliseconds after the clock's beginning, at most 2⁶⁴ microseconds.
    #[must_use]
    pub const fn from_millis(millis: u64) -> Self {
        Self {
            micros: millis.saturating_mul(1000),
        }
    }

    /// Microseconds since the clock's beginning.
    #[must_use]
    pub const fn micros(self) -> u64 {
        self.micros
    }

    /// Microseconds since `earlier`; 0 if that is later.
    pub(crate) const fn since(self, earlier: Self) -> u64 {
        self.micros.saturating_sub(earlier.micros)
    }

    /// Seconds since `earlier`; 0 if that is later.
    pub(crate) fn seconds_since(self, earlier: Self) -> f32 {
        // Exact up to 16 s; beyond, f32 has room for the ranges of motions that only grow.
        self.since(earlier) as f32 * 1.0e-6
    }

    /// So many microseconds later.
    pub(crate) const fn plus(self, micros: u64) -> Self {
        Self {
            micros: self.micros.saturating_add(micros),
        }
    }

    /// So many microseconds earlier, but not before the clock's beginning.
    pub(crate) const fn minus(self, micros: u64) -> Self {
        Self {
            micros: self.micros.saturating_sub(micros),
        }
    }
}

/// A time span of a contract (s, in [0, 10⁴]) in whole microseconds, rounded.
pub(crate) fn micros(seconds: f32) -> u64 {
    // Truncates and saturates: no number becomes a large one.
    (seconds * 1.0e6 + 0.5) as u64
}
