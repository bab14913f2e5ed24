//! An ensemble of networks as one network.

use crate::nn::network::Network;

impl Network {
    /// One network whose outputs are the means of the `members`' outputs. The hidden layers of the
    /// members lie side by side, with zero weights between them.
    ///
    /// # Panics
    /// If there are no members, or they differ in shape.
    #[must_use]
    pub fn mean(members: &[Self]) -> Self {
        let (count, shape) = (members.len(), members[0].sizes());
        assert!(members.iter().all(|member| member.sizes() == shape));
        let last = shape.len() - 1;
        let wide = |i: usize| shape[i] * if i == 0 || i == last { 1 } else { count };
        let sizes: Vec<usize> = (0..=last).map(wide).collect();
        let share = 1.0 / count as f32;
        let mut parameters = Vec::new();
        for i in 0..last {
            let (inputs, outputs) = (sizes[i], sizes[i + 1]);
            let mut layer = vec![0.0; (inputs + 1) * outputs];
            for (k, member) in members.iter().enumerate() {
                let Some(part) = member.layers().nth(i) else {
                    continue;
                };
                // The members share the rows of the first layer and the columns of the last one.
                let row = if i == 0 { 0 } else { k * part.inputs };
                let column = if i + 1 == last { 0 } else { k * part.outputs };
                let weight = if i + 1 == last { share } else { 1.0 };
                let rows = part.weights.chunks_exact(part.outputs).enumerate();
                let rows = rows.map(|(r, values)| (row + r, values));
                for (r, values) in rows.chain([(inputs, part.biases)]) {
                    let place = &mut layer[r * outputs + column..][..part.outputs];
                    place
                        .iter_mut()
                        .zip(values)
                        .for_each(|(p, v)| *p += weight * v);
                }
            }
            parameters.extend(layer);
        }
        Self::from_parts(sizes, parameters)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nn::network::Tape;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    #[test]
    fn the_ensemble_gives_the_mean_of_its_members_outputs() {
        let mut random = Pcg64::seed_from_u64(5);
        let members: Vec<Network> = (0..3)
            .map(|_| Network::new(&[4, 6, 5, 2], &mut random))
            .collect();
        let mean = Network::mean(&members);
        assert_eq!(mean.sizes(), [4, 18, 15, 2]);
        let input: Vec<f32> = (0..8).map(|_| random.random_range(-2.0..2.0)).collect();
        let run = |network: &Network| network.forward(&input, &mut Tape::default()).to_vec();
        let each: Vec<Vec<f32>> = members.iter().map(run).collect();
        for (i, got) in run(&mean).into_iter().enumerate() {
            let expected = each.iter().map(|outputs| outputs[i]).sum::<f32>() / 3.0;
            assert!((got - expected).abs() < 1e-6, "{got} against {expected}");
        }
    }
}
