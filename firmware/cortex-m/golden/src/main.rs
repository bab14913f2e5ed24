//! Writes the golden file: `cede-golden FOLDER [i16]`. The embedded policy drives, or the same in integers.
//!
//! The last scene is one that a search for the most instructions of a decision found. Everything else comes from one fixed
//! generator: vehicles that start at random and drive as they please,
//! within the contract for most of the time; now and then one vanishes, jumps, or is no number at all, and a call is late.

mod random;
mod traffic;

use cede_controller::policy::embedded;
use cede_controller::{Approach, Policy};
use cede_golden::{Golden, HEADER, QUESTION, Question, ROUTE, answer};
use random::Random;
use std::io::{Error, Result};
use std::path::Path;
use traffic::Traffic;

/// Junctions, with 1 to 8 others in turn, and their steps of 0.1 s: every third one under the worst-case contract, the last ones
/// under one in which nothing is exact.
const SCENES: usize = 28;
const EXACT: usize = 24;
const STEPS: usize = 60;
/// A scene as in the file, without decisions.
const WORST: &[u8] = include_bytes!("../worst.bin");
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
    golden.extend(worst(&policy)?);
    write(&Path::new(&folder).join("golden.bin"), &golden)
}

fn write(path: &Path, words: &[u32]) -> Result<()> {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    std::fs::write(path, bytes)
}

/// Junction number `i`, and what `policy` decides in it.
fn scene(policy: &Policy<'_>, random: &mut Random, i: usize, steps: usize) -> Result<Vec<u32>> {
    let others = 1 + i % 8;
    let contract = if i < EXACT {
        u32::from(!i.is_multiple_of(3))
    } else {
        2
    };
    let mut traffic = Traffic::new(random, others);
    let mut words = vec![others as u32, steps as u32, contract];
    words.extend(traffic.routes());
    let mut answers = Vec::new();
    enter(&words, policy, |approach| {
        for _ in 0..steps {
            let acceleration = step(approach, &traffic.observe(random), &mut answers);
            traffic.advance(random, acceleration);
        }
    })?;
    words.extend(answers);
    Ok(words)
}

/// The scene that was found, and what `policy` decides in it.
fn worst(policy: &Policy<'_>) -> Result<Vec<u32>> {
    let words = WORST
        .as_chunks()
        .0
        .iter()
        .map(|&word| u32::from_le_bytes(word));
    let mut words: Vec<u32> = words.collect();
    let questions = words.split_off(HEADER + (1 + words[0] as usize) * ROUTE);
    let mut answers = Vec::new();
    enter(&words, policy, |approach| {
        for question in questions.as_chunks::<QUESTION>().0 {
            step(approach, question, &mut answers);
        }
    })?;
    words.extend(answers);
    Ok(words)
}

/// Enters the junction of these words, of which the steps are yet to come.
fn enter(words: &[u32], policy: &Policy<'_>, drive: impl FnOnce(&mut Approach)) -> Result<()> {
    let mut words = words.to_vec();
    words[1] = 0;
    let golden = Golden::next(&mut words.as_slice());
    let golden = golden.ok_or_else(|| Error::other("no junction at the end"))?;
    let junction = golden.junction().map_err(Error::other)?;
    drive(&mut golden.approach(policy, &junction).map_err(Error::other)?);
    Ok(())
}

/// Asks for a decision, notes question and answer, and gives the acceleration.
fn step(approach: &mut Approach, words: &[u32; QUESTION], noted: &mut Vec<u32>) -> f32 {
    let question = Question::new(words);
    let decision = approach.decide(question.now, &question.observation());
    noted.extend(words);
    noted.extend(answer(&decision));
    decision.acceleration
}
