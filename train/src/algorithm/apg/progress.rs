//! The state of a run between two updates.

use crate::algorithm::apg::claims::AdversarialStates;
use crate::algorithm::apg::closed_loop::Start;
use crate::algorithm::apg::settings::{ApgSettings, as_text};
use crate::driving::inputs::Inputs;
use crate::nn::adam::Adam;
use crate::nn::network::Network;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// The state of a run between two updates; a checkpoint stores it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ApgProgress {
    #[serde(with = "as_text")]
    pub(super) settings: ApgSettings,
    pub(super) inputs: Inputs,
    /// The network in training.
    pub(super) network: Network,
    /// Trained networks that will join the ensemble.
    members: Vec<Network>,
    /// The unrefined ensemble, during a refinement.
    pub(super) former: Option<Network>,
    pub(super) adam: Adam,
    pub(super) random: Pcg64,
    /// Number of updates done.
    pub(super) update: u32,
    /// Where the last roll-outs have ended and the next ones may begin.
    pub(super) places: Vec<Start>,
    pub(super) adversarial: AdversarialStates,
}

impl ApgProgress {
    /// The state before the first update; `inputs` normalises the features.
    pub(super) fn new(settings: ApgSettings, inputs: Inputs, seed: u64) -> Self {
        let mut random = Pcg64::seed_from_u64(seed);
        let network = initial_network(&settings, &mut random);
        Self {
            adam: Adam::new(network.parameters().len()),
            settings,
            inputs,
            network,
            members: Vec::new(),
            former: None,
            random,
            update: 0,
            places: Vec::new(),
            adversarial: AdversarialStates::new(),
        }
    }

    /// Counts an update. After the last update of a network it begins the training of the next one,
    /// or joins all of them to an ensemble.
    pub(super) fn finish_update(&mut self) {
        self.update += 1;
        let ApgSettings {
            members, updates, ..
        } = self.settings;
        let trained = self.update.checked_rem(updates) == Some(0);
        if !trained || self.update > members * updates {
            return;
        }
        let next = if self.update == members * updates {
            self.members.push(self.network.clone());
            let ensemble = Network::mean(&std::mem::take(&mut self.members));
            self.former = (self.settings.refinement.updates > 0).then(|| ensemble.clone());
            ensemble
        } else {
            let next = initial_network(&self.settings, &mut self.random);
            self.members
                .push(std::mem::replace(&mut self.network, next.clone()));
            next
        };
        self.begin(next);
    }

    /// Begins the training of `network`.
    fn begin(&mut self, network: Network) {
        self.adam = Adam::new(network.parameters().len());
        self.network = network;
        self.places.clear();
        self.adversarial.clear();
    }
}

/// A network with random weights.
fn initial_network(settings: &ApgSettings, random: &mut Pcg64) -> Network {
    let (i, w) = (settings.features.count(), settings.width);
    Network::new(&[i, w, w, w, 4], random).with_last_layer_scaled(0.1)
}
