//! The same network in Cede and in what users would otherwise take to run it.

pub mod burn;
pub mod candle;
pub mod cede;
pub mod onnx;
pub mod onnxruntime;
pub mod tract;

/// Whatever goes wrong in a peer.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Number of inputs.
pub const INPUTS: usize = 8;
/// Number of outputs.
pub const OUTPUTS: usize = 4;

/// Runs the network once, from inputs in memory to outputs in memory.
pub type Run = Box<dyn FnMut(&[f32; INPUTS]) -> Result<[f32; OUTPUTS], Failure>>;

/// A dense layer.
pub struct Layer {
    /// Its inputs and outputs.
    pub shape: [usize; 2],
    /// Input by input the weights to each output.
    pub weights: Vec<f32>,
    /// One for each output.
    pub biases: Vec<f32>,
}

/// Four dense layers with ReLU between, 8→`width`→`width`→`width`→4, with weights that look random.
#[must_use]
pub fn layers(width: usize) -> Vec<Layer> {
    let mut state = 1_u32;
    let mut weight = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (f32::from((state >> 16) as u16) / 32768.0 - 1.0) / (width as f32).sqrt()
    };
    [
        [INPUTS, width],
        [width, width],
        [width, width],
        [width, OUTPUTS],
    ]
    .map(|shape| Layer {
        shape,
        weights: std::iter::repeat_with(&mut weight)
            .take(shape[0] * shape[1])
            .collect(),
        biases: std::iter::repeat_with(&mut weight).take(shape[1]).collect(),
    })
    .into()
}
