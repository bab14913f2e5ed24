//! The truth about a small network: every activation pattern is a system of linear inequalities,
//! which Fourier–Motzkin elimination decides in integers, strict ones told from closed ones.
//!
//! It shares nothing with the verifier or the checker: neither their numbers nor their readers.

use num_bigint::BigInt;
use num_integer::Integer as _;
use num_rational::BigRational;
use num_traits::{One as _, Signed as _, Zero as _};

/// One layer: weights by output, biases, and whether a ReLU follows.
#[derive(Clone, Debug)]
pub(super) struct Dense {
    pub(super) weights: Vec<Vec<f64>>,
    pub(super) bias: Vec<f64>,
    pub(super) relu: bool,
}

/// coefficients · v ≤ bound, or <.
#[derive(Clone, Debug)]
pub(super) struct Constraint {
    pub(super) coefficients: Vec<BigRational>,
    pub(super) bound: BigRational,
    pub(super) strict: bool,
}

impl Constraint {
    pub(super) fn holds(&self, v: &[BigRational]) -> bool {
        let terms = self.coefficients.iter().zip(v);
        let sum = terms.map(|(c, v)| c * v).sum::<BigRational>();
        sum < self.bound || sum == self.bound && !self.strict
    }
}

/// A conjunction of constraints on inputs and outputs.
#[derive(Clone, Debug)]
pub(super) struct Clause {
    pub(super) inputs: Vec<Constraint>,
    pub(super) outputs: Vec<Constraint>,
}

/// A network and a property: whether an input exists that satisfies one of the clauses.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    pub(super) inputs: usize,
    pub(super) layers: Vec<Dense>,
    pub(super) clauses: Vec<Clause>,
}

pub(super) fn fraction(value: f64) -> BigRational {
    BigRational::from_float(value).expect("a finite number")
}

impl Problem {
    pub(super) fn outputs(&self) -> usize {
        self.layers.last().map_or(self.inputs, |l| l.bias.len())
    }

    /// The exact outputs.
    pub(super) fn run(&self, x: &[BigRational]) -> Vec<BigRational> {
        self.layers.iter().fold(x.to_vec(), |x, layer| {
            let neuron = |(row, b): (&Vec<f64>, &f64)| {
                let terms = row.iter().zip(&x).map(|(w, x)| fraction(*w) * x);
                let z = terms.sum::<BigRational>() + fraction(*b);
                if layer.relu && z.is_negative() {
                    BigRational::zero()
                } else {
                    z
                }
            };
            layer.weights.iter().zip(&layer.bias).map(neuron).collect()
        })
    }

    /// Whether this input satisfies one of the clauses.
    pub(super) fn is_solved_by(&self, x: &[BigRational]) -> bool {
        let y = self.run(x);
        let holds = |all: &[Constraint], v: &[BigRational]| all.iter().all(|c| c.holds(v));
        let clauses = &mut self.clauses.iter();
        clauses.any(|c| holds(&c.inputs, x) && holds(&c.outputs, &y))
    }

    /// Whether any input satisfies one of the clauses.
    pub(super) fn has_solution(&self) -> bool {
        self.clauses.iter().any(|clause| {
            let rows: Vec<Row> = clause.inputs.iter().map(Row::of).collect();
            let unit = |i: usize| Form {
                coefficients: (0..self.inputs)
                    .map(|j| BigRational::from(BigInt::from(u8::from(i == j))))
                    .collect(),
                constant: BigRational::zero(),
            };
            self.any_pattern(
                0,
                &(0..self.inputs).map(unit).collect::<Vec<_>>(),
                rows,
                clause,
            )
        })
    }

    /// Whether some pattern of the layers from `index` on has a solution, their inputs given as
    /// forms of the network's.
    fn any_pattern(&self, index: usize, values: &[Form], rows: Vec<Row>, clause: &Clause) -> bool {
        if !feasible(rows.clone()) {
            return false;
        }
        let Some(layer) = self.layers.get(index) else {
            let atoms = clause.outputs.iter().map(|atom| {
                let form = Form::sum(&atom.coefficients, values, -atom.bound.clone());
                form.at_most_zero(atom.strict)
            });
            return feasible(rows.into_iter().chain(atoms).collect());
        };
        let exact = |row: &Vec<f64>| row.iter().map(|w| fraction(*w)).collect::<Vec<_>>();
        let neurons = layer.weights.iter().zip(&layer.bias);
        let forms: Vec<Form> = neurons
            .map(|(row, b)| Form::sum(&exact(row), values, fraction(*b)))
            .collect();
        if !layer.relu {
            return self.any_pattern(index + 1, &forms, rows, clause);
        }
        (0_u32..1 << forms.len()).any(|pattern| {
            let mut rows = rows.clone();
            let mut values = forms.clone();
            for (i, (form, value)) in forms.iter().zip(&mut values).enumerate() {
                if pattern >> i & 1 == 1 {
                    rows.push(form.negated().at_most_zero(false));
                } else {
                    rows.push(form.at_most_zero(false));
                    *value = form.scaled(&BigRational::zero());
                }
            }
            self.any_pattern(index + 1, &values, rows, clause)
        })
    }
}

/// coefficients · x + constant.
#[derive(Clone)]
struct Form {
    coefficients: Vec<BigRational>,
    constant: BigRational,
}

impl Form {
    fn sum(factors: &[BigRational], forms: &[Form], constant: BigRational) -> Self {
        let width = forms[0].coefficients.len();
        let terms = || factors.iter().zip(forms);
        let column = |j: usize| terms().map(|(f, form)| f * &form.coefficients[j]).sum();
        Self {
            coefficients: (0..width).map(column).collect(),
            constant: terms().fold(constant, |sum, (f, form)| sum + f * &form.constant),
        }
    }

    fn scaled(&self, factor: &BigRational) -> Self {
        Self {
            coefficients: self.coefficients.iter().map(|c| c * factor).collect(),
            constant: &self.constant * factor,
        }
    }

    fn negated(&self) -> Self {
        self.scaled(&-BigRational::one())
    }

    fn at_most_zero(&self, strict: bool) -> Row {
        let all = || self.coefficients.iter().chain([&self.constant]);
        let unit = all().fold(BigInt::one(), |unit, c| unit.lcm(c.denom()));
        let whole: Vec<BigInt> = all().map(|c| c.numer() * (&unit / c.denom())).collect();
        Row { whole, strict }
    }
}

/// Integers c and d, last, of c·x + d ≤ 0, or < 0.
#[derive(Clone)]
struct Row {
    whole: Vec<BigInt>,
    strict: bool,
}

impl Row {
    fn of(constraint: &Constraint) -> Self {
        let form = Form {
            coefficients: constraint.coefficients.clone(),
            constant: -constraint.bound.clone(),
        };
        form.at_most_zero(constraint.strict)
    }

    /// The positive combination of two rows that is free of a variable.
    fn eliminated(above: &Self, below: &Self, variable: usize) -> Self {
        let (p, n) = (&above.whole[variable], -&below.whole[variable]);
        let pairs = above.whole.iter().zip(&below.whole);
        let whole: Vec<BigInt> = pairs.map(|(a, b)| a * &n + b * p).collect();
        let common = whole.iter().fold(BigInt::zero(), |g, c| g.gcd(c));
        Self {
            whole: if common > BigInt::one() {
                whole.iter().map(|c| c / &common).collect()
            } else {
                whole
            },
            strict: above.strict || below.strict,
        }
    }
}

/// Whether some real x satisfies all rows.
fn feasible(mut rows: Vec<Row>) -> bool {
    let variables = rows.first().map_or(0, |row| row.whole.len() - 1);
    for variable in 0..variables {
        let (with, mut rest): (Vec<Row>, Vec<Row>) = rows
            .into_iter()
            .partition(|row| !row.whole[variable].is_zero());
        let (above, below): (Vec<Row>, Vec<Row>) = with
            .into_iter()
            .partition(|row| row.whole[variable].is_positive());
        for a in &above {
            rest.extend(below.iter().map(|b| Row::eliminated(a, b, variable)));
        }
        rows = rest;
    }
    rows.iter().all(|row| {
        let constant = &row.whole[variables];
        constant.is_negative() || constant.is_zero() && !row.strict
    })
}

#[test]
fn strict_and_closed_inequalities_differ_where_they_meet() {
    let half = |c: i64, bound: i64, strict| Constraint {
        coefficients: vec![BigRational::from(BigInt::from(c))],
        bound: BigRational::from(BigInt::from(bound)),
        strict,
    };
    // y = relu(x) on [0, 1], and whether y ≤ 0, y < 0, y ≥ 1, y > 1.
    for (output, solved) in [
        (half(1, 0, false), true),
        (half(1, 0, true), false),
        (half(-1, -1, false), true),
        (half(-1, -1, true), false),
    ] {
        let problem = Problem {
            inputs: 1,
            layers: vec![Dense {
                weights: vec![vec![1.0]],
                bias: vec![0.0],
                relu: true,
            }],
            clauses: vec![Clause {
                inputs: vec![half(1, 1, false), half(-1, 0, false)],
                outputs: vec![output],
            }],
        };
        assert_eq!(problem.has_solution(), solved);
    }
}
