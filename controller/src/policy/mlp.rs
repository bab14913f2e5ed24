//! The network: four dense layers with ReLU between, in `f32`, in one fixed order of summation.

use core::ops::Range;

/// Widths are multiples of this: so many neurons are summed side by side, with one accumulator each.
pub const LANES: usize = 16;
/// Widest hidden layer.
pub const MAX_WIDTH: usize = 128;
/// Outputs: mean of the two commands, then the logarithms of their spreads (training's; unused at inference).
pub const OUTPUTS: usize = 4;

/// Neurons of a layer whose weights lie together: what follows in memory is what is needed next, so
/// a network that does not fit the first-level cache is read in one ascending stream.
const TILE: usize = 96;
/// Neurons summed side by side, as many of a tile as the target's registers hold. It changes no result,
/// because a neuron's sum always runs over its inputs in the same order.
const ABREAST: usize = if cfg!(target_feature = "avx") {
    TILE
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

/// A dense layer. Its words: for every 96 neurons, and then for those that are left, a row of biases and for
/// each input a row of weights.
#[derive(Clone, Copy, Debug)]
pub struct Dense<'a> {
    words: &'a [u32],
    inputs: usize,
    neurons: usize,
}

impl<'a> Mlp<'a> {
    /// Number of words that a network of this shape takes.
    ///
    /// Cost: constant. Overflows, as `usize` does, for sizes beyond [`MAX_WIDTH`] by far.
    #[must_use]
    pub const fn words(inputs: usize, width: usize) -> usize {
        (inputs + 1) * width + 2 * (width + 1) * width + (width + 1) * OUTPUTS
    }

    /// A network over `words` (bit patterns of `f32`), or `None` if their number does not fit the shape,
    /// if `width` is not a multiple of [`LANES`] up to [`MAX_WIDTH`], or if there are no inputs or more than that.
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

    /// Where each of a network's parameters lies among its words: layer by layer the biases, then
    /// the weights, input by input.
    pub(crate) fn places(inputs: usize, width: usize) -> impl Iterator<Item = usize> {
        let mut start = 0;
        let layers = [
            (inputs, width),
            (width, width),
            (width, width),
            (width, OUTPUTS),
        ];
        layers.into_iter().flat_map(move |(inputs, neurons)| {
            let layer = start;
            let words = (inputs + 1) * neurons;
            start += words;
            (0..words).map(move |number| layer + place(inputs, neurons, number))
        })
    }

    /// Width of the hidden layers.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.output.inputs
    }

    /// The four layers, from the inputs to the outputs; ReLU follows all but the last.
    #[must_use]
    pub const fn layers(&self) -> [Dense<'a>; 4] {
        let [first, second, third] = self.hidden;
        [first, second, third, self.output]
    }

    /// The outputs for `inputs`; inputs that are missing count as zero, surplus ones are ignored.
    ///
    /// Cost: `Mlp::words` multiplications and additions, the same instructions for every input.
    /// finite if inputs and weights are within the limits that `weights` enforces.
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
        first.relu::<ABREAST>(inputs, &mut a);
        second.relu::<ABREAST>(&a, &mut b);
        third.relu::<ABREAST>(&b, &mut a);
        self.output.sum(&a)
    }
}

impl<'a> Dense<'a> {
    /// The bias of each neuron.
    ///
    /// Cost: O(neurons) to go through.
    pub fn biases(&self) -> impl ExactSizeIterator<Item = f32> + use<'a> {
        self.parameters(0..self.neurons)
    }

    /// The weights, input by input: those of input 0 for each neuron, then those of input 1, …
    ///
    /// Cost: O(weights) to go through.
    pub fn weights(&self) -> impl ExactSizeIterator<Item = f32> + use<'a> {
        self.parameters(self.neurons..self.words.len())
    }

    /// The parameters with these numbers: the biases are the first, the weights of input 0 the next, …
    fn parameters(&self, numbers: Range<usize>) -> impl ExactSizeIterator<Item = f32> + use<'a> {
        let layer = *self;
        let place = move |number| place(layer.inputs, layer.neurons, number);
        numbers.map(move |number| f32::from_bits(layer.words[place(number)]))
    }

    /// Takes a layer from the front of `words`.
    fn split(words: &'a [u32], inputs: usize, neurons: usize) -> Option<(Self, &'a [u32])> {
        let (words, rest) = words.split_at_checked((inputs + 1) * neurons)?;
        let layer = Self {
            words,
            inputs,
            neurons,
        };
        Some((layer, rest))
    }

    /// The first places of `y` become max(0, bias + W·x); `A` neurons are summed side by side.
    fn relu<const A: usize>(&self, x: &[f32], y: &mut [f32]) {
        let Some(y) = y.get_mut(..self.neurons) else {
            return;
        };
        let mut words = self.words;
        for y in y.chunks_mut(TILE) {
            let Some((tile, rest)) = Self::split(words, self.inputs, y.len()) else {
                return;
            };
            tile.relu_of_tile::<A>(x, y);
            words = rest;
        }
    }

    /// The same for a layer that is one tile.
    fn relu_of_tile<const A: usize>(&self, x: &[f32], y: &mut [f32]) {
        if A == TILE {
            // All of its neurons side by side: the length of a row is then a constant, too.
            return match self.neurons {
                96 => self.abreast::<96>(96, 0, x, y),
                80 => self.abreast::<80>(80, 0, x, y),
                64 => self.abreast::<64>(64, 0, x, y),
                48 => {
                    // In two, because LLVM leaves 48 sums in memory.
                    self.abreast::<32>(48, 0, x, y);
                    self.abreast::<LANES>(48, 32, x, y);
                }
                32 => self.abreast::<32>(32, 0, x, y),
                _ => self.abreast::<LANES>(LANES, 0, x, y),
            };
        }
        let mut start = 0;
        while start + A <= self.neurons {
            self.abreast::<A>(self.neurons, start, x, y);
            start += A;
        }
        while A > LANES && start < self.neurons {
            self.abreast::<LANES>(self.neurons, start, x, y);
            start += LANES;
        }
    }

    /// The same for the `N` neurons from `start` on, of `neurons` in a row.
    #[inline(always)]
    fn abreast<const N: usize>(&self, neurons: usize, start: usize, x: &[f32], y: &mut [f32]) {
        let mut rows = self.words.chunks_exact(neurons);
        let biases = rows.next().and_then(|row| chunk::<N>(row, start));
        let y = y.get_mut(start..).and_then(<[f32]>::first_chunk_mut);
        let (Some(biases), Some(y)) = (biases, y) else {
            return;
        };
        let mut sums = biases.map(f32::from_bits);
        for (row, &x) in rows.zip(x) {
            let Some(weights) = chunk::<N>(row, start) else {
                break;
            };
            for (sum, &weight) in sums.iter_mut().zip(weights) {
                *sum += f32::from_bits(weight) * x;
            }
        }
        *y = sums.map(|sum| if sum > 0.0 { sum } else { 0.0 });
    }

    /// bias + W·x for the few outputs: four partial sums each, so that the additions need not wait for each other.
    fn sum(&self, x: &[f32]) -> [f32; OUTPUTS] {
        let mut sums = [[0.0; OUTPUTS]; 4];
        let Some((biases, columns)) = self.words.as_chunks::<OUTPUTS>().0.split_first() else {
            return sums[0];
        };
        sums[0] = biases.map(f32::from_bits);
        for (columns, x) in columns.as_chunks::<4>().0.iter().zip(x.as_chunks::<4>().0) {
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

fn chunk<const N: usize>(row: &[u32], start: usize) -> Option<&[u32; N]> {
    row.get(start..)?.first_chunk()
}

/// Where the parameter with this number lies among a layer's words.
fn place(inputs: usize, neurons: usize, number: usize) -> usize {
    let (row, neuron) = (number / neurons, number % neurons);
    let in_tile = neuron % TILE;
    let start = neuron - in_tile;
    (inputs + 1) * start + row * TILE.min(neurons - start) + in_tile
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::policy::weights::testing::noise;
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

    /// A network's parameters in the documented order, and its words.
    fn network(inputs: usize, width: usize) -> (Vec<u32>, Vec<u32>) {
        let count = Mlp::words(inputs, width);
        let parameters: Vec<u32> = noise(3).map(f32::to_bits).take(count).collect();
        let mut words = std::vec![0; count];
        for (place, &parameter) in Mlp::places(inputs, width).zip(&parameters) {
            words[place] = parameter;
        }
        (parameters, words)
    }

    fn bits(words: &[u32], x: &[f32], width: usize) -> [u32; OUTPUTS] {
        let mlp = Mlp::new(words, x.len(), width).unwrap();
        mlp.forward(x).map(f32::to_bits)
    }

    #[test]
    fn every_width_gives_the_bits_of_the_documented_order() {
        for inputs in [1, 8, 14, 18] {
            for width in (LANES..=MAX_WIDTH).step_by(LANES) {
                let (parameters, words) = network(inputs, width);
                let x: Vec<f32> = noise(5).take(inputs).collect();
                let expected = reference(&parameters, &x, width);
                assert!(expected.iter().any(|&o| o != 0.0));
                assert_eq!(bits(&words, &x, width), expected.map(f32::to_bits));
            }
        }
    }

    #[test]
    fn every_target_gives_the_same_bits() {
        for width in (LANES..=MAX_WIDTH).step_by(LANES) {
            let (_, words) = network(8, width);
            let x: Vec<f32> = noise(5).take(width).collect();
            for layer in Mlp::new(&words, 8, width).unwrap().hidden {
                let [mut cortex, mut sse, mut avx] = [[0.0; MAX_WIDTH]; 3];
                layer.relu::<LANES>(&x, &mut cortex);
                layer.relu::<{ 2 * LANES }>(&x, &mut sse);
                layer.relu::<TILE>(&x, &mut avx);
                assert!(cortex[width - LANES..width].iter().any(|&y| y > 0.0));
                assert_eq!(cortex.map(f32::to_bits), sse.map(f32::to_bits));
                assert_eq!(cortex.map(f32::to_bits), avx.map(f32::to_bits));
            }
        }
    }

    #[test]
    fn a_wide_layer_lies_in_tiles_and_others_row_by_row() {
        for width in (LANES..=MAX_WIDTH).step_by(LANES) {
            let (parameters, words) = network(2, width);
            assert_eq!(parameters == words, width <= TILE);
            let x = [0.4, -0.9];
            let in_place = bits(&words, &x, width) == bits(&parameters, &x, width);
            assert_eq!(in_place, width <= TILE);
        }
        // Bias and two weights of the first 96, then of the other 32.
        let places: Vec<usize> = Mlp::places(2, 128).take(4 * 128).collect();
        assert_eq!(places[..96], (0..96).collect::<Vec<_>>());
        assert_eq!(places[96..128], (288..320).collect::<Vec<_>>());
        assert_eq!(places[128..224], (96..192).collect::<Vec<_>>());
        assert_eq!(places[224..256], (320..352).collect::<Vec<_>>());
        assert_eq!(places[3 * 128], 3 * 128);
    }

    #[test]
    fn another_order_gives_other_bits() {
        let (words, _) = network(8, 64);
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
