//! `cede data` and `cede replay`: what they print, what they write, how they fail.

use assert_cmd::Command;
use std::path::Path;

fn cede(folder: &Path, arguments: &[&str]) -> assert_cmd::assert::Assert {
    let mut command = Command::cargo_bin("cede").unwrap();
    command.current_dir(folder).args(arguments).assert()
}

/// A left-turner from the south and an oncoming vehicle that goes first, as a generic CSV.
fn tracks() -> String {
    tracks_from(30.0)
}

/// The same, but the oncoming vehicle comes from `start` m north of the origin.
fn tracks_from(start: f64) -> String {
    let mut csv = String::from("track,t,x,y\n");
    for step in 0..150 {
        let t = f64::from(step) * 0.1;
        csv += &format!("2,{t:.1},-2,{:.3}\n", start - 8.0 * t);
        let way = 5.03 * t - 40.0;
        let (x, y) = if way < 0.0 {
            (2.0, way - 4.0)
        } else {
            (2.0 - way, -4.0 + 0.01 * way)
        };
        csv += &format!("1,{t:.1},{x:.3},{y:.3}\n");
    }
    csv
}

#[test]
fn the_encounters_of_a_generic_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("tracks_3.csv"), tracks()).unwrap();
    let found = cede(
        folder.path(),
        &[
            "data",
            "extract",
            "--data",
            ".",
            "--site",
            "X",
            "--out",
            "pairs.csv",
        ],
    );
    let counts = String::from_utf8(found.success().get_output().stdout.clone()).unwrap();
    assert_eq!(counts, "file 003     1 pairs\ntotal        1 pairs\n");
    let pairs = std::fs::read_to_string(folder.path().join("pairs.csv")).unwrap();
    let (header, row) = pairs.split_once('\n').unwrap();
    assert!(header.starts_with(
        "Scenario,File_id,StartTime_ms,EndTime_ms,Ego_agent_id,Reactive_agent_id,Agent_with_right_of_way,"
    ));
    // The other is 5 m from (−2, −4) after 3.7 s, the left-turner another 3.7 s later.
    let expected =
        "X,003,0,3700,1,2,2,2,37,3.7,crossing,left,straight,unknown,unknown,unknown,-2.000,";
    assert!(row.starts_with(expected), "{row}");
    let replay = [
        "replay",
        "tracks_3.csv",
        "--site",
        "X",
        "--out",
        "page.html",
    ];
    let shown = cede(folder.path(), &replay).success();
    let shown = String::from_utf8(shown.get_output().stdout.clone()).unwrap();
    assert!(
        shown.starts_with("Left-turner 1, other 2: other first"),
        "{shown}"
    );
    assert!(folder.path().join("page.html").is_file());
}

#[test]
fn a_replay_says_why_the_shield_acted() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("tracks_3.csv"), tracks_from(55.0)).unwrap();
    let replay = ["replay", "tracks_3.csv", "--site", "X", "--shield", "on"];
    let driven = [&replay[..], &["--driver", "initial-speed"]].concat();
    let shown = cede(folder.path(), &driven).success();
    let shown = String::from_utf8(shown.get_output().stdout.clone()).unwrap();
    let acted = shown.split("where the shield acted:").nth(1);
    assert!(
        acted.is_some_and(|lines| lines.contains("left-turner  shielded: ")),
        "{shown}"
    );
}

#[test]
fn numbers_and_a_drawing_of_synthetic_encounters() {
    let folder = tempfile::tempdir().unwrap();
    let inspect = [
        "data",
        "inspect",
        "--data",
        "synthetic",
        "--encounters",
        "50",
        "--json",
    ];
    let numbers = cede(folder.path(), &inspect).success();
    let numbers: serde_json::Value = serde_json::from_slice(&numbers.get_output().stdout).unwrap();
    assert!(numbers["encounters"].as_u64().unwrap() >= 50);
    let drawing = std::fs::read_to_string(folder.path().join("out/scene.svg")).unwrap();
    assert!(drawing.starts_with("<svg") && drawing.contains("<circle"));
}

#[test]
fn orientations_in_numbers_and_as_a_figure() {
    let folder = tempfile::tempdir().unwrap();
    let svo = [
        "data",
        "svo",
        "--data",
        "synthetic",
        "--encounters",
        "60",
        "--draw",
        "svo.svg",
    ];
    let text = cede(folder.path(), &svo).success();
    let text = String::from_utf8(text.get_output().stdout.clone()).unwrap();
    for said in [
        "who went first",
        "area under the curve",
        "with its orientation, as estimated",
    ] {
        assert!(text.contains(said), "{text}");
    }
    let figure = std::fs::read_to_string(folder.path().join("svo.svg")).unwrap();
    assert!(figure.starts_with("<svg") && figure.contains("class=\"bar\""));
    let json = cede(folder.path(), &[&svo[..], &["--json"]].concat()).success();
    let studies: serde_json::Value = serde_json::from_slice(&json.get_output().stdout).unwrap();
    let study = &studies[0];
    assert!(study["encounters"].as_u64().unwrap() >= 60);
    let area = study["first"][0]["svo"].as_f64().unwrap();
    assert!(
        (0.9..=1.0).contains(&area),
        "0.5 s before the conflict: {area}"
    );
    assert!(study["acceleration"]["estimated"].as_f64().unwrap() > 0.0);
}

#[test]
fn bad_input_ends_with_code_3_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let broken = tracks().replacen("2,0.5,-2", "2,0.5,west", 1);
    std::fs::write(folder.path().join("tracks.csv"), broken).unwrap();
    let extract = ["data", "extract", "--data", ".", "--out", "pairs.csv"];
    let failed = cede(folder.path(), &extract).code(3);
    let message = String::from_utf8(failed.get_output().stderr.clone()).unwrap();
    assert!(
        message.contains("tracks.csv:12: column `x`: `west` is not a number"),
        "{message}"
    );
    assert!(
        message.contains("write a plain decimal number"),
        "{message}"
    );
    assert!(!folder.path().join("pairs.csv").exists());
    let named = ["replay", "tracks.csv", "--pair", "one"];
    cede(folder.path(), &named).code(2);
}

#[test]
fn a_new_site_is_drafted_from_its_tracks() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let made = ["data", "synthesize", "--out", "made", "--encounters", "600"];
    cede(folder, &made).success();
    for (site, arms) in [("SYN-T-AWS-17", 3), ("SYN-X-AWS-3", 4)] {
        let data = format!("made/{site}");
        let out = format!("{site}.toml");
        let draft = ["data", "new-site", "--data", &data, "--out", &out];
        let told = cede(folder, &draft).success();
        let told = String::from_utf8(told.get_output().stdout.clone()).unwrap();
        assert!(told.contains("encounters: "), "{told}");
        let text = std::fs::read_to_string(folder.join(&out)).unwrap();
        assert_eq!(text.matches("[[arm]]").count(), arms, "{text}");
        assert!(text.contains("manoeuvre = \"left\""), "{text}");
        let extract = ["data", "extract", "--data", &data, "--site", &out];
        let counted = cede(folder, &extract).success();
        let counted = String::from_utf8(counted.get_output().stdout.clone()).unwrap();
        let total = counted.split_whitespace().rev().nth(1).unwrap();
        assert!(
            told.contains(&format!("encounters: {total} by the draft")),
            "{told}{counted}"
        );
        // A description that somebody has corrected is not overwritten.
        cede(folder, &draft).code(3);
    }
}

fn stderr(assert: &assert_cmd::assert::Assert) -> String {
    String::from_utf8(assert.get_output().stderr.clone()).unwrap()
}

#[test]
fn recordings_of_two_runs_are_never_mixed() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let many = "data synthesize --out made --encounters 60";
    let few = "data synthesize --out made --encounters 20 --seed 3";
    let run = |command: &str| cede(folder, &command.split(' ').collect::<Vec<_>>());
    run(many).success();
    let refused = run(few).code(3);
    assert!(
        stderr(&refused).contains("made is not empty"),
        "{}",
        stderr(&refused)
    );
    assert!(stderr(&refused).contains("--overwrite"));
    run(&format!("{few} --overwrite")).success();
    run(&few.replace("made", "alone")).success();
    let files = |name: &str| {
        let mut files: Vec<_> = walk(&folder.join(name));
        files.sort();
        files
    };
    assert_eq!(files("made"), files("alone"));
}

/// Paths and contents of the files below `folder`.
fn walk(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() {
            let inner = walk(&path).into_iter();
            files.extend(inner.map(|(path, text)| (format!("{name}/{path}"), text)));
        } else {
            files.push((name, std::fs::read(&path).unwrap()));
        }
    }
    files
}

#[test]
fn all_sites_are_judged_but_those_without_encounters() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let run = |command: &str| cede(folder, &command.split(' ').collect::<Vec<_>>());
    run("data synthesize --out made --encounters 20 --seed 3").success();
    let all = "evaluate --data made --site all --driver cede --split all";
    let judged = run(all).success();
    assert_eq!(
        stderr(&judged),
        "left out: site SYN-X-AWS-1 has no encounters\n"
    );
    let table = String::from_utf8(judged.get_output().stdout.clone()).unwrap();
    assert!(
        table.starts_with("SYN-T-AWS-0, all: 16 encounters"),
        "{table}"
    );
    assert!(
        table.contains("\nSYN-T-TWS-2, all: 9 encounters"),
        "{table}"
    );
    let none = run(&all.replace("--split all", "--split test")).code(3);
    assert!(
        stderr(&none).contains("no encounters in these splits"),
        "{}",
        stderr(&none)
    );
    let named = run("evaluate --data made --site SYN-X-AWS-1 --driver cede").code(3);
    assert!(stderr(&named).contains("no encounters in the recordings of site SYN-X-AWS-1"));
    for site in ["SYN-T-AWS-0", "SYN-T-TWS-2"] {
        std::fs::remove_dir_all(folder.join("made").join(site)).unwrap();
    }
    let none = run(all).code(3);
    assert!(
        stderr(&none).contains("no encounters at any site in made"),
        "{}",
        stderr(&none)
    );
}

#[test]
fn a_site_without_a_description_is_told() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("tracks_3.csv"), tracks()).unwrap();
    let inspect = ["data", "inspect", "--data", ".", "--site", "X"];
    let told = cede(folder.path(), &inspect).success();
    assert!(
        stderr(&told).contains("site X: no description (no X.toml beside"),
        "{}",
        stderr(&told)
    );
}

#[test]
fn who_does_not_turn_left_is_no_left_turner() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let run = |command: &str| cede(folder, &command.split(' ').collect::<Vec<_>>());
    run("data synthesize --out made --encounters 20").success();
    let replay = "replay made/SYN-X-AWS-1/vehicle_tracks_001.csv --site SYN-X-AWS-1 --driver cede --shield on";
    let shown = run(replay).success();
    let shown = String::from_utf8(shown.get_output().stdout.clone()).unwrap();
    assert!(
        shown.starts_with("Vehicle 11, other 12: vehicle 11 first"),
        "{shown}"
    );
    assert!(!shown.contains("left-turner"), "{shown}");
    let page = std::fs::read_to_string(folder.join("out/replay.html")).unwrap();
    assert!(page.contains("\"called\":[\"vehicle 11\",\"other\"]"));
    assert!(
        page.contains("crossing, vehicle 11 first") || page.contains("merging, vehicle 11 first")
    );
}
