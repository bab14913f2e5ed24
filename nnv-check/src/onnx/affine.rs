//! Values as affine maps of the last activations, and the layers that grow out of them.

use super::tensor::{MOST_ELEMENTS, Shape};
use crate::model::{Activation, Layer, Matrix, Network};
use crate::rounding::{exact_product, exact_sum};
use std::ops::Range;

/// A tensor that depends on the inputs: element i is Σ terms of row i + bias i, over the outputs
/// of layer `base` − 1 (the network's inputs for base 0).
#[derive(Clone, Debug)]
pub(super) struct Variable {
    pub(super) shape: Shape,
    base: usize,
    rows: Vec<Row>,
    /// Relative uncertainty of every coefficient.
    uncertainty: f64,
}

#[derive(Clone, Debug)]
struct Row {
    terms: Vec<(usize, f64)>,
    bias: f64,
}

impl Row {
    fn unit(index: usize) -> Self {
        Self {
            terms: vec![(index, 1.0)],
            bias: 0.0,
        }
    }
}

impl Variable {
    /// The same elements in another shape or order: element i of the result is element `pick(i)`.
    pub(super) fn rearranged(&self, shape: Shape, pick: impl Fn(usize) -> usize) -> Self {
        let rows = (0..shape.size())
            .map(|i| self.rows[pick(i)].clone())
            .collect();
        Self {
            shape,
            rows,
            ..*self
        }
    }

    /// Elements taken from several variables of the same base: element i is element `pick(i).1` of
    /// `parts[pick(i).0]`.
    pub(super) fn gathered(
        parts: &[&Self],
        shape: Shape,
        pick: impl Fn(usize) -> (usize, usize),
    ) -> Result<Self, String> {
        let base = parts[0].base;
        if parts
            .iter()
            .any(|part| part.base != base || part.uncertainty != parts[0].uncertainty)
        {
            return Err(
                "joins values of different depths; only chains of layers are supported".to_owned(),
            );
        }
        let rows = (0..shape.size())
            .map(pick)
            .map(|(part, i)| parts[part].rows[i].clone())
            .collect();
        Ok(Self {
            shape,
            base,
            rows,
            uncertainty: parts[0].uncertainty,
        })
    }

    fn entries(&self) -> usize {
        self.rows.iter().map(|row| row.terms.len()).sum()
    }
}

/// The layers so far.
pub(super) struct Builder {
    inputs: usize,
    layers: Vec<Layer>,
}

impl Builder {
    pub(super) fn new(inputs: usize) -> Self {
        Self {
            inputs,
            layers: Vec::new(),
        }
    }

    /// A graph input, as the given range of the network's inputs.
    pub(super) fn input(&self, range: Range<usize>, shape: Shape) -> Variable {
        Variable {
            shape,
            base: 0,
            rows: range.map(Row::unit).collect(),
            uncertainty: 0.0,
        }
    }

    /// The affine map of a value: element i of the result is Σ (c·element j) + bias over the terms
    /// (j, c) that `row(i)` gives. Merged into the map that the value already is where that takes
    /// no rounding; otherwise the value becomes a layer first.
    pub(super) fn map(
        &mut self,
        value: &Variable,
        shape: Shape,
        row: impl Fn(usize) -> (Vec<(usize, f64)>, f64),
    ) -> Result<Variable, String> {
        let maps: Vec<_> = (0..shape.size()).map(row).collect();
        let merged: Option<Vec<Row>> = maps
            .iter()
            .map(|(terms, bias)| merge(value, terms, *bias))
            .collect();
        let rows = match merged {
            Some(rows) => {
                return bounded(Variable {
                    shape,
                    rows,
                    ..*value
                });
            }
            None => maps
                .into_iter()
                .map(|(terms, bias)| Row { terms, bias })
                .collect(),
        };
        let base = self.activate(value, Activation::Identity)?;
        bounded(Variable {
            shape,
            rows,
            ..base
        })
    }

    /// Every element divided by a constant: exact where the reciprocal is, otherwise the
    /// coefficients of the result are uncertain by one rounding.
    pub(super) fn divide(
        &mut self,
        value: &Variable,
        shape: Shape,
        row: impl Fn(usize) -> (usize, f64),
    ) -> Result<Variable, String> {
        let exact = (0..shape.size()).all(|i| exact_product(row(i).1, 1.0 / row(i).1) == Some(1.0));
        let reciprocal = |i| {
            let (index, divisor) = row(i);
            (vec![(index, 1.0 / divisor)], 0.0)
        };
        if exact {
            return self.map(value, shape, reciprocal);
        }
        let value = self.activate(value, Activation::Identity)?;
        let divided = self.map(&value, shape, reciprocal)?;
        let uncertain = Variable {
            uncertainty: f64::EPSILON,
            ..divided
        };
        self.activate(&uncertain, Activation::Identity)
    }

    /// Ends a layer: the value, then the activation.
    pub(super) fn activate(
        &mut self,
        value: &Variable,
        activation: Activation,
    ) -> Result<Variable, String> {
        if value.base != self.layers.len() {
            return Err(
                "takes a value that a later layer has left behind; only chains are supported"
                    .to_owned(),
            );
        }
        let width = self.layers.last().map_or(self.inputs, Layer::outputs);
        let outputs = value.rows.len();
        if outputs
            .checked_mul(width)
            .is_none_or(|entries| entries > MOST_ELEMENTS)
        {
            return Err(format!("a layer of {width} by {outputs} is too large"));
        }
        let mut weights = Matrix::zeros(outputs, width);
        for (i, row) in value.rows.iter().enumerate() {
            for &(j, c) in &row.terms {
                weights.row_mut(i)[j] += c;
            }
        }
        let bias = value.rows.iter().map(|row| row.bias).collect();
        self.layers.push(Layer {
            weights,
            bias,
            activation,
            uncertainty: value.uncertainty,
        });
        let rows = (0..outputs).map(Row::unit).collect();
        Ok(Variable {
            shape: value.shape.clone(),
            base: self.layers.len(),
            rows,
            uncertainty: 0.0,
        })
    }

    /// The network whose output is the value.
    pub(super) fn finish(mut self, value: &Variable) -> Result<Network, String> {
        let plain = |(i, row): (usize, &Row)| row.bias == 0.0 && row.terms.as_slice() == [(i, 1.0)];
        let is_last_layer = value.base == self.layers.len()
            && self
                .layers
                .last()
                .is_some_and(|last| last.outputs() == value.rows.len())
            && value.rows.iter().enumerate().all(plain);
        if !is_last_layer {
            self.activate(value, Activation::Identity)?;
        }
        Network::new(self.inputs, self.layers).map_err(|e| e.to_string())
    }
}

fn bounded(value: Variable) -> Result<Variable, String> {
    if value.entries() > MOST_ELEMENTS {
        Err("gives too large a map".to_owned())
    } else {
        Ok(value)
    }
}

/// The row Σ c·(row j of the value) + bias, if no rounding is needed to write it down.
fn merge(value: &Variable, terms: &[(usize, f64)], bias: f64) -> Option<Row> {
    if value.uncertainty != 0.0 {
        return None;
    }
    let mut merged = Row {
        terms: Vec::with_capacity(terms.len()),
        bias,
    };
    let mut sorted = true;
    for &(j, c) in terms {
        let row = &value.rows[j];
        merged.bias = exact_sum(merged.bias, exact_product(c, row.bias)?)?;
        for &(k, d) in &row.terms {
            sorted &= merged.terms.last().is_none_or(|&(last, _)| last < k);
            merged.terms.push((k, exact_product(c, d)?));
        }
    }
    if !sorted {
        merged.terms.sort_by_key(|&(k, _)| k);
        let mut unique: Vec<(usize, f64)> = Vec::with_capacity(merged.terms.len());
        for (k, c) in merged.terms {
            match unique.last_mut() {
                Some((last, sum)) if *last == k => *sum = exact_sum(*sum, c)?,
                _ => unique.push((k, c)),
            }
        }
        merged.terms = unique;
    }
    Some(merged)
}
