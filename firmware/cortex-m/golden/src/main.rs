//! Writes the golden file and a weights file: `cede-golden FOLDER`.
//!
//! The cases come from a fixed generator: some plausible, some with arbitrary bits.

use cede_controller::weights::Draft;
use cede_controller::{FeatureSet, Mlp, Perspective, Policy};
use cede_golden::{QUESTION, answer};
use std::io::{Error, Result};
use std::path::Path;

const CASES: usize = 256;

fn main() -> Result<()> {
    let folder = std::env::args_os()
        .nth(1)
        .ok_or_else(|| Error::other("usage: cede-golden FOLDER"))?;
    let folder = Path::new(&folder);
    let mut random = Random(1);
    let weights = weights(&mut random);
    let policy = Policy::new(&weights).map_err(Error::other)?;
    let mut golden = Vec::new();
    for case in 0..CASES {
        let question = question(&mut random, case % 4 == 3);
        golden.extend(question);
        golden.extend(answer(&policy, &question));
    }
    write(&folder.join("policy.cede"), &weights)?;
    write(&folder.join("golden.bin"), &golden)
}

fn write(path: &Path, words: &[u32]) -> Result<()> {
    std::fs::write(
        path,
        words
            .iter()
            .flat_map(|word| word.to_le_bytes())
            .collect::<Vec<_>>(),
    )
}

/// A plausible pair, or 18 arbitrary words.
fn question(random: &mut Random, arbitrary: bool) -> [u32; QUESTION] {
    if arbitrary {
        return std::array::from_fn(|_| random.word());
    }
    let mut party = || {
        let mut unit = || {
            let angle = random.within(std::f32::consts::PI);
            [angle.cos(), angle.sin()]
        };
        let ([dx, dy], [ex, ey]) = (unit(), unit());
        let speed = 7.5 + random.within(7.5);
        [
            random.within(60.0),
            random.within(60.0),
            dx,
            dy,
            ex,
            ey,
            speed,
            random.within(60.0),
        ]
    };
    let mut values = [party(), party()].concat();
    values.push(0.8 + random.within(0.8));
    let mut question = [0; QUESTION];
    for (place, value) in question.iter_mut().zip(values) {
        *place = value.to_bits();
    }
    question[QUESTION - 1] = random.word();
    question
}

/// A network of the embedded policy's size with random weights.
fn weights(random: &mut Random) -> Vec<u32> {
    let (features, width) = (FeatureSet::Raw, 64);
    let count = Mlp::words(features.count(), width);
    let draft = Draft {
        features,
        perspective: Perspective::Joint,
        width,
        provenance: [0; 32],
        centres: &vec![0.0; features.count()],
        scales: &vec![0.05; features.count()],
        parameters: &(0..count).map(|_| random.within(0.3)).collect::<Vec<_>>(),
    };
    let mut file = vec![0; draft.words()];
    draft.encode(&mut file).expect("the draft fits its buffer");
    file
}

/// PCG-XSH-RR 64/32.
struct Random(u64);

impl Random {
    fn word(&mut self) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let x = (((self.0 >> 18) ^ self.0) >> 27) as u32;
        x.rotate_right((self.0 >> 59) as u32)
    }

    /// A number within ± `limit`.
    fn within(&mut self, limit: f32) -> f32 {
        ((self.word() >> 8) as f32 / (1 << 23) as f32 - 1.0) * limit
    }
}
