//! `cede verify`: what was not shown is said, and in the exit code.

use assert_cmd::cargo::cargo_bin_cmd;

#[test]
fn too_few_boxes_show_nothing_and_name_the_inputs() {
    let mut command = cargo_bin_cmd!("cede");
    command.args(["verify", "margins", "--boxes", "100", "--json"]);
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(
        told.contains("not shown: crosses before the other (worst case) for speed "),
        "{told}"
    );
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = report["margins"].as_array().unwrap();
    assert_eq!(rows.len(), 10);
    let stops = &rows[0];
    assert_eq!(stops["verdict"], "proved");
    assert!(stops["met_m"].as_f64() <= stops["at_most_m"].as_f64());
}

#[test]
fn the_margins_are_written_for_rocq_and_nothing_is_proved() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("Shipped.v");
    let write = |form: &str, more: &[&str]| {
        let mut command = cargo_bin_cmd!("cede");
        command.args(["verify", "lemmas", "--write", form]);
        command.arg(&file).args(more).output().unwrap()
    };
    let output = write("rocq", &[]);
    assert!(output.status.success(), "{output:?}");
    let written = std::fs::read_to_string(&file).unwrap();
    assert_eq!(written, include_str!("../../proofs/Shipped.v"));
    for (form, more) in [
        ("lean", &[][..]),
        ("rocq", &["--json"]),
        ("rocq", &["--only", "rest"]),
    ] {
        assert_eq!(write(form, more).status.code(), Some(2), "{form} {more:?}");
    }
}
