//! Values as affine maps of the last activations, and the layers that grow out of them.

use super::OnnxError;
use crate::model::{Activation, Layer, Matrix, Network};
use crate::rounding::{exact_product, exact_sum};
use cede_formats::onnx::MOST_WEIGHTS;
use cede_formats::onnx::graph::GraphError;
use std::ops::Range;

/// A tensor that depends on the inputs: element i is Σ terms of row i + bias i, over the outputs
/// of layer `base` − 1 (the network's inputs for base 0).
#[derive(Clone, Debug)]
pub(super) struct Variable {
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
    /// A graph input, as the given range of the network's inputs.
    pub(super) fn input(range: Range<usize>) -> Self {
        Self {
            base: 0,
            rows: range.map(Row::unit).collect(),
            uncertainty: 0.0,
        }
    }

    /// Number of elements.
    pub(super) fn size(&self) -> usize {
        self.rows.len()
    }

    fn entries(&self) -> usize {
        self.rows.iter().map(|row| row.terms.len()).sum()
    }
}

/// The layers so far.
pub(super) struct Builder {
    inputs: usize,
    layers: Vec<Layer>,
    /// Entries of maps that the graph may still give.
    room: usize,
}

/// The most entries that all maps of a graph have together.
const MOST_IN_ALL: usize = 1 << 28;

impl Builder {
    pub(super) fn new(inputs: usize) -> Self {
        Self {
            inputs,
            layers: Vec::new(),
            room: MOST_IN_ALL,
        }
    }

    /// The same elements in another order: element i of the result is element `pick[i]`.
    pub(super) fn rearranged(
        &mut self,
        value: &Variable,
        pick: &[usize],
    ) -> Result<Variable, String> {
        let rows = pick.iter().map(|&i| value.rows[i].clone()).collect();
        self.bounded(Variable { rows, ..*value })
    }

    /// Elements taken from several values of the same depth: element i is element `pick[i].1` of
    /// `parts[pick[i].0]`.
    pub(super) fn joined(
        &mut self,
        parts: &[&Variable],
        pick: &[(usize, usize)],
    ) -> Result<Variable, String> {
        let Variable {
            base, uncertainty, ..
        } = *parts[0];
        let differs = |part: &&Variable| part.base != base || part.uncertainty != uncertainty;
        if parts.iter().any(differs) {
            return Err(
                "joins values of different depths; only chains of layers are supported".to_owned(),
            );
        }
        let rows = pick.iter().map(|&(part, i)| parts[part].rows[i].clone());
        self.bounded(Variable {
            base,
            rows: rows.collect(),
            uncertainty,
        })
    }

    /// The affine map of a value: element i of the result is Σ (c·element j) + bias over the terms
    /// (j, c) that `row(i)` gives. Merged into the map that the value already is where that takes
    /// no rounding; otherwise the value becomes a layer first.
    pub(super) fn map(
        &mut self,
        value: &Variable,
        size: usize,
        row: impl Fn(usize) -> (Vec<(usize, f64)>, f64),
    ) -> Result<Variable, String> {
        let maps: Vec<_> = (0..size).map(row).collect();
        let merged: Option<Vec<Row>> = maps
            .iter()
            .map(|(terms, bias)| merge(value, terms, *bias))
            .collect();
        let rows = match merged {
            Some(rows) => {
                return self.bounded(Variable { rows, ..*value });
            }
            None => maps
                .into_iter()
                .map(|(terms, bias)| Row { terms, bias })
                .collect(),
        };
        let base = self.activate(value, Activation::Identity)?;
        self.bounded(Variable { rows, ..base })
    }

    /// Every element divided by a constant: exact where the reciprocal is, otherwise the
    /// coefficients of the result are uncertain by one rounding.
    pub(super) fn divide(
        &mut self,
        value: &Variable,
        divisors: &[f64],
    ) -> Result<Variable, String> {
        let exact = divisors
            .iter()
            .all(|&d| exact_product(d, 1.0 / d) == Some(1.0));
        let reciprocal = |i: usize| (vec![(i, 1.0 / divisors[i])], 0.0);
        if exact {
            return self.map(value, divisors.len(), reciprocal);
        }
        let value = self.activate(value, Activation::Identity)?;
        let divided = self.map(&value, divisors.len(), reciprocal)?;
        let uncertain = Variable {
            // One rounding: half a unit in the last place, more where the reciprocal is not normal.
            uncertainty: 2.0 * f64::EPSILON,
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
            .is_none_or(|entries| entries > MOST_WEIGHTS)
        {
            return Err(format!(
                "gives a layer of {width} by {outputs} weights; at most {MOST_WEIGHTS} (2²⁶) are supported"
            ));
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
            base: self.layers.len(),
            rows,
            uncertainty: 0.0,
        })
    }

    fn bounded(&mut self, value: Variable) -> Result<Variable, String> {
        let entries = value.entries();
        self.room = self
            .room
            .checked_sub(entries + value.size())
            .ok_or_else(|| format!("makes the network too large: its maps have more than {MOST_IN_ALL} (2²⁸) entries"))?;
        if entries > MOST_WEIGHTS {
            return Err(format!(
                "gives a map of {entries} weights; at most {MOST_WEIGHTS} (2²⁶) are supported"
            ));
        }
        Ok(value)
    }

    /// The network whose output is the value.
    pub(super) fn finish(mut self, value: &Variable) -> Result<Network, OnnxError> {
        let plain = |(i, row): (usize, &Row)| row.bias == 0.0 && row.terms.as_slice() == [(i, 1.0)];
        let is_last_layer = value.base == self.layers.len()
            && self
                .layers
                .last()
                .is_some_and(|last| last.outputs() == value.rows.len())
            && value.rows.iter().enumerate().all(plain);
        if !is_last_layer {
            self.activate(value, Activation::Identity)
                .map_err(GraphError::Graph)?;
        }
        Ok(Network::new(self.inputs, self.layers)?)
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
