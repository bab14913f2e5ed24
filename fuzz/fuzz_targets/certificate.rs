#![no_main]
//! Certificates: what is read is written as a text that can be read, and can be checked.

use cede_nnv_check::{Certificate, Network, Property, onnx, vnnlib};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static CLAIM: LazyLock<(Network, Property)> = LazyLock::new(|| {
    let network = onnx::read(include_bytes!("../seeds/network_onnx/narrow.onnx"));
    let property = vnnlib::read(include_str!("../seeds/vnnlib/narrow.vnnlib"));
    (network.expect("a seed"), property.expect("a seed"))
});

fuzz_target!(|text: &str| {
    if let Ok(certificate) = Certificate::from_text(text) {
        let again = Certificate::from_text(&certificate.to_text());
        assert!(again.is_ok(), "{again:?}");
        let _ = certificate.check_proofs(&CLAIM.0, &CLAIM.1);
    }
});
