//! What a policy was trained from: a text, and its SHA-256 for the weights file.

use cede_data::{Encounter, Entry, Rights};
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// SHA-256 of everything that training reads from `encounters`, and of the text of its `claims`
/// (empty if there are none).
#[must_use]
pub fn data_hash<'e>(
    encounters: impl IntoIterator<Item = &'e Encounter>,
    claims: &str,
) -> [u8; 32] {
    let mut hash = Sha256::new();
    for encounter in encounters {
        let id = &encounter.id;
        hash.update(format!("{} {} {} {} ", id.site, id.file, id.left, id.other));
        hash.update(format!(
            "{:?} {:?} {}\n",
            encounter.kind, encounter.first, encounter.steps
        ));
        // Nothing is known without a map.
        if encounter.rights != Rights::default() {
            hash.update(format!("{:?}\n", encounter.rights));
        }
        for participant in &encounter.participants {
            if participant.entry != Entry::default() {
                hash.update(format!("{:?}\n", participant.entry));
            }
            hash.update(participant.conflict_s.to_le_bytes());
            hash.update(participant.appears.to_le_bytes());
            for point in participant.route.points() {
                hash.update(point.x.to_le_bytes());
                hash.update(point.y.to_le_bytes());
            }
            for sample in &participant.record {
                for value in [sample.s, sample.v, sample.a] {
                    hash.update(value.to_le_bytes());
                }
            }
        }
    }
    hash.update(claims);
    hash.finalize().into()
}

/// How a policy was trained; its text is stored next to the weights.
#[derive(Clone, Debug, PartialEq)]
pub struct Provenance {
    /// The algorithm's name on the command line.
    pub algorithm: String,
    /// Its settings as TOML.
    pub settings: String,
    /// Seed of every random choice.
    pub seed: u64,
    /// Source of the data, in a few words.
    pub data: String,
    /// Number of encounters.
    pub encounters: usize,
    /// See [`data_hash`].
    pub data_hash: [u8; 32],
    /// The command that trains it again.
    pub command: String,
}

impl Provenance {
    /// The text; its SHA-256 is the weights file's provenance hash.
    #[must_use]
    pub fn text(&self) -> String {
        let mut hash = String::new();
        for byte in self.data_hash {
            // Writing to a string cannot fail.
            let _ = write!(hash, "{byte:02x}");
        }
        format!(
            "Policy trained by cede {version}\n\ncommand: {}\nalgorithm: {}\nseed: {}\ndata: {} ({} encounters)\ndata SHA-256: {hash}\n\nsettings:\n{}",
            self.command,
            self.algorithm,
            self.seed,
            self.data,
            self.encounters,
            self.settings,
            version = env!("CARGO_PKG_VERSION"),
        )
    }

    /// SHA-256 of [`Provenance::text`].
    #[must_use]
    pub fn hash(&self) -> [u8; 32] {
        Sha256::digest(self.text()).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cede_data::Dataset;

    #[test]
    fn a_changed_sample_changes_the_hash() {
        let mut dataset = Dataset::synthetic(3, 1);
        let before = data_hash(&dataset.encounters, "");
        assert_eq!(before, data_hash(&Dataset::synthetic(3, 1).encounters, ""));
        dataset.encounters[1].participants[0].record[2].v += 1e-3;
        let after = data_hash(&dataset.encounters, "");
        assert_ne!(before, after);
        assert_ne!(after, data_hash(&dataset.encounters, "[[property]]"));
    }
}
