#![no_main]
//! Policies as ONNX graphs: what is imported is a weights file that the controller accepts.

use cede_controller::Policy;
use cede_formats::onnx::{self, Told};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(words) = onnx::import(bytes, Told::default()) {
        Policy::new(&words).expect("an imported policy is accepted");
    }
});
