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

    /// Its terms' number.
    fn entries(&self) -> usize {
        self.rows.iter().map(|row| row.terms.len()).sum()
    }
}

/// A layer as it grows: what its outputs are before the activation.
struct Draft {
    rows: Vec<Row>,
    activation: Activation,
    uncertainty: f64,
}

/// The layers so far.
pub(super) struct Builder {
    inputs: usize,
    layers: Vec<Draft>,
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

    /// Elements taken from several values: element i is element `pick[i].1` of `parts[pick[i].0]`.
    pub(super) fn joined(
        &mut self,
        parts: &[&Variable],
        pick: &[(usize, usize)],
    ) -> Result<Variable, String> {
        let parts = self.levelled(parts)?;
        let Variable {
            base, uncertainty, ..
        } = parts[0];
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
        self.divide_nearly(value, divisors)
    }

    /// Every element divided by a positive constant that is known to 4 units in the last place.
    pub(super) fn divide_nearly(
        &mut self,
        value: &Variable,
        divisors: &[f64],
    ) -> Result<Variable, String> {
        let reciprocal = |i: usize| (vec![(i, 1.0 / divisors[i])], 0.0);
        let value = self.activate(value, Activation::Identity)?;
        let divided = self.map(&value, divisors.len(), reciprocal)?;
        // The divisor's error, and that of the reciprocal, which may not be a normal number.
        let uncertain = Variable {
            uncertainty: 8.0 * f64::EPSILON,
            ..divided
        };
        self.activate(&uncertain, Activation::Identity)
    }

    /// The sum of two values of one size, the second with a sign.
    pub(super) fn sum(
        &mut self,
        first: &Variable,
        second: &Variable,
        sign: f64,
    ) -> Result<Variable, String> {
        let both = self.both(first, second)?;
        let size = first.size();
        self.map(&both, size, |i| (vec![(i, 1.0), (size + i, sign)], 0.0))
    }

    /// The elements of one value, then those of another.
    pub(super) fn both(&mut self, first: &Variable, second: &Variable) -> Result<Variable, String> {
        let firsts = (0..first.size()).map(|i| (0, i));
        let all: Vec<_> = firsts.chain((0..second.size()).map(|i| (1, i))).collect();
        self.joined(&[first, second], &all)
    }

    /// The values, all as maps of the outputs of one layer whose coefficients are exact.
    fn levelled(&mut self, values: &[&Variable]) -> Result<Vec<Variable>, String> {
        let mut level = values.iter().map(|v| v.base).max().unwrap_or(0);
        if values.iter().any(|v| v.uncertainty != 0.0) {
            // Uncertain coefficients end a layer, and there may not be one yet.
            level += 1;
        }
        if level > self.layers.len() {
            self.layers.push(Draft {
                rows: Vec::new(),
                activation: Activation::Identity,
                uncertainty: 0.0,
            });
        }
        values.iter().map(|v| self.lifted(v, level)).collect()
    }

    /// A value as a map of the outputs of a later layer: what lies between passes it on, a ReLU as
    /// x = relu(x) − relu(−x).
    fn lifted(&mut self, value: &Variable, level: usize) -> Result<Variable, String> {
        let mut value = value.clone();
        while value.base < level {
            let layer = &mut self.layers[value.base];
            layer.uncertainty = layer.uncertainty.max(value.uncertainty);
            let first = layer.rows.len();
            let signs: &[f64] = match layer.activation {
                Activation::Identity => &[1.0],
                Activation::Relu => &[1.0, -1.0],
                Activation::Tanh => {
                    return Err("of a value from before a Tanh is not supported".to_owned());
                }
            };
            let mut rows = Vec::with_capacity(value.rows.len());
            for (i, row) in value.rows.into_iter().enumerate() {
                let place = first + signs.len() * i;
                for sign in signs {
                    layer.rows.push(Row {
                        terms: row.terms.iter().map(|&(j, c)| (j, sign * c)).collect(),
                        bias: sign * row.bias,
                    });
                }
                let places = signs.iter().enumerate();
                rows.push(Row {
                    terms: places.map(|(k, &sign)| (place + k, sign)).collect(),
                    bias: 0.0,
                });
            }
            value = self.bounded(Variable {
                base: value.base + 1,
                rows,
                uncertainty: 0.0,
            })?;
        }
        Ok(value)
    }

    /// Ends a layer: the value, then the activation.
    pub(super) fn activate(
        &mut self,
        value: &Variable,
        activation: Activation,
    ) -> Result<Variable, String> {
        let value = &self.lifted(value, self.layers.len())?;
        let width = self.layers.last().map_or(self.inputs, |l| l.rows.len());
        let outputs = value.rows.len();
        fits(width, outputs)?;
        self.layers.push(Draft {
            rows: value.rows.clone(),
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
                .is_some_and(|last| last.rows.len() == value.rows.len())
            && value.rows.iter().enumerate().all(plain);
        if !is_last_layer {
            self.activate(value, Activation::Identity)
                .map_err(GraphError::Graph)?;
        }
        let mut width = self.inputs;
        let mut layers = Vec::with_capacity(self.layers.len());
        for draft in self.layers {
            let layer = draft.layer(width).map_err(GraphError::Graph)?;
            width = layer.outputs();
            layers.push(layer);
        }
        Ok(Network::new(self.inputs, layers)?)
    }
}

impl Draft {
    /// The layer, for so many inputs.
    fn layer(self, width: usize) -> Result<Layer, String> {
        let outputs = self.rows.len();
        fits(width, outputs)?;
        let mut weights = Matrix::zeros(outputs, width);
        for (i, row) in self.rows.iter().enumerate() {
            for &(j, c) in &row.terms {
                weights.row_mut(i)[j] += c;
            }
        }
        Ok(Layer {
            weights,
            bias: self.rows.iter().map(|row| row.bias).collect(),
            activation: self.activation,
            uncertainty: self.uncertainty,
        })
    }
}

/// Refuses a layer of too many weights.
fn fits(width: usize, outputs: usize) -> Result<(), String> {
    match outputs.checked_mul(width) {
        Some(0..=MOST_WEIGHTS) => Ok(()),
        _ => Err(format!(
            "gives a layer of {width} by {outputs} weights; at most {MOST_WEIGHTS} (2²⁶) are supported"
        )),
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
