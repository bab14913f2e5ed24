//! What tests of all crates share: materials that are not part of the project, and a word on each test that lacks them.
#![forbid(unsafe_code)]

use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The folder of INTERACTION's recordings: `CEDE_INTERACTION_DIR`, or `../shared/interaction` beside
/// the repository. `None`, and a line that says so, where there is none.
#[must_use]
pub fn interaction() -> Option<PathBuf> {
    let folder = material("CEDE_INTERACTION_DIR", "interaction");
    found(
        folder.is_dir(),
        folder,
        "recorded data (CEDE_INTERACTION_DIR)",
    )
}

/// The folder `name` of the public conformance material: in `CEDE_CONFORMANCE_DIR`, or in
/// `../shared/conformance` beside the repository. `None`, and a line that says so, where there is none.
#[must_use]
pub fn conformance(name: &str) -> Option<PathBuf> {
    let folder = material("CEDE_CONFORMANCE_DIR", "conformance").join(name);
    found(
        folder.is_dir(),
        folder,
        "conformance material (CEDE_CONFORMANCE_DIR)",
    )
}

/// Says that this test is skipped for want of `what`: on standard error, past the test harness, which
/// shows nothing else of a test that passes, and as a line of the file in `CEDE_SKIPS`.
///
/// # Panics
/// If that file cannot be written.
pub fn skip(what: &str) {
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("a test");
    // One write for each line: tests in other threads write as well.
    let _ = std::io::stderr().write_all(format!("skipped: {test}: no {what}\n").as_bytes());
    if let Some(path) = std::env::var_os("CEDE_SKIPS") {
        let file = OpenOptions::new().create(true).append(true).open(&path);
        file.and_then(|mut file| file.write_all(format!("{what}\n").as_bytes()))
            .unwrap_or_else(|error| panic!("CEDE_SKIPS={}: {error}", path.display()));
    }
}

/// The folder in the variable, or `../shared/NAME` beside the repository.
fn material(variable: &str, name: &str) -> PathBuf {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared");
    std::env::var_os(variable).map_or_else(|| shared.join(name), PathBuf::from)
}

fn found(there: bool, folder: PathBuf, what: &str) -> Option<PathBuf> {
    if !there {
        skip(what);
    }
    there.then_some(folder)
}
