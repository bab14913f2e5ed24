//! The hyperbolic tangent and the angle of a point by micromath: fewer instructions, more error.
//!
//! Total: whatever the bits of the arguments, the result is a number within the function's range.

use core::f32::consts::{FRAC_PI_2, PI};
use micromath::F32Ext;

/// From here on, tanh is 1 to the last bit.
const SATURATED: f32 = 10.0;

/// The hyperbolic tangent, within ±1; −1 of what is not a number. The error is at most 3.4 · 10⁻⁴.
pub(crate) fn tanh(x: f32) -> f32 {
    // The sign of what is not a number differs between processors.
    let x = if x.is_nan() { -SATURATED } else { x };
    let size = x.abs();
    let e = F32Ext::exp(2.0 * if size < SATURATED { size } else { SATURATED });
    ((e - 1.0) / (e + 1.0)).copysign(x)
}

/// The angle (rad) of the point (`x`, `y`), within ±π; 0 or ±π if the quotient of the two is not a number.
/// The error is at most 2.9 · 10⁻³.
pub(crate) fn atan2(y: f32, x: f32) -> f32 {
    let (rise, run) = (y.abs(), x.abs());
    let steep = rise > run;
    let slope = if steep { run / rise } else { rise / run };
    // micromath's own atan2 multiplies its arguments: 0, or what overflows, then gives what is not a number.
    let octant = F32Ext::atan(if slope <= 1.0 { slope } else { 0.0 });
    let quadrant = if steep { FRAC_PI_2 - octant } else { octant };
    let half = if x < 0.0 { PI - quadrant } else { quadrant };
    if y.is_nan() { half } else { half.copysign(y) }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    const ALL: u64 = 1 << 32;

    /// The largest error over every `step`-th float.
    fn worst(step: u64, error: impl Fn(f32) -> f64 + Sync) -> f64 {
        let threads = std::thread::available_parallelism().map_or(1, usize::from) as u64;
        let part = |first: u64| {
            (first * step..ALL)
                .step_by((threads * step) as usize)
                .map(|bits| error(f32::from_bits(bits as u32)))
                .fold(0.0, f64::max)
        };
        let part = &part;
        std::thread::scope(|scope| {
            let parts: Vec<_> = (0..threads)
                .map(|first| scope.spawn(move || part(first)))
                .collect();
            let worst = parts.into_iter().map(|it| it.join().unwrap());
            worst.fold(0.0, f64::max)
        })
    }

    fn error_of_tanh(x: f32) -> f64 {
        let value = tanh(x);
        assert!((-1.0..=1.0).contains(&value), "{x}: {value}");
        if x.is_nan() {
            return 0.0;
        }
        (f64::from(value) - f64::from(x).tanh()).abs()
    }

    fn error_of_atan2(y: f32, x: f32) -> f64 {
        let value = atan2(y, x);
        assert!((-PI..=PI).contains(&value), "{y}, {x}: {value}");
        if x.is_nan() || y.is_nan() || (x.is_infinite() && y.is_infinite()) {
            return 0.0;
        }
        // Of ±0 micromath's sign is that of +0.
        let x = if x == 0.0 { 0.0 } else { f64::from(x) };
        (f64::from(value) - f64::from(y).atan2(x)).abs()
    }

    fn tanh_over(step: u64) {
        let worst = worst(step, error_of_tanh);
        std::println!("tanh: {worst:.3e}");
        assert!(worst <= 3.4e-4, "{worst}");
    }

    fn atan2_over(step: u64) {
        let worst = worst(step, |x| error_of_atan2(x, 1.0));
        std::println!("atan2: {worst:.3e}");
        assert!(worst <= 2.9e-3, "{worst}");
    }

    #[test]
    fn errors_are_as_stated() {
        tanh_over(4099);
        atan2_over(4099);
    }

    #[test]
    #[ignore = "minutes"]
    fn tanh_errs_as_stated_over_all_floats() {
        tanh_over(1);
    }

    #[test]
    #[ignore = "minutes"]
    fn atan2_errs_as_stated_over_all_floats() {
        atan2_over(1);
    }

    #[test]
    fn the_error_of_an_angle_depends_on_the_slope_alone() {
        // Every 2²²-th float, of either sign, zeros, subnormal numbers, infinities and NaNs among them.
        let floats = || (0..1024_u32).map(|i| f32::from_bits(i << 22));
        for (y, x) in floats().flat_map(|y| floats().map(move |x| (y, x))) {
            let error = error_of_atan2(y, x);
            assert!(error <= 2.9e-3, "{y}, {x}: {error}");
        }
    }
}
