//! The network: four dense layers with ReLU between, in `f32`, in one fixed order of summation.

/// Widths are multiples of this: so many neurons are summed side by side, with one accumulator each.
pub const LANES: usize = 16;
/// Widest hidden layer.
pub const MAX_WIDTH: usize = 128;
/// Outputs: mean of the two commands, then the logarithms of their spreads (training's; unused at inference).
pub const OUTPUTS: usize = 4;

/// Neurons summed side by side, as many as the target's registers hold. It changes no result,
/// because a neuron's sum always runs over its inputs in the same order.
const TILE: usize = if cfg!(target_feature = "avx") {
    4 * LANES
} else if cfg!(target_feature = "sse2") {
    2 * LANES
} else {
    LANES
};

/// A network that borrows its weights from where they lie: no copy, no allocation.
///
/// Each hidden neuron is summed as `((bias + w₀x₀) + w₁x₁) + …`, each output as four such sums over the inputs
/// 0, 4, 8, …; 1, 5, 9, …; 2, …; 3, … (the first with the bias), added as `(s₀ + s₁) + (s₂ + s₃)`. No product
/// is fused with a sum. So every target that follows IEEE 754 gives the same bits.
///
/// The sizes are values, not types: as fast, and one code serves every weights file.
#[derive(Clone, Copy, Debug)]
pub struct Mlp<'a> {
    hidden: [Dense<'a>; 3],
    output: Dense<'a>,
}

/// A dense layer: a bias for each neuron, and for each input a column of weights, one for each neuron.
#[derive(Clone, Copy, Debug)]
pub struct Dense<'a> {
    biases: &'a [u32],
    columns: &'a [u32],
}

impl<'a> Mlp<'a> {
    /// Number of words that a network of this shape takes: layer by layer the biases, then the columns.
    ///
    /// Cost: constant. Overflows, as `usize` does, for sizes beyond [`MAX_WIDTH`] by far.
    #[must_use]
    pub const fn words(inputs: usize, width: usize) -> usize {
        (inputs + 1) * width + 2 * (width + 1) * width + (width + 1) * OUTPUTS
    }

    /// A network over `words` (bit patterns of `f32`), or `None` if their number does not fit the shape,
    /// if `width` is not a multiple of [`LANES`] up to [`MAX_WIDTH`], or if there are no inputs or more than that.
    ///
    /// Cost: constant. Never panics.
    #[must_use]
    pub fn new(words: &'a [u32], inputs: usize, width: usize) -> Option<Self> {
        let shape_fits = (LANES..=MAX_WIDTH).contains(&width)
            && width.is_multiple_of(LANES)
            && (1..=MAX_WIDTH).contains(&inputs);
        if !shape_fits || words.len() != Self::words(inputs, width) {
            return None;
        }
        let (first, rest) = Dense::split(words, inputs, width)?;
        let (second, rest) = Dense::split(rest, width, width)?;
        let (third, rest) = Dense::split(rest, width, width)?;
        let (output, _) = Dense::split(rest, width, OUTPUTS)?;
        Some(Self {
            hidden: [first, second, third],
            output,
        })
    }

    /// Width of the hidden layers.
    ///
    /// Cost: constant. Never panics.
    #[must_use]
    pub fn width(&self) -> usize {
        self.output.columns.len() / OUTPUTS
    }

    /// The four layers, from the inputs to the outputs; ReLU follows all but the last.
    ///
    /// Cost: constant. Never panics.
    #[must_use]
    pub const fn layers(&self) -> [Dense<'a>; 4] {
        let [first, second, third] = self.hidden;
        [first, second, third, self.output]
    }

    /// The outputs for `inputs`; inputs that are missing count as zero, surplus ones are ignored.
    ///
    /// Cost: `Mlp::words` multiplications and additions, the same instructions for every input.
    /// Never panics; finite if inputs and weights are within the limits that `weights` enforces.
    #[must_use]
    pub fn forward(&self, inputs: &[f32]) -> [f32; OUTPUTS] {
        // The stack of a small network is half that of a wide one.
        if self.width() <= MAX_WIDTH / 2 {
            self.pass::<{ MAX_WIDTH / 2 }>(inputs)
        } else {
            self.pass::<MAX_WIDTH>(inputs)
        }
    }

    /// The pass through a network whose layers are at most `W` wide.
    #[inline(never)]
    fn pass<const W: usize>(&self, inputs: &[f32]) -> [f32; OUTPUTS] {
        let (mut a, mut b) = ([0.0; W], [0.0; W]);
        let [first, second, third] = &self.hidden;
        first.relu(inputs, &mut a);
        second.relu(&a, &mut b);
        third.relu(&b, &mut a);
        self.output.sum(&a)
    }
}

impl<'a> Dense<'a> {
    /// The bias of each neuron.
    ///
    /// Cost: O(neurons) to go through. Never panics.
    pub fn biases(&self) -> impl ExactSizeIterator<Item = f32> + use<'a> {
        self.biases.iter().map(|&word| f32::from_bits(word))
    }

    /// The weights, input by input: those of input 0 for each neuron, then those of input 1, …
    ///
    /// Cost: O(weights) to go through. Never panics.
    pub fn weights(&self) -> impl ExactSizeIterator<Item = f32> + use<'a> {
        self.columns.iter().map(|&word| f32::from_bits(word))
    }

    /// Takes a layer from the front of `words`.
    fn split(words: &'a [u32], inputs: usize, neurons: usize) -> Option<(Self, &'a [u32])> {
        let (biases, rest) = words.split_at_checked(neurons)?;
        let (columns, rest) = rest.split_at_checked(inputs * neurons)?;
        Some((Self { biases, columns }, rest))
    }

    /// The first places of `y` become max(0, bias + W·x).
    fn relu(&self, x: &[f32], y: &mut [f32]) {
        let Some(y) = y.get_mut(..self.biases.len()) else {
            return;
        };
        let (wide, rest) = y.as_chunks_mut::<TILE>();
        let mut start = 0;
        for y in wide {
            *y = self.tile(start, x);
            start += TILE;
        }
        if TILE > LANES {
            for y in rest.as_chunks_mut::<LANES>().0 {
                *y = self.tile(start, x);
                start += LANES;
            }
        }
    }

    /// `T` neurons from `start` on.
    #[inline]
    fn tile<const T: usize>(&self, start: usize, x: &[f32]) -> [f32; T] {
        let Some(biases) = chunk::<T>(self.biases, start) else {
            return [0.0; T];
        };
        let mut sums = biases.map(f32::from_bits);
        for (column, &x) in self.columns.chunks_exact(self.biases.len()).zip(x) {
            let Some(weights) = chunk::<T>(column, start) else {
                break;
            };
            for (sum, &weight) in sums.iter_mut().zip(weights) {
                *sum += f32::from_bits(weight) * x;
            }
        }
        sums.map(|sum| if sum > 0.0 { sum } else { 0.0 })
    }

    /// bias + W·x for the few outputs: four partial sums each, so that the additions need not wait for each other.
    fn sum(&self, x: &[f32]) -> [f32; OUTPUTS] {
        let mut sums = [[0.0; OUTPUTS]; 4];
        if let Some(biases) = self.biases.first_chunk::<OUTPUTS>() {
            sums[0] = biases.map(f32::from_bits);
        }
        let columns = self.columns.as_chunks::<OUTPUTS>().0.as_chunks::<4>().0;
        for (columns, x) in columns.iter().zip(x.as_chunks::<4>().0) {
            for ((sums, column), x) in sums.iter_mut().zip(columns).zip(x) {
                for (sum, &weight) in sums.iter_mut().zip(column) {
                    *sum += f32::from_bits(weight) * x;
                }
            }
        }
        let [a, b, c, d] = sums;
        core::array::from_fn(|i| (a[i] + b[i]) + (c[i] + d[i]))
    }
}

fn chunk<const T: usize>(words: &[u32], start: usize) -> Option<&[u32; T]> {
    words.get(start..)?.first_chunk()
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::weights::testing::noise;
    use std::vec::Vec;

    /// The documented order of summation, one number at a time.
    fn layer(w: &mut impl Iterator<Item = f32>, x: &[f32], neurons: usize) -> Vec<f32> {
        let mut sums: Vec<f32> = w.take(neurons).collect();
        for x in x {
            for sum in &mut sums {
                *sum += w.next().unwrap() * x;
            }
        }
        sums
    }

    fn reference(words: &[u32], x: &[f32], width: usize) -> [f32; OUTPUTS] {
        let mut w = words.iter().map(|&w| f32::from_bits(w));
        let mut x = x.to_vec();
        for _ in 0..3 {
            x = layer(&mut w, &x, width);
            x.iter_mut()
                .for_each(|x| *x = if *x > 0.0 { *x } else { 0.0 });
        }
        let biases: Vec<f32> = w.by_ref().take(OUTPUTS).collect();
        let columns: Vec<f32> = w.collect();
        core::array::from_fn(|o| {
            let sum = |start: usize, bias: f32| {
                (start..width)
                    .step_by(4)
                    .fold(bias, |sum, i| sum + columns[i * OUTPUTS + o] * x[i])
            };
            (sum(0, biases[o]) + sum(1, 0.0)) + (sum(2, 0.0) + sum(3, 0.0))
        })
    }

    #[test]
    fn every_width_gives_the_bits_of_the_documented_order() {
        for inputs in [1, 8, 14, 18] {
            for width in (LANES..=MAX_WIDTH).step_by(LANES) {
                let count = Mlp::words(inputs, width);
                let words: Vec<u32> = noise(3).map(f32::to_bits).take(count).collect();
                let mlp = Mlp::new(&words, inputs, width).unwrap();
                let x: Vec<f32> = noise(5).take(inputs).collect();
                let (out, expected) = (mlp.forward(&x), reference(&words, &x, width));
                assert!(out.iter().any(|&o| o != 0.0));
                assert_eq!(out.map(f32::to_bits), expected.map(f32::to_bits));
            }
        }
    }

    #[test]
    fn another_order_gives_other_bits() {
        let words: Vec<u32> = noise(3).map(f32::to_bits).take(Mlp::words(8, 64)).collect();
        let x: Vec<f32> = noise(5).take(8).collect();
        let mut w = words.iter().map(|&w| f32::from_bits(w));
        let mut hidden = x.clone();
        for _ in 0..3 {
            hidden = layer(&mut w, &hidden, 64);
            hidden
                .iter_mut()
                .for_each(|x| *x = if *x > 0.0 { *x } else { 0.0 });
        }
        assert_ne!(layer(&mut w, &hidden, OUTPUTS), reference(&words, &x, 64));
    }

    #[test]
    fn a_wrong_shape_is_refused() {
        let words = std::vec![0; Mlp::words(8, 32)];
        assert!(Mlp::new(&words, 8, 32).is_some());
        assert!(Mlp::new(&words[1..], 8, 32).is_none());
        assert!(Mlp::new(&words, 9, 32).is_none());
        assert!(Mlp::new(&[], 0, 0).is_none());
        assert!(Mlp::new(&words, usize::MAX, 32).is_none());
        assert!(Mlp::new(&words, 8, usize::MAX).is_none());
    }
}
