//! Writes the seeds in binary formats, and those that need a program, to `fuzz/seeds`: `cargo run --example seeds`
//! in `fuzz`. The other seeds are written by hand. All are small and made up: none comes from recorded data.
#![forbid(unsafe_code)]

use cede_controller::policy::features::FeatureSet;
use cede_controller::policy::mlp::Mlp;
use cede_controller::policy::weights::{Draft, Perspective, Weights};
use cede_data::Dataset;
use cede_data::Encounter;
use cede_formats::onnx;
use cede_nnv::{Answer, SearchOptions};
use cede_nnv_check::{Certificate, Network, Source, vnnlib};
use cede_train::run::checkpoint::Checkpoint;
use cede_train::run::curve::Curve;
use cede_train::run::{Algorithm, Lessons, Run};
use std::error::Error;
use std::fmt::Write;
use std::path::Path;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

fn main() -> Result<()> {
    let words = policy()?;
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    let graph = onnx::export(&Weights::parse(&words)?)?;
    write("weights/narrow.cede", &bytes)?;
    write("policy_onnx/narrow.onnx", &graph)?;
    write("network_onnx/narrow.onnx", &graph)?;
    let network = cede_nnv_check::onnx::read(&graph)?;
    let property = property(&network)?;
    write("vnnlib/narrow.vnnlib", property.as_bytes())?;
    write(
        "certificate/narrow.cert",
        certificate(&network, &graph, &property)?.as_bytes(),
    )?;
    write("tracks/turn.csv", tracks()?.as_bytes())?;
    write("interaction/turn.csv", interaction()?.as_bytes())?;
    checkpoint()?.save(&path("checkpoint/begun.checkpoint"))?;
    Ok(())
}

fn path(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("seeds")
        .join(name)
}

fn write(name: &str, content: &[u8]) -> Result<()> {
    Ok(std::fs::write(path(name), content)?)
}

/// The smallest policy that there is, with weights of no meaning.
fn policy() -> Result<Vec<u32>> {
    let (features, width) = (FeatureSet::ALL[0], 16);
    let inputs = features.count();
    let parameters = (0..Mlp::words(inputs, width)).map(|i| (i % 7) as f32 * 0.125 - 0.375);
    let draft = Draft {
        features,
        perspective: Perspective::Joint,
        width,
        provenance: [1; 32],
        centres: &vec![1.0; inputs],
        scales: &vec![0.125; inputs],
        parameters: &parameters.collect::<Vec<f32>>(),
    };
    let mut words = vec![0; draft.words()];
    draft.encode(&mut words)?;
    Ok(words)
}

/// Something that holds of the policy: it never commands 10 m/s².
fn property(network: &Network) -> Result<String> {
    let mut text = String::new();
    for input in 0..network.inputs() {
        writeln!(text, "(declare-const X_{input} Real)")?;
        writeln!(text, "(assert (and (>= X_{input} 0) (<= X_{input} 1)))")?;
    }
    for output in 0..network.outputs() {
        writeln!(text, "(declare-const Y_{output} Real)")?;
    }
    writeln!(text, "(assert (>= Y_0 10))")?;
    Ok(text)
}

/// The proof of `property`.
fn certificate(network: &Network, model: &[u8], property: &str) -> Result<String> {
    let options = SearchOptions::default().record(true);
    let report = cede_nnv::verify(network, &vnnlib::read(property)?, options)?;
    if report.answer != Answer::Unsat {
        return Err("the property does not hold".into());
    }
    let onnx = Source::new(Path::new("narrow.onnx"), model);
    let vnnlib = Source::new(Path::new("narrow.vnnlib"), property.as_bytes());
    Ok(Certificate::new("seeds 1", onnx, vnnlib, report.proofs).to_text())
}

/// A left-turner from the west and somebody straight from the east, at (track, tenth of a second): x, y, vx, vy.
fn motion(track: u32, step: u32) -> [f64; 4] {
    let way = f64::from(step);
    match track {
        1 if step < 20 => [975.0 + way, 985.0, 10.0, 0.0],
        1 => [995.0, 965.0 + way, 0.0, 10.0],
        _ => [1015.0 - way, 990.0, -10.0, 0.0],
    }
}

fn tracks() -> Result<String> {
    let mut text = "track,t,x,y\n".to_owned();
    for (track, step) in [1, 2]
        .into_iter()
        .flat_map(|t| (0..5).map(move |s| (t, 10 * s)))
    {
        let [x, y, ..] = motion(track, step);
        writeln!(text, "{track},{},{x},{y}", step / 10)?;
    }
    Ok(text)
}

fn interaction() -> Result<String> {
    let mut text =
        "track_id,frame_id,timestamp_ms,agent_type,x,y,vx,vy,psi_rad,length,width\n".to_owned();
    for (track, step) in [1, 2]
        .into_iter()
        .flat_map(|t| (0..41).map(move |s| (t, s)))
    {
        let [x, y, vx, vy] = motion(track, step);
        let (frame, heading) = (step + 1, vy.atan2(vx));
        writeln!(
            text,
            "{track},{frame},{frame}00,car,{x},{y},{vx},{vy},{heading:.3},4.5,1.8"
        )?;
    }
    Ok(text)
}

/// A training after its first step.
fn checkpoint() -> Result<Checkpoint> {
    let dataset = Dataset::synthetic(4, 4);
    let encounters: Vec<&Encounter> = dataset.encounters.iter().take(4).collect();
    let lessons = Lessons::new(&encounters, &[]);
    let settings = Algorithm::Bc.settings().with(&"width = 16".parse()?)?;
    let mut run = Run::new(settings, &lessons, 1);
    run.advance();
    Ok(Checkpoint {
        data: [3; 32],
        algorithm: Algorithm::Bc,
        seed: 1,
        settings: String::new(),
        progress: run.progress(),
        curve: Curve::default(),
    })
}
