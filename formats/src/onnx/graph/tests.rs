use super::*;
use crate::onnx::proto::{
    Dimension, Graph as Encoded, Model, Node, Shape as Stated, Tensor, TensorType, Type, ValueInfo,
};

fn node(operator: &str, input: &[&str], output: &str) -> Node {
    Node {
        op_type: operator.into(),
        input: input.iter().map(|&i| i.into()).collect(),
        output: vec![output.into()],
        ..Node::default()
    }
}

fn tensor(name: &str, dims: &[i64], values: &[f32]) -> Tensor {
    Tensor {
        name: name.into(),
        dims: dims.to_vec(),
        data_type: 1,
        float_data: values.to_vec(),
        ..Tensor::default()
    }
}

fn encoded(dims: &[i64], initializer: Vec<Tensor>, node: Vec<Node>) -> Vec<u8> {
    let dim = |&dim_value: &i64| Dimension {
        dim_value,
        ..Dimension::default()
    };
    let shape = Some(Stated {
        dim: dims.iter().map(dim).collect(),
    });
    let tensor_type = Some(TensorType {
        shape,
        ..TensorType::default()
    });
    let named = |name: &str| ValueInfo {
        name: name.into(),
        ..ValueInfo::default()
    };
    let input = ValueInfo {
        r#type: Some(Type { tensor_type }),
        ..named("x")
    };
    let graph = Encoded {
        input: vec![input],
        output: vec![named("y")],
        initializer,
        node,
        ..Encoded::default()
    };
    let model = Model {
        graph: Some(graph),
        ..Model::default()
    };
    model.encode_to_vec()
}

#[test]
fn a_graph_becomes_a_list_of_typed_steps() {
    let constants = vec![
        tensor("w", &[3, 2], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        tensor("b", &[2], &[0.1, 0.2]),
        tensor("c", &[2, 1], &[7.0, 8.0]),
    ];
    let nodes = vec![
        node("Flatten", &["x"], "f"),
        node("Gemm", &["f", "w", "b"], "g"),
        node("Sub", &["c", "g"], "y"),
    ];
    let graph = read(&encoded(&[0, 3], constants, nodes)).unwrap();
    assert_eq!(graph.inputs[0].shape.dims(), [1, 3]);
    assert_eq!(graph.output, 4);
    let operations: Vec<_> = graph.steps.iter().map(|step| &step.operation).collect();
    let [Operation::Linear(linear), bias, broadcast, difference] = operations.as_slice() else {
        panic!("{operations:?}");
    };
    assert_eq!((linear.inputs(), linear.outputs()), (3, 2));
    assert_eq!(linear.terms(1), [(0, 2.0), (1, 4.0), (2, 6.0)]);
    let add = |own, other, constant| Operation::Add {
        own,
        other,
        constant,
    };
    let biases = [0.1_f32, 0.2].map(f64::from).to_vec();
    assert_eq!(**bias, add(1.0, 1.0, biases));
    assert_eq!(**broadcast, Operation::Move(vec![0, 1, 0, 1]));
    assert_eq!(**difference, add(-1.0, 1.0, vec![7.0, 7.0, 8.0, 8.0]));
    assert!(graph.steps.iter().zip(0..).all(|(s, i)| s.from == [i]));
}

#[test]
fn a_small_file_cannot_ask_for_much_memory() {
    let names: Vec<String> = (0..64).map(|i| format!("t{i}")).collect();
    let mut nodes: Vec<Node> = names
        .windows(2)
        .map(|pair| node("Transpose", &[&pair[0]], &pair[1]))
        .collect();
    nodes[0].input[0] = "x".into();
    let error = read(&encoded(&[2048, 2048], Vec::new(), nodes)).unwrap_err();
    let GraphError::Node { operator, what, .. } = error else {
        panic!("{error}");
    };
    assert_eq!(operator, "Transpose");
    assert!(what.starts_with("makes the graph too large"), "{what}");
}

#[test]
fn limits_are_named_where_they_are_passed() {
    let large = |rows: i64, columns: i64| {
        let size = (rows * columns) as usize;
        let weight = tensor("w", &[rows, columns], &vec![1.0; size]);
        read(&encoded(
            &[1, rows],
            vec![weight],
            vec![node("MatMul", &["x", "w"], "y")],
        ))
    };
    assert!(large(2048, 4096).is_ok(), "8 million weights");
    let error = large(16384, 4097).expect_err("67 million and 16384 weights");
    assert!(error.to_string().contains("2²⁶"), "{error}");
}
