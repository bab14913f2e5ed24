#![no_main]
//! Certificates: what is read is written as a text that reads the same, and can be checked.

use cede_verify::network::{Certificate, Network, Property, onnx, vnnlib};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static CLAIM: LazyLock<(Network, Property)> = LazyLock::new(|| {
    let network = onnx::read(include_bytes!("../seeds/network_onnx/narrow.onnx"));
    let property = vnnlib::read(include_str!("../seeds/vnnlib/narrow.vnnlib"));
    (network.expect("a seed"), property.expect("a seed"))
});

fuzz_target!(|text: &str| {
    if let Ok(certificate) = Certificate::from_text(text) {
        assert_eq!(
            Certificate::from_text(&certificate.to_text()),
            Ok(certificate.clone())
        );
        let _ = certificate.check(&CLAIM.0, &CLAIM.1);
    }
});
