//! The normal form of a network: affine layers, each followed by one activation.

use super::dyadic::{self, Dyadic};
use super::interval::Interval;
use super::rounding::gamma;
use num_bigint::BigInt;
use num_integer::Integer as _;
use num_rational::BigRational;
use num_traits::One as _;
use std::cmp::Ordering;

/// A dense matrix, row-major.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    rows: usize,
    cols: usize,
    data: Vec<f64>,
}

impl Matrix {
    /// A matrix of zeros.
    #[must_use]
    pub fn zeros(rows: usize, cols: usize) -> Self {
        Self {
            rows,
            cols,
            data: vec![0.0; rows * cols],
        }
    }

    /// A matrix from row-major data; `None` if there are not rows × cols values.
    #[must_use]
    pub fn from_rows(rows: usize, cols: usize, data: Vec<f64>) -> Option<Self> {
        (rows.checked_mul(cols)? == data.len()).then_some(Self { rows, cols, data })
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[must_use]
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// One row. Panics if there is no such row.
    #[must_use]
    pub fn row(&self, row: usize) -> &[f64] {
        &self.data[row * self.cols..(row + 1) * self.cols]
    }

    /// One row, to be written. Panics if there is no such row.
    pub fn row_mut(&mut self, row: usize) -> &mut [f64] {
        &mut self.data[row * self.cols..(row + 1) * self.cols]
    }

    /// All entries, row-major.
    #[must_use]
    pub fn data(&self) -> &[f64] {
        &self.data
    }
}

/// What follows a layer's affine map, element by element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activation {
    /// Nothing.
    Identity,
    /// max(0, z).
    Relu,
    /// tanh z.
    Tanh,
}

impl Activation {
    /// The activation's value.
    #[must_use]
    pub fn apply(self, z: f64) -> f64 {
        match self {
            Self::Identity => z,
            Self::Relu => {
                if z > 0.0 {
                    z
                } else {
                    0.0
                }
            }
            Self::Tanh => z.tanh(),
        }
    }

    /// The activation's range on an interval. The system's tanh is assumed to err by at most 8
    /// units in the last place (glibc states 2).
    fn enclose(self, z: Interval) -> Interval {
        if !z.is_known() {
            return match self {
                Self::Tanh => Interval { lo: -1.0, hi: 1.0 },
                Self::Identity | Self::Relu => z,
            };
        }
        let error = match self {
            Self::Identity | Self::Relu => 0.0,
            Self::Tanh => 8.0 * f64::EPSILON,
        };
        Interval {
            lo: self.apply(z.lo) - error,
            hi: self.apply(z.hi) + error,
        }
    }
}

/// An affine map x ↦ Wx + b and the activation after it.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// W: one row for each output.
    pub weights: Matrix,
    /// b.
    pub bias: Vec<f64>,
    /// What follows.
    pub activation: Activation,
    /// By how much of its own size each weight may differ from the exact one (0 almost always;
    /// a division by a constant has no exact reciprocal).
    pub uncertainty: f64,
}

impl Layer {
    /// Number of outputs.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.bias.len()
    }

    /// Number of inputs.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.weights.cols()
    }

    /// Relative error of a sum over this layer's inputs, its weights' own uncertainty included.
    pub fn relative_error(&self) -> f64 {
        gamma(self.inputs() + 4) + 2.0 * self.uncertainty
    }

    /// What an exact weight may be as a multiple of the given one.
    pub(crate) fn spread(&self) -> Interval {
        Interval {
            lo: 1.0 - self.uncertainty,
            hi: 1.0 + self.uncertainty,
        }
    }
}

/// A feed-forward network in normal form.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    inputs: usize,
    layers: Vec<Layer>,
}

/// Layers that do not fit together, or numbers that are not finite.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("layer {layer} {what}")]
#[non_exhaustive]
pub struct ModelError {
    /// Index of the layer.
    pub layer: usize,
    /// What is wrong with it.
    pub what: &'static str,
}

impl Network {
    /// A network of these layers.
    ///
    /// # Errors
    /// If a layer's sizes do not fit the one before it, or a number is not finite.
    pub fn new(inputs: usize, layers: Vec<Layer>) -> Result<Self, ModelError> {
        let mut width = inputs;
        for (layer, l) in layers.iter().enumerate() {
            let fault = |what| Err(ModelError { layer, what });
            if l.inputs() != width {
                return fault("does not take what the layer before it gives");
            }
            if l.weights.rows() != l.bias.len() {
                return fault("has not one bias for each row of weights");
            }
            let finite = |values: &[f64]| values.iter().all(|v| v.is_finite());
            if !finite(l.weights.data()) || !finite(&l.bias) || !l.uncertainty.is_finite() {
                return fault("has a number that is not finite");
            }
            width = l.outputs();
        }
        if layers.is_empty() {
            return Err(ModelError {
                layer: 0,
                what: "is missing: a network has at least one",
            });
        }
        Ok(Self { inputs, layers })
    }

    /// Number of inputs.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Number of outputs.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.layers.last().map_or(self.inputs, Layer::outputs)
    }

    /// The layers, first to last.
    #[must_use]
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// The outputs in `f64`, and for each a bound on its distance from the exact output of the
    /// network in real-number semantics: infinite where a number on the way overflows. Panics if
    /// `input` is shorter than the network's inputs.
    #[must_use]
    pub fn run(&self, input: &[f64]) -> Evaluation {
        let mut values = input[..self.inputs].to_vec();
        for layer in &self.layers {
            let sum = |i: usize| {
                let terms = layer.weights.row(i).iter().zip(&values);
                layer.bias[i] + terms.map(|(w, v)| w * v).sum::<f64>()
            };
            values = (0..layer.outputs())
                .map(|i| layer.activation.apply(sum(i)))
                .collect();
        }
        let input = input[..self.inputs].iter().copied().map(Interval::point);
        let ranges = self.enclose(input.collect());
        let error = |(v, y): (&f64, Interval)| {
            if v.is_finite() && y.is_known() {
                (y.hi - v).max(v - y.lo).next_up()
            } else {
                f64::INFINITY
            }
        };
        let errors = values.iter().zip(ranges).map(error).collect();
        Evaluation { values, errors }
    }

    /// Intervals that contain the exact outputs for all inputs in the given ones.
    pub(crate) fn enclose(&self, input: Vec<Interval>) -> Vec<Interval> {
        let mut values = input;
        for layer in &self.layers {
            let uncertain = layer.spread();
            let sum = |i: usize| {
                let terms = layer.weights.row(i).iter().zip(&values);
                let start = Interval::point(layer.bias[i]);
                let z = terms.fold(start, |sum, (&w, &v)| {
                    sum.add(v.mul(Interval::point(w)).mul(uncertain))
                });
                layer.activation.enclose(z)
            };
            values = (0..layer.outputs()).map(sum).collect();
        }
        values
    }

    /// Whether outputs of rational inputs are rational and can be computed: there is no tanh and
    /// no weight is uncertain.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        let exact = |l: &Layer| l.uncertainty == 0.0 && l.activation != Activation::Tanh;
        self.layers.iter().all(exact)
    }

    /// The exact outputs; `None` unless [`Self::is_exact`]. Panics if `input` is shorter than the
    /// network's inputs.
    ///
    /// Cost: one product of large integers for each weight; their length grows with the layers.
    #[must_use]
    pub fn evaluate(&self, input: &[BigRational]) -> Option<Vec<BigRational>> {
        if !self.is_exact() {
            return None;
        }
        // All values are multiples of 1/unit, which no layer changes: ReLU is homogeneous.
        let input = &input[..self.inputs];
        let unit = input
            .iter()
            .fold(BigInt::one(), |unit, x| unit.lcm(x.denom()));
        let whole = |x: &BigRational| Dyadic::from(x.numer() * (&unit / x.denom()));
        let mut values: Vec<Dyadic> = input.iter().map(whole).collect();
        let scale = Dyadic::from(unit.clone());
        for layer in &self.layers {
            let of = |v: f64| Dyadic::of(v).unwrap_or_else(Dyadic::zero);
            let neuron = |i: usize| {
                let terms = layer.weights.row(i).iter().zip(&values);
                let terms = terms.filter(|(w, v)| **w != 0.0 && !v.is_zero());
                let start = &of(layer.bias[i]) * &scale;
                let z = terms.fold(start, |sum, (&w, v)| &sum + &(&of(w) * v));
                match layer.activation {
                    Activation::Relu if z.sign() == Ordering::Less => Dyadic::zero(),
                    _ => z,
                }
            };
            values = (0..layer.outputs()).map(neuron).collect();
        }
        let fraction = |y: &Dyadic| y.rational() / BigRational::from(unit.clone());
        Some(values.iter().map(fraction).collect())
    }

    /// Intervals that contain the exact outputs of rational inputs.
    pub(crate) fn enclose_rational(&self, input: &[BigRational]) -> Vec<Interval> {
        let ends = |x: &BigRational| Interval {
            lo: dyadic::floor(x),
            hi: dyadic::ceil(x),
        };
        self.enclose(input[..self.inputs].iter().map(ends).collect())
    }

    /// The outputs as an `f32` runtime computes them (products summed in order of the inputs).
    #[must_use]
    pub fn run_f32(&self, input: &[f64]) -> Vec<f64> {
        let mut values: Vec<f32> = input[..self.inputs].iter().map(|&x| x as f32).collect();
        for layer in &self.layers {
            values = (0..layer.outputs())
                .map(|i| {
                    let sum = layer
                        .weights
                        .row(i)
                        .iter()
                        .zip(&values)
                        .fold(0.0_f32, |sum, (w, v)| sum + *w as f32 * v);
                    layer
                        .activation
                        .apply(f64::from(sum + layer.bias[i] as f32)) as f32
                })
                .collect();
        }
        values.into_iter().map(f64::from).collect()
    }
}

/// The result of running a network at one point.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// The outputs, computed in `f64`.
    pub values: Vec<f64>,
    /// For each output, a bound on its distance from the exact one.
    pub errors: Vec<f64>,
}
