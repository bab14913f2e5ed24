//! Linear forms with a bound on their own rounding.

/// A linear form c·x + constant, with bounds on what rounding has cost so far.
pub(super) struct Form {
    pub(super) coefficients: Vec<f64>,
    /// How far each coefficient may be off; charged where the values it multiplies are known.
    pub(super) doubts: Vec<f64>,
    pub(super) constant: f64,
    pub(super) error: f64,
}

/// Relative error allowed for every operation: eight times the unit roundoff.
pub(super) const ULP: f64 = 4.0 * f64::EPSILON;
/// Allowance for underflow in each operation.
pub(super) const TINY: f64 = 1e-290;

impl Form {
    pub(super) fn zero(length: usize) -> Self {
        Self {
            coefficients: vec![0.0; length],
            doubts: vec![0.0; length],
            constant: 0.0,
            error: 0.0,
        }
    }

    /// Adds factor·(row, constant).
    pub(super) fn add(&mut self, row: &[f64], constant: f64, factor: f64) {
        for ((sum, doubt), c) in self.coefficients.iter_mut().zip(&mut self.doubts).zip(row) {
            *sum += factor * c;
            *doubt += ULP * (sum.abs() + (factor * c).abs());
        }
        self.constant += factor * constant;
        self.error += ULP * (self.constant.abs() + (factor * constant).abs());
    }
}
