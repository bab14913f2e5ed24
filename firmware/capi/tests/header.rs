//! The header that is checked in is the one that the crate has, and each of its numbers has a text.

use std::path::{Path, PathBuf};

fn here(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// With `UPDATE_HEADER` in the environment, writes it instead.
#[test]
fn the_header_is_up_to_date() {
    let config = cbindgen::Config::from_file(here("cbindgen.toml")).unwrap();
    let mut text = Vec::new();
    cbindgen::Builder::new()
        .with_config(config)
        .with_crate(here(""))
        .generate()
        .unwrap()
        .write(&mut text);
    let file = here("include/cede.h");
    if std::env::var_os("UPDATE_HEADER").is_some() {
        std::fs::write(&file, &text).unwrap();
    }
    let is_same = std::fs::read(&file).is_ok_and(|known| known == text);
    assert!(is_same, "include/cede.h is not what the crate has: UPDATE_HEADER=1 cargo test --test header");
}
