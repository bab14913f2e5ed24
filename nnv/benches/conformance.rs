//! CPU seconds for every public instance: `cargo bench -p cede-nnv --bench conformance --
//! FOLDER [FILTER]`, FOLDER with an `instances.csv` (see `docs/benchmarks.md`). Linux only: CPU
//! time is read from `/proc`.

use cede_nnv::{SearchOptions, verify};
use cede_nnv_check::{onnx, vnnlib};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with("--"))
        .collect();
    let Some(folder) = arguments.first().map(Path::new) else {
        println!("no folder with an instances.csv given: nothing measured");
        return Ok(());
    };
    let filter = arguments.get(1).map_or("", String::as_str);
    let (mut total, mut worst, mut disagree, mut count) = (0.0, 0.0_f64, 0, 0);
    for line in std::fs::read_to_string(folder.join("instances.csv"))?
        .lines()
        .skip(1)
    {
        let [onnx, vnnlib, verdict, ..] = line.split(',').collect::<Vec<_>>()[..] else {
            continue;
        };
        if !line.contains(filter) {
            continue;
        }
        let start = cpu_seconds()?;
        let network = onnx::read(&std::fs::read(folder.join(onnx))?)?;
        let property = vnnlib::read(&std::fs::read_to_string(folder.join(vnnlib))?)?;
        let report = verify(&network, &property, SearchOptions::default())?;
        let used = cpu_seconds()? - start;
        let word = report.answer.word();
        println!(
            "{onnx} {vnnlib} {word} {used:.2} s, {} regions",
            report.regions
        );
        (total, worst, count) = (total + used, worst.max(used), count + 1);
        disagree += u32::from(word != verdict);
    }
    println!(
        "{count} instances, {disagree} disagree; {total:.2} CPU seconds, at most {worst:.2} for one"
    );
    Ok(())
}

/// User and system time of this process so far, in seconds.
fn cpu_seconds() -> Result<f64, Box<dyn std::error::Error>> {
    let stat = std::fs::read_to_string("/proc/self/stat")?;
    // The command's name may hold spaces; the numbers follow its closing parenthesis.
    let fields: Vec<&str> = stat
        .rsplit(')')
        .next()
        .unwrap_or_default()
        .split_whitespace()
        .collect();
    let ticks = |i: usize| {
        fields
            .get(i)
            .and_then(|f| f.parse::<f64>().ok())
            .unwrap_or(0.0)
    };
    Ok((ticks(11) + ticks(12)) / 100.0)
}
