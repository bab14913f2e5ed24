//! `cede evaluate` from the outside: what it prints and with which exit code it ends.

use assert_cmd::Command;
use serde_json::Value;
use std::path::Path;

fn cede(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cede"));
    command.args(arguments);
    command
}

/// `cede evaluate` on a few synthetic encounters.
fn evaluate(arguments: &[&str]) -> Command {
    let mut command = cede(&["evaluate", "--data", "synthetic", "--encounters", "60"]);
    command.args(arguments);
    command
}

fn stdout(command: &mut Command) -> String {
    let output = command.assert().success().get_output().stdout.clone();
    String::from_utf8(output).unwrap()
}

fn stderr(command: &mut Command, code: i32) -> String {
    let output = command.assert().code(code).get_output().stderr.clone();
    String::from_utf8(output).unwrap()
}

#[test]
fn json_is_one_object_with_the_rows() {
    let text = stdout(&mut evaluate(&[
        "--driver",
        "replay,idm",
        "--split",
        "all",
        "--json",
    ]));
    let object: Value = serde_json::from_str(&text).unwrap();
    let rows = object["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    for (row, driver) in rows.iter().zip(["replay", "idm"]) {
        assert_eq!(row["driver"], driver);
        assert_eq!(row["split"], "all");
        assert_eq!(row["mode"], "joint");
        assert_eq!(row["until"], "conflict");
        assert_eq!(row["shield"], "off");
        assert!(row["n"].as_u64().unwrap() >= 60);
        for share in ["priority_accuracy", "episode_length_error"] {
            assert!((0.0..=1.0).contains(&row[share].as_f64().unwrap()));
            assert_eq!(
                row[format!("{share}_interval")].as_array().unwrap().len(),
                2
            );
        }
        for count in ["collisions", "time_outs"] {
            assert!(row[count].is_u64());
        }
    }
}

#[test]
fn threads_change_nothing_but_time() {
    let arguments = |threads| ["--split", "all", "--until", "cleared", "--threads", threads];
    let one = stdout(&mut evaluate(&arguments("1")));
    assert_eq!(one, stdout(&mut evaluate(&arguments("3"))));
    assert!(one.contains("| logistic"));
}

#[test]
fn ego_mode_judges_both_roles() {
    let arguments = [
        "--driver", "idm", "--split", "all", "--mode", "ego", "--json",
    ];
    let object: Value = serde_json::from_str(&stdout(&mut evaluate(&arguments))).unwrap();
    let row = &object["rows"][0];
    let n = row["n"].as_u64().unwrap();
    assert_eq!(Some(n), row["encounters"].as_u64().map(|n| 2 * n));
}

#[test]
fn a_line_an_episode_as_csv_and_as_parquet() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str| {
        let path = folder.path().join(name);
        let file = path.to_str().unwrap();
        let arguments = ["--driver", "idm", "--split", "all", "--episodes", file];
        evaluate(&arguments).assert().success();
        path
    };
    let csv = std::fs::read_to_string(write("episodes.csv")).unwrap();
    let header = csv.lines().next().unwrap();
    assert!(header.starts_with("driver,split,mode,until,shield,site,file,left_track,other_track"));
    assert!(csv.lines().count() > 60);
    let parquet = std::fs::read(write("episodes.parquet")).unwrap();
    assert!(parquet.starts_with(b"PAR1") && parquet.ends_with(b"PAR1"));
    assert_eq!(
        rows(&folder.path().join("episodes.parquet")),
        csv.lines().count() - 1
    );
}

fn rows(parquet: &Path) -> usize {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    let file = std::fs::File::open(parquet).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    reader.get_row_iter(None).unwrap().count()
}

/// The folder of two synthetic sites, and their names.
fn two_sites(folder: &Path) -> Vec<String> {
    let out = folder.to_str().unwrap();
    let synthesize = ["data", "synthesize", "--encounters", "150", "--out", out];
    cede(&synthesize).assert().success();
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            names.push(path.file_name().unwrap().to_str().unwrap().to_owned());
        }
    }
    // The crossings first: not every small site has encounters.
    names.sort_by_key(|name| (!name.contains("-X-"), name.clone()));
    for name in names.split_off(2) {
        std::fs::remove_dir_all(folder.join(name)).unwrap();
    }
    names
}

#[test]
fn several_sites_are_judged_one_after_the_other() {
    let folder = tempfile::tempdir().unwrap();
    let names = two_sites(folder.path());
    let data = folder.path().to_str().unwrap();
    let judge = |sites: &str| {
        let arguments = ["--driver", "nearer-first", "--split", "all", "--json"];
        let mut command = cede(&["evaluate", "--data", data, "--site", sites]);
        let object: Value = serde_json::from_str(&stdout(command.args(arguments))).unwrap();
        object
    };
    let both = judge(&names.join(","));
    assert_eq!(both["site"], names.join(",").as_str());
    let rows = both["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    for (row, name) in rows.iter().zip(&names) {
        assert_eq!(row["site"], name.as_str());
        assert_eq!(row, &judge(name)["rows"][0]);
    }
    // Each site once, and all folders of recordings.
    let [first, second] = names.as_slice() else {
        unreachable!()
    };
    assert_eq!(
        judge(&format!("{first},{second},{first}"))["rows"],
        both["rows"]
    );
    assert_eq!(judge("all"), both);
    let mut missing = cede(&["evaluate", "--data", data, "--site", "Nowhere"]);
    assert!(stderr(&mut missing, 3).contains("no recorded tracks of site Nowhere"));
    let report = [
        "evaluate",
        "--data",
        data,
        "--site",
        "all",
        "--report",
        "page.html",
    ];
    assert!(stderr(&mut cede(&report), 2).contains("a report shows one site"));
    let inspect = ["data", "inspect", "--data", data, "--site", "all"];
    assert!(stderr(&mut cede(&inspect), 2).contains("one site"));
}

#[test]
fn seven_folds_judge_each_encounter_once() {
    let folds = [
        "--driver",
        "logistic",
        "--split",
        "seven-fold,all",
        "--json",
    ];
    let object: Value = serde_json::from_str(&stdout(&mut evaluate(&folds))).unwrap();
    assert_eq!(object["rows"][0]["split"], "seven-fold");
    assert_eq!(object["rows"][0]["n"], object["rows"][1]["n"]);
}

#[test]
fn usage_errors_name_what_there_is() {
    let message = stderr(&mut evaluate(&["--driver", "fast"]), 2);
    assert!(message.contains("no driver is called `fast`"), "{message}");
    assert!(message.contains("nearer-first"), "{message}");
    let message = stderr(&mut evaluate(&["--split", "half"]), 2);
    assert!(message.contains("leave-one-file-out"), "{message}");
    let message = stderr(&mut evaluate(&["--episodes", "out.txt"]), 2);
    assert!(message.contains(".parquet"), "{message}");
    stderr(&mut cede(&["evaluate"]), 2);
}

#[test]
fn bad_input_ends_with_code_3_and_the_mend() {
    let folder = tempfile::tempdir().unwrap();
    let empty = folder.path().to_str().unwrap();
    let message = stderr(&mut cede(&["evaluate", "--data", empty]), 3);
    assert!(
        message.contains("no recorded tracks of site EP0"),
        "{message}"
    );
    let unwritable = folder.path().join("a-file").join("episodes.csv");
    std::fs::write(folder.path().join("a-file"), "").unwrap();
    let file = unwritable.to_str().unwrap();
    let message = stderr(
        &mut evaluate(&["--driver", "replay", "--episodes", file]),
        3,
    );
    assert!(message.contains("cannot write"), "{message}");
}

#[test]
fn each_orientation_has_its_row_and_the_middle_one_is_the_policy_as_it_learned() {
    let rows = |arguments: &[&str]| -> Vec<Value> {
        let common = [
            "--driver", "cede", "--split", "all", "--until", "cleared", "--mode", "ego", "--json",
        ];
        let text = stdout(&mut evaluate(&[&common[..], arguments].concat()));
        let object: Value = serde_json::from_str(&text).unwrap();
        object["rows"].as_array().unwrap().clone()
    };
    let dial = rows(&["--svo", "15,45,75", "--partner", "cede"]);
    let names = dial.iter().map(|row| row["driver"].as_str().unwrap());
    assert!(names.eq(["cede 15°", "cede 45°", "cede 75°"]));
    let first = |row: &Value| row["went_first"].as_f64().unwrap();
    assert!(first(&dial[0]) > first(&dial[1]) && first(&dial[1]) > first(&dial[2]));
    assert!(dial[0]["delay_s"].as_f64() < dial[2]["delay_s"].as_f64());
    let mut plain = rows(&["--partner", "cede"]).remove(0);
    plain["driver"] = dial[1]["driver"].clone();
    assert_eq!(plain, dial[1]);
}

#[test]
fn in_traffic_a_share_of_the_vehicles_of_recordings_is_driven() {
    let folder = tempfile::tempdir().unwrap();
    let made = folder.path().join("made");
    let made = made.to_str().unwrap();
    stdout(&mut cede(&[
        "data",
        "synthesize",
        "--out",
        made,
        "--encounters",
        "20",
    ]));
    let site = format!("{made}/SYN-T-AWS-0.toml");
    let traffic = |arguments: &[&str]| {
        let mut command = cede(&["evaluate", "--data", made, "--mode", "traffic"]);
        command.args(["--site", &site]).args(arguments);
        command
    };
    let text = stdout(&mut traffic(&["--share", "0,1", "--json"]));
    let object: Value = serde_json::from_str(&text).unwrap();
    let rows = object["rows"].as_array().unwrap();
    let drivers: Vec<_> = rows.iter().map(|row| row["driver"].as_str()).collect();
    assert_eq!(drivers, [Some("profile"), Some("profile"), Some("cede")]);
    assert_eq!(
        (&rows[0]["driven"], &rows[0]["delay_s"]),
        (&0.into(), &Value::Null)
    );
    for row in &rows[1..] {
        assert!(row["driven"].as_u64() > Some(0), "{row}");
        assert!(row["no_plan_share"].as_f64().is_some(), "{row}");
    }
    let table = stdout(&mut traffic(&["--share", "1"]));
    assert!(
        table.contains("| cede") && table.contains("100 %"),
        "{table}"
    );
    assert!(stderr(&mut traffic(&["--split", "all"]), 2).contains("--split has no effect"));
    assert!(stderr(&mut traffic(&["--share", "1.5"]), 2).contains("not a share"));
    assert!(stderr(&mut evaluate(&["--mode", "traffic"]), 2).contains("needs recordings"));
    assert!(stderr(&mut evaluate(&["--share", "1"]), 2).contains("--mode traffic"));
}
