//! Errors of sensors: of any shape within their bound.

use crate::rng::Rng;

/// How an error changes from one observation to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// None at all.
    Exact,
    /// Always the same, at the bound.
    Constant,
    /// From one bound to the other, every time.
    Alternating,
    /// At either bound, changing now and then.
    Held,
    /// Uniform.
    Uniform,
    /// At either bound, at random.
    Extreme,
}

impl Shape {
    /// Those that are not exact.
    pub const WRONG: [Self; 5] = [
        Self::Constant,
        Self::Alternating,
        Self::Held,
        Self::Uniform,
        Self::Extreme,
    ];
}

/// Just below the bound, so that rounding to f32 does not exceed it.
const ALMOST: f64 = 0.999;

/// The error of one number of one vehicle, as one observer sees it.
#[derive(Clone, Debug)]
pub struct ErrorSource {
    shape: Shape,
    sign: f64,
    rng: Rng,
}

impl ErrorSource {
    /// Errors of this shape that begin at the bound of this sign.
    #[must_use]
    pub fn new(shape: Shape, sign: f64, rng: Rng) -> Self {
        Self { shape, sign, rng }
    }

    /// The next error, in units of the bound.
    pub fn draw(&mut self) -> f64 {
        let flips = match self.shape {
            Shape::Exact => return 0.0,
            Shape::Uniform => return ALMOST * self.rng.within(-1.0, 1.0),
            Shape::Constant => false,
            Shape::Alternating => true,
            Shape::Held => self.rng.chance(0.15),
            Shape::Extreme => self.rng.chance(0.5),
        };
        if flips {
            self.sign = -self.sign;
        }
        ALMOST * self.sign
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_within_their_bound_and_most_are_at_it() {
        for shape in Shape::WRONG {
            let mut source = ErrorSource::new(shape, 1.0, Rng::new(2));
            let drawn: Vec<f64> = (0..200).map(|_| source.draw()).collect();
            assert!(drawn.iter().all(|e| e.abs() <= ALMOST));
            let changes = drawn.windows(2).filter(|w| w[0] != w[1]).count();
            assert_eq!(changes == 0, shape == Shape::Constant, "{shape:?}");
        }
        assert_eq!(ErrorSource::new(Shape::Exact, 1.0, Rng::new(2)).draw(), 0.0);
    }
}
