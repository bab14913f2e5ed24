//! A test that is skipped says so, although it passes.

use std::process::Command;

/// Runs itself as a test that lacks its material.
#[test]
fn a_skipped_test_says_so_without_nocapture_and_in_the_file_of_skips() {
    const INNER: &str = "CEDE_TESTS_INNER";
    let name = "a_skipped_test_says_so_without_nocapture_and_in_the_file_of_skips";
    if std::env::var_os(INNER).is_some() {
        assert_eq!(cede_tests::interaction(), None);
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let skips = folder.path().join("skips");
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", name])
        .env(INNER, "")
        .env("CEDE_INTERACTION_DIR", "/nowhere")
        .env("CEDE_SKIPS", &skips)
        .output()
        .unwrap();
    assert!(output.status.success());
    let said = String::from_utf8(output.stderr).unwrap();
    let what = "recorded data (CEDE_INTERACTION_DIR)";
    assert_eq!(said, format!("skipped: {name}: no {what}\n"));
    assert_eq!(std::fs::read_to_string(skips).unwrap(), format!("{what}\n"));
}
