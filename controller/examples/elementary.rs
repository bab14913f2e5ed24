//! The error of the elementary functions in use, and of micromath's beside them, over every `f32` there is.
//!
//! `cargo run --release -p cede-controller --example elementary` (minutes; all cores). The reference is the
//! standard library's `f64`. A unit in the last place (ulp) is that of the exact result, rounded to `f32`.

use micromath::F32Ext;
use std::hint::black_box;
use std::time::Instant;

struct Function {
    name: &'static str,
    approximate: fn(f32) -> f32,
    exact: fn(f64) -> f64,
}

/// micromath has no tanh: by its exponential, where that does not overflow.
fn micromath_tanh(x: f32) -> f32 {
    let e = F32Ext::exp(2.0 * x.clamp(-10.0, 10.0));
    (e - 1.0) / (e + 1.0)
}

const FUNCTIONS: [Function; 4] = [
    Function {
        name: "tanh, libm (in use)",
        approximate: libm::tanhf,
        exact: f64::tanh,
    },
    Function {
        name: "tanh, micromath's exp",
        approximate: micromath_tanh,
        exact: f64::tanh,
    },
    Function {
        name: "atan2(x, 1), libm (in use)",
        approximate: |x| libm::atan2f(x, 1.0),
        exact: f64::atan,
    },
    Function {
        name: "atan2(x, 1), micromath",
        approximate: |x| F32Ext::atan2(x, 1.0),
        exact: f64::atan,
    },
];

#[derive(Default)]
struct Error {
    absolute: f64,
    ulps: f64,
    /// How often a larger argument gives a smaller value.
    falls: u64,
    /// How often the value of a number is not a number.
    broken: u64,
}

impl Function {
    /// Over the floats with the bit patterns in `patterns`, which all have one sign.
    fn error(&self, patterns: std::ops::RangeInclusive<u32>) -> Error {
        let mut error = Error::default();
        let mut last: Option<f32> = None;
        for x in patterns.map(f32::from_bits) {
            let (value, exact) = ((self.approximate)(x), (self.exact)(x.into()));
            if value.is_nan() {
                error.broken += 1;
                continue;
            }
            let difference = (f64::from(value) - exact).abs();
            error.absolute = error.absolute.max(difference);
            error.ulps = error.ulps.max(difference / ulp(exact));
            if last.is_some_and(|last| value.abs() < last.abs()) {
                error.falls += 1;
            }
            last = Some(value);
        }
        error
    }

    fn over_all(&self) -> Error {
        let threads = std::thread::available_parallelism().map_or(1, usize::from) as u32;
        let infinity = f32::INFINITY.to_bits();
        let share = infinity / threads;
        std::thread::scope(|scope| {
            let parts: Vec<_> = [0, 1 << 31]
                .into_iter()
                .flat_map(|sign| (0..threads).map(move |i| (sign, i)))
                .map(|(sign, i)| {
                    // Neighbouring parts share a float, so that no fall between them is missed.
                    let end = if i + 1 == threads {
                        infinity
                    } else {
                        (i + 1) * share
                    };
                    scope.spawn(move || self.error(sign + i * share..=sign + end))
                })
                .collect();
            parts
                .into_iter()
                .map(|part| part.join().expect("no part panics"))
                .fold(Error::default(), |a, b| Error {
                    absolute: a.absolute.max(b.absolute),
                    ulps: a.ulps.max(b.ulps),
                    falls: a.falls + b.falls,
                    broken: a.broken + b.broken,
                })
        })
    }

    /// Nanoseconds a call, the best of many rounds.
    fn time(&self) -> f64 {
        let inputs: Vec<f32> = (0..1000).map(|i| i as f32 * 0.006 - 3.0).collect();
        let round = || {
            let start = Instant::now();
            for &x in &inputs {
                black_box((self.approximate)(black_box(x)));
            }
            start.elapsed().as_secs_f64() * 1e9 / inputs.len() as f64
        };
        (0..2000).map(|_| round()).fold(f64::INFINITY, f64::min)
    }
}

fn ulp(exact: f64) -> f64 {
    let rounded = (exact.abs() as f32).max(f32::MIN_POSITIVE);
    f64::from(f32::from_bits(rounded.to_bits() + 1)) - f64::from(rounded)
}

fn main() {
    println!(
        "{:28} {:>10} {:>10} {:>10} {:>10} {:>8}",
        "", "absolute", "ulps", "falls", "broken", "ns"
    );
    for function in &FUNCTIONS {
        let (error, time) = (function.over_all(), function.time());
        println!(
            "{:28} {:10.2e} {:10.3} {:10} {:10} {:8.1}",
            function.name, error.absolute, error.ulps, error.falls, error.broken, time
        );
    }
}
