//! The normal form of a network: affine layers, each followed by one activation.

use super::rounding::{SPARE, UNDERFLOW, gamma};

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

    /// How far the computed value can be from the exact one. The system's tanh is assumed to err
    /// by at most 8 units in the last place (glibc states 2).
    pub fn error(self) -> f64 {
        match self {
            Self::Identity | Self::Relu => 0.0,
            Self::Tanh => 8.0 * f64::EPSILON,
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
    /// network in real-number semantics. Panics if `input` is shorter than the network's inputs.
    #[must_use]
    pub fn run(&self, input: &[f64]) -> Evaluation {
        let mut values = input[..self.inputs].to_vec();
        let mut errors = vec![0.0; self.inputs];
        for layer in &self.layers {
            let relative = layer.relative_error();
            let (z, e): (Vec<f64>, Vec<f64>) = (0..layer.outputs())
                .map(|i| {
                    let (mut sum, mut size, mut carried) =
                        (layer.bias[i], layer.bias[i].abs(), 0.0);
                    for ((w, v), e) in layer.weights.row(i).iter().zip(&values).zip(&errors) {
                        sum += w * v;
                        size += (w * v).abs();
                        carried += w.abs() * e;
                    }
                    let error = (carried * (1.0 + relative) + relative * size + UNDERFLOW) * SPARE;
                    (
                        layer.activation.apply(sum),
                        error + layer.activation.error(),
                    )
                })
                .unzip();
            (values, errors) = (z, e);
        }
        Evaluation { values, errors }
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
