//! Bad inputs of every command: each ends soon, with the right exit code and a message that says what is wrong.
//!
//! 2: the command line is wrong. 3: a file is. What a case names is made in its folder by [`materials`].
#![cfg(unix)]

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::Read;
use std::os::unix::ffi::OsStringExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The longest that a case may take, on a busy machine.
const DEADLINE: Duration = Duration::from_secs(60);

/// A command line, the exit code, and what standard error contains. Words are separated by blanks; `''` is an
/// empty word, and `\xff` in a word is a byte that is no UTF-8.
type Case = (&'static str, i32, &'static str);

#[rustfmt::skip]
const CASES: &[Case] = &[
    // What is no command.
    ("frobnicate", 2, "unrecognized subcommand 'frobnicate'"),
    ("\\xff", 2, "unrecognized subcommand"),
    ("--frobnicate", 2, "unexpected argument '--frobnicate'"),
    ("data", 2, "Usage: cede data [OPTIONS] <COMMAND>"),
    ("verify", 2, "Usage: cede verify [OPTIONS] <COMMAND>"),
    ("help frobnicate", 2, "frobnicate"),
    ("completions dos", 2, "[possible values: bash"),
    ("man --out empty.csv", 3, "empty.csv is a file, not a folder"),
    ("evaluate --config folder", 3, "cannot read folder: Is a directory"),
    ("reproduce --config key.toml", 3, "key.toml:1: `cede reproduce` has no option `nam`"),
    // Recordings.
    ("data inspect", 2, "--data <DIR|synthetic>"),
    ("data inspect --data ''", 2, "a value is required for '--data"),
    ("data inspect --data \\xff", 2, "invalid UTF-8"),
    ("data inspect --data nowhere", 3, "nowhere: cannot be read: No such file"),
    ("data inspect --data folder", 3, "no recorded tracks of site EP0 here"),
    ("data inspect --data empty.csv", 3, "empty.csv: no rows"),
    ("data svo --data folder", 3, "no recorded tracks of site EP0 here"),
    ("data svo --data synthetic --draw svo.png", 2, "drawings are SVG"),
    ("data svo --data synthetic --weights cut.cede", 3, "the checksum does not fit: the file is damaged"),
    ("data inspect --data header.csv --site X", 3, "header.csv: no rows"),
    ("data inspect --data binary.csv", 3, "binary.csv:1: the header lacks the column `track`"),
    ("data inspect --data cut.csv", 3, "cut.csv:2: the file ends in the middle of this line"),
    ("data inspect --data nan.csv", 3, "nan.csv:2: column `x`: NaN is not a finite number"),
    ("data inspect --data far.csv", 3, "is farther than 8192 m from the origin"),
    ("data inspect --data late.csv", 3, "late.csv:2: column `t`: a time must be from 0 to 1,000,000,000 s"),
    ("data inspect --data track.csv", 3, "track.csv:2: column `track`: `99999999999999` is not a whole number"),
    ("data inspect --data hole.csv", 3, "hole.csv:3: hole in track 1"),
    ("data inspect --data words.csv", 3, "words.csv:2: column `y`: `north` is not a number"),
    ("data inspect --data alone.csv --site key.toml", 3, "unknown field `nam`"),
    ("data inspect --data alone.csv --site arm.toml", 3, "there is no arm `X`"),
    ("data inspect --data alone.csv --site nowhere.toml", 3, "nowhere.toml: cannot be read"),
    ("data inspect --data synthetic --encounters 20 --draw scene.png", 2, "has to end in .svg"),
    ("data inspect --data synthetic --encounters 20 --draw empty.csv/scene.svg", 3, "empty.csv is a file, not a folder"),
    ("data inspect --data synthetic --encounters 0", 2, "0 is not in 1..=1000000"),
    ("data inspect --data synthetic --encounters 18446744073709551615", 2, "is not in 1..=1000000"),
    ("data inspect --data alone.csv --seed 1", 2, "--seed has no effect with the recordings in alone.csv"),
    ("data extract --data synthetic --encounters 1000000 --out folder", 3, "cannot write folder: this is a folder"),
    ("data extract --data alone.csv --site X --out pairs.csv", 3, "no encounters in the recordings of site X"),
    ("data extract --data folder --site all", 3, "no folder with recorded tracks here"),
    ("data synthesize --out empty.csv", 3, "empty.csv is a file, not a folder"),
    ("data synthesize --out folder/..", 3, "folder/.. is not empty"),
    ("data synthesize --out made --encounters 1e3", 2, "invalid digit"),
    ("data new-site --data nowhere --out site.toml", 3, "nowhere: No such file"),
    ("data new-site --data alone.csv --out site.toml", 3, "the tracks show no arms of a junction"),
    ("data new-site --data alone.csv --out site.txt", 2, "has to end in .toml"),
    ("data new-site --data alone.csv --out key.toml", 3, "key.toml exists"),
    // Evaluation.
    ("evaluate", 2, "--data <DIR|synthetic>"),
    ("evaluate --data synthetic --driver fast", 2, "no driver is called `fast`; there are: replay"),
    ("evaluate --data synthetic --driver ''", 2, "no driver is called ``"),
    ("evaluate --data synthetic --mode ego --partner fast", 2, "no driver is called `fast`; there are: replay"),
    ("evaluate --data synthetic --split half", 2, "leave-one-file-out"),
    ("evaluate --data synthetic --until never", 2, "[possible values: conflict, cleared]"),
    ("evaluate --data synthetic --seed 99999999999999999999", 2, "number too large"),
    ("evaluate --data synthetic --threads many", 2, "invalid digit"),
    ("evaluate --data synthetic --encounters 1000000 --episodes out.txt", 2, "has to end in .csv or .parquet"),
    ("evaluate --data synthetic --encounters 1000000 --episodes empty.csv/e.csv", 3, "empty.csv is a file, not a folder"),
    ("evaluate --data synthetic --encounters 1000000 --report folder", 3, "cannot write folder: this is a folder"),
    ("evaluate --data synthetic --driver cede --weights binary.cede", 3, "not a weights file: it does not begin with CEDE"),
    ("evaluate --data synthetic --driver cede --weights cut.cede", 3, "the checksum does not fit: the file is damaged"),
    ("evaluate --data synthetic --driver cede --weights flipped.cede", 3, "the checksum does not fit: the file is damaged"),
    ("evaluate --data synthetic --driver cede --weights \\xff.cede", 3, "No such file"),
    ("evaluate --data synthetic --driver idm --weights cut.cede", 2, "--weights has no effect with --driver idm"),
    ("evaluate --data synthetic --driver idm --svo 30", 2, "--svo has no effect with --driver idm"),
    ("evaluate --data synthetic --driver cede --svo 91", 2, "an orientation is between 0 and 90°"),
    ("evaluate --data synthetic --driver cede --svo high", 2, "`high` is not a number of degrees"),
    ("replay alone.csv --svo 30", 2, "--svo has no effect with --driver replay"),
    // Contracts.
    ("evaluate --data synthetic --shield on --contract nowhere", 2, "no contract has this name: worst-case"),
    ("evaluate --data synthetic --shield on --contract \\xff.toml", 2, "invalid UTF-8"),
    ("evaluate --data synthetic --shield on --contract nowhere.toml", 3, "cannot read nowhere.toml: No such file"),
    ("evaluate --data synthetic --shield on --contract binary.toml", 3, "cannot use binary.toml: it is not text in UTF-8"),
    ("evaluate --data synthetic --shield on --contract folder.toml", 3, "cannot read folder.toml: Is a directory"),
    ("evaluate --data synthetic --contract worst-case", 2, "--contract has no effect with --shield off"),
    ("verify margins --contract empty.toml", 3, "missing field `period`"),
    ("verify margins --contract period-nan.toml", 3, "period = NaN is outside [0.01, 1]"),
    ("verify margins --contract period-huge.toml", 3, "period = inf is outside [0.01, 1]"),
    ("verify beyond --contract latency-negative.toml", 3, "latency = -1 is outside [0, 1]"),
    ("verify shield --data . --contract braking-hard.toml", 3, "ego.braking = 9 is outside (0, 8]"),
    ("replay alone.csv --shield on --contract latency-word.toml", 3, "invalid type: string \"x\", expected f32"),
    ("replay alone.csv --shield on --contract latency-misspelt.toml", 3, "unknown field `laten`"),
    // One encounter.
    ("replay", 2, "<FILE>"),
    ("replay nowhere.csv", 3, "nowhere.csv: cannot be read"),
    ("replay \\xff.csv", 3, "cannot be read"),
    ("replay folder", 3, "no recorded tracks of site EP0 here"),
    ("replay alone.csv --site X", 3, "cede data inspect --data . --site X"),
    ("replay alone.csv --site X --pair 1,2", 3, "tracks 1 and 2 are not an encounter"),
    ("replay alone.csv --pair 1", 2, "two track numbers are needed, as in 25,26"),
    ("replay alone.csv --pair -1,2", 2, "'-1"),
    // Training.
    ("train", 2, "<ALGORITHM>"),
    ("train dqn --data synthetic --out p.cede", 2, "[possible values: bc, sac, sacer-v, sacer-svo, apg]"),
    ("train bc --data synthetic --encounters 1000000 --out empty.csv/p.cede", 3, "empty.csv is a file, not a folder"),
    ("train bc --data synthetic --encounters 1000000 --out folder", 3, "cannot write folder: this is a folder"),
    ("train bc --data synthetic --out p.cede --settings folder", 3, "cannot read folder: Is a directory"),
    ("train bc --data synthetic --out p.cede --settings binary.toml", 3, "cannot use binary.toml: it is not text"),
    ("train bc --data synthetic --out p.cede --settings key.toml", 3, "unknown field `nam`"),
    ("train bc --data synthetic --out p.cede --set width", 3, "key with no value"),
    ("train bc --data synthetic --out p.cede --set width=100", 3, "width must be a multiple of 16 up to 128, not 100"),
    ("train bc --data synthetic --out p.cede --set rate=nan", 3, "rate must be above 0 and finite, not NaN"),
    ("train bc --data synthetic --out p.cede --set rate=1e300", 3, "rate must be above 0 and finite, not inf"),
    ("train apg --data synthetic --out p.cede --claims empty.toml", 3, "cannot use empty.toml"),
    ("train sac --data synthetic --out p.cede --claims empty.toml", 2, "--claims has no effect with sac"),
    ("train bc --data synthetic --encounters 20 --out nowhere.cede --resume", 3, "nowhere.checkpoint"),
    ("train bc --data synthetic --encounters 20 --out binary.cede --resume", 3, "binary.checkpoint"),
    ("reproduce --data nowhere", 3, "nowhere: cannot be read"),
    ("reproduce --data synthetic --seeds 0", 2, "0 is not in 1.."),
    ("reproduce --data synthetic --rows dqn", 2, "[possible values: bc, sac"),
    ("reproduce --data synthetic --set width=64", 3, "--set width=64: names no setting of a row"),
    ("reproduce --data synthetic --leave-one-file-out --seven-fold", 2, "cannot be used with"),
    ("reproduce --data synthetic --encounters 1000000 --out empty.csv", 3, "empty.csv is a file, not a folder"),
    ("reproduce --data synthetic --transfer MA", 2, "--transfer has no effect with --data synthetic"),
    // Policies of other programs.
    ("export --format pdf --out p.pdf", 2, "[possible values: onnx, safetensors]"),
    ("export --format onnx --quantise i16 --out p.cede", 2, "cannot be used with"),
    ("export --out p.cede", 2, "required arguments were not provided"),
    ("verify departure --only SR-99", 3, "there is no property SR-99"),
    ("export --format onnx --out folder", 3, "cannot write folder: this is a folder"),
    ("export --format onnx --out .", 3, "cannot write .: this is a folder"),
    ("export --format onnx --out p.onnx --weights empty.cede", 3, "not a weights file"),
    ("export --format onnx --out p.onnx --weights /dev/zero", 3, "it is larger than"),
    ("import --onnx nowhere.onnx --out p.cede", 3, "cannot read nowhere.onnx: No such file"),
    ("import --onnx folder --out p.cede", 3, "cannot read folder: Is a directory"),
    ("import --onnx empty.onnx --out p.cede", 3, "cannot use empty.onnx: the file holds no graph"),
    ("import --onnx binary.onnx --out p.cede", 3, "cannot use binary.onnx: not an ONNX model"),
    ("import --onnx cut.onnx --out p.cede", 3, "cannot use cut.onnx: not an ONNX model"),
    ("import --onnx policy.onnx --features raw --out p.cede", 3, "features, `raw` has 8"),
    ("import --onnx policy.onnx --features fast --out p.cede", 2, "[possible values: raw"),
    ("import --onnx policy.onnx --out empty.csv/p.cede", 3, "empty.csv is a file, not a folder"),
    ("import --onnx /dev/zero --out p.cede", 3, "cannot read /dev/zero: it is larger than"),
    // The playground.
    ("play --port 99999", 2, "99999 is not in 0..=65535"),
    ("play --port 8080 --out folder", 2, "cannot be used with"),
    ("play --out empty.csv", 3, "empty.csv is a file, not a folder"),
    // Proofs.
    ("verify network --vnnlib p.vnnlib", 2, "--onnx <FILE>"),
    ("verify network --onnx policy.onnx --vnnlib empty.csv", 3, "policy.onnx and empty.csv: the property has 0 inputs"),
    ("verify network --onnx policy.onnx --vnnlib binary.csv", 3, "cannot use binary.csv: line 1"),
    ("verify network --onnx binary.onnx --vnnlib empty.csv", 3, "cannot use binary.onnx: not an ONNX model"),
    ("verify network --onnx policy.onnx --vnnlib empty.csv --timeout nan", 2, "not a number of seconds from 0 to"),
    ("verify network --onnx policy.onnx --vnnlib empty.csv --timeout 1e300", 2, "not a number of seconds from 0 to"),
    ("verify network --onnx policy.onnx --vnnlib empty.csv --certificate folder", 3, "cannot write folder: this is a folder"),
    ("verify check", 2, "<CERT>"),
    ("verify check nowhere", 3, "cannot read nowhere: No such file"),
    ("verify check folder", 3, "cannot read folder: Is a directory"),
    ("verify check empty.csv", 3, "not a certificate of Cede"),
    ("verify check binary.csv", 3, "cannot use binary.csv: it is not text in UTF-8"),
    ("verify policy --weights binary.cede", 3, "cannot use binary.cede: not a weights file"),
    ("verify policy --properties empty.toml", 3, "missing field `property`"),
    ("verify policy --properties folder", 3, "cannot read folder: Is a directory"),
    ("verify policy --timeout 0", 2, "0 is not in 1..=1000000"),
    ("verify policy --timeout 18446744073709551615", 2, "is not in 1..=1000000"),
    ("verify reach --scenarios binary.toml", 3, "cannot use binary.toml: it is not text in UTF-8"),
    ("verify reach --scenarios key.toml", 3, "unknown field `nam`"),
    ("verify reach --timeout 18446744073709551615", 2, "is not in 1..=1000000"),
    ("verify margins --boxes 0", 2, "0 is not in 1.."),
    ("verify margins --boxes 18446744073709551616", 2, "number too large"),
    ("verify zones nowhere", 3, "cannot read nowhere: No such file"),
    ("verify zones folder", 3, "cannot read folder: Is a directory"),
    ("verify zones empty.csv", 3, "cannot use empty.csv: EOF while parsing"),
    ("verify zones --parts 0", 2, "0 is not in 1.."),
    ("verify zones --write folder", 2, "--write: name one junction"),
    ("verify zones crossing --write folder", 3, "cannot write folder: this is a folder"),
    ("verify zones --data nowhere", 3, "nowhere: cannot be read"),
    ("verify lemmas --only fast", 2, "no such lemma; the lemmas are: "),
    ("verify lemmas --solver nowhere", 3, "cannot run the solver nowhere"),
    ("verify lemmas --solver /bin/cat", 3, "/bin/cat is not Z3"),
    ("verify lemmas --write empty.csv", 3, "empty.csv is a file, not a folder"),
    ("verify lemmas --timeout 18446744073709551615", 2, "is not in 1..=1000000"),
    ("verify shield --data nowhere", 3, "nowhere: cannot be read"),
    ("verify shield --data alone.csv --site X --sweep folder", 3, "cannot write folder: this is a folder"),
    ("verify campaign --steps 0", 2, "0 is not in 1.."),
    ("verify campaign --shard 1/2", 2, "--scenarios <N>"),
    ("verify campaign --scenarios 9 --shard 3/2", 2, "a share is I/N with I from 1 to N"),
    ("verify campaign --scenarios 9 --shard half", 2, "a share is I/N with I from 1 to N"),
    ("verify campaign --scenarios 9 --steps 9", 2, "cannot be used with"),
    ("verify campaign --seed 18446744073709551615", 2, "is not in 0..=9223372036854775807"),
    ("verify beyond --encounters 0", 2, "0 is not in 1.."),
    ("verify beyond --draw beyond.png", 2, "the file's name has to end in .svg"),
];

#[test]
fn each_is_a_clear_error_with_its_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    materials(folder.path());
    let wrong: Vec<String> = CASES
        .iter()
        .filter_map(|case| complaint(folder.path(), *case))
        .collect();
    assert!(
        wrong.is_empty(),
        "{} of {}:\n{}",
        wrong.len(),
        CASES.len(),
        wrong.join("\n")
    );
}

/// What is wrong with the answer to a case.
fn complaint(folder: &Path, (line, code, said): Case) -> Option<String> {
    let answer = run(folder, line);
    let told = answer
        .stderr
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ");
    // An error's lines are wrapped, with a bar before each.
    let told = told.replace("│ ", "");
    let right = answer.code == Some(code) && told.contains(said) && !told.contains("panicked");
    (!right).then(|| {
        let ended = answer
            .code
            .map_or("no end".to_owned(), |code| format!("exit code {code}"));
        format!("cede {line}: {ended}, not {code} with `{said}`: {told}")
    })
}

struct Answer {
    /// `None` if the command did not end in time.
    code: Option<i32>,
    stderr: String,
}

fn run(folder: &Path, line: &str) -> Answer {
    let errors = folder.join("stderr.txt");
    let mut child = Command::new(env!("CARGO_BIN_EXE_cede"))
        .args(line.split(' ').map(word))
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(File::create(&errors).unwrap())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    let code = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status.code();
        }
        if begun.elapsed() > DEADLINE {
            child.kill().unwrap();
            child.wait().unwrap();
            break None;
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    let mut bytes = Vec::new();
    File::open(errors).unwrap().read_to_end(&mut bytes).unwrap();
    let stderr = String::from_utf8_lossy(&bytes).into_owned();
    Answer { code, stderr }
}

/// A word of a command line; see [`Case`].
fn word(text: &str) -> OsString {
    if text == "''" {
        return OsString::new();
    }
    let mut parts = text.split("\\xff").map(str::as_bytes);
    let mut bytes = parts.next().unwrap_or_default().to_vec();
    for part in parts {
        bytes.push(0xff);
        bytes.extend(part);
    }
    OsString::from_vec(bytes)
}

/// Makes the files that the cases name.
fn materials(folder: &Path) {
    let write = |name: &str, bytes: &[u8]| fs::write(folder.join(name), bytes).unwrap();
    for name in ["folder", "folder.toml"] {
        fs::create_dir(folder.join(name)).unwrap();
    }
    let noise: Vec<u8> = (0..3000_u32)
        .map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8)
        .collect();
    for ending in ["csv", "toml", "cede", "onnx"] {
        write(&format!("empty.{ending}"), b"");
        write(&format!("binary.{ending}"), &noise);
    }
    write("binary.checkpoint", &noise);
    for (name, rows) in [
        ("header", ""),
        ("cut", "1,0,1"),
        ("nan", "1,0,nan,2\n"),
        ("far", "1,0,1e30,2\n"),
        ("late", "1,1e300,1,2\n"),
        ("track", "99999999999999,0,1,2\n"),
        ("hole", "1,0,1,2\n1,1000,1,2\n"),
        ("words", "1,0,1,north\n"),
        ("alone", "1,0,1,2\n1,0.1,1,3\n1,0.2,1,4\n"),
    ] {
        write(
            &format!("{name}.csv"),
            format!("track,t,x,y\n{rows}").as_bytes(),
        );
    }
    write("key.toml", b"nam = \"A\"\n");
    let arm = "name = \"A\"\nfolder = \"A\"\n[[movement]]\nway = { from = \"X\", to = \"Y\" }\nmanoeuvre = \"left\"\n";
    write("arm.toml", arm.as_bytes());
    let contract = include_str!("../../contracts/worst-case.toml");
    for (name, number, wrong) in [
        ("period-nan", "period = 0.1", "period = nan"),
        ("period-huge", "period = 0.1", "period = 1e308"),
        ("latency-negative", "latency = 0.1", "latency = -1"),
        ("latency-word", "latency = 0.1", "latency = \"x\""),
        ("latency-misspelt", "latency = 0.1", "laten = 0.1"),
        ("braking-hard", "braking = 3.0 ", "braking = 9.0 "),
    ] {
        assert!(contract.contains(number), "{number}");
        write(
            &format!("{name}.toml"),
            contract.replace(number, wrong).as_bytes(),
        );
    }
    let policy = include_bytes!("../../controller/assets/embedded.cede");
    write("cut.cede", &policy[..1000]);
    let mut flipped = policy.to_vec();
    flipped[2000] ^= 1;
    write("flipped.cede", &flipped);
    let exported = run(folder, "export --format onnx --out policy.onnx");
    assert_eq!(exported.code, Some(0), "{}", exported.stderr);
    let onnx = fs::read(folder.join("policy.onnx")).unwrap();
    write("cut.onnx", &onnx[..onnx.len() / 2]);
}

#[cfg(target_os = "linux")]
#[test]
fn odd_outputs_are_no_panic_and_nothing_is_lost() {
    use std::os::unix::fs::FileTypeExt;
    let folder = tempfile::tempdir().unwrap();
    let few = "evaluate --data synthetic --encounters 20 --split all --driver replay";
    let answer = run(folder.path(), &format!("{few} --report \\xff.html"));
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let answer = run(folder.path(), &format!("{few} --report /dev/null"));
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let null = fs::metadata("/dev/null").unwrap().file_type();
    assert!(null.is_char_device(), "a device is not replaced by a file");
    let answer = run(folder.path(), &format!("{few} --report /dev/full"));
    assert_eq!(answer.code, Some(3), "{}", answer.stderr);
    assert!(
        answer.stderr.contains("the disk is full"),
        "{}",
        answer.stderr
    );
}
