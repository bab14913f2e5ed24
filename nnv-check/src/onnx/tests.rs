use super::read;
use crate::Network;
use cede_formats::onnx::proto::{
    Attribute, Dimension, Graph, Model, Node, Shape as ShapeProto, Tensor, TensorType, Type,
    ValueInfo,
};
use proptest::prelude::*;
use prost::Message;

fn tensor(name: &str, dims: &[i64], values: &[f32]) -> Tensor {
    Tensor {
        name: name.into(),
        dims: dims.to_vec(),
        data_type: 1,
        float_data: values.to_vec(),
        ..Tensor::default()
    }
}

fn raw(name: &str, dims: &[i64], values: &[f64]) -> Tensor {
    let raw_data = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    Tensor {
        name: name.into(),
        dims: dims.to_vec(),
        data_type: 11,
        raw_data,
        ..Tensor::default()
    }
}

fn integers(name: &str, values: &[i64]) -> Tensor {
    let dims = vec![values.len() as i64];
    Tensor {
        name: name.into(),
        dims,
        data_type: 7,
        int64_data: values.to_vec(),
        ..Tensor::default()
    }
}

fn value(name: &str, dims: &[i64]) -> ValueInfo {
    let dim = dims
        .iter()
        .map(|&dim_value| Dimension {
            dim_value,
            ..Dimension::default()
        })
        .collect();
    let tensor_type = Some(TensorType {
        shape: Some(ShapeProto { dim }),
        ..TensorType::default()
    });
    ValueInfo {
        name: name.into(),
        r#type: Some(Type { tensor_type }),
        ..ValueInfo::default()
    }
}

fn node(op: &str, input: &[&str], output: &str, attribute: Vec<Attribute>) -> Node {
    Node {
        input: input.iter().map(|&i| i.into()).collect(),
        output: vec![output.into()],
        name: format!("node_{output}"),
        op_type: op.into(),
        attribute,
        domain: String::new(),
    }
}

fn integer(name: &str, i: i64) -> Attribute {
    Attribute {
        name: name.into(),
        i,
        ..Attribute::default()
    }
}

fn model(input: Vec<ValueInfo>, initializer: Vec<Tensor>, node: Vec<Node>) -> Vec<u8> {
    let output = vec![value("y", &[])];
    Model {
        graph: Some(Graph {
            node,
            initializer,
            input,
            output,
            ..Graph::default()
        }),
        ..Model::default()
    }
    .encode_to_vec()
}

/// Reads the model and runs it; the error bounds must be honest and tiny.
fn run(bytes: &[u8], x: &[f64], expected: &[f64]) -> Network {
    let network = read(bytes).expect("a supported model");
    let y = network.run(x);
    assert_eq!(y.values.len(), expected.len());
    for ((y, e), expected) in y.values.iter().zip(&y.errors).zip(expected) {
        assert!(
            (y - expected).abs() <= e + 1e-12 && *e < 1e-9,
            "{y} ± {e} for {expected}"
        );
    }
    network
}

#[test]
fn gemm_with_all_its_attributes() {
    let float = |name: &str, f| Attribute {
        name: name.into(),
        f,
        ..Attribute::default()
    };
    let attributes = vec![
        integer("transA", 1),
        integer("transB", 1),
        float("alpha", 0.5),
        float("beta", 2.0),
    ];
    let bytes = model(
        vec![value("x", &[2, 1])],
        vec![
            raw("w", &[3, 2], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
            tensor("b", &[3], &[1.0, 0.0, -1.0]),
        ],
        vec![node("Gemm", &["x", "w", "b"], "y", attributes)],
    );
    let network = run(&bytes, &[1.0, -1.0], &[1.5, -0.5, -2.5]);
    assert_eq!(
        network.layers().len(),
        1,
        "nothing was rounded, so all is one layer"
    );
}

#[test]
fn shapes_are_moved_as_numpy_moves_them() {
    let perm = Attribute {
        name: "perm".into(),
        ints: vec![1, 0],
        ..Attribute::default()
    };
    let bytes = model(
        vec![value("a", &[0, 2]), value("b", &[1, 4])],
        vec![
            integers("two", &[2, -1]),
            tensor("c", &[1, 2], &[10.0, 100.0]),
            tensor("one", &[3], &[1.0, 2.0, 3.0]),
        ],
        vec![
            node("Concat", &["a", "b"], "ab", vec![integer("axis", -1)]),
            node("Reshape", &["ab", "two"], "m", vec![]),
            node("Transpose", &["m"], "t", vec![perm]),
            // Rows of t: (x0, x3), (x1, x4), (x2, x5).
            node("Mul", &["t", "c"], "scaled", vec![]),
            node("Relu", &["scaled"], "r", vec![]),
            node("MatMul", &["one", "r"], "p", vec![]),
            node("Flatten", &["p"], "y", vec![integer("axis", 0)]),
        ],
    );
    run(
        &bytes,
        &[1.0, 2.0, 3.0, -4.0, 5.0, 6.0],
        &[10.0 + 40.0 + 90.0, 0.0 + 1000.0 + 1800.0],
    );
}

#[test]
fn sums_divisions_and_tanh_keep_their_exact_meaning() {
    let bytes = model(
        vec![value("x", &[1, 2])],
        vec![
            tensor("third", &[2], &[3.0, 4.0]),
            tensor("shift", &[1], &[0.1]),
        ],
        vec![
            node("Sub", &["shift", "x"], "s", vec![]),
            node("Div", &["s", "third"], "d", vec![]),
            node("Tanh", &["d"], "t", vec![]),
            node("Add", &["t", "shift"], "y", vec![]),
        ],
    );
    let shift = f64::from(0.1_f32);
    let of = |x: f64, by: f64| ((shift - x) / by).tanh() + shift;
    let network = run(&bytes, &[0.7, -0.3], &[of(0.7, 3.0), of(-0.3, 4.0)]);
    assert!(
        network.layers().iter().any(|l| l.uncertainty > 0.0),
        "1/3 has no exact value"
    );
}

#[test]
fn clip_limits_from_both_sides_or_one() {
    let float = |name: &str, f| Attribute {
        name: name.into(),
        f,
        ..Attribute::default()
    };
    let inputs = [-7.5, -0.25, 0.0, 1.3, 9.0];
    let clipped = |input: &[&str], attributes: Vec<Attribute>, expected: [f64; 5]| {
        let bounds = vec![tensor("low", &[], &[-0.5]), tensor("high", &[], &[1.0])];
        let clip = node("Clip", input, "y", attributes);
        let bytes = model(vec![value("x", &[1, 5])], bounds, vec![clip]);
        run(&bytes, &inputs, &expected);
    };
    clipped(&["x", "low", "high"], vec![], [-0.5, -0.25, 0.0, 1.0, 1.0]);
    clipped(&["x", "", "high"], vec![], [-7.5, -0.25, 0.0, 1.0, 1.0]);
    clipped(&["x", "low"], vec![], [-0.5, -0.25, 0.0, 1.3, 9.0]);
    clipped(&["x", "high", "low"], vec![], [-0.5; 5]);
    let old = vec![float("min", -0.5), float("max", 1.0)];
    clipped(&["x"], old, [-0.5, -0.25, 0.0, 1.0, 1.0]);
}

#[test]
fn constants_may_be_nodes() {
    let t = Attribute {
        name: "value".into(),
        t: Some(tensor("", &[1, 1], &[2.5])),
        ..Attribute::default()
    };
    let nodes = vec![
        node("Constant", &[], "c", vec![t]),
        node("MatMul", &["x", "c"], "y", vec![]),
    ];
    run(
        &model(vec![value("x", &[1, 1])], vec![], nodes),
        &[2.0],
        &[5.0],
    );
}

#[test]
fn the_first_unsupported_operator_is_named() {
    let nodes = vec![
        node("Relu", &["x"], "r", vec![]),
        node("Erf", &["r"], "s", vec![]),
        node("Softmax", &["s"], "y", vec![]),
    ];
    let error = read(&model(vec![value("x", &[1, 2])], vec![], nodes)).expect_err("Erf");
    assert!(
        error
            .to_string()
            .starts_with("node \"node_s\", operator Erf: is not supported; supported are Gemm")
    );
}

fn ints(name: &str, ints: &[i64]) -> Attribute {
    Attribute {
        name: name.into(),
        ints: ints.to_vec(),
        ..Attribute::default()
    }
}

fn float(name: &str, f: f32) -> Attribute {
    Attribute {
        name: name.into(),
        f,
        ..Attribute::default()
    }
}

#[test]
fn branches_are_added_and_joined_at_any_depth() {
    let bytes = model(
        vec![value("x", &[1, 2])],
        vec![tensor("w", &[2, 2], &[1.0, -1.0, 0.5, 2.0])],
        vec![
            node("MatMul", &["x", "w"], "a", vec![]),
            node("Relu", &["a"], "r", vec![]),
            node("MatMul", &["r", "w"], "b", vec![]),
            node("Relu", &["b"], "s", vec![]),
            // Past two ReLUs, past one, and of the same depth.
            node("Add", &["s", "x"], "t", vec![]),
            node("Sub", &["r", "t"], "u", vec![]),
            node("Concat", &["u", "x", "s"], "y", vec![integer("axis", 1)]),
        ],
    );
    for [x0, x1] in [[1.0, -2.0], [-3.0, 0.5], [0.25, 4.0], [-1.0, -1.0]] {
        let relu = |v: f64| v.max(0.0);
        let by = |v: [f64; 2]| [v[0] + 0.5 * v[1], -v[0] + 2.0 * v[1]];
        let r = by([x0, x1]).map(relu);
        let s = by(r).map(relu);
        let u = [r[0] - s[0] - x0, r[1] - s[1] - x1];
        run(&bytes, &[x0, x1], &[u[0], u[1], x0, x1, s[0], s[1]]);
    }
    let behind_tanh = vec![
        node("Tanh", &["x"], "t", vec![]),
        node("Add", &["x", "t"], "y", vec![]),
    ];
    let error = read(&model(vec![value("x", &[1, 2])], vec![], behind_tanh)).expect_err("Tanh");
    assert!(error.to_string().contains("node_y"), "{error}");
}

#[test]
fn smooth_and_leaky_activations_are_rewritten_exactly() {
    let bytes = model(
        vec![value("x", &[1, 3])],
        vec![],
        vec![
            node("LeakyRelu", &["x"], "l", vec![float("alpha", 0.25)]),
            node("Sigmoid", &["l"], "y", vec![]),
        ],
    );
    let of = |x: f64| 1.0 / (1.0 + (-(if x < 0.0 { 0.25 * x } else { x })).exp());
    run(&bytes, &[-4.0, 0.0, 1.5], &[of(-4.0), of(0.0), of(1.5)]);
}

/// A direct convolution with one pad on every side, in two groups.
fn convolved(x: &[f64], kernel: &[f64], stride: usize, filter: usize) -> Vec<f64> {
    let mut y = Vec::new();
    for row in (0..4).step_by(stride) {
        for column in (0..4).step_by(stride) {
            let mut sum = 0.0;
            for i in 0..3 {
                for j in 0..3 {
                    let (r, c) = (row + i, column + j);
                    if (1..=4).contains(&r) && (1..=4).contains(&c) {
                        sum +=
                            kernel[9 * filter + 3 * i + j] * x[16 * filter + 4 * (r - 1) + c - 1];
                    }
                }
            }
            y.push(sum);
        }
    }
    y
}

#[test]
fn images_are_convolved_and_pooled() {
    let x: Vec<f64> = (0..32).map(|i| f64::from((7 * i) % 11) - 5.0).collect();
    let kernel: Vec<f32> = (0..18).map(|i| ((5 * i) % 7) as f32 - 3.0).collect();
    let exact: Vec<f64> = kernel.iter().map(|&k| f64::from(k)).collect();
    for stride in [1, 2] {
        let attributes = vec![
            ints("pads", &[1, 1, 1, 1]),
            ints("strides", &[stride, stride]),
            integer("group", 2),
        ];
        let bytes = model(
            vec![value("x", &[1, 2, 4, 4])],
            vec![
                tensor("k", &[2, 1, 3, 3], &kernel),
                tensor("b", &[2], &[0.5, -1.0]),
            ],
            vec![node("Conv", &["x", "k", "b"], "y", attributes)],
        );
        let of = |filter: usize, b: f64| {
            let y = convolved(&x, &exact, stride as usize, filter);
            y.into_iter().map(move |y| y + b)
        };
        let expected: Vec<f64> = of(0, 0.5).chain(of(1, -1.0)).collect();
        run(&bytes, &x, &expected);
    }
    let pooled = |operator: &str, attributes: Vec<Attribute>, of: &dyn Fn(&[f64]) -> f64| {
        let nodes = vec![node(operator, &["x"], "y", attributes)];
        let bytes = model(vec![value("x", &[1, 2, 4, 4])], vec![], nodes);
        let window = |channel: usize, row: usize, column: usize, side: usize| {
            let at = |i: usize| x[16 * channel + 4 * (row + i / side) + column + i % side];
            of(&(0..side * side).map(at).collect::<Vec<_>>())
        };
        let whole = operator.starts_with("Global");
        let (side, places): (usize, &[usize]) = if whole { (4, &[0]) } else { (3, &[0, 1]) };
        let mut expected = Vec::new();
        for channel in 0..2 {
            for &row in places {
                expected.extend(
                    places
                        .iter()
                        .map(|&column| window(channel, row, column, side)),
                );
            }
        }
        run(&bytes, &x, &expected);
    };
    let most = |v: &[f64]| v.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let kernel = || vec![ints("kernel_shape", &[3, 3])];
    pooled("MaxPool", kernel(), &most);
    pooled("AveragePool", kernel(), &mean);
    pooled("GlobalAveragePool", vec![], &mean);
}

#[test]
fn batches_are_normalised() {
    let numbers = |name: &str, values: [f32; 2]| tensor(name, &[2], &values);
    let bytes = model(
        vec![value("x", &[1, 2, 2])],
        vec![
            numbers("scale", [2.0, -1.0]),
            numbers("shift", [0.5, 3.0]),
            numbers("mean", [1.0, 0.25]),
            numbers("variance", [4.0, 0.3]),
        ],
        vec![node(
            "BatchNormalization",
            &["x", "scale", "shift", "mean", "variance"],
            "y",
            vec![float("epsilon", 0.5)],
        )],
    );
    let of = |x: f64, c: usize| {
        let (scale, shift, mean) = ([2.0, -1.0][c], [0.5, 3.0][c], [1.0, 0.25][c]);
        let variance = f64::from([4.0_f32, 0.3][c]);
        (x - mean) / (variance + 0.5).sqrt() * scale + shift
    };
    let x = [0.0, 1.5, -2.0, 4.0];
    let expected = [of(0.0, 0), of(1.5, 0), of(-2.0, 1), of(4.0, 1)];
    let network = run(&bytes, &x, &expected);
    assert!(!network.is_exact(), "a square root is no fraction");
}

#[test]
fn parts_are_taken() {
    let bytes = model(
        vec![value("x", &[1, 6])],
        vec![
            integers("from", &[-5]),
            integers("to", &[100]),
            integers("axis", &[1]),
            integers("step", &[2]),
            integers("places", &[-1, 0]),
        ],
        vec![
            // x1, x3, x5.
            node("Slice", &["x", "from", "to", "axis", "step"], "odd", vec![]),
            node("Gather", &["x", "places"], "ends", vec![integer("axis", 1)]),
            node("Concat", &["odd", "ends"], "y", vec![integer("axis", 1)]),
        ],
    );
    run(
        &bytes,
        &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
        &[1.0, 3.0, 5.0, 5.0, 0.0],
    );
    let mut split = node(
        "Split",
        &["x"],
        "a",
        vec![integer("axis", 1), ints("split", &[2, 4])],
    );
    split.output.push("b".into());
    let last = node("Concat", &["b", "a"], "y", vec![integer("axis", 1)]);
    let bytes = model(vec![value("x", &[1, 6])], vec![], vec![split, last]);
    run(
        &bytes,
        &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
        &[2.0, 3.0, 4.0, 5.0, 0.0, 1.0],
    );
}

fn sound_model() -> Vec<u8> {
    model(
        vec![value("x", &[1, 3])],
        vec![
            tensor("w", &[3, 2], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
            raw("b", &[2], &[0.5, -0.5]),
            integers("s", &[1, -1]),
        ],
        vec![
            node("Gemm", &["x", "w", "b"], "z", vec![]),
            node("Relu", &["z"], "r", vec![]),
            node("Reshape", &["r", "s"], "y", vec![]),
        ],
    )
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = read(&bytes);
    }

    #[test]
    fn a_damaged_model_is_read_or_refused(damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4), cut in any::<prop::sample::Index>()) {
        let mut bytes = sound_model();
        for (at, byte) in damage {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        bytes.truncate(cut.index(bytes.len() * 4).max(1));
        let _ = read(&bytes);
    }
}
