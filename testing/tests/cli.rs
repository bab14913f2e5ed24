//! The program: exit status, files, and what it says of bad input.
#![cfg(feature = "cli")]

use assert_cmd::Command;
use std::path::Path;

fn conformance(arguments: &[&str]) -> (i32, String) {
    let mut command = Command::cargo_bin("cede-conformance").unwrap();
    let output = command.args(arguments).output().unwrap();
    let text = [output.stdout, output.stderr].concat();
    (
        output.status.code().unwrap(),
        String::from_utf8(text).unwrap(),
    )
}

fn file(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn it_passes_fails_and_refuses_with_0_1_and_2() {
    let folder = tempfile::tempdir().unwrap();
    let junit = folder.path().join("out.xml");
    let only = [
        "--only",
        "contract-fits-vehicle",
        "--only",
        "door",
        "--cases",
        "8",
    ];
    let junit_argument = ["--junit", junit.to_str().unwrap()];
    let (status, text) = conformance(&[&only[..], &junit_argument[..]].concat());
    assert_eq!(status, 0, "{text}");
    let xml = std::fs::read_to_string(&junit).unwrap();
    let document = roxmltree::Document::parse(&xml).unwrap();
    assert_eq!(
        document
            .descendants()
            .filter(|n| n.has_tag_name("testcase"))
            .count(),
        2
    );

    let (status, text) = conformance(&[&only[..], &["--vehicle", "braking=2"]].concat());
    assert_eq!(status, 1, "{text}");
    assert!(
        text.contains("change ego.braking in the contract from 3 to 2"),
        "{text}"
    );

    let (status, text) = conformance(&["--vehicle", "breaking=2"]);
    assert_eq!(status, 2);
    assert!(
        text.contains("there is no `breaking`; there are length, "),
        "{text}"
    );
}

#[test]
fn bad_files_are_named_with_field_and_value() {
    let folder = tempfile::tempdir().unwrap();
    let (status, json) = conformance(&["--print-contract"]);
    assert_eq!(status, 0, "{json}");
    let refuse = |arguments: &[&str], wanted: &[&str]| {
        let (status, text) = conformance(arguments);
        assert_eq!(status, 2, "{text}");
        assert!(wanted.iter().all(|part| text.contains(part)), "{text}");
    };
    let wrong = file(
        folder.path(),
        "c.json",
        &json.replace("\"latency\": 0.1", "\"latency\": 1.2"),
    );
    refuse(
        &["--contract", &wrong],
        &["c.json", "latency = 1.2 is outside [0, 1]"],
    );
    let unknown = file(folder.path(), "d.toml", "perod = 1.0");
    refuse(&["--contract", &unknown], &["d.toml", "perod"]);
    let damaged = file(folder.path(), "e.cede", "CEDEnothing");
    refuse(&["--policy", &damaged], &["e.cede"]);
    refuse(&["--policy", "missing.cede"], &["missing.cede"]);
    refuse(
        &["--vehicle", "braking=x"],
        &["braking = `x` is not a number"],
    );
    refuse(
        &["--vehicle", "width=-1"],
        &["width = -1 is outside (0, 40]"],
    );
    refuse(&["--only", "nothing"], &["there is no check `nothing`"]);
}

#[test]
fn a_contract_in_toml_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let text = "period = 0.1\nlatency = 0.08\nposition_error = 0.0\nspeed_error = 0.0\nslack = 0.01\n\
                [ego]\nmax_speed = 15.0\nacceleration = 3.0\ngo = 3.0\nbraking = 4.0\n\
                [other]\nmax_speed = 15.0\nacceleration = 3.0\nbraking = 8.0\n\
                [follower]\nreaction = 0.5\nbraking = 4.0\n";
    let path = file(folder.path(), "contract.toml", text);
    let (status, text) = conformance(&["--contract", &path, "--only", "door", "--cases", "4"]);
    assert_eq!(status, 0, "{text}");
    assert!(text.contains("ego.braking = 4"), "{text}");
}

#[test]
fn help_has_an_example_and_the_list_has_every_check() {
    let (status, help) = conformance(&["--help"]);
    assert_eq!(status, 0);
    assert!(
        help.contains("cede-conformance --policy driver.cede --contract contract.toml"),
        "{help}"
    );
    let (_, list) = conformance(&["--list"]);
    assert!(
        cede_testing::checks()
            .iter()
            .all(|(id, _)| list.contains(id))
    );
}
