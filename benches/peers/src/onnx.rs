//! The network as an ONNX model: a Gemm and a Relu for each layer but the last, which has a Gemm alone.

use crate::{INPUTS, Layer, OUTPUTS};
use prost::Message;
use tract_onnx::pb::tensor_shape_proto::{Dimension, dimension::Value};
use tract_onnx::pb::{
    GraphProto, ModelProto, NodeProto, OperatorSetIdProto, TensorProto, TensorShapeProto,
    TypeProto, ValueInfoProto, tensor_proto::DataType, type_proto,
};

/// The model's bytes; its input is `x`, its output `y`.
#[must_use]
pub fn onnx(layers: &[Layer]) -> Vec<u8> {
    let mut graph = GraphProto {
        name: "policy".into(),
        input: vec![value("x", INPUTS)],
        output: vec![value("y", OUTPUTS)],
        ..Default::default()
    };
    let mut from = "x".to_owned();
    for (i, layer) in layers.iter().enumerate() {
        let last = i + 1 == layers.len();
        let (weights, biases) = (format!("w{i}"), format!("b{i}"));
        graph
            .initializer
            .push(tensor(&weights, &layer.shape, &layer.weights));
        graph
            .initializer
            .push(tensor(&biases, &layer.shape[1..], &layer.biases));
        let to = if last {
            "y".to_owned()
        } else {
            format!("z{i}")
        };
        graph
            .node
            .push(node("Gemm", vec![from, weights, biases], &to));
        from = to;
        if !last {
            let to = format!("a{i}");
            graph.node.push(node("Relu", vec![from], &to));
            from = to;
        }
    }
    let model = ModelProto {
        ir_version: 8,
        opset_import: vec![OperatorSetIdProto {
            domain: String::new(),
            version: 13,
        }],
        graph: Some(graph),
        ..Default::default()
    };
    model.encode_to_vec()
}

fn node(operator: &str, input: Vec<String>, output: &str) -> NodeProto {
    NodeProto {
        op_type: operator.into(),
        name: output.into(),
        input,
        output: vec![output.into()],
        ..Default::default()
    }
}

fn tensor(name: &str, shape: &[usize], data: &[f32]) -> TensorProto {
    TensorProto {
        name: name.into(),
        dims: shape.iter().map(|&n| n as i64).collect(),
        data_type: DataType::Float as i32,
        float_data: data.to_vec(),
        ..Default::default()
    }
}

fn value(name: &str, length: usize) -> ValueInfoProto {
    let dimension = |n: usize| Dimension {
        value: Some(Value::DimValue(n as i64)),
        ..Default::default()
    };
    ValueInfoProto {
        name: name.into(),
        r#type: Some(TypeProto {
            value: Some(type_proto::Value::TensorType(type_proto::Tensor {
                elem_type: DataType::Float as i32,
                shape: Some(TensorShapeProto {
                    dim: vec![dimension(1), dimension(length)],
                }),
            })),
            ..Default::default()
        }),
        ..Default::default()
    }
}
