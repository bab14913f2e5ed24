//! The command line as a whole: help, configuration files, completions, manual pages, `--json` and `--quiet`.

use assert_cmd::assert::Assert;
use serde_json::Value;
use std::path::Path;

fn cede_in(folder: &Path, arguments: &str) -> Assert {
    let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_cede"));
    command
        .current_dir(folder)
        .args(arguments.split_whitespace());
    command.assert()
}

fn stdout(assert: &Assert) -> String {
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

/// Standard error without the wrapping of lines.
fn stderr(assert: &Assert) -> String {
    let text = String::from_utf8(assert.get_output().stderr.clone()).unwrap();
    let words = text.split_whitespace().filter(|word| *word != "│");
    words.collect::<Vec<_>>().join(" ")
}

#[test]
fn the_help_is_grouped_by_reader() {
    let help = stdout(&cede_in(Path::new("."), "help").success());
    let mut rest = help.as_str();
    for part in [
        "Firmware:",
        "  export ",
        "Safety:",
        "  verify lemmas ",
        "Research:",
        "  train ",
        "Simulation:",
        "  replay ",
    ] {
        let place = rest.find(part).unwrap_or_else(|| panic!("{part}: {help}"));
        rest = &rest[place..];
    }
}

#[test]
fn options_of_a_file_are_those_of_the_command_line_which_wins() {
    let folder = tempfile::tempdir().unwrap();
    let cede = |arguments: &str| cede_in(folder.path(), arguments);
    let file = "data = \"synthetic\"\nencounters = 2_0\ndriver = [\"idm\", \"replay\"]\nsplit = [\"all\"]\njson = true\n";
    std::fs::write(folder.path().join("run.toml"), file).unwrap();
    let long = "evaluate --data synthetic --encounters 20 --split all --json --driver";
    let by_options = stdout(&cede(&format!("{long} idm,replay")).success());
    assert_eq!(
        stdout(&cede("evaluate --config run.toml").success()),
        by_options
    );
    let by_options = stdout(&cede(&format!("{long} nearer-first")).success());
    let won = cede("evaluate --driver nearer-first --config run.toml").success();
    assert_eq!(stdout(&won), by_options);
    let help = stdout(&cede("evaluate --help").success());
    assert!(help.contains("--data <DIR|synthetic>"), "{help}");
}

#[test]
fn what_is_wrong_in_a_file_is_named_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    for (command, line, said) in [
        (
            "evaluate",
            "drivr = \"idm\"",
            "bad.toml:2: `cede evaluate` has no option `drivr`; it has data, site,",
        ),
        (
            "reproduce",
            "driver = \"idm\"",
            "bad.toml:2: `cede reproduce` has no option `driver`",
        ),
        (
            "evaluate",
            "config = \"x\"",
            "bad.toml:2: `cede evaluate` has no option `config`",
        ),
        (
            "evaluate",
            "driver = \"fast\"",
            "bad.toml:2: invalid value 'fast' for '--driver",
        ),
        (
            "reproduce",
            "seeds = 0",
            "bad.toml:2: invalid value '0' for '--seeds",
        ),
        (
            "evaluate",
            "json = \"yes\"",
            "bad.toml:2: `json` has to be true or false",
        ),
        (
            "evaluate",
            "driver = { a = 1 }",
            "bad.toml:2: `driver` has to be a string, a number, or an array",
        ),
        (
            "evaluate",
            "driver = ",
            "cannot use bad.toml: TOML parse error at line 2",
        ),
    ] {
        let text = format!("data = \"synthetic\"\n{line}\n");
        std::fs::write(folder.path().join("bad.toml"), text).unwrap();
        let failed = cede_in(folder.path(), &format!("{command} --config bad.toml")).code(3);
        assert!(
            stderr(&failed).contains(said),
            "{line}: {}",
            stderr(&failed)
        );
    }
    let failed = cede_in(folder.path(), "evaluate --config nowhere.toml").code(3);
    assert!(stderr(&failed).contains("cannot read nowhere.toml: No such file"));
    std::fs::write(folder.path().join("bad.toml"), "driver = \"idm\"\n").unwrap();
    let failed = cede_in(folder.path(), "evaluate --config bad.toml").code(2);
    assert!(
        stderr(&failed).contains("--data <DIR|synthetic>"),
        "{}",
        stderr(&failed)
    );
}

#[test]
fn shells_complete_and_every_command_has_a_page() {
    let folder = tempfile::tempdir().unwrap();
    for (shell, said) in [
        ("bash", "complete -F _cede"),
        ("zsh", "#compdef cede"),
        ("fish", "complete -c cede"),
    ] {
        let script = stdout(&cede_in(folder.path(), &format!("completions {shell}")).success());
        assert!(
            script.contains(said) && script.contains("leave-one-file-out"),
            "{shell}"
        );
    }
    cede_in(folder.path(), "completions dos").code(2);
    cede_in(folder.path(), "man --out man1").success();
    for (page, said) in [
        ("cede", "cede\\-evaluate"),
        ("cede-evaluate", "\\-\\-config"),
        ("cede-verify-lemmas", "\\-\\-solver"),
    ] {
        let text = std::fs::read_to_string(folder.path().join(format!("man1/{page}.1"))).unwrap();
        assert!(text.contains(said), "{page}: {text}");
    }
}

#[test]
fn quiet_leaves_the_result_alone() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        "evaluate --data synthetic --encounters 20 --split all --driver replay --threads 999999",
        "data inspect --data synthetic --encounters 20",
        "verify margins --boxes 100",
    ] {
        let spoken = cede_in(folder.path(), arguments);
        let quiet = cede_in(folder.path(), &format!("{arguments} --quiet"));
        assert_eq!(stdout(&quiet), stdout(&spoken));
        assert!(stderr(&quiet).len() < stderr(&spoken).len(), "{arguments}");
        let code = quiet.get_output().status.code();
        assert_eq!(code, spoken.get_output().status.code());
        assert!(
            stderr(&quiet).is_empty() || code == Some(1),
            "{}",
            stderr(&quiet)
        );
    }
}

#[test]
fn json_is_one_value_on_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    let json = |arguments: &str| -> Value {
        let assert = cede_in(folder.path(), &format!("{arguments} --json"));
        serde_json::from_str(&stdout(&assert))
            .unwrap_or_else(|error| panic!("{arguments}: {error}"))
    };
    let made = json("data synthesize --out made --encounters 40");
    let site = made["sites"][0]["site"].as_str().unwrap();
    let site = format!("--site made/{site}.toml");
    assert!(json(&format!("data extract --data made {site}"))[0]["encounters"].is_u64());
    assert!(json(&format!("data inspect --data made {site}"))["encounters"].is_u64());
    let recording = format!(
        "made/{}/vehicle_tracks_000.csv",
        made["sites"][0]["site"].as_str().unwrap()
    );
    let replayed = json(&format!(
        "replay {recording} {site} --driver replay,cede --shield both"
    ));
    assert_eq!(replayed["rows"].as_array().unwrap().len(), 4);
    let shield = json(&format!(
        "verify shield --data made {site} --contract worst-case"
    ));
    assert_eq!(shield["rows"][0]["contract"], "as given");
    let campaign = json("verify campaign --scenarios 1");
    assert_eq!(campaign["setups"].as_array().unwrap().len(), 15);
}

#[test]
fn the_shares_of_a_campaign_add_up_to_the_whole() {
    let setups = |options: &str| {
        let run = cede_in(
            Path::new("."),
            &format!("verify campaign --scenarios 10 --seed 5 {options} --json"),
        );
        let printed: Value = serde_json::from_str(&stdout(&run.success())).unwrap();
        printed["setups"].as_array().unwrap().clone()
    };
    let counts = |setup: &Value| {
        let counts = setup
            .as_object()
            .unwrap()
            .values()
            .filter_map(Value::as_u64);
        counts.collect::<Vec<_>>()
    };
    let shares: Vec<_> = (1..=3)
        .map(|share| setups(&format!("--shard {share}/3")))
        .collect();
    for (place, setup) in setups("").iter().enumerate() {
        let sums = shares.iter().map(|share| counts(&share[place]));
        let sums = sums.reduce(|a, b| a.iter().zip(b).map(|(a, b)| a + b).collect());
        assert_eq!(Some(counts(setup)), sums, "{setup}");
    }
}

#[test]
fn reproduce_says_how_far_it_is_without_a_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = "reproduce --data synthetic --encounters 24 --rows bc --seeds 2 --set bc.updates=20 --set bc.width=16";
    let spoken = cede_in(folder.path(), arguments).success();
    let told = stderr(&spoken);
    for said in ["1 of 2 trainings: bc-", "2 of 2 trainings: bc-"] {
        assert!(told.contains(said), "{told}");
    }
    let quiet = cede_in(folder.path(), &format!("{arguments} --quiet")).success();
    assert_eq!(stderr(&quiet), "");
    assert_eq!(stdout(&quiet), stdout(&spoken));
}
