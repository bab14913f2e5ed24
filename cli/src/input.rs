//! Input files, read whole.

use crate::failure::Failure;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Maximum size of a file (bytes): a device that never ends is no input.
const LARGEST: u64 = 1 << 30;

/// The bytes of the file at `path`, which should be `what`.
///
/// # Errors
/// It cannot be read, or is larger than [`LARGEST`].
pub(crate) fn bytes(path: &Path, what: &str) -> Result<Vec<u8>, Failure> {
    read(path).map_err(|error| {
        let path = path.display();
        Failure::input(
            format!("cannot read {path}: {error}"),
            format!("give {what}"),
        )
    })
}

/// The text of the file at `path`, which should be `what`.
///
/// # Errors
/// As [`bytes`], or it is not text.
pub(crate) fn text(path: &Path, what: &str) -> Result<String, Failure> {
    let bytes = bytes(path, what)?;
    String::from_utf8(bytes).map_err(|_| unusable(path, "it is not text in UTF-8", what))
}

/// `path` cannot be used because of `problem`; it should be `what`.
pub(crate) fn unusable(path: &Path, problem: impl std::fmt::Display, what: &str) -> Failure {
    let (path, problem) = (path.display(), problem.to_string());
    let problem = problem.trim_end();
    Failure::input(
        format!("cannot use {path}: {problem}"),
        format!("give {what}"),
    )
}

fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?
        .take(LARGEST + 1)
        .read_to_end(&mut bytes)?;
    if bytes.len() as u64 > LARGEST {
        return Err(io::Error::other("it is larger than 1 GiB"));
    }
    Ok(bytes)
}
