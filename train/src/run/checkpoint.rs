//! Checkpoint files: a run at rest.
//!
//! `CEDECKPT`, the SHA-256 of what the run learns from, the seed, the run
//! (postcard), and a CRC-32 of all that. A file that is damaged, or that belongs
//! to other data, is refused; writing replaces the last file only when the new one is whole.

use crate::run::Progress;
use crate::run::curve::Curve;
use cede_data::output;
use cede_data::output::OutputError;
use crc::{CRC_32_ISO_HDLC, Crc};
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::{Path, PathBuf};

const MAGIC: &[u8; 8] = b"CEDECKPT";
static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// A run at rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// SHA-256 of what the run learns from.
    pub data: [u8; 32],
    /// The algorithm's name.
    pub algorithm: String,
    /// The seed that the run began with.
    pub seed: u64,
    /// Its settings as TOML.
    pub settings: String,
    /// The run.
    pub progress: Progress,
    /// How its drivers scored on the way.
    pub curve: Curve,
}

/// A checkpoint cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// It cannot be read.
    #[error("cannot read {}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// It is not a checkpoint, or it is damaged.
    #[error("{} is not a sound checkpoint: {problem}", .path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: &'static str,
    },
}

impl Checkpoint {
    /// Writes the checkpoint; an earlier one at `path` stays until this one is whole.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn save(&self, path: &Path) -> Result<(), OutputError> {
        let mut bytes = MAGIC.to_vec();
        let body = postcard::to_allocvec(self).map_err(|error| OutputError {
            path: path.to_owned(),
            source: std::io::Error::other(error),
        })?;
        bytes.extend(body);
        let checksum = CRC.checksum(&bytes);
        bytes.extend(checksum.to_le_bytes());
        output::write(path, |file: &mut dyn Write| file.write_all(&bytes))
    }

    /// Reads a checkpoint.
    ///
    /// # Errors
    /// When it cannot be read, is damaged, or is of another version.
    pub fn load(path: &Path) -> Result<Self, CheckpointError> {
        let bytes = std::fs::read(path).map_err(|source| CheckpointError::Read {
            path: path.to_owned(),
            source,
        })?;
        Self::parse(&bytes).map_err(|problem| CheckpointError::Content {
            path: path.to_owned(),
            problem,
        })
    }

    fn parse(bytes: &[u8]) -> Result<Self, &'static str> {
        let rest = bytes
            .strip_prefix(MAGIC)
            .ok_or("it does not begin with CEDECKPT")?;
        let (body, checksum) = rest.split_last_chunk::<4>().ok_or("it is cut short")?;
        let content = &bytes[..MAGIC.len() + body.len()];
        if CRC.checksum(content) != u32::from_le_bytes(*checksum) {
            return Err("the checksum does not fit: it is damaged or cut short");
        }
        postcard::from_bytes(body).map_err(|_| "another version of the program wrote it")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::{Algorithm, Lessons, Run};
    use cede_data::{Dataset, Encounter};

    fn checkpoint() -> Checkpoint {
        let dataset = Dataset::synthetic(4, 4);
        let encounters: Vec<&Encounter> = dataset.encounters.iter().take(4).collect();
        let lessons = Lessons::new(&encounters, &[]);
        let settings = Algorithm::Bc
            .settings()
            .with(&"width = 16".parse().unwrap())
            .unwrap();
        let mut run = Run::new(settings, &lessons, 1);
        assert!(run.advance().is_some());
        Checkpoint {
            data: [3; 32],
            algorithm: "bc".to_owned(),
            seed: 1,
            settings: String::new(),
            progress: run.progress(),
            curve: Curve::default(),
        }
    }

    #[test]
    fn a_checkpoint_is_read_back_and_a_damaged_one_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.checkpoint");
        let checkpoint = checkpoint();
        checkpoint.save(&path).unwrap();
        assert!(Checkpoint::load(&path).unwrap() == checkpoint);

        let bytes = std::fs::read(&path).unwrap();
        for place in [0, 9, bytes.len() / 2, bytes.len() - 1] {
            let mut damaged = bytes.clone();
            damaged[place] ^= 16;
            assert!(Checkpoint::parse(&damaged).is_err(), "byte {place}");
        }
        for length in [0, 8, 11, bytes.len() - 1] {
            assert!(
                Checkpoint::parse(&bytes[..length]).is_err(),
                "{length} bytes"
            );
        }
    }

    #[test]
    fn the_last_checkpoint_stays_when_the_next_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.checkpoint");
        std::fs::create_dir(&path).unwrap();
        assert!(checkpoint().save(&path).is_err(), "a folder is in the way");
        assert!(path.is_dir());
    }
}
