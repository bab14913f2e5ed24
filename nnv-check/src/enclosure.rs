//! A network's inputs as functions of other variables, for whoever searches over those.

use super::property::InputBox;
use super::rounding::{gamma, underflow};

/// An input of the network as a linear function of the variables of a box:
/// |input − (constant + slopes · x)| ≤ radius everywhere on it.
#[derive(Clone, Debug, PartialEq)]
pub struct AffineEnclosure {
    /// The constant.
    pub constant: f64,
    /// One slope for each variable.
    pub slopes: Vec<f64>,
    /// How far the input may be from the linear function.
    pub radius: f64,
}

impl AffineEnclosure {
    /// Range of the linear part on the box, rounding included.
    #[must_use]
    pub fn affine_range(&self, region: &InputBox) -> (f64, f64) {
        let (mut l, mut u, mut size) = (self.constant, self.constant, self.constant.abs());
        for ((s, lo), hi) in self.slopes.iter().zip(&region.lower).zip(&region.upper) {
            let (a, b) = (s * lo, s * hi);
            l += a.min(b);
            u += a.max(b);
            size += a.abs().max(b.abs());
        }
        let slack = gamma(self.slopes.len() + 4) * size + underflow(self.slopes.len() + 4, 1.0);
        (l - slack, u + slack)
    }

    /// Largest absolute value of the input on the box.
    #[must_use]
    pub fn magnitude(&self, region: &InputBox) -> f64 {
        let (l, u) = self.affine_range(region);
        (l.abs().max(u.abs()) + self.radius) * (1.0 + 1e-12) + underflow(1, 1.0)
    }
}
