//! What a new user meets first: odd numbers, options that contradict each other, help, and Ctrl-C.

use assert_cmd::assert::Assert;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

fn cede_in(folder: &Path, arguments: &str) -> Assert {
    let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_cede"));
    command.current_dir(folder).args(arguments.split(' '));
    command.assert()
}

fn cede(arguments: &str) -> Assert {
    let folder = tempfile::tempdir().unwrap();
    cede_in(folder.path(), arguments)
}

fn stdout(assert: &Assert) -> String {
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

fn stderr(assert: &Assert) -> String {
    String::from_utf8(assert.get_output().stderr.clone()).unwrap()
}

const FEW: &str = "--data synthetic --encounters 20 --split all";

#[test]
fn threads_are_capped_with_a_word_and_zero_means_all_cores() {
    let told = cede(&format!("evaluate {FEW} --driver replay --threads 999999")).success();
    assert!(
        stderr(&told).contains("--threads 999999: ")
            && stderr(&told).contains(" are used, 4 per core"),
        "{}",
        stderr(&told)
    );
    let zero = cede(&format!("evaluate {FEW} --driver replay --threads 0")).success();
    assert_eq!(stderr(&zero), "");
    assert_eq!(stdout(&zero), stdout(&told));
}

#[test]
fn options_that_would_be_ignored_are_refused() {
    for (arguments, said) in [
        (
            "evaluate --data synthetic --driver idm --weights p.cede",
            "--weights has no effect with --driver idm",
        ),
        (
            "evaluate --data synthetic --partner idm",
            "--partner has no effect with --mode joint",
        ),
        (
            "evaluate --data synthetic --contract all-way-stop",
            "--contract has no effect with --shield off",
        ),
        (
            "evaluate --data synthetic --site MA",
            "--site has no effect with --data synthetic",
        ),
        (
            "evaluate --data . --encounters 5",
            "--encounters has no effect with the recordings in .",
        ),
        (
            "data inspect --data . --seed 5",
            "--seed has no effect with the recordings in .",
        ),
        (
            "data extract --data . --seed 5",
            "--seed has no effect with the recordings in .",
        ),
        (
            "replay tracks.csv --contract worst-case",
            "--contract has no effect with --shield off",
        ),
        (
            "replay tracks.csv --weights p.cede",
            "--weights has no effect with --driver replay",
        ),
        (
            "train bc --data . --data-seed 5 --out p.cede",
            "--data-seed has no effect with the recordings in .",
        ),
        (
            "train bc --data synthetic --every-pair --out p.cede",
            "--every-pair has no effect with bc",
        ),
        (
            "train sac --data synthetic --claims c.toml --out p.cede",
            "--claims has no effect with sac",
        ),
        (
            "reproduce --data synthetic --transfer MA",
            "--transfer has no effect with --data synthetic",
        ),
        (
            "reproduce --data synthetic --rows bc --set apg.width=64",
            "--set apg.width=64 has no effect with --rows bc",
        ),
    ] {
        let failed = cede(arguments).code(2);
        assert!(
            stderr(&failed).contains(said),
            "{arguments}: {}",
            stderr(&failed)
        );
    }
}

#[test]
fn nothing_to_do_is_a_failure() {
    for arguments in [
        "verify campaign --steps 0",
        "verify margins --boxes 0",
        "evaluate --data synthetic --encounters 0",
        "data synthesize --out made --encounters 0",
    ] {
        cede(arguments).code(2);
    }
    let failed = cede("evaluate --data synthetic --encounters 20 --split test").code(3);
    assert!(
        stderr(&failed).contains("no encounters of synthetic in `test`"),
        "{}",
        stderr(&failed)
    );
}

#[test]
fn recordings_in_which_nobody_meets_are_a_failure() {
    let folder = tempfile::tempdir().unwrap();
    let mut alone = String::from("track,t,x,y\n");
    for step in 0..50 {
        let t = f64::from(step) * 0.1;
        alone += &format!("1,{t:.1},-2,{:.3}\n", 30.0 - 8.0 * t);
    }
    std::fs::write(folder.path().join("tracks_1.csv"), alone).unwrap();
    for command in [
        "evaluate",
        "data extract --out pairs.csv",
        "data inspect",
        "verify shield",
        "train bc --out p.cede",
        "reproduce",
    ] {
        let failed = cede_in(folder.path(), &format!("{command} --data . --site X")).code(3);
        assert!(
            stderr(&failed).contains("no encounters in the "),
            "{command}: {}",
            stderr(&failed)
        );
    }
    assert!(!folder.path().join("pairs.csv").exists());
    // Its drawing shows why.
    assert!(folder.path().join("out/scene.svg").exists());
}

#[test]
fn show_settings_works_alone() {
    let shown = cede("train apg --show-settings").success();
    assert!(stdout(&shown).contains("width = "), "{}", stdout(&shown));
    let set = cede("train apg --set width=16 --show-settings").success();
    assert!(stdout(&set).contains("width = 16\n"), "{}", stdout(&set));
    let order = "train apg --data synthetic --out p.cede --show-settings";
    assert_eq!(stdout(&cede(order).success()), stdout(&shown));
    let failed = cede("train apg").code(2);
    let told = stderr(&failed);
    assert!(told.contains("--data") && told.contains("--out"), "{told}");
    cede("train apg --data synthetic").code(2);
}

#[test]
fn help_says_which_graphs_are_understood_and_what_exit_codes_mean() {
    let help = stdout(&cede("help import").success());
    for word in [
        "Gemm",
        "Relu",
        "Clip",
        "Dropout",
        "scene 19",
        "cede.features",
        "cede.perspective",
        "possible values: raw, route, traffic, scene",
    ] {
        assert!(help.contains(word), "{word}: {help}");
    }
    for command in [
        "all", "policy", "reach", "margins", "lemmas", "check", "shield", "campaign",
    ] {
        let help = stdout(&cede(&format!("help verify {command}")).success());
        assert!(help.contains("Exit code"), "{command}: {help}");
    }
}

#[test]
fn a_driver_or_split_named_twice_is_judged_once() {
    let once = stdout(&cede(&format!("evaluate {FEW} --driver idm,replay")).success());
    let twice = format!("evaluate {FEW},all --driver idm,replay,idm");
    assert_eq!(stdout(&cede(&twice).success()), once);
    cede(&format!("evaluate {FEW} --driver idm,all")).success();
}

#[test]
fn a_drawing_is_svg_or_refused() {
    let failed = cede("data inspect --data synthetic --encounters 20 --draw x.png").code(2);
    assert!(
        stderr(&failed).contains("has to end in .svg"),
        "{}",
        stderr(&failed)
    );
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_is_no_panic() {
    for arguments in [
        "help",
        "train apg --show-settings",
        "evaluate --data synthetic --encounters 20 --split all --driver replay --threads 999999",
        "verify margins --boxes 10",
        "verify shield --data nowhere",
    ] {
        let mut child = start(Path::new("."), arguments, Stdio::piped);
        // Closed before anything is printed, as `2>&1 | head -0` would.
        drop((child.stdout.take(), child.stderr.take()));
        let code = child.wait().unwrap().code();
        // 101: Rust's own exit code of a panic.
        assert!(matches!(code, Some(0..=3)), "{arguments}: {code:?}");
    }
}

#[cfg(unix)]
fn start(folder: &Path, arguments: &str, output: fn() -> Stdio) -> Child {
    Command::new(env!("CARGO_BIN_EXE_cede"))
        .args(arguments.split(' '))
        .current_dir(folder)
        .stdout(output())
        .stderr(output())
        .spawn()
        .unwrap()
}

/// Sends `signal` to `child` after a while; gives its exit code, and how long that took. `None` if it has ended by
/// itself before.
#[cfg(unix)]
fn end(child: &mut Child, signal: &str) -> Option<(Option<i32>, Duration)> {
    std::thread::sleep(Duration::from_millis(300));
    if child.try_wait().unwrap().is_some() {
        return None;
    }
    let sent = Command::new("kill")
        .args([signal, &child.id().to_string()])
        .status();
    assert!(sent.unwrap().success());
    let begun = Instant::now();
    let code = child.wait().unwrap().code();
    Some((code, begun.elapsed()))
}

#[cfg(unix)]
#[test]
fn a_signal_ends_every_command_within_a_second_and_leaves_nothing_half_written() {
    let recordings = tempfile::tempdir().unwrap();
    let made = "data synthesize --out made --encounters 3000";
    cede_in(recordings.path(), made).success();
    let description = std::fs::read_dir(recordings.path().join("made"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .find(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .unwrap();
    let recorded = format!("--data made --site {}", description.display());
    for arguments in [
        "evaluate --data synthetic --encounters 100000 --report report.html".to_owned(),
        "data extract --data synthetic --encounters 100000 --out pairs.csv".to_owned(),
        "data inspect --data synthetic --encounters 100000".to_owned(),
        "data synthesize --out more --encounters 100000".to_owned(),
        "demo".to_owned(),
        "train apg --data synthetic --encounters 1000 --out p.cede".to_owned(),
        "train sac --data synthetic --encounters 100000 --out p.cede".to_owned(),
        "reproduce --data synthetic --encounters 1000".to_owned(),
        "verify campaign --steps 1000000000".to_owned(),
        "verify margins --boxes 1000000000".to_owned(),
        "verify policy --sweep --check --timeout 600".to_owned(),
        "verify reach --timeout 600".to_owned(),
        concat!(
            "verify all --quick --source ",
            env!("CARGO_MANIFEST_DIR"),
            "/.."
        )
        .to_owned(),
        format!("verify shield {recorded} --sweep sweep.csv"),
    ] {
        for signal in ["-TERM", "-INT"] {
            let mut child = start(recordings.path(), &arguments, Stdio::null);
            let Some((code, took)) = end(&mut child, signal) else {
                assert!(
                    arguments.starts_with("verify"),
                    "{arguments} is over too soon"
                );
                continue;
            };
            // Synthetic sites are small: it may be over by itself in the same moment.
            if code != Some(4) && arguments.starts_with("verify shield") {
                continue;
            }
            assert_eq!(code, Some(4), "{arguments}");
            // A second, and what a busy machine needs to start the threads that count it.
            assert!(took < Duration::from_millis(1500), "{arguments}: {took:?}");
        }
    }
    let unfinished = walk(recordings.path());
    assert!(unfinished.is_empty(), "{unfinished:?}");
}

/// The temporary files in `folder`.
#[cfg(unix)]
fn walk(folder: &Path) -> Vec<std::path::PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(walk(&path));
        } else if path.extension().is_some_and(|ending| ending == "part") {
            found.push(path);
        }
    }
    found
}

#[cfg(target_os = "linux")]
#[test]
fn a_signal_ends_the_solvers_of_the_lemmas_too() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let solver = folder.path().join("z3");
    let script = "#!/bin/sh\n\
        if [ \"$1\" = --version ]; then echo 'Z3 version 0'; exit; fi\n\
        touch asked.$$\nexec sleep 60\n";
    std::fs::write(&solver, script).unwrap();
    std::fs::set_permissions(&solver, PermissionsExt::from_mode(0o755)).unwrap();
    let arguments = format!("verify lemmas --threads 1 --solver {}", solver.display());
    let mut child = start(folder.path(), &arguments, Stdio::null);
    let asked = || {
        let entries = std::fs::read_dir(folder.path()).unwrap();
        let mut names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.find_map(|name| name.strip_prefix("asked.").map(str::to_owned))
    };
    let process = loop {
        if let Some(process) = asked() {
            break process;
        }
        assert!(child.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(5));
    };
    let (code, _) = end(&mut child, "-TERM").unwrap();
    assert_eq!(code, Some(4));
    // Killed, it takes a moment to end; an orphan that nobody waits for may stay a zombie.
    let status = || std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let begun = Instant::now();
    while !(status().is_empty() || status().contains("State:\tZ")) {
        assert!(begun.elapsed() < Duration::from_secs(5), "{}", status());
        std::thread::sleep(Duration::from_millis(10));
    }
}
