//! Small networks and properties to try the verifier on: weights of every size a float can have,
//! thresholds that are met exactly, and constraints written in unusual ways; and their files.

use super::oracle::{Clause, Constraint, Dense, Problem, fraction};
use cede_formats::onnx::proto;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One as _, Signed as _, Zero as _};
use prost::Message as _;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// A problem, and the files that state it.
pub(super) struct Case {
    pub(super) problem: Problem,
    pub(super) onnx: Vec<u8>,
    pub(super) vnnlib: String,
}

/// Where numbers come from.
#[derive(Clone, Copy, PartialEq)]
enum Scale {
    /// Small multiples of a half: ties and thresholds are met exactly.
    Whole,
    /// Between −1 and 1.
    Unit,
    /// Any size that a float can have, and mostly ordinary ones.
    Mixed,
    /// Any size that a float can have.
    Any,
    /// Very small, then very large, and so on by layers.
    Turns,
}

struct Source {
    random: Pcg64,
    /// Whether weights are `f32`.
    single: bool,
    scale: Scale,
}

impl Source {
    fn below(&mut self, count: usize) -> usize {
        self.random.random_range(0..count)
    }

    fn chance(&mut self, percent: usize) -> bool {
        self.below(100) < percent
    }

    fn unit(&mut self) -> f64 {
        2.0 * self.random.random::<f64>() - 1.0
    }

    /// A number with a decimal exponent between these.
    fn sized(&mut self, low: i32, high: i32) -> f64 {
        let exponent = self.random.random_range(low..=high);
        let digits = self.unit();
        let text = format!("{digits}e{exponent}");
        let value: f64 = text.parse().expect("a number");
        if self.single {
            f64::from(value as f32)
        } else {
            value
        }
    }

    fn any(&mut self) -> f64 {
        if self.single {
            self.sized(-46, 38)
        } else {
            self.sized(-324, 300)
        }
    }

    /// A weight of the layer.
    fn weight(&mut self, layer: usize) -> f64 {
        let ordinary = self.chance(75);
        let value = match self.scale {
            Scale::Whole => 0.5 * (self.below(9) as f64 - 4.0),
            Scale::Unit => self.unit(),
            Scale::Mixed if ordinary => self.unit(),
            Scale::Mixed | Scale::Any => self.any(),
            Scale::Turns => {
                let most = if self.single { 37 } else { 290 };
                let size = self.random.random_range(0..=most);
                if layer.is_multiple_of(2) {
                    self.sized(-size, -size)
                } else {
                    self.sized(size, size)
                }
            }
        };
        if self.single {
            // Overflow would be no weight at all.
            f64::from((value as f32).clamp(f32::MIN, f32::MAX))
        } else {
            value
        }
    }

    fn layers(&mut self, inputs: usize) -> Vec<Dense> {
        let hidden = 1 + self.below(2);
        let mut widths = vec![inputs];
        widths.extend((0..hidden).map(|_| 1 + self.below(3)));
        widths.push(1 + self.below(2));
        let pairs: Vec<[usize; 2]> = widths.windows(2).map(|w| [w[0], w[1]]).collect();
        let count = pairs.len();
        let layer = |(index, [from, to]): (usize, [usize; 2])| Dense {
            weights: (0..to)
                .map(|_| (0..from).map(|_| self.weight(index)).collect())
                .collect(),
            bias: (0..to)
                .map(|_| {
                    if self.chance(30) {
                        0.0
                    } else {
                        self.weight(index)
                    }
                })
                .collect(),
            relu: index + 1 < count || self.chance(20),
        };
        pairs.into_iter().enumerate().map(layer).collect()
    }

    /// A limit of an input.
    fn limit(&mut self) -> BigRational {
        match self.below(4) {
            0 => fraction(self.weight(0)),
            1 => fraction(0.5 * (self.below(9) as f64 - 4.0)),
            // A decimal that is no float.
            2 => BigRational::new(
                BigInt::from(self.below(2001) as i64 - 1000),
                BigInt::from(700),
            )
            .round_to_decimal(7),
            _ => fraction(self.unit()),
        }
    }

    fn input(&mut self, index: usize, inputs: usize) -> [Constraint; 2] {
        let (a, b) = (self.limit(), self.limit());
        let (low, high) = match self.below(20) {
            0 => (a.clone(), a),
            // Nothing is between these; it is an empty range.
            1 => (a.clone().max(b.clone()), a.min(b)),
            _ => (a.clone().min(b.clone()), a.max(b)),
        };
        let side = |sign: i32, bound: BigRational, strict| {
            let mut coefficients = vec![BigRational::zero(); inputs];
            coefficients[index] = BigRational::from(BigInt::from(sign));
            Constraint {
                coefficients,
                bound,
                strict,
            }
        };
        [
            side(-1, -low, self.chance(20)),
            side(1, high, self.chance(20)),
        ]
    }

    /// A point of the range, often a corner.
    fn point(&mut self, ranges: &[[Constraint; 2]]) -> Vec<BigRational> {
        let share = [0, 4, self.below(5)][self.below(3)];
        let within = |[low, high]: &[Constraint; 2]| {
            let share = BigRational::new(
                BigInt::from(if self.chance(70) {
                    share
                } else {
                    4 * self.below(2)
                }),
                BigInt::from(4),
            );
            let low = -low.bound.clone();
            &low + (&high.bound - &low) * share
        };
        ranges.iter().map(within).collect()
    }

    /// A constraint on the outputs; `y` is what the network gives somewhere.
    fn output(&mut self, y: &[BigRational]) -> Constraint {
        let coefficient = |source: &mut Self| match source.below(6) {
            0 => BigRational::zero(),
            1 => fraction(source.any()),
            2 => BigRational::new(BigInt::from(source.below(21) as i64 - 10), BigInt::from(10)),
            3 => fraction(source.weight(1)),
            n => BigRational::from(BigInt::from(if n == 4 { 1 } else { -1 })),
        };
        let coefficients: Vec<BigRational> = y.iter().map(|_| coefficient(self)).collect();
        let terms = coefficients.iter().zip(y);
        let there: BigRational = terms.map(|(c, y)| c * y).sum();
        let bound = match self.below(8) {
            // Met exactly.
            0..=2 => there,
            3 => &there + fraction(self.any()),
            4 => &there * fraction(1.0 + self.unit() * 1e-15),
            5 => fraction(self.any()),
            6 => BigRational::zero(),
            _ => fraction(self.unit()),
        };
        Constraint {
            coefficients,
            bound,
            strict: self.chance(40),
        }
    }
}

trait RoundToDecimal {
    fn round_to_decimal(&self, places: u32) -> Self;
}

impl RoundToDecimal for BigRational {
    fn round_to_decimal(&self, places: u32) -> Self {
        let unit = BigRational::from(BigInt::from(10).pow(places));
        (self * &unit).round() / unit
    }
}

impl Case {
    /// The same for the same seed.
    pub(super) fn new(seed: u64) -> Self {
        let mut random = Pcg64::seed_from_u64(seed);
        let scales = [
            Scale::Whole,
            Scale::Unit,
            Scale::Mixed,
            Scale::Any,
            Scale::Turns,
        ];
        let scale = scales[random.random_range(0..scales.len())];
        let single = random.random();
        let mut source = Source {
            random,
            single,
            scale,
        };
        let inputs = 1 + source.below(2);
        let mut problem = Problem {
            inputs,
            layers: source.layers(inputs),
            clauses: Vec::new(),
        };
        let mut ranges: Vec<_> = (0..inputs).map(|i| source.input(i, inputs)).collect();
        for _ in 0..=source.below(3) {
            if source.chance(20) {
                ranges = (0..inputs).map(|i| source.input(i, inputs)).collect();
            }
            let y = problem.run(&source.point(&ranges));
            let atoms = if source.chance(3) {
                0
            } else {
                1 + source.below(2)
            };
            let outputs = (0..atoms).map(|_| source.output(&y)).collect();
            problem.clauses.push(Clause {
                inputs: ranges.concat(),
                outputs,
            });
        }
        let forms: Vec<usize> = problem.layers.iter().map(|_| source.below(FORMS)).collect();
        let onnx = onnx(&problem, single, &forms);
        let vnnlib = vnnlib(&problem, &mut source);
        Self {
            problem,
            onnx,
            vnnlib,
        }
    }
}

/// Ways to write a layer.
const FORMS: usize = 5;

/// The network as an ONNX file, in `f32` or `f64`, each layer written in one of several ways.
pub(super) fn onnx(problem: &Problem, single: bool, forms: &[usize]) -> Vec<u8> {
    let tensor = |name: String, dims: Vec<i64>, values: Vec<f64>| {
        let raw_data = if single {
            values
                .iter()
                .flat_map(|v| (*v as f32).to_le_bytes())
                .collect()
        } else {
            values.iter().flat_map(|v| v.to_le_bytes()).collect()
        };
        proto::Tensor {
            name,
            dims,
            data_type: if single { 1 } else { 11 },
            raw_data,
            ..proto::Tensor::default()
        }
    };
    let node = |operator: &str, inputs: Vec<String>, output: String| proto::Node {
        op_type: operator.to_owned(),
        input: inputs,
        output: vec![output],
        ..proto::Node::default()
    };
    let value = |name: &str, width: usize| {
        let dim = |dim_value| proto::Dimension {
            dim_value,
            ..proto::Dimension::default()
        };
        let shape = proto::Shape {
            dim: vec![dim(1), dim(width as i64)],
        };
        let tensor_type = Some(proto::TensorType {
            shape: Some(shape),
            ..proto::TensorType::default()
        });
        proto::ValueInfo {
            name: name.to_owned(),
            r#type: Some(proto::Type { tensor_type }),
            ..proto::ValueInfo::default()
        }
    };
    let mut graph = proto::Graph {
        input: vec![value("v0", problem.inputs)],
        ..proto::Graph::default()
    };
    let mut last = "v0".to_owned();
    for (i, layer) in problem.layers.iter().enumerate() {
        let (rows, columns) = (layer.weights[0].len(), layer.bias.len());
        // MatMul's constant has a column for each output.
        let columns_first = (0..rows).flat_map(|j| layer.weights.iter().map(move |row| row[j]));
        let dims = vec![rows as i64, columns as i64];
        let (weights, bias) = (format!("w{i}"), format!("b{i}"));
        graph
            .initializer
            .push(tensor(weights.clone(), dims, columns_first.collect()));
        let dims = vec![columns as i64];
        graph
            .initializer
            .push(tensor(bias.clone(), dims, layer.bias.clone()));
        graph
            .node
            .push(node("MatMul", vec![last, weights], format!("m{i}")));
        last = format!("z{i}");
        graph
            .node
            .push(node("Add", vec![format!("m{i}"), bias], last.clone()));
        let form = forms.get(i).copied().unwrap_or(0);
        if form == 1 {
            // Twice the value less the value: two branches.
            let (twice, same) = (format!("t{i}"), format!("s{i}"));
            let sum = node("Add", vec![last.clone(), last.clone()], twice.clone());
            let difference = node("Sub", vec![twice, last], same.clone());
            graph.node.extend([sum, difference]);
            last = same;
        }
        if layer.relu {
            let output = format!("r{i}");
            let activation = match form {
                2 => {
                    let mut leaky = node("LeakyRelu", vec![last], output.clone());
                    leaky.attribute = vec![proto::Attribute {
                        name: "alpha".to_owned(),
                        f: 0.0,
                        ..proto::Attribute::default()
                    }];
                    vec![leaky]
                }
                // relu(z) = z + relu(−z): a connection that skips a layer.
                3 => {
                    let (minus, below) = (format!("n{i}"), format!("d{i}"));
                    let one = tensor(format!("o{i}"), Vec::new(), vec![-1.0]);
                    graph.initializer.push(one);
                    vec![
                        node("Mul", vec![last.clone(), format!("o{i}")], minus.clone()),
                        node("Relu", vec![minus], below.clone()),
                        node("Add", vec![last, below], output.clone()),
                    ]
                }
                _ => vec![node("Relu", vec![last], output.clone())],
            };
            graph.node.extend(activation);
            last = output;
        }
    }
    graph.output = vec![value(&last, problem.outputs())];
    let model = proto::Model {
        graph: Some(graph),
        ..proto::Model::default()
    };
    model.encode_to_vec()
}

/// The exact value: a decimal if it has one, else a quotient.
fn number(value: &BigRational) -> String {
    let mut rest = value.denom().clone();
    let mut power = |prime: u32| {
        let mut count = 0;
        while (&rest % prime).is_zero() {
            rest /= prime;
            count += 1;
        }
        count
    };
    let places: u32 = power(2).max(power(5));
    let sign = if value.is_negative() { "-" } else { "" };
    if !rest.is_one() || places > 1900 {
        let (numer, denom) = (value.numer(), value.denom());
        return format!("(/ {numer} {denom})");
    }
    let digits = (value.abs() * BigInt::from(10).pow(places)).to_integer();
    format!("{sign}{digits}e-{places}")
}

/// Σ c·name_i, written in one of several ways, and the bound likewise.
fn comparison(name: char, constraint: &Constraint, source: &mut Source) -> String {
    let Constraint {
        coefficients,
        bound,
        strict,
    } = constraint;
    let nonzero = coefficients
        .iter()
        .enumerate()
        .filter(|(_, c)| !c.is_zero());
    let terms: Vec<String> = nonzero
        .map(|(i, c)| {
            let variable = format!("{name}_{i}");
            match source.below(4) {
                0 if c.is_one() => variable,
                1 => format!("(* {variable} {})", number(c)),
                2 => format!("(- (* {} {variable}))", number(&-c.clone())),
                _ => format!("(* {} {variable})", number(c)),
            }
        })
        .collect();
    let (less, greater) = if *strict { ("<", ">") } else { ("<=", ">=") };
    let sum = match terms.as_slice() {
        [] => "0".to_owned(),
        [only] => only.clone(),
        many => format!("(+ {})", many.join(" ")),
    };
    let right = number(bound);
    match source.below(6) {
        0 => format!("({greater} {right} {sum})"),
        1 => format!("({less} (- {sum} {right}) 0.0)"),
        2 => {
            // A number that swallows others in floating point comes and goes.
            let huge = ["1e17", "1e300", "123456789012345678901.5"][source.below(3)];
            format!("({less} (+ {sum} {huge} {right} (- {huge})) (+ {right} {right}))")
        }
        3 => format!("({less} {} {right})", format_args!("(+ 0.1 {sum} -0.1)")),
        4 => {
            let factor = number(&fraction(source.any().abs().max(1e-300)));
            format!("({less} (* {factor} {sum}) (* {factor} {right}))")
        }
        _ => format!("({less} {sum} {right})"),
    }
}

fn vnnlib(problem: &Problem, source: &mut Source) -> String {
    use std::fmt::Write as _;
    let mut text = String::new();
    let declared = [('X', problem.inputs), ('Y', problem.outputs())];
    for (name, count) in declared {
        for i in 0..count {
            let _ = writeln!(text, "(declare-const {name}_{i} Real)");
        }
    }
    let clauses: Vec<String> = problem
        .clauses
        .iter()
        .map(|clause| {
            let inputs = clause.inputs.iter().map(|c| ('X', c));
            let all = inputs.chain(clause.outputs.iter().map(|c| ('Y', c)));
            let all: Vec<String> = all.map(|(name, c)| comparison(name, c, source)).collect();
            format!("(and {})", all.join(" "))
        })
        .collect();
    if let ([only], true) = (problem.clauses.as_slice(), source.chance(50)) {
        for (name, all) in [('X', &only.inputs), ('Y', &only.outputs)] {
            for c in all {
                let _ = writeln!(text, "(assert {})", comparison(name, c, source));
            }
        }
    } else {
        let _ = writeln!(text, "(assert (or {}))", clauses.join("\n  "));
    }
    text
}
