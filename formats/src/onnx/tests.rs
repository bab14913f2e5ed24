use super::proto::{
    Attribute, Dimension, Graph, Model, Node, Shape, Tensor, TensorType, Type, ValueInfo,
};
use super::*;
use cede_controller::policy::MAX_ACCELERATION;
use cede_controller::policy::features::LIMIT;
use cede_controller::policy::weights::Draft;
use cede_controller::{FeatureSet, Mlp, Perspective, Weights};
use proptest::prelude::*;
use prost::Message;

/// Numbers between ± 1 that look random.
fn noise(seed: u32) -> impl Iterator<Item = f32> {
    std::iter::successors(Some(seed), |&x| {
        Some(x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453))
    })
    .map(|x| ((x >> 16) as u16 as i16) as f32 / 32768.0)
}

fn policy(features: FeatureSet, perspective: Perspective, width: usize) -> Vec<u32> {
    let inputs = features.count();
    let draw = |seed, n| noise(seed).take(n).collect::<Vec<f32>>();
    let draft = Draft {
        features,
        perspective,
        width,
        provenance: [5; 32],
        centres: &draw(1, inputs),
        scales: &draw(2, inputs),
        parameters: &draw(3, Mlp::words(inputs, width)),
    };
    let mut words = vec![0; draft.words()];
    draft.encode(&mut words).unwrap();
    words
}

/// What the network of a weights file makes of raw features: its outputs before squashing.
fn outputs(words: &[u32], features: &[f32]) -> [f32; 4] {
    let weights = Weights::parse(words).unwrap();
    let inputs: Vec<f32> = features
        .iter()
        .zip(weights.normalisation())
        .map(|(x, (c, s))| ((x - c) * s).clamp(-LIMIT, LIMIT))
        .collect();
    weights.network().forward(&inputs)
}

#[test]
fn what_is_exported_comes_back_with_the_bits_of_its_outputs() {
    for features in FeatureSet::ALL {
        for (perspective, width) in [(Perspective::Joint, 16), (Perspective::Ego, 48)] {
            let words = policy(features, perspective, width);
            let bytes = export(&Weights::parse(&words).unwrap()).unwrap();
            let back = import(&bytes, Told::default()).unwrap();
            let weights = Weights::parse(&back).unwrap();
            assert_eq!(weights.features(), features);
            assert_eq!(weights.perspective(), perspective);
            assert_eq!(weights.network().width(), width);
            assert_ne!(weights.provenance(), [5; 32]);
            for seed in 0..50 {
                let x = noise(seed).map(|x| 40.0 * x).take(features.count());
                let x: Vec<f32> = x.collect();
                let (before, after) = (outputs(&words, &x), outputs(&back, &x));
                assert!(before[..2].iter().any(|&y| y != 0.0));
                assert_eq!(before[..2], after[..2]);
            }
        }
    }
}

#[test]
fn the_same_policy_gives_the_same_bytes() {
    let words = policy(FeatureSet::Scene, Perspective::Ego, 32);
    let weights = Weights::parse(&words).unwrap();
    assert_eq!(export(&weights), export(&weights));
    let again = || crate::safetensors::write(&weights).unwrap();
    assert_eq!(again(), again());
}

fn tensor(name: &str, dims: &[usize], values: &[f32]) -> Tensor {
    Tensor {
        name: name.into(),
        dims: dims.iter().map(|&n| n as i64).collect(),
        data_type: 1,
        float_data: values.to_vec(),
        ..Tensor::default()
    }
}

fn node(operator: &str, input: &[&str], output: &str) -> Node {
    Node {
        op_type: operator.into(),
        name: format!("/{operator}_{output}"),
        input: input.iter().map(|&i| i.into()).collect(),
        output: vec![output.into()],
        ..Node::default()
    }
}

fn whole(name: &str, i: i64) -> Attribute {
    Attribute {
        name: name.into(),
        i,
        r#type: 2,
        ..Attribute::default()
    }
}

fn value(name: &str, length: usize) -> ValueInfo {
    let dim = [0, length as i64].map(|dim_value| Dimension {
        dim_value,
        ..Dimension::default()
    });
    let shape = Some(Shape { dim: dim.into() });
    let tensor_type = Some(TensorType {
        elem_type: 1,
        shape,
    });
    ValueInfo {
        name: name.into(),
        r#type: Some(Type { tensor_type }),
        ..ValueInfo::default()
    }
}

/// A policy as `torch.onnx.export` writes an actor of stable-baselines3's SAC with layers of these sizes.
fn actor(sizes: &[usize]) -> Graph {
    let mut graph = Graph {
        name: "main_graph".into(),
        input: vec![value("observation", sizes[0])],
        output: vec![value("action", sizes[sizes.len() - 1])],
        node: vec![node("Flatten", &["observation"], "f")],
        ..Graph::default()
    };
    graph.node[0].attribute = vec![whole("axis", 1)];
    let mut last = "f".to_owned();
    let mut numbers = noise(11);
    for (i, pair) in sizes.windows(2).enumerate() {
        let (weight, bias) = (
            format!("latent_pi.{i}.weight"),
            format!("latent_pi.{i}.bias"),
        );
        let mut draw = |n: usize| -> Vec<f32> {
            let bound = 1.5 / (pair[0] as f32).sqrt();
            numbers.by_ref().map(|w| bound * w).take(n).collect()
        };
        let values = draw(pair[0] * pair[1]);
        let tensors = [
            tensor(&weight, &[pair[1], pair[0]], &values),
            tensor(&bias, &[pair[1]], &draw(pair[1])),
        ];
        graph.initializer.extend(tensors);
        let (sum, active) = (format!("s{i}"), format!("a{i}"));
        let mut gemm = node("Gemm", &[&last, &weight, &bias], &sum);
        gemm.attribute = vec![whole("transB", 1)];
        graph.node.push(gemm);
        let hidden = i + 2 < sizes.len();
        let operator = if hidden { "Relu" } else { "Tanh" };
        graph.node.push(node(operator, &[&sum], &active));
        last = active;
    }
    let mut three = node("Constant", &[], "three");
    three.attribute = vec![Attribute {
        name: "value".into(),
        t: Some(tensor("", &[], &[MAX_ACCELERATION])),
        r#type: 4,
        ..Attribute::default()
    }];
    graph.node.push(three);
    graph.node.push(node("Mul", &[&last, "three"], "action"));
    graph
}

fn bytes(graph: Graph) -> Vec<u8> {
    let model = Model {
        graph: Some(graph),
        ..Model::default()
    };
    model.encode_to_vec()
}

/// What such a graph computes, by its definition in `f64`.
fn reference(graph: &Graph, features: &[f32]) -> Vec<f64> {
    let mut x: Vec<f64> = features.iter().copied().map(f64::from).collect();
    let layers = graph.initializer.as_chunks::<2>().0;
    for (i, [weight, bias]) in layers.iter().enumerate() {
        let rows = weight.float_data.chunks_exact(x.len());
        let sums = rows.zip(&bias.float_data).map(|(row, b)| {
            let products = row.iter().zip(&x).map(|(w, x)| f64::from(*w) * x);
            products.sum::<f64>() + f64::from(*b)
        });
        let last = i + 1 == layers.len();
        x = sums
            .map(|s| if last { 3.0 * s.tanh() } else { s.max(0.0) })
            .collect();
    }
    x
}

const ROUTE: Told = Told {
    features: Some(FeatureSet::Route),
    perspective: None,
};

#[test]
fn actors_of_one_to_three_hidden_layers_of_any_width_fly() {
    for sizes in [
        &[14, 64, 64, 64, 2][..],
        &[14, 24, 20, 2],
        &[14, 128, 4],
        &[14, 7, 33, 65, 1],
    ] {
        let graph = actor(sizes);
        let words = import(&bytes(graph.clone()), ROUTE).unwrap();
        let weights = Weights::parse(&words).unwrap();
        assert_eq!(weights.perspective(), Perspective::Ego);
        for seed in 0..50 {
            let x: Vec<f32> = noise(seed).map(|x| 30.0 * x).take(14).collect();
            let got = outputs(&words, &x).map(|mean| 3.0 * mean.tanh());
            let expected = reference(&graph, &x);
            for (got, expected) in got.iter().zip(expected).take(2) {
                assert!((f64::from(*got) - expected).abs() < 1e-5, "{sizes:?}");
            }
            if sizes.last() == Some(&1) {
                assert_eq!(got[1], 0.0);
            }
        }
    }
}

#[test]
fn normalisation_limits_and_separate_biases_are_understood() {
    // (x + 2) · 0.5 − 1 within ± 5, then a layer as MatMul and Add.
    let mut graph = actor(&[14, 16, 2]);
    let bound = |name: &str, f| Attribute {
        name: name.into(),
        f,
        r#type: 1,
        ..Attribute::default()
    };
    let mut clip = node("Clip", &["c"], "d");
    clip.attribute = vec![bound("min", -5.0), bound("max", 5.0)];
    let row = [0.5; 14];
    graph.initializer.extend([
        tensor("two", &[], &[2.0]),
        tensor("half", &[1, 14], &row),
        tensor("one", &[1], &[1.0]),
    ]);
    let weight = graph.initializer[0].clone();
    let transposed: Vec<f32> = (0..14 * 16)
        .map(|at| weight.float_data[at % 16 * 14 + at / 16])
        .collect();
    graph
        .initializer
        .push(tensor("columns", &[14, 16], &transposed));
    let nodes = [
        node("Add", &["two", "f"], "a"),
        node("Mul", &["a", "half"], "b"),
        node("Sub", &["b", "one"], "c"),
        clip,
        node("MatMul", &["d", "columns"], "e"),
        node("Add", &["e", "latent_pi.0.bias"], "s0"),
    ];
    graph.node.splice(1..2, nodes);
    let words = import(&bytes(graph.clone()), ROUTE).unwrap();
    for seed in 0..50 {
        let x: Vec<f32> = noise(seed).map(|x| 20.0 * x).take(14).collect();
        let seen: Vec<f32> = x
            .iter()
            .map(|x| ((x + 2.0) * 0.5 - 1.0).clamp(-5.0, 5.0))
            .collect();
        let expected = reference(
            &Graph {
                initializer: graph.initializer[..4].to_vec(),
                ..Graph::default()
            },
            &seen,
        );
        let got = 3.0 * outputs(&words, &x)[0].tanh();
        assert!((f64::from(got) - expected[0]).abs() < 1e-5);
    }
}

fn refusal(graph: Graph, told: Told) -> String {
    import(&bytes(graph), told).unwrap_err().to_string()
}

#[test]
fn what_does_not_fit_is_named() {
    let graph = || actor(&[14, 16, 2]);
    let changed = |change: fn(&mut Graph)| {
        let mut graph = graph();
        change(&mut graph);
        refusal(graph, ROUTE)
    };
    assert_eq!(
        refusal(graph(), Told::default()),
        "the file does not say which features the network is told"
    );
    let raw = Told {
        features: Some(FeatureSet::Raw),
        ..ROUTE
    };
    assert_eq!(
        refusal(graph(), raw),
        "the network takes 14 features, `raw` has 8"
    );
    let joint = Told {
        perspective: Some(Perspective::Joint),
        ..ROUTE
    };
    assert_eq!(
        refusal(actor(&[14, 16, 1]), joint),
        "1 outputs; supported are 2 or 4"
    );
    assert_eq!(
        refusal(actor(&[14, 256, 256, 2]), ROUTE),
        "hidden layer 1 has 256 neurons; at most 128 are supported"
    );
    assert_eq!(
        refusal(actor(&[14, 16, 16, 16, 16, 2]), ROUTE),
        "4 hidden layers; from 1 to 3 are supported"
    );
    // Hidden layers of tanh, as stable-baselines3's PPO has them.
    let tanh = changed(|graph| graph.node[2].op_type = "Tanh".into());
    assert!(
        tanh.starts_with("node \"/Gemm_s1\", operator Gemm: is not supported after Tanh"),
        "{tanh}"
    );
    let unknown = changed(|graph| graph.node[2].op_type = "Elu".into());
    assert!(unknown.contains("operator Elu: is not supported; supported are Gemm"));
    let factor = changed(|graph| {
        if let Some(t) = graph.node.iter_mut().find(|n| n.op_type == "Constant") {
            t.attribute[0].t = Some(tensor("", &[], &[2.0]));
        }
    });
    assert!(
        factor.ends_with("operator Mul: after Tanh only by 3 m/s²"),
        "{factor}"
    );
    let missing = changed(|graph| graph.initializer.truncate(3));
    assert!(missing.ends_with("takes \"latent_pi.1.bias\", which no earlier node gives"));
    let mut skip = actor(&[14, 14, 2]);
    skip.node[3].input[0] = "f".into();
    let skip = refusal(skip, ROUTE);
    assert!(skip.ends_with("Gemm: does not take what the node before it gives: not a chain"));
    let shape = changed(|graph| graph.initializer[0].dims = vec![14, 16]);
    assert!(
        shape.ends_with("shapes [1, 14] and [14, 16] do not fit"),
        "{shape}"
    );
    let infinite = changed(|graph| graph.initializer[0].float_data[3] = f32::INFINITY);
    assert!(infinite.ends_with("holds a number that is not finite"));
    let large = changed(|graph| graph.initializer[0].float_data[3] = 2e3);
    assert_eq!(large, "a weight is not finite or too large");
    let two = changed(|graph| graph.output.push(value("log_prob", 1)));
    assert_eq!(two, "2 outputs; exactly one is supported");
    let inputs = changed(|graph| graph.input.push(value("mask", 1)));
    assert_eq!(inputs, "2 inputs instead of one");
    let garbage = import(b"not a model", ROUTE).unwrap_err().to_string();
    assert!(garbage.starts_with("not an ONNX model"), "{garbage}");
}

proptest! {
    #[test]
    fn any_bytes_are_taken_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = import(&bytes, ROUTE);
    }

    #[test]
    fn a_damaged_graph_is_taken_or_refused(
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut bytes = bytes(actor(&[14, 16, 2]));
        for (place, byte) in damage {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        let _ = import(&bytes, ROUTE);
        let _ = import(&bytes[..cut.index(bytes.len())], ROUTE);
    }
}
