//! `cede train` and `cede reproduce` as commands: interruption, resumption and failures.
#![cfg(unix)]

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// `cede train` of small networks on a few synthetic encounters, into `folder`.
fn train(algorithm: &str, folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cede"));
    command
        .args(["train", algorithm, "--data", "synthetic"])
        .args(["--encounters", "20", "--set", "width=16"])
        .arg("--out")
        .arg(folder.join("driver.cede"));
    let sets: &[&str] = match algorithm {
        "bc" => &["updates=3000", "batch=16"],
        "apg" => &["updates=150", "batch=16", "horizon=5", "last_horizon=5"],
        _ => &[
            "episodes=400",
            "batch=16",
            "buffer=2000",
            "steps_per_update=8",
        ],
    };
    sets.iter().for_each(|set| {
        command.args(["--set", set]);
    });
    command
}

fn succeed(command: &mut Command) {
    let output = command.output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{stderr}");
}

/// Starts `command`, which logs to `log`, and presses Ctrl-C after the first scalars.
fn interrupt(mut command: Command, log: &Path) -> Option<i32> {
    let mut child = command.stderr(Stdio::null()).spawn().unwrap();
    let curve = log.join("scalars.csv");
    while std::fs::metadata(&curve).map_or(0, |m| m.len()) < 200 {
        if let Some(status) = child.try_wait().unwrap() {
            return status.code();
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    press_ctrl_c(&child);
    child.wait().unwrap().code()
}

fn press_ctrl_c(child: &Child) {
    let interrupted = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(interrupted.unwrap().success());
}

#[test]
fn an_interrupted_training_resumes_to_the_same_bits() {
    for algorithm in ["bc", "sac", "apg"] {
        let [whole, parts] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        succeed(&mut train(algorithm, whole.path()));
        let log = parts.path().join("log");
        let mut first = train(algorithm, parts.path());
        first.arg("--log").arg(&log);
        assert_eq!(interrupt(first, &log), Some(4), "{algorithm}");
        assert!(parts.path().join("driver.checkpoint").exists());
        assert!(!parts.path().join("driver.cede").exists());
        succeed(train(algorithm, parts.path()).arg("--resume"));
        let weights = |folder: &Path| std::fs::read(folder.join("driver.cede")).unwrap();
        assert_eq!(weights(parts.path()), weights(whole.path()), "{algorithm}");
        assert!(!parts.path().join("driver.checkpoint").exists());
    }
}

#[test]
fn reproduce_gives_rows_baselines_and_curves_and_resumes_from_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let reproduce = |extra: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_cede"));
        command
            .args(["reproduce", "--data", "synthetic", "--encounters", "20"])
            .args(["--rows", "bc", "--seeds", "1", "--json", "--out"])
            .arg(folder.path())
            .args(extra);
        let output = command.output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stdout).unwrap()
    };
    let text = reproduce(&[]);
    let object: serde_json::Value = serde_json::from_str(&text).unwrap();
    let rows = object["rows"].as_array().unwrap();
    let count = |driver: &str| rows.iter().filter(|row| row["driver"] == driver).count();
    // So few encounters are all in the training split: without a shield and with either contract.
    assert_eq!((count("bc"), count("logistic")), (3, 1));
    assert!(
        rows.iter()
            .all(|row| row["seed"].is_null() != (row["driver"] == "bc"))
    );
    let points = object["curves"][0]["points"].as_array().unwrap();
    assert_eq!(points.len(), 25);
    assert!(points[24]["train"]["reward"].as_f64().unwrap() < 0.0);
    assert!(folder.path().join("report.html").exists());

    let weights = folder.path().join("bc-0.cede");
    let made = || std::fs::metadata(&weights).unwrap().modified().unwrap();
    let before = made();
    assert_eq!(reproduce(&["--resume"]), text);
    assert_eq!(made(), before, "it was trained again");
}

/// Whether the child answers to Ctrl-C itself.
#[cfg(target_os = "linux")]
fn listens(child: &Child) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
    let caught = status.lines().find_map(|l| l.strip_prefix("SigCgt:"));
    const SIGINT: u64 = 2;
    u64::from_str_radix(caught.unwrap().trim(), 16).unwrap() >> (SIGINT - 1) & 1 == 1
}

#[test]
#[cfg(target_os = "linux")]
fn an_interrupted_reproduce_resumes_to_the_same_bits() {
    let reproduce = |folder: &Path| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_cede"));
        command
            .args(["reproduce", "--data", "synthetic", "--encounters", "20"])
            .args(["--rows", "apg", "--seeds", "2", "--out"])
            .arg(folder);
        for set in [
            "width=16",
            "batch=16",
            "updates=200",
            "refinement.updates=400",
        ] {
            command.args(["--set", &format!("apg.{set}")]);
        }
        command
    };
    let [whole, parts] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    succeed(&mut reproduce(whole.path()));
    let mut child = reproduce(parts.path())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while !listens(&child) {
        std::thread::sleep(Duration::from_millis(1));
    }
    std::thread::sleep(Duration::from_millis(200));
    press_ctrl_c(&child);
    assert_eq!(child.wait().unwrap().code(), Some(4));
    assert!(!parts.path().join("report.html").exists());
    succeed(reproduce(parts.path()).arg("--resume"));
    for file in ["apg-0.cede", "apg-1.cede", "apg-1.curve.json"] {
        let read = |folder: &Path| std::fs::read(folder.join(file)).unwrap();
        assert_eq!(read(parts.path()), read(whole.path()), "{file}");
    }
    let rows = |folder: &Path| std::fs::read(folder.join("rows.json")).unwrap();
    assert_eq!(rows(parts.path()), rows(whole.path()));
}

/// `command` where no file may grow beyond `kib` KiB, as on a full disk.
fn confined(command: &Command, kib: u32) -> Command {
    let mut shell = Command::new("sh");
    shell
        .arg("-c")
        .arg(format!("trap '' XFSZ; ulimit -f {}; exec \"$@\"", 2 * kib))
        .arg("sh")
        .arg(command.get_program())
        .args(command.get_args());
    shell
}

#[test]
fn where_nothing_can_be_written_the_old_file_stays() {
    let folder = tempfile::tempdir().unwrap();
    succeed(&mut train("bc", folder.path()));
    let file = folder.path().join("driver.cede");
    let before = std::fs::read(&file).unwrap();
    let mut again = train("bc", folder.path());
    let output = confined(again.args(["--seed", "1"]), 1).output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(
        stderr.contains("cannot write") && stderr.contains("untouched"),
        "{stderr}"
    );
    assert_eq!(std::fs::read(&file).unwrap(), before);
}

#[test]
fn where_no_checkpoint_can_be_written_the_last_one_stays() {
    let folder = tempfile::tempdir().unwrap();
    let logs = ["first", "second"].map(|name| folder.path().join(name));
    let mut first = train("sac", folder.path());
    first.arg("--log").arg(&logs[0]);
    assert_eq!(interrupt(first, &logs[0]), Some(4));
    let checkpoint = folder.path().join("driver.checkpoint");
    let before = std::fs::read(&checkpoint).unwrap();
    let kib = 16;
    assert!(before.len() > 2 * kib * 1024, "{}", before.len());
    let mut second = train("sac", folder.path());
    second.arg("--resume").arg("--log").arg(&logs[1]);
    let second = confined(&second, u32::try_from(kib).unwrap());
    assert_eq!(interrupt(second, &logs[1]), Some(3));
    assert_eq!(std::fs::read(&checkpoint).unwrap(), before);
}

#[test]
fn settings_out_of_range_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let output = train("apg", folder.path())
        .args(["--set", "width=100000000000"])
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(
        stderr.contains("width must be a multiple of 16"),
        "{stderr}"
    );
}

/// A checkpoint of an interrupted training in `folder`.
fn checkpoint(folder: &Path) -> PathBuf {
    let log = folder.join("log");
    let mut first = train("sac", folder);
    first.arg("--log").arg(&log);
    assert_eq!(interrupt(first, &log), Some(4));
    folder.join("driver.checkpoint")
}

/// Asserts that a training refuses to resume from `checkpoint`, with these words, and keeps the file.
fn assert_refused(folder: &Path, checkpoint: &Path, words: &[&str]) {
    let bytes = std::fs::read(checkpoint).unwrap();
    let output = train("sac", folder).arg("--resume").output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    // Messages are wrapped to the width of the terminal.
    let words_of = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    for expected in words {
        assert!(words_of(&stderr).contains(expected), "{stderr}");
    }
    assert_eq!(std::fs::read(checkpoint).unwrap(), bytes);
}

#[test]
fn a_damaged_checkpoint_is_refused_and_stays() {
    let folder = tempfile::tempdir().unwrap();
    let file = checkpoint(folder.path());
    let mut bytes = std::fs::read(&file).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&file, &bytes).unwrap();
    assert_refused(folder.path(), &file, &["checksum", "delete it"]);
}

#[test]
fn a_checkpoint_of_another_version_is_refused_and_stays() {
    let folder = tempfile::tempdir().unwrap();
    let file = checkpoint(folder.path());
    let mut bytes = std::fs::read(&file).unwrap();
    bytes[8..12].copy_from_slice(&7_u32.to_le_bytes());
    let end = bytes.len() - 4;
    let checksum = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&bytes[..end]);
    bytes[end..].copy_from_slice(&checksum.to_le_bytes());
    std::fs::write(&file, &bytes).unwrap();
    assert_refused(
        folder.path(),
        &file,
        &["version 7", "the program that wrote it", "without --resume"],
    );
}
