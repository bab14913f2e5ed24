//! Weights files from disk, as policies that live as long as the program.

use cede_controller::policy::weights;
use cede_controller::{Policy, WeightsError};
use std::path::{Path, PathBuf};

/// A weights file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// It cannot be read.
    #[error("cannot read {}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// It is not a weights file, or it is damaged.
    #[error("cannot use {}: {source}", .path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: WeightsError,
    },
}

/// The policy of the weights file (`.cede`) at `path`.
///
/// # Errors
/// When the file cannot be read, or is not a sound weights file.
pub fn load(path: &Path) -> Result<Policy<'static>, LoadError> {
    let bytes = std::fs::read(path).map_err(|source| LoadError::Read {
        path: path.to_owned(),
        source,
    })?;
    let words: Vec<u32> = weights::words(&bytes).collect();
    keep(&words).map_err(|source| LoadError::Content {
        path: path.to_owned(),
        source,
    })
}

/// The policy of a weights file's words, copied to a cache line's boundary, where it runs fastest.
///
/// The copy is never freed: a policy is wanted to the program's end, and there are few of them.
///
/// # Errors
/// When `words` are not a sound weights file; then nothing is kept.
pub fn keep(words: &[u32]) -> Result<Policy<'static>, WeightsError> {
    Policy::new(words)?;
    let line = size_of::<weights::Aligned<16>>() / size_of::<u32>();
    let mut buffer = vec![0; words.len() + line];
    let start = buffer
        .as_ptr()
        .align_offset(align_of::<weights::Aligned<16>>());
    buffer[start..start + words.len()].copy_from_slice(words);
    Policy::new(&buffer.leak()[start..start + words.len()])
}

#[cfg(test)]
mod tests {
    use super::*;
    use cede_controller::policy::weights::Draft;
    use cede_controller::{FeatureSet, Mlp, Perspective};

    fn file() -> Vec<u32> {
        let draft = Draft {
            features: FeatureSet::Raw,
            perspective: Perspective::Joint,
            width: 16,
            provenance: [7; 32],
            centres: &[0.0; 8],
            scales: &[0.1; 8],
            parameters: &[0.01; Mlp::words(8, 16)],
        };
        let mut words = vec![0; draft.words()];
        draft.encode(&mut words).unwrap();
        words
    }

    #[test]
    fn a_file_is_loaded_and_a_damaged_one_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("driver.cede");
        let mut bytes: Vec<u8> = file().iter().flat_map(|w| w.to_le_bytes()).collect();
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(load(&path).unwrap().weights().provenance(), [7; 32]);

        bytes[100] ^= 4;
        std::fs::write(&path, &bytes).unwrap();
        let message = load(&path).unwrap_err().to_string();
        assert!(message.ends_with("driver.cede: the checksum does not fit: the file is damaged"));

        bytes.truncate(2);
        std::fs::write(&path, &bytes).unwrap();
        let message = load(&path).unwrap_err().to_string();
        assert!(message.contains("does not begin with CEDE"));

        let missing = load(&folder.path().join("none.cede")).unwrap_err();
        assert!(missing.to_string().starts_with("cannot read"));
    }
}
