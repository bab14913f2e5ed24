#![no_main]
//! Properties in VNN-LIB.

use cede_nnv_check::vnnlib;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let _ = vnnlib::read(text);
});
