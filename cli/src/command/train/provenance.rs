//! How the policy of a training was made: the text next to the weights.

use super::{DATA_SEED, Method, Options};
use crate::source::Source;
use crate::training::Identity;
use cede_train::run::provenance::Provenance;

/// The provenance of the policy that is trained by `method` on this number of encounters from a `source`.
pub(super) fn of(
    method: &Method,
    (source, encounters): (&Source, usize),
    options: &Options,
    identity: &Identity,
) -> Provenance {
    let algorithm = method.algorithm.0.name();
    let mut command = format!("cede train {algorithm}");
    let data = if source.is_synthetic() {
        let (least, seed) = (source.encounters(), options.data_seed.unwrap_or(DATA_SEED));
        command += &format!(" --data synthetic --encounters {least} --data-seed {seed}");
        format!("synthetic, seed {seed}")
    } else {
        command += &format!(" --data DIR --site {}", source.sites());
        format!("recordings of {}", source.sites())
    };
    if options.every_pair {
        command += " --every-pair";
    }
    if let Some(path) = &options.claims {
        command += &format!(" --claims {}", path.display());
    }
    command += &format!(" --seed {}", options.seed);
    for set in &method.set {
        command += &format!(" --set {set}");
    }
    if method.settings.is_some() {
        command += " --settings FILE.toml";
    }
    Provenance {
        algorithm: algorithm.to_owned(),
        settings: identity.settings.text(),
        seed: options.seed,
        data,
        encounters,
        data_hash: identity.data,
        command: command + " --out FILE.cede",
    }
}
