//! The two linear programmes of a region on which the network is affine. Nothing rests on what
//! the solver says: its weights are evaluated soundly, its points are run through the network.

use cede_nnv_check::InputBox;
use microlp::{ComparisonOp, LinearExpr, OptimizationDirection, Problem, SolveOutcome, Variable};
use std::time::Duration;

/// Multipliers beyond this are of no use in floating point.
const LARGEST: f64 = 1e7;

/// The weights (of the atoms, summing to 1) and multipliers ≥ 0 (of the other forms) for which
/// the least value of the weighted sum over the box is greatest. Forms are over the constant and
/// the inputs.
pub(super) fn best_weights(
    forms: &[Vec<f64>],
    atoms: usize,
    region: &InputBox,
    time: Duration,
) -> Option<Vec<f64>> {
    let mut lp = Problem::new(OptimizationDirection::Maximize);
    let weights: Vec<Variable> = forms
        .iter()
        .map(|form| lp.add_var(form[0], (0.0, LARGEST)))
        .collect();
    lp.add_constraint(
        sum(weights[..atoms].iter().map(|&w| (w, 1.0))),
        ComparisonOp::Eq,
        1.0,
    );
    for (input, (&lo, &hi)) in region.lower.iter().zip(&region.upper).enumerate() {
        // The sum's coefficient is up − down, at least lo·up − hi·down on the box.
        let up = lp.add_var(lo, (0.0, f64::INFINITY));
        let down = lp.add_var(-hi, (0.0, f64::INFINITY));
        let coefficient = weights
            .iter()
            .zip(forms)
            .map(|(&w, form)| (w, form[input + 1]));
        lp.add_constraint(
            sum(coefficient.chain([(up, -1.0), (down, 1.0)])),
            ComparisonOp::Eq,
            0.0,
        );
    }
    let solution = solved(lp, time)?;
    Some(weights.iter().map(|&w| solution[w].max(0.0)).collect())
}

/// The input of the box where the largest of the atoms is least, the other forms being ≤ 0.
pub(super) fn least_excess(
    forms: &[Vec<f64>],
    atoms: usize,
    region: &InputBox,
    time: Duration,
) -> Option<Vec<f64>> {
    let mut lp = Problem::new(OptimizationDirection::Minimize);
    let largest = lp.add_var(1.0, (f64::NEG_INFINITY, f64::INFINITY));
    let sides = region.lower.iter().zip(&region.upper);
    let inputs: Vec<Variable> = sides.map(|(&lo, &hi)| lp.add_var(0.0, (lo, hi))).collect();
    for (index, form) in forms.iter().enumerate() {
        let of_largest = if index < atoms { -1.0 } else { 0.0 };
        let terms = inputs.iter().zip(&form[1..]).map(|(&x, &c)| (x, c));
        lp.add_constraint(
            sum(terms.chain([(largest, of_largest)])),
            ComparisonOp::Le,
            -form[0],
        );
    }
    let solution = solved(lp, time)?;
    let clamped = inputs.iter().zip(&region.lower).zip(&region.upper);
    Some(
        clamped
            .map(|((&x, &lo), &hi)| solution[x].clamp(lo, hi))
            .collect(),
    )
}

fn sum(terms: impl Iterator<Item = (Variable, f64)>) -> LinearExpr {
    let mut sum = LinearExpr::empty();
    terms.for_each(|(variable, c)| sum.add(variable, c));
    sum
}

fn solved(mut lp: Problem, time: Duration) -> Option<microlp::Solution> {
    lp.set_time_limit(time);
    match lp.solve() {
        Ok(SolveOutcome::Solution(solution)) => Some(solution),
        _ => None,
    }
}
