//! Bounds of all neurons on a box, by a dense backward pass for each.

use super::InputMap;
use super::form::{Form, TINY, ULP};
use crate::enclosure::AffineEnclosure;
use crate::model::{Activation, Layer, Network};
use crate::property::InputBox;

/// A box and bounds of all pre-activations, layer by layer.
#[derive(Clone)]
pub(super) struct Bounds<'a> {
    /// The box.
    pub(super) region: InputBox,
    inputs: Option<InputMap<'a>>,
    /// The network's inputs on the region, where they are functions of its variables.
    enclosures: Vec<AffineEnclosure>,
    /// Least and greatest value of each pre-activation.
    pub(super) layers: Vec<Vec<(f64, f64)>>,
    /// Which bounds are assumptions about a ReLU's phase, and stay.
    first: Vec<Option<usize>>,
}

impl<'a> Bounds<'a> {
    /// A box before anything is known of the pre-activations; the network's inputs are
    /// functions of its variables where there are `inputs`.
    pub(super) fn new(network: &Network, inputs: Option<InputMap<'a>>, region: InputBox) -> Self {
        let mut count = 0;
        let first = network.layers().iter().map(|layer| {
            let start = (layer.activation != Activation::Identity).then_some(count);
            count += start.map_or(0, |_| layer.outputs());
            start
        });
        let first = first.collect();
        let unbounded = |layer: &Layer| vec![(f64::NEG_INFINITY, f64::INFINITY); layer.outputs()];
        Self {
            region,
            inputs,
            enclosures: Vec::new(),
            layers: network.layers().iter().map(unbounded).collect(),
            first,
        }
    }

    /// Assumes a phase of a ReLU.
    pub(super) fn assume(&mut self, neuron: usize, on: bool) -> Option<()> {
        let (layer, first) = self
            .first
            .iter()
            .enumerate()
            .filter_map(|(i, f)| f.map(|f| (i, f)))
            .rfind(|(_, f)| *f <= neuron)?;
        let (l, u) = self.layers[layer].get_mut(neuron - first)?;
        if on {
            *l = l.max(0.0);
        } else {
            *u = u.min(0.0);
        }
        Some(())
    }

    /// Tightens all bounds to the box; false if they contradict each other.
    pub(super) fn tighten(&mut self, network: &Network) -> bool {
        self.enclosures = self
            .inputs
            .map_or_else(Vec::new, |inputs| inputs(&self.region));
        for (index, layer) in network.layers().iter().enumerate() {
            for i in 0..layer.outputs() {
                let (l, u) = self.layers[index][i];
                if layer.activation == Activation::Relu && (l >= 0.0 || u <= 0.0) {
                    continue;
                }
                let side = |sign: f64| {
                    let mut form = Form::zero(layer.inputs());
                    form.add(layer.weights.row(i), layer.bias[i], sign);
                    // The row is exact but for its own uncertainty.
                    form.error +=
                        layer.uncertainty * self.reach(network, index, layer.weights.row(i));
                    self.least(network, index, form, |_| None, |_| 0.0)
                };
                let (l, u) = (l.max(side(1.0)), u.min(-side(-1.0)));
                if l > u {
                    return false;
                }
                self.layers[index][i] = (l, u);
            }
        }
        true
    }

    /// Largest |row·x| by interval arithmetic over what layer `index` takes.
    fn reach(&self, network: &Network, index: usize, row: &[f64]) -> f64 {
        row.iter()
            .enumerate()
            .map(|(j, w)| w.abs() * self.magnitude(network, index, j))
            .sum::<f64>()
            * (1.0 + 1e-9)
    }

    /// Largest absolute value of input j of layer `index`.
    fn magnitude(&self, network: &Network, index: usize, j: usize) -> f64 {
        if index == 0 {
            return match self.inputs {
                Some(_) => self.enclosures[j].magnitude(&self.region),
                None => self.region.lower[j].abs().max(self.region.upper[j].abs()),
            };
        }
        let (l, u) = self.layers[index - 1][j];
        match network.layers()[index - 1].activation {
            Activation::Relu => u.max(0.0),
            Activation::Identity => l.abs().max(u.abs()),
            Activation::Tanh => 1.0,
        }
    }

    /// A lower bound of a form over what layer `index` takes: back through the layers before it,
    /// each activation replaced by a line, then over the box. `slope` may choose lower slopes of
    /// ReLUs; `multiplier` adds multiples of pre-activations.
    pub(super) fn least(
        &self,
        network: &Network,
        index: usize,
        mut form: Form,
        slope: impl Fn(usize) -> Option<f64>,
        multiplier: impl Fn(usize) -> f64,
    ) -> f64 {
        let doubts = form.doubts.iter().enumerate();
        form.error += doubts
            .map(|(j, d)| d * self.magnitude(network, index, j))
            .sum::<f64>()
            * (1.0 + 1e-9);
        for (depth, layer) in network.layers()[..index].iter().enumerate().rev() {
            let first = self.first[depth];
            let mut before = Form::zero(layer.inputs());
            (before.constant, before.error) = (form.constant, form.error);
            let mut sizes = vec![0.0; layer.inputs()];
            for (j, &c) in form.coefficients.iter().enumerate() {
                let bounds = self.layers[depth][j];
                let (factor, offset) = line(
                    layer.activation,
                    bounds,
                    c,
                    first.and_then(|f| slope(f + j)),
                );
                let lambda = first.map_or(0.0, |f| multiplier(f + j));
                let total = factor + lambda;
                before.constant += offset + total * layer.bias[j];
                before.error += ULP
                    * (before.constant.abs()
                        + offset.abs()
                        + (total * layer.bias[j]).abs()
                        + (factor.abs() + lambda.abs() + c.abs())
                            * bounds.0.abs().max(bounds.1.abs()));
                if total == 0.0 {
                    continue;
                }
                let row = layer.weights.row(j);
                for ((sum, size), w) in before.coefficients.iter_mut().zip(&mut sizes).zip(row) {
                    *sum += total * w;
                    *size += (total * w).abs();
                }
            }
            // Each coefficient was summed from so many products.
            let terms = form.coefficients.len() as f64 * ULP + layer.uncertainty;
            let reach = sizes
                .iter()
                .enumerate()
                .map(|(i, s)| s * self.magnitude(network, depth, i));
            before.error += terms * reach.sum::<f64>() + TINY;
            form = before;
        }
        if self.inputs.is_some() {
            form = self.before_inputs(&form);
        }
        let mut least = form.constant;
        let mut size = least.abs();
        for ((&c, &lo), &hi) in form
            .coefficients
            .iter()
            .zip(&self.region.lower)
            .zip(&self.region.upper)
        {
            let term = (c * lo).min(c * hi);
            least += term;
            size += term.abs();
        }
        let terms = form.coefficients.len() as f64 * ULP;
        least - (form.error + terms * size) * (1.0 + 1e-9) - TINY
    }
}

impl Bounds<'_> {
    /// The form over the variables that bounds a form over the inputs from below.
    fn before_inputs(&self, form: &Form) -> Form {
        let mut before = Form::zero(self.region.lower.len());
        before.error = form.error;
        before.constant = form.constant;
        let mut sizes = form.constant.abs();
        for (input, &c) in self.enclosures.iter().zip(&form.coefficients) {
            before.add(&input.slopes, input.constant, c);
            before.constant -= c.abs() * input.radius;
            sizes += c.abs() * (input.magnitude(&self.region) + input.radius);
        }
        let sides = self.region.lower.iter().zip(&self.region.upper);
        let reach = before.doubts.iter().zip(sides);
        let doubt: f64 = reach.map(|(d, (lo, hi))| d * lo.abs().max(hi.abs())).sum();
        before.error += doubt * (1.0 + 1e-9) + self.enclosures.len() as f64 * ULP * sizes;
        before
    }
}

/// For c·f(z) with z in the bounds: (factor, offset) with factor·z + offset ≤ c·f(z).
fn line(activation: Activation, (l, u): (f64, f64), c: f64, slope: Option<f64>) -> (f64, f64) {
    match activation {
        Activation::Identity => (c, 0.0),
        Activation::Relu if u <= 0.0 => (0.0, 0.0),
        Activation::Relu if l >= 0.0 => (c, 0.0),
        Activation::Relu if c >= 0.0 => {
            let usual = if u + l > 0.0 { 1.0 } else { 0.0 };
            (c * slope.unwrap_or(usual), 0.0)
        }
        Activation::Relu => {
            // The chord from (l, 0) to (u, u), raised until it clears both ends.
            let chord = (u / (u - l)).min(1.0);
            (c * chord, c * (-(chord * l)).max(u - chord * u))
        }
        Activation::Tanh => {
            let (low, high) = (l.tanh(), u.tanh());
            let flattest = ((1.0 - low * low).min(1.0 - high * high) - 1e-9).max(0.0);
            let offset = if c >= 0.0 {
                low - flattest * l - 1e-14
            } else {
                high - flattest * u + 1e-14
            };
            (c * flattest, c * offset)
        }
    }
}
