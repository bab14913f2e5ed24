//! Repeats on the host what a page asked its controller, and compares every word: `replay FILE`.
//!
//! The file is that of `play/check/visitors.js`: for each call its number, the count of its words, the words, the count of
//! words of the answer (or -1), and those words. Call 255 begins with a new controller.

use cede_play::{Call, Desk, Input, Output, Place};
use std::io::{Error, Result};
use std::process::ExitCode;

const BEGIN: u32 = 255;

fn main() -> Result<ExitCode> {
    let usage = || Error::other("usage: replay FILE");
    let file = std::env::args_os().nth(1).ok_or_else(usage)?;
    let bytes = std::fs::read(file)?;
    let words: Vec<u32> = bytes
        .as_chunks()
        .0
        .iter()
        .map(|word| u32::from_le_bytes(*word))
        .collect();
    let mut words = words.as_slice();
    let mut tally = Tally::default();
    while !words.is_empty() {
        words = drive(words, &mut tally).ok_or_else(|| Error::other("the file ends in a call"))?;
    }
    println!(
        "controllers: {}, calls: {}, decisions: {}, words: {}; calls that differ: {}",
        tally.desks, tally.calls, tally.decisions, tally.words, tally.different
    );
    let good = tally.decisions > 0 && tally.different == 0;
    Ok(ExitCode::from(u8::from(!good)))
}

#[derive(Default)]
struct Tally {
    desks: usize,
    calls: usize,
    decisions: usize,
    words: usize,
    different: usize,
}

/// Repeats the calls of one controller: what is left of the words, or none if they end early.
fn drive<'w>(words: &'w [u32], tally: &mut Tally) -> Option<&'w [u32]> {
    let (&[begin, 0, 0], mut words) = words.split_first_chunk()? else {
        return None;
    };
    if begin != BEGIN {
        return None;
    }
    let place = Place::new();
    let mut desk = Desk::new(&place);
    tally.desks += 1;
    while let Some(&call) = words.first()
        && call != BEGIN
    {
        let (&[call, count], rest) = words.split_first_chunk()?;
        let (question, rest) = rest.split_at_checked(count as usize)?;
        let (&answered, rest) = rest.split_first()?;
        let accepted = answered != u32::MAX;
        let (answer, rest) = rest.split_at_checked(if accepted { answered as usize } else { 0 })?;
        let mut out = Output::new();
        let same = desk.call(call, Input(question), &mut out) == accepted
            && (!accepted || out.words() == answer);
        tally.calls += 1;
        tally.words += answer.len();
        tally.decisions += usize::from(call == Call::Decide as u32);
        tally.different += usize::from(!same);
        words = rest;
    }
    Some(words)
}
