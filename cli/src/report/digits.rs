//! Numbers as the page needs them, with few digits.

/// Rounded to thousandths.
pub(super) fn milli(value: f32) -> f64 {
    (f64::from(value) * 1000.0).round() / 1000.0
}

/// Rounded to hundredths, which is enough for drawing and takes a third of the bytes.
pub(super) fn centi(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}
