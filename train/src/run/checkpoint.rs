//! Checkpoint files: the state of a run on disk.
//!
//! Integers of a fixed size are little-endian.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `CEDECKPT` |
//! | 4 | version of the format, u32: [`VERSION`] |
//! | n | body: the fields of [`Checkpoint`] in their order, in [postcard](https://postcard.jamesmunns.com/wire-format.html)'s encoding |
//! | 4 | CRC-32 (ISO-HDLC) of all bytes before it, u32 |
//!
//! Magic, version and checksum keep their places in all versions. The body's layout belongs to the
//! version: a change of any type in [`Progress`] or [`Curve`] is a new version. A checkpoint bridges
//! an interruption, so a program reads its own version only. Writing replaces an earlier file only
//! when the new one is complete.

use crate::run::algorithm::Algorithm;
use crate::run::curve::Curve;
use crate::run::runner::Progress;
use cede_data::output;
use cede_data::output::OutputError;
use crc::{CRC_32_ISO_HDLC, Crc};
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Version of the format that this program writes and reads.
pub const VERSION: u32 = 3;

const MAGIC: &[u8; 8] = b"CEDECKPT";
static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// The state of a run, and what identifies the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// SHA-256 of the data that the run learns from.
    pub data: [u8; 32],
    /// The algorithm.
    pub algorithm: Algorithm,
    /// The run's seed.
    pub seed: u64,
    /// The run's settings as TOML.
    pub settings: String,
    /// The state.
    pub progress: Progress,
    /// The learning curve so far.
    pub curve: Curve,
}

/// A checkpoint cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The operating system's error.
        source: std::io::Error,
    },
    /// The file is not a checkpoint, or it is damaged.
    #[error("{} is not a valid checkpoint: {problem}", .path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// The file has another version of the format.
    #[error(
        "{} is a checkpoint of format version {found}; this program reads version {VERSION}",
        .path.display()
    )]
    Version {
        /// The file.
        path: PathBuf,
        /// The file's version.
        found: u32,
    },
}

/// Why bytes are no checkpoint.
#[derive(Debug, PartialEq)]
enum ParseError {
    Content(&'static str),
    Version(u32),
}

impl Checkpoint {
    /// Writes the checkpoint to `path`. An earlier file there stays until the new one is complete.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), OutputError> {
        let bytes = self.encode().map_err(|error| OutputError {
            path: path.to_owned(),
            source: std::io::Error::other(error),
        })?;
        output::write(path, |file: &mut dyn Write| file.write_all(&bytes))
    }

    /// Reads a checkpoint.
    ///
    /// # Errors
    /// The file cannot be read, is damaged, or has another version of the format.
    pub fn load(path: &Path) -> Result<Self, CheckpointError> {
        let path = path.to_owned();
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            Err(source) => return Err(CheckpointError::Read { path, source }),
        };
        Self::parse(&bytes).map_err(|error| match error {
            ParseError::Content(problem) => CheckpointError::Content { path, problem },
            ParseError::Version(found) => CheckpointError::Version { path, found },
        })
    }

    fn encode(&self) -> Result<Vec<u8>, postcard::Error> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(postcard::to_allocvec(self)?);
        let checksum = CRC.checksum(&bytes);
        bytes.extend(checksum.to_le_bytes());
        Ok(bytes)
    }

    fn parse(bytes: &[u8]) -> Result<Self, ParseError> {
        let content = |problem| ParseError::Content(problem);
        if !bytes.starts_with(MAGIC) {
            return Err(content("it does not begin with CEDECKPT"));
        }
        let truncated = || content("it is truncated");
        let (checked, checksum) = bytes.split_last_chunk::<4>().ok_or_else(truncated)?;
        let rest = checked.get(MAGIC.len()..).ok_or_else(truncated)?;
        let (version, body) = rest.split_first_chunk::<4>().ok_or_else(truncated)?;
        if CRC.checksum(checked) != u32::from_le_bytes(*checksum) {
            return Err(content(
                "the checksum does not match: it is damaged or truncated",
            ));
        }
        match u32::from_le_bytes(*version) {
            VERSION => postcard::from_bytes(body)
                .map_err(|_| content("its body does not have the layout of its version")),
            found => Err(ParseError::Version(found)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::lessons::Lessons;
    use crate::run::runner::Run;
    use crate::run::settings::TrainSettings;
    use cede_data::{Dataset, Encounter};

    fn taken_from(run: &Run<'_>, algorithm: Algorithm) -> Checkpoint {
        Checkpoint {
            data: [3; 32],
            algorithm,
            seed: 1,
            settings: String::new(),
            progress: run.progress(),
            curve: Curve::default(),
        }
    }

    fn checkpoint() -> Checkpoint {
        let dataset = Dataset::synthetic(4, 4);
        let encounters: Vec<&Encounter> = dataset.encounters.iter().take(4).collect();
        let lessons = Lessons::new(&encounters, &[]);
        let mut run = Run::new(small(Algorithm::Bc), &lessons, 1);
        assert!(run.advance().is_some());
        taken_from(&run, Algorithm::Bc)
    }

    /// Settings with which a run takes a moment.
    fn small(algorithm: Algorithm) -> TrainSettings {
        let set = match algorithm {
            Algorithm::Bc => "updates = 100\nwidth = 16\nbatch = 64",
            Algorithm::Apg => {
                "updates = 12\nwidth = 16\nbatch = 80\nhorizon = 6\nmembers = 2\n\
                 refinement = { updates = 10, places = 30 }"
            }
            _ => {
                "episodes = 60\nwidth = 16\nbatch = 32\nparallel = 4\nsteps_per_update = 8\n\
                 buffer = 500\nbuffer_minimum = 50\ncentred = true"
            }
        };
        algorithm.settings().with(&set.parse().unwrap()).unwrap()
    }

    /// `bytes` with the checksum of what they are now.
    fn with_checksum(mut bytes: Vec<u8>) -> Vec<u8> {
        bytes.truncate(bytes.len() - 4);
        let checksum = CRC.checksum(&bytes);
        bytes.extend(checksum.to_le_bytes());
        bytes
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
            let error = Checkpoint::parse(&damaged).unwrap_err();
            assert!(matches!(error, ParseError::Content(_)), "byte {place}");
        }
        for length in [0, 8, 11, 12, 15, bytes.len() - 1] {
            assert!(
                Checkpoint::parse(&bytes[..length]).is_err(),
                "{length} bytes"
            );
        }
    }

    #[test]
    fn another_version_is_refused_by_its_number() {
        let mut bytes = checkpoint().encode().unwrap();
        bytes[8] = 7;
        let bytes = with_checksum(bytes);
        assert_eq!(Checkpoint::parse(&bytes), Err(ParseError::Version(7)));

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.checkpoint");
        std::fs::write(&path, bytes).unwrap();
        let error = Checkpoint::load(&path).unwrap_err().to_string();
        for part in ["run.checkpoint", "format version 7", "reads version 3"] {
            assert!(error.contains(part), "{error}");
        }
    }

    #[test]
    fn the_file_begins_as_documented() {
        let bytes = checkpoint().encode().unwrap();
        assert_eq!(bytes[..8], *b"CEDECKPT");
        assert_eq!(bytes[8..12], [3, 0, 0, 0]);
        assert_eq!(bytes[12..44], [3; 32]);
        assert_eq!(bytes[44..47], [0, 1, 0], "algorithm, seed, no settings");
    }

    /// A change of these lengths is a change of the body's layout: raise [`VERSION`] with it.
    #[test]
    fn the_layout_is_that_of_the_version() {
        let dataset = Dataset::synthetic(8, 4);
        let encounters: Vec<&Encounter> = dataset.encounters.iter().take(8).collect();
        let lessons = Lessons::new(&encounters, &[]);
        let lengths = [Algorithm::Bc, Algorithm::Sac, Algorithm::Apg].map(|algorithm| {
            let run = Run::new(small(algorithm), &lessons, 1);
            taken_from(&run, algorithm).encode().unwrap().len()
        });
        assert_eq!((VERSION, lengths), (3, [9252, 35977, 11871]));
    }

    #[test]
    fn the_last_checkpoint_stays_if_the_next_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.checkpoint");
        std::fs::create_dir(&path).unwrap();
        assert!(checkpoint().save(&path).is_err(), "the path is a folder");
        assert!(path.is_dir());
    }

    #[test]
    fn every_algorithm_continues_from_a_checkpoint_with_the_same_bits() {
        let dataset = Dataset::synthetic(8, 4);
        let encounters: Vec<&Encounter> = dataset.encounters.iter().take(8).collect();
        let auxiliary: Vec<&Encounter> = dataset.encounters.iter().skip(8).take(4).collect();
        let lessons = Lessons::new(&encounters, &auxiliary);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.checkpoint");
        for algorithm in Algorithm::ALL {
            let mut whole = Run::new(small(algorithm), &lessons, 3);
            while whole.advance().is_some() {}
            let mut first = Run::new(small(algorithm), &lessons, 3);
            (0..27).for_each(|_| assert!(first.advance().is_some()));
            taken_from(&first, algorithm).save(&path).unwrap();
            drop(first);
            let loaded = Checkpoint::load(&path).unwrap();
            let mut second = Run::resume(loaded.progress, &lessons);
            while second.advance().is_some() {}
            assert!(
                second.progress() == whole.progress(),
                "{}",
                algorithm.name()
            );
            let weights = |run: &Run<'_>| run.view().weights([0; 32]).unwrap();
            assert_eq!(weights(&second), weights(&whole), "{}", algorithm.name());
        }
    }
}
