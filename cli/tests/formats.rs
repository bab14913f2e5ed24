//! `cede export` and `cede import`: a policy goes out and comes back; what cannot come in is named.

use assert_cmd::Command;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{self, Stdio};

fn cede(folder: &Path, arguments: &str) -> assert_cmd::assert::Assert {
    let mut command = Command::cargo_bin("cede").unwrap();
    command.current_dir(folder).args(arguments.split(' '));
    command.assert()
}

fn stdout(folder: &Path, arguments: &str) -> String {
    let output = cede(folder, arguments)
        .success()
        .get_output()
        .stdout
        .clone();
    String::from_utf8(output).unwrap()
}

fn stderr(folder: &Path, arguments: &str) -> String {
    let output = cede(folder, arguments).code(3).get_output().stderr.clone();
    String::from_utf8(output).unwrap()
}

#[test]
fn the_embedded_policy_goes_out_and_comes_back_to_drive_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    stdout(folder, "export --format onnx --out policy.onnx");
    let told = stdout(folder, "import --onnx policy.onnx --out back.cede");
    assert!(told.starts_with("ego policy over the features `rights`, hidden layers 48 wide\n"));
    assert!(told.ends_with("back.cede\n"));
    let drive = "evaluate --data synthetic --encounters 20 --driver cede --split all --shield both";
    let back = stdout(folder, &format!("{drive} --weights back.cede"));
    assert_eq!(back, stdout(folder, drive));

    stdout(
        folder,
        "export --weights back.cede --format safetensors --out policy.safetensors",
    );
    let bytes = std::fs::read(folder.join("policy.safetensors")).unwrap();
    let header = String::from_utf8_lossy(&bytes[8..1500]).into_owned();
    assert!(header.contains("layers.3.weight"), "{header}");
}

#[test]
fn what_cannot_come_in_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("text.onnx"), "no model").unwrap();
    let text = stderr(
        folder,
        "import --onnx text.onnx --features raw --out p.cede",
    );
    assert!(
        text.contains("cannot use text.onnx: not an ONNX model"),
        "{text}"
    );
    stdout(folder, "export --format onnx --out policy.onnx");
    let text = stderr(
        folder,
        "import --onnx policy.onnx --features raw --out p.cede",
    );
    assert!(text.contains("takes 22 features, `raw` has 8"), "{text}");
    assert!(
        text.contains("--features raw, route, traffic, scene or rights"),
        "{text}"
    );
    assert!(
        stderr(folder, "import --onnx none.onnx --out p.cede").contains("cannot read none.onnx")
    );
    assert!(!folder.join("p.cede").exists());
    cede(
        folder,
        "import --onnx policy.onnx --features speed --out p.cede",
    )
    .code(2);
}

#[test]
fn a_reader_that_has_seen_enough_is_no_failure() {
    let folder = tempfile::tempdir().unwrap();
    let mut child = process::Command::new(env!("CARGO_BIN_EXE_cede"))
        .args(["data", "synthesize", "--out", "made", "--encounters", "20"])
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Closed before anything is printed, as `| head -0` would.
    drop(child.stdout.take());
    let errors = BufReader::new(child.stderr.take().unwrap()).lines();
    let errors: Vec<String> = errors.map(Result::unwrap).collect();
    assert!(
        errors.iter().all(|line| !line.contains("panicked")),
        "{errors:?}"
    );
    assert!(child.wait().unwrap().success());
    assert!(folder.path().join("made").is_dir());
}
