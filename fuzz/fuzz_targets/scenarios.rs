#![no_main]
//! Scenarios of the closed loop (TOML).

use cede_verify::reach::Scenarios;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let _ = Scenarios::read(text);
});
