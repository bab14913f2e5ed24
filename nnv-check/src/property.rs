//! What is asked of a network: whether any input of a box gives an output in an unsafe set.

use super::model::Evaluation;

/// A closed box of inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct InputBox {
    /// Least value of each input.
    pub lower: Vec<f64>,
    /// Greatest value of each input.
    pub upper: Vec<f64>,
}

impl InputBox {
    /// Whether the point lies in the box.
    #[must_use]
    pub fn contains(&self, point: &[f64]) -> bool {
        point.len() == self.lower.len()
            && point.iter().zip(&self.lower).all(|(x, lo)| x >= lo)
            && point.iter().zip(&self.upper).all(|(x, hi)| x <= hi)
    }
}

/// One linear constraint on the outputs: coefficients · y ≤ bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Halfspace {
    /// One coefficient for each output.
    pub coefficients: Vec<f64>,
    /// The right-hand side.
    pub bound: f64,
}

impl Halfspace {
    /// Whether the exact output certainly satisfies the constraint, whatever rounding did.
    #[must_use]
    pub fn certainly_holds(&self, y: &Evaluation) -> bool {
        let terms = self.coefficients.iter().zip(&y.values);
        let size: f64 = terms.clone().map(|(c, v)| (c * v).abs()).sum::<f64>() + self.bound.abs();
        let carried: f64 = self
            .coefficients
            .iter()
            .zip(&y.errors)
            .map(|(c, e)| c.abs() * e)
            .sum();
        let error =
            super::rounding::gamma(y.values.len() + 4) * size + carried * super::rounding::SPARE;
        self.excess(&y.values) + error <= 0.0
    }

    /// coefficients · y − bound in plain `f64`: positive where the constraint is violated.
    #[must_use]
    pub fn excess(&self, y: &[f64]) -> f64 {
        self.coefficients
            .iter()
            .zip(y)
            .map(|(c, v)| c * v)
            .sum::<f64>()
            - self.bound
    }
}

/// A conjunction of constraints on the outputs: one convex part of the unsafe set. An empty
/// conjunction holds everywhere.
pub type Conjunction = Vec<Halfspace>;

/// Is there an input of the box whose output satisfies all of one of the conjunctions?
#[derive(Clone, Debug, PartialEq)]
pub struct Query {
    /// The inputs.
    pub region: InputBox,
    /// The unsafe set: a union of convex sets.
    pub unsafe_set: Vec<Conjunction>,
}

/// A property in normal form: it is violated if any of its queries has a solution.
#[derive(Clone, Debug, PartialEq)]
pub struct Property {
    /// Number of inputs of the network it is about.
    pub inputs: usize,
    /// Number of outputs.
    pub outputs: usize,
    /// One query for each distinct input box.
    pub queries: Vec<Query>,
}

impl Property {
    /// Whether this input is certainly in a query's box and its exact output certainly in that
    /// query's unsafe set.
    #[must_use]
    pub fn certainly_violated(&self, input: &[f64], output: &Evaluation) -> bool {
        self.queries.iter().any(|query| {
            query.region.contains(input)
                && query
                    .unsafe_set
                    .iter()
                    .any(|c| c.iter().all(|h| h.certainly_holds(output)))
        })
    }
}
