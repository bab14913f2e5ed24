#![no_main]
//! Weights files (.cede), also past their checksum.

use cede_controller::Policy;
use cede_controller::policy::weights;
use cede_fuzz::with_checksum;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for bytes in [bytes, &with_checksum(bytes)] {
        let words: Vec<u32> = weights::words(bytes).collect();
        let _ = Policy::new(&words);
    }
});
