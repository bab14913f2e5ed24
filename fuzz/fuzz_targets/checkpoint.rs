#![no_main]
//! Checkpoints of a training, also past their checksum.

use cede_fuzz::{with_checksum, with_file};
use cede_train::run::checkpoint::Checkpoint;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for bytes in [bytes, &with_checksum(bytes)] {
        with_file("run.checkpoint", bytes, |path| {
            let _ = Checkpoint::load(path);
        });
    }
});
