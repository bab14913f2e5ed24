//! The forms of a layer's neurons from those of the layer before.

use super::{Place, PreparedLayer, Unbounded, Weights, Workspace, in_time};
use crate::kernel::{compose, padded};
use cede_nnv_check::rounding::{SPARE, underflow};
use std::time::Instant;

/// Products that are taken between two looks at the clock.
const PRODUCTS_AT_A_TIME: usize = 1 << 26;

impl Workspace {
    /// The forms of the wanted neurons of a layer from those of the layer before.
    ///
    /// # Errors
    /// If the deadline passed.
    #[inline(always)]
    pub(super) fn compose_layer(
        &mut self,
        layer: &PreparedLayer,
        deadline: Option<Instant>,
    ) -> Result<(), Unbounded> {
        let lanes = padded(self.forms.neurons.len());
        let columns = self.symbols.columns();
        self.forms.coefficients.clear();
        self.forms.coefficients.resize(columns * lanes, 0.0);
        if lanes == 0 {
            return Ok(());
        }
        let values = self.active.iter().map(|&lane| self.previous.sizes[lane]);
        let values = underflow(1, values.sum::<f64>() * SPARE);
        let products = 4 * (self.active.len() + self.direct.len());
        let errors = self.symbols.underflow(products) + values;
        self.forms.errors.clear();
        self.forms.errors.resize(lanes, errors);
        match &layer.weights {
            Weights::Dense(weights) => self.compose_dense(layer, weights, deadline)?,
            Weights::Sparse(rows) => self.compose_sparse(layer, rows, deadline)?,
        }
        let (z, errors) = (&mut self.forms.coefficients, &mut self.forms.errors);
        for (lane, &i) in self.forms.neurons.iter().enumerate() {
            z[lane] += layer.bias[i];
            let of_bias = (layer.relative_error + layer.uncertainty) * layer.bias[i].abs();
            errors[lane] = (errors[lane] + of_bias) * SPARE;
        }
        let sizes = &mut self.forms.sizes;
        sizes.clear();
        sizes.resize(lanes, underflow(columns, 1.0));
        for (row, &most) in z.chunks_exact(lanes).zip(self.symbols.most()) {
            for (size, c) in sizes.iter_mut().zip(row) {
                *size += c.abs() * most;
            }
        }
        for size in sizes {
            *size *= SPARE;
        }
        Ok(())
    }

    /// Columns of the forms of the layer before.
    fn columns_before(&self) -> usize {
        if self.active.is_empty() {
            0
        } else {
            self.previous.coefficients.len() / padded(self.previous.neurons.len())
        }
    }

    /// The error of a neuron's sum for each unit of the weight of an active form before it.
    fn carried(&self, layer: &PreparedLayer, lane: usize) -> f64 {
        self.previous.errors[lane] * (1.0 + 1e-9)
            + (layer.relative_error + layer.uncertainty) * self.previous.sizes[lane]
            + underflow(4, 1.0)
    }

    /// The same for each unit of the weight of a symbol.
    fn uncertain(&self, layer: &PreparedLayer, column: usize) -> f64 {
        layer.uncertainty * self.symbols.most()[column] + underflow(2, 1.0)
    }

    #[inline(always)]
    fn compose_dense(
        &mut self,
        layer: &PreparedLayer,
        weights: &[f64],
        deadline: Option<Instant>,
    ) -> Result<(), Unbounded> {
        let (wanted, active) = (self.forms.neurons.len(), self.active.len());
        let (lanes, before) = (padded(wanted), self.columns_before());
        let of = |neuron: usize| &weights[neuron * layer.outputs..][..layer.outputs];
        self.compact_weights.clear();
        for &lane in &self.active {
            let weights = of(self.previous.neurons[lane]);
            self.compact_weights
                .extend(self.forms.neurons.iter().map(|&i| weights[i]));
            self.compact_weights
                .resize(self.compact_weights.len() + lanes - wanted, 0.0);
        }
        self.compact_rows.clear();
        let stride = padded(self.previous.neurons.len());
        for column in 0..before {
            let row = &self.previous.coefficients[column * stride..(column + 1) * stride];
            self.compact_rows
                .extend(self.active.iter().map(|&lane| row[lane]));
        }
        let group = (PRODUCTS_AT_A_TIME / (active * lanes + 1)).next_multiple_of(4);
        for first in (0..before).step_by(group) {
            in_time(deadline)?;
            let last = before.min(first + group);
            compose(
                &self.compact_rows[first * active..last * active],
                &self.compact_weights,
                active,
                lanes,
                &mut self.forms.coefficients[first * lanes..last * lanes],
            );
        }
        let mut errors = std::mem::take(&mut self.forms.errors);
        let weights = self.compact_weights.chunks_exact(lanes);
        for (&lane, weights) in self.active.iter().zip(weights) {
            let carried = self.carried(layer, lane);
            for (error, w) in errors.iter_mut().zip(weights) {
                *error += w.abs() * carried;
            }
        }
        for &(neuron, column) in &self.direct {
            let weights = of(neuron);
            let uncertain = self.uncertain(layer, column);
            for (lane, &i) in self.forms.neurons.iter().enumerate() {
                self.forms.coefficients[column * lanes + lane] = weights[i];
                errors[lane] += weights[i].abs() * uncertain;
            }
        }
        self.forms.errors = errors;
        Ok(())
    }

    fn compose_sparse(
        &mut self,
        layer: &PreparedLayer,
        rows: &[Vec<(u32, f64)>],
        deadline: Option<Instant>,
    ) -> Result<(), Unbounded> {
        let (lanes, before) = (padded(self.forms.neurons.len()), self.columns_before());
        let mut places = std::mem::take(&mut self.places);
        places.clear();
        places.resize(layer.inputs, Place::Off);
        for &lane in &self.active {
            places[self.previous.neurons[lane]] = Place::Active(lane);
        }
        for &(neuron, column) in &self.direct {
            places[neuron] = Place::Direct(column);
        }
        let mut products = std::mem::take(&mut self.products);
        products.clear();
        for k in 0..self.forms.neurons.len() {
            let mut error = 0.0;
            for &(input, w) in &rows[self.forms.neurons[k]] {
                match places[input as usize] {
                    Place::Off => {}
                    Place::Active(lane) => {
                        products.push((k, lane, w));
                        error += w.abs() * self.carried(layer, lane);
                    }
                    Place::Direct(column) => {
                        self.forms.coefficients[column * lanes + k] = w;
                        error += w.abs() * self.uncertain(layer, column);
                    }
                }
            }
            self.forms.errors[k] += error;
        }
        let stride = padded(self.previous.neurons.len());
        let group = PRODUCTS_AT_A_TIME / (products.len() + 1) + 1;
        for column in 0..before {
            if column.is_multiple_of(group) {
                in_time(deadline)?;
            }
            let row = &self.previous.coefficients[column * stride..(column + 1) * stride];
            let sums = &mut self.forms.coefficients[column * lanes..(column + 1) * lanes];
            for &(k, lane, w) in &products {
                sums[k] += row[lane] * w;
            }
        }
        (self.places, self.products) = (places, products);
        Ok(())
    }
}
