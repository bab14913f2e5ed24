//! Writes the golden file: `cede-golden FOLDER [i16]`. The embedded policy drives, or the same in integers.
//!
//! Everything else comes from one fixed generator: vehicles that start at random and drive as they please,
//! within the contract for most of the time; now and then one vanishes, jumps, or is no number at all, and a call is late.

mod random;
mod traffic;

use cede_controller::Policy;
use cede_controller::policy::embedded;
use cede_golden::{Golden, Question, answer};
use random::Random;
use std::io::{Error, Result};
use std::path::Path;
use traffic::Traffic;

/// Junctions, with 1 to 8 others in turn and every third one under the worst-case contract, and their steps of 0.1 s.
const SCENES: usize = 24;
const STEPS: usize = 60;
/// Steps with the policy in integers: cores without an FPU take their time.
const STEPS_I16: usize = 10;

fn main() -> Result<()> {
    let usage = || Error::other("usage: cede-golden FOLDER [i16]");
    let folder = std::env::args_os().nth(1).ok_or_else(usage)?;
    let (words, steps) = match std::env::args().nth(2).as_deref() {
        None => (embedded::words(), STEPS),
        Some("i16") => (embedded::words_i16(), STEPS_I16),
        Some(_) => return Err(usage()),
    };
    let mut random = Random::new(1);
    let policy = Policy::new(words).map_err(Error::other)?;
    let mut golden = Vec::new();
    for i in 0..SCENES {
        golden.extend(scene(&policy, &mut random, i, steps)?);
    }
    write(&Path::new(&folder).join("golden.bin"), &golden)
}

fn write(path: &Path, words: &[u32]) -> Result<()> {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    std::fs::write(path, bytes)
}

/// Junction number `i`, and what `policy` decides in it.
fn scene(policy: &Policy<'_>, random: &mut Random, i: usize, steps: usize) -> Result<Vec<u32>> {
    let others = 1 + i % 8;
    let mut traffic = Traffic::new(random, others);
    let mut words = vec![others as u32, 0, u32::from(!i.is_multiple_of(3))];
    words.extend(traffic.routes());
    let golden = Golden::next(&mut words.as_slice());
    let golden = golden.ok_or_else(|| Error::other("no junction at the end"))?;
    let junction = golden.junction().map_err(Error::other)?;
    let mut approach = golden.approach(policy, &junction).map_err(Error::other)?;
    words[1] = steps as u32;
    for _ in 0..steps {
        let words_of_step = traffic.observe(random);
        let question = Question::new(&words_of_step);
        let decision = approach.decide(question.now, &question.observation());
        words.extend(words_of_step);
        words.extend(answer(&decision));
        traffic.advance(random, decision.acceleration);
    }
    Ok(words)
}
