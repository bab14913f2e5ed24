//! The known answer is the one that the library finds, for the weights that it was found with and for no others.

mod common;

use cede::*;
use common::{OK, World};
use std::path::Path;

/// What the policy of this world answers.
fn answer(world: &mut World) -> u32 {
    let mut answer = 0;
    // SAFETY: as the header says.
    let status = unsafe {
        cede_known_answer(
            &world.policy,
            &mut world.junction,
            &mut world.approach,
            &mut answer,
        )
    };
    assert_eq!(status, OK);
    answer
}

/// With `UPDATE_HEADER` in the environment, writes it instead.
#[test]
fn the_embedded_policy_has_the_answer_of_the_header() {
    let mut world = World::empty();
    // SAFETY: as the header says.
    assert_eq!(unsafe { cede_policy_init_embedded(&mut world.policy) }, OK);
    let found = answer(&mut world);
    if std::env::var_os("UPDATE_HEADER").is_some() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/known_answer.rs");
        let text = std::fs::read_to_string(&file).unwrap();
        let known = format!("CEDE_EMBEDDED_ANSWER: u32 = {CEDE_EMBEDDED_ANSWER:#010x};");
        assert!(text.contains(&known), "{known}");
        let line = format!("CEDE_EMBEDDED_ANSWER: u32 = {found:#010x};");
        std::fs::write(&file, text.replace(&known, &line)).unwrap();
    } else {
        assert_eq!(
            found, CEDE_EMBEDDED_ANSWER,
            "the decisions are others: in firmware/capi, UPDATE_HEADER=1 cargo test --test known_answer --test header"
        );
    }
    assert_eq!(found, answer(&mut world), "whatever the storage holds");
}

/// A weight is another one, and the file's checksum fits it: what a checksum cannot find.
#[test]
fn another_weight_has_another_answer() {
    let mut words = cede_controller::policy::embedded::words().to_vec();
    let middle = words.len() / 2;
    let (mut others, mut tried) = (0, 0);
    for at in (middle..middle + 400).step_by(8) {
        words[at] ^= 1 << 20; // of an f32 the mantissa's high bits
        let last = words.len() - 1;
        words[last] = checksum(&words[..last]);
        let weights = words.clone().leak();
        let mut world = World::empty();
        // SAFETY: as the header says; the weights stay.
        let status = unsafe {
            cede_policy_init(
                &mut world.policy,
                weights.as_ptr(),
                4 * weights.len() as u32,
            )
        };
        assert_eq!(status, OK);
        tried += 1;
        others += u32::from(answer(&mut world) != CEDE_EMBEDDED_ANSWER);
        words[at] ^= 1 << 20;
    }
    // A weight of a neuron that is silent all the way has no effect.
    assert!(others * 10 > tried * 9, "{others} of {tried}");
}

/// CRC-32 (ISO-HDLC), bit by bit.
fn checksum(words: &[u32]) -> u32 {
    let bytes = words.iter().flat_map(|word| word.to_le_bytes());
    !bytes.fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg())
        })
    })
}
