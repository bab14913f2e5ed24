//! Writes the golden file and a weights file: `cede-golden FOLDER`.
//!
//! Everything comes from one fixed generator: vehicles that start at random and drive as they please,
//! within the contract for most of the time; now and then one vanishes, jumps, or is no number at all.

mod random;
mod traffic;

use cede_controller::weights::Draft;
use cede_controller::{FeatureSet, Mlp, Perspective, Policy};
use cede_golden::{Golden, answer, controller, observation};
use random::Random;
use std::io::{Error, Result};
use std::path::Path;
use traffic::Traffic;

/// Scenes, with 1 to 8 others in turn, and their steps of 0.1 s.
const SCENES: usize = 24;
const STEPS: usize = 60;

fn main() -> Result<()> {
    let usage = || Error::other("usage: cede-golden FOLDER");
    let folder = std::env::args_os().nth(1).ok_or_else(usage)?;
    let mut random = Random::new(1);
    let weights = weights(&mut random)?;
    let policy = Policy::new(&weights).map_err(Error::other)?;
    let mut golden = Vec::new();
    for i in 0..SCENES {
        golden.extend(scene(&policy, &mut random, 1 + i % 8)?);
    }
    let folder = Path::new(&folder);
    write(&folder.join("policy.cede"), &weights)?;
    write(&folder.join("golden.bin"), &golden)
}

fn write(path: &Path, words: &[u32]) -> Result<()> {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    std::fs::write(path, bytes)
}

/// A scene with `others` others, and what `policy` decides in it.
fn scene(policy: &Policy<'_>, random: &mut Random, others: usize) -> Result<Vec<u32>> {
    let mut traffic = Traffic::new(random, others);
    let mut words = vec![others as u32, 0];
    words.extend(traffic.routes());
    let scene = Golden::next(&mut words.as_slice()).and_then(|golden| golden.scene());
    let scene = scene.ok_or_else(|| Error::other("the routes make no scene"))?;
    let mut controller = controller(policy).ok_or_else(|| Error::other("no controller"))?;
    words[1] = STEPS as u32;
    for _ in 0..STEPS {
        let question = traffic.observe(random);
        let decision = controller.decide(&scene, &observation(&question));
        words.extend(question);
        words.extend(answer(&decision));
        traffic.advance(random, decision.acceleration);
    }
    Ok(words)
}

/// A network 64 wide with the most features and random weights.
fn weights(random: &mut Random) -> Result<Vec<u32>> {
    let (features, width) = (FeatureSet::Traffic, 64);
    let inputs = features.count();
    let parameters: Vec<f32> = (0..Mlp::words(inputs, width))
        .map(|_| random.within(0.25))
        .collect();
    let draft = Draft {
        features,
        perspective: Perspective::Ego,
        width,
        provenance: [0; 32],
        centres: &vec![0.0; inputs],
        scales: &vec![0.1; inputs],
        parameters: &parameters,
    };
    let mut file = vec![0; draft.words()];
    draft.encode(&mut file).map_err(Error::other)?;
    Ok(file)
}
