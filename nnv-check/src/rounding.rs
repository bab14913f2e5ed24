//! A-priori bounds on what rounding to nearest can do to sums of products.
//!
//! With u = 2⁻⁵³, the computed value of a sum of n products differs from the exact one by at most
//! γₙ·Σ|aᵢbᵢ| plus an underflow term, γₙ = n·u / (1 − n·u), in whatever order the sum is taken
//! (Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed., §3.1). The bounds below are
//! at least twice that, so that the rounding of the bound itself is covered as well.

/// At least twice the error of this many products that may not be normal numbers: each is off by
/// at most half of the smallest positive `f64`, 2⁻¹⁰⁷⁴, times `reach` where it is multiplied by
/// numbers whose absolute values add up to that.
#[must_use]
pub fn underflow(products: usize, reach: f64) -> f64 {
    // A NaN stays one.
    let reach = if reach < 1.0 { 1.0 } else { reach };
    products as f64 * f64::from_bits(1) * reach
}

/// Twice γₙ for `terms` products: the relative error of a sum of so many, with room to spare.
pub fn gamma(terms: usize) -> f64 {
    // A usize below 2⁵² is exact as f64; networks are far smaller.
    terms as f64 * f64::EPSILON
}

/// Factor that covers the rounding of an error bound that was itself summed up in floating point.
pub const SPARE: f64 = 1.0 + 1e-9;

/// The float product `a·b` if it is exact.
pub fn exact_product(a: f64, b: f64) -> Option<f64> {
    let product = a * b;
    let lost = a.mul_add(b, -product);
    let normal = product == 0.0 && (a == 0.0 || b == 0.0) || product.abs() > 1e-250;
    (lost == 0.0 && normal && product.is_finite()).then_some(product)
}

/// The float sum `a + b` if it is exact (Knuth's two-sum finds the rounding error).
pub fn exact_sum(a: f64, b: f64) -> Option<f64> {
    let sum = a + b;
    let of_b = sum - a;
    let lost = (a - (sum - of_b)) + (b - of_b);
    (lost == 0.0 && sum.is_finite()).then_some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_operations_refuse_what_rounds() {
        assert_eq!(exact_product(0.5, 3.0), Some(1.5));
        assert_eq!(exact_product(0.1, 0.1), None);
        assert_eq!(exact_product(0.0, 7.0), Some(0.0));
        assert_eq!(exact_product(1e-200, 1e-200), None);
        assert_eq!(exact_sum(0.25, 0.5), Some(0.75));
        assert_eq!(exact_sum(1.0, 1e-17), None);
        assert_eq!(exact_sum(1e308, 1e308), None);
    }
}
