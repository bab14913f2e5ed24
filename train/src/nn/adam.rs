//! The Adam optimiser (Kingma & Ba, 2015).

use serde::{Deserialize, Serialize};

/// Adam with its moments; β₁ = 0.9, β₂ = 0.999, ε = 1e-8 as in the paper and in PyTorch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Adam {
    first: Vec<f32>,
    second: Vec<f32>,
    steps: u32,
}

const BETA: (f32, f32) = (0.9, 0.999);
const EPSILON: f32 = 1e-8;

impl Adam {
    /// An optimiser for `parameters` parameters, before its first step.
    #[must_use]
    pub fn new(parameters: usize) -> Self {
        Self {
            first: vec![0.0; parameters],
            second: vec![0.0; parameters],
            steps: 0,
        }
    }

    /// Moves `parameters` against `gradient` at the given learning `rate`.
    ///
    /// # Panics
    /// If the two do not have the optimiser's length.
    pub fn step(&mut self, parameters: &mut [f32], gradient: &[f32], rate: f32) {
        assert!(parameters.len() == self.first.len() && gradient.len() == self.first.len());
        self.steps += 1;
        let t = self.steps as f32;
        let rate = rate * (1.0 - libm::powf(BETA.1, t)).sqrt() / (1.0 - libm::powf(BETA.0, t));
        let epsilon = EPSILON * (1.0 - libm::powf(BETA.1, t)).sqrt();
        let moments = self.first.iter_mut().zip(&mut self.second);
        for ((p, g), (m, v)) in parameters.iter_mut().zip(gradient).zip(moments) {
            *m += (1.0 - BETA.0) * (g - *m);
            *v += (1.0 - BETA.1) * (g * g - *v);
            *p -= rate * *m / (v.sqrt() + epsilon);
        }
    }
}

/// Scales `gradient` down to a Euclidean length of at most `limit`.
pub fn clip(gradient: &mut [f32], limit: f32) {
    let length = gradient.iter().map(|g| g * g).sum::<f32>().sqrt();
    if length > limit {
        gradient.iter_mut().for_each(|g| *g *= limit / length);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_step_has_the_length_of_the_learning_rate() {
        let mut p = [1.0, -2.0];
        Adam::new(2).step(&mut p, &[0.5, -1e-3], 0.1);
        assert!((p[0] - 0.9).abs() < 1e-5 && (p[1] + 1.9).abs() < 1e-4);
    }

    #[test]
    fn finds_the_minimum_of_a_badly_scaled_parabola() {
        let mut p = [5.0, -3.0];
        let mut adam = Adam::new(2);
        for _ in 0..2000 {
            let gradient = [200.0 * (p[0] - 1.0), 0.02 * (p[1] - 2.0)];
            adam.step(&mut p, &gradient, 0.02);
        }
        assert!(
            (p[0] - 1.0).abs() < 1e-3 && (p[1] - 2.0).abs() < 1e-2,
            "{p:?}"
        );
    }

    #[test]
    fn clipping_keeps_the_direction() {
        let mut g = [3.0, 4.0];
        clip(&mut g, 1.0);
        assert!((g[0] - 0.6).abs() < 1e-6 && (g[1] - 0.8).abs() < 1e-6);
    }
}
