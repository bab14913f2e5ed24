//! `cede verify`: what was not shown is said, and in the exit code.

use assert_cmd::cargo::cargo_bin_cmd;

#[test]
fn too_few_boxes_show_nothing_and_name_the_inputs() {
    let mut command = cargo_bin_cmd!("cede");
    command.args(["verify", "margins", "--boxes", "3000", "--json"]);
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(
        told.contains("not shown: crosses before the other (worst case) for speed "),
        "{told}"
    );
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = report["margins"].as_array().unwrap();
    assert_eq!(rows.len(), 12);
    let stops = &rows[0];
    assert_eq!(stops["verdict"], "proved");
    assert!(stops["met_m"].as_f64() <= stops["at_most_m"].as_f64());
}

#[test]
fn a_larger_slack_is_no_mend_where_there_is_no_bound() {
    let mut command = cargo_bin_cmd!("cede");
    command.args(["verify", "margins", "--boxes", "1"]);
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(
        told.contains(
            "no bound in so many boxes: crosses before the other (worst case) for speed 0 to 20"
        ),
        "{told}"
    );
    assert!(!told.contains("larger `slack`"), "{told}");
}

#[test]
fn what_is_beyond_the_contract_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("beyond.svg");
    let mut command = cargo_bin_cmd!("cede");
    command.args(["verify", "beyond", "--encounters", "2", "--draw"]);
    let output = command.arg(&file).output().unwrap();
    assert!(output.status.success());
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.contains("those of 2 that begin with a safe plan"));
    assert!(table.contains("noticed: ") && !table.contains("lag 2 ×"));
    let drawn = std::fs::read_to_string(&file).unwrap();
    assert!(drawn.starts_with("<svg") && drawn.ends_with("</svg>\n"));
    for text in [
        "no guard",
        "plain rule",
        "shield",
        "hostile",
        "gentle",
        "latency 2 ×",
    ] {
        assert!(drawn.contains(text), "{text}");
    }
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

/// The smallest network and a property that holds of it: seeds of the fuzz targets.
const NETWORK: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../fuzz/seeds/network_onnx/narrow.onnx"
);
const PROPERTY: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../fuzz/seeds/vnnlib/narrow.vnnlib"
);

#[test]
fn a_certificate_says_what_is_proved_of_what_and_fits_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).display().to_string();
    let run = |arguments: &[&str]| {
        let mut command = cargo_bin_cmd!("cede");
        let output = command.arg("verify").args(arguments).output().unwrap();
        let told = [output.stdout, output.stderr].concat();
        (output.status.code(), String::from_utf8(told).unwrap())
    };
    let certificate = file("proof.txt");
    let verified = run(&[
        "network",
        "--onnx",
        NETWORK,
        "--vnnlib",
        PROPERTY,
        "--certificate",
        &certificate,
    ]);
    assert_eq!(verified, (Some(0), "unsat\n".to_owned()));
    let (code, told) = run(&["check", &certificate]);
    assert_eq!(code, Some(0), "{told}");
    for part in [
        "proved: for no input",
        "sha256",
        "narrow.onnx (",
        "narrow.vnnlib",
        "by cede ",
    ] {
        assert!(told.contains(part), "{part} in {told}");
    }
    let other = file("other.vnnlib");
    let text = std::fs::read_to_string(PROPERTY).unwrap();
    std::fs::write(&other, text + "; a comment\n").unwrap();
    let (code, told) = run(&["check", &certificate, "--vnnlib", &other]);
    assert_eq!(code, Some(1), "{told}");
    assert!(told.contains("about another property"), "{told}");
}

#[test]
fn a_time_limit_is_kept_while_files_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let long = folder.path().join("long.vnnlib");
    let boxes: String = (0..40_000)
        .map(|i| format!("(and (<= 0.{i} X_0 0.{i}1)(<= 0.1 X_1 0.{i}7)(<= Y_0 -{i}.5))\n"))
        .collect();
    let declared = "(declare-const X_0 Real)(declare-const X_1 Real)(declare-const Y_0 Real)";
    std::fs::write(&long, format!("{declared}(assert (or {boxes}))")).unwrap();
    let mut command = cargo_bin_cmd!("cede");
    command.args([
        "verify",
        "network",
        "--timeout",
        "0",
        "--onnx",
        NETWORK,
        "--vnnlib",
    ]);
    let start = std::time::Instant::now();
    let output = command.arg(&long).output().unwrap();
    assert!(start.elapsed().as_secs_f64() < 5.0, "{:?}", start.elapsed());
    // What is wrong with the property is found only if there is time.
    assert!(output.stdout.starts_with(b"timeout") || output.status.code() == Some(2));
}
