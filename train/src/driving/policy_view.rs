//! A trained network with its inputs and its seat: what drives, and what a weights file is made of.

use crate::driving::inputs::Inputs;
use crate::nn::network::{Network, Tape};
use cede_controller::policy::acceleration;
use cede_controller::policy::weights::Draft;
use cede_controller::{Pair, Perspective, WeightsError};

/// A network that drives, borrowed from the run that trains it.
#[derive(Clone, Copy, Debug)]
pub struct PolicyView<'n> {
    /// The network: its first two outputs are the means of the two commands.
    pub network: &'n Network,
    /// Its inputs.
    pub inputs: &'n Inputs,
    /// Whose commands it gives.
    pub perspective: Perspective,
}

impl PolicyView<'_> {
    /// Accelerations (m/s²) of the left-turner and of the other for what each pair of vehicles sees.
    pub fn drive(&self, pairs: &[[Pair; 2]], tape: &mut Tape) -> Vec<[f32; 2]> {
        let alone = self.perspective == Perspective::Ego;
        let mut rows = Vec::new();
        for [left, other] in pairs {
            self.inputs.append(left, &mut rows);
            if alone {
                self.inputs.append(other, &mut rows);
            }
        }
        let output = self.network.forward(&rows, tape);
        let width = self.network.sizes()[self.network.sizes().len() - 1];
        let (row, second) = if alone {
            (2 * width, width)
        } else {
            (width, 1)
        };
        let rows = output.chunks_exact(row);
        rows.map(|o| [acceleration(o[0]), acceleration(o[second])])
            .collect()
    }

    /// The words of the weights file (`.cede`) that `cede_controller` runs.
    ///
    /// # Errors
    /// When the network has another shape than the controller's, or its training has diverged.
    pub fn weights(&self, provenance: [u8; 32]) -> Result<Vec<u32>, WeightsError> {
        let mut parameters = Vec::with_capacity(self.network.parameters().len());
        for layer in self.network.layers() {
            parameters.extend_from_slice(layer.biases);
            parameters.extend_from_slice(layer.weights);
        }
        let draft = Draft {
            features: self.inputs.features(),
            perspective: self.perspective,
            width: self.network.sizes().get(1).copied().unwrap_or(0),
            provenance,
            centres: &self.inputs.centres,
            scales: &self.inputs.scales,
            parameters: &parameters,
        };
        let mut words = vec![0; draft.words()];
        draft.encode(&mut words)?;
        Ok(words)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cede_controller::{FeatureSet, Policy};
    use cede_data::Dataset;
    use cede_sim::ObservationModel;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    #[test]
    fn the_controller_drives_as_the_trainer_does() {
        let dataset = Dataset::synthetic(5, 1);
        let models: Vec<ObservationModel<'_>> = dataset
            .encounters
            .iter()
            .take(5)
            .map(ObservationModel::new)
            .collect();
        let pairs: Vec<[Pair; 2]> = models
            .iter()
            .flat_map(|model| {
                let flat: Vec<Pair> = model.recorded().collect();
                flat.as_chunks().0.to_vec()
            })
            .collect();
        for (features, perspective) in [
            (FeatureSet::Raw, Perspective::Joint),
            (FeatureSet::Scene, Perspective::Ego),
        ] {
            let inputs = Inputs::fit(features, pairs.iter().flatten());
            let sizes = [features.count(), 48, 48, 48, 4];
            let network = Network::new(&sizes, &mut Pcg64::seed_from_u64(3));
            let view = PolicyView {
                network: &network,
                inputs: &inputs,
                perspective,
            };
            let words = view.weights([9; 32]).unwrap();
            let policy = Policy::new(&words).unwrap();
            let commands = view.drive(&pairs, &mut Tape::default());
            for (pair, command) in pairs.iter().zip(commands) {
                for i in 0..2 {
                    assert!((policy.act(&pair[i])[0] - command[i]).abs() < 1e-4);
                }
            }
        }
    }
}
