//! Golden cases: what a bare-metal image is told, and what it must answer, bit for bit.
#![no_std]
#![forbid(unsafe_code)]

use cede_controller::{
    ConflictKind, Footprint, Pair, Part, Party, Point, Policy, Pose, RightOfWay,
};

/// Words of a case: a pair of vehicles, then the answer.
pub const WORDS: usize = QUESTION + ANSWER;
/// Words that describe the pair: `f32` bit patterns, the last chooses the discrete fields.
pub const QUESTION: usize = 18;
/// Words of the answer: the two accelerations.
pub const ANSWER: usize = 2;

/// What `policy` answers to `question`, as bit patterns.
#[must_use]
pub fn answer(policy: &Policy<'_>, question: &[u32; QUESTION]) -> [u32; ANSWER] {
    policy.act(&pair(question)).map(f32::to_bits)
}

/// The pair that `question` describes.
#[must_use]
pub fn pair(question: &[u32; QUESTION]) -> Pair {
    let [ego @ .., svo, choices] = question;
    let (ego, other) = ego.split_at(8);
    Pair {
        ego: party(ego),
        other: party(other),
        kind: [ConflictKind::Crossing, ConflictKind::Merging][usize::from(choices & 1 != 0)],
        right_of_way: if choices & 2 != 0 {
            RightOfWay::Ego
        } else {
            RightOfWay::Unsettled
        },
        part: if choices & 4 != 0 {
            Part::Left
        } else {
            Part::Other
        },
        last_svo: f32::from_bits(*svo),
    }
}

fn party(words: &[u32]) -> Party {
    let at = |i: usize| words.get(i).map_or(0.0, |&word| f32::from_bits(word));
    Party {
        pose: Pose {
            position: Point::new(at(0), at(1)),
            direction: Point::new(at(2), at(3)),
        },
        exit: Point::new(at(4), at(5)),
        speed: at(6),
        distance: at(7),
        footprint: Footprint::PAPER,
        leader: None,
    }
}
