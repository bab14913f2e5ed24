#![no_main]
//! Certificates: what is read is written as a text that reads the same.

use cede_verify::network::Certificate;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Ok(certificate) = Certificate::from_text(text) {
        let _ = Certificate::from_text(&certificate.to_text()).expect("its own text");
    }
});
