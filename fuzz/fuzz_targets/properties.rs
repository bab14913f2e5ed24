#![no_main]
//! Properties of a policy (TOML).

use cede_formats::property::Properties;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let _ = Properties::read(text);
});
