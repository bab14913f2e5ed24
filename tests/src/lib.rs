//! What the tests in `tests/` share.
#![forbid(unsafe_code)]

use std::path::{Path, PathBuf};

/// The folder of INTERACTION's recordings: `CEDE_INTERACTION_DIR`, or `../shared/interaction` beside
/// the repository. `None`, and a line that says so, where there is none.
#[must_use]
pub fn interaction(test: &str) -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/interaction");
    let folder = std::env::var_os("CEDE_INTERACTION_DIR").map_or(beside, PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("{test} skips: no recorded tracks in {}", folder.display());
    None
}
