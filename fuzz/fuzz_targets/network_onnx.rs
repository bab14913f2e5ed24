#![no_main]
//! Networks for the verifier as ONNX graphs: what is read can be run.

use cede_nnv_check::onnx;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(network) = onnx::read(bytes) {
        let given = network.run(&vec![0.0; network.inputs()]).values;
        assert_eq!(given.len(), network.outputs());
    }
});
