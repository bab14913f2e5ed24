//! Numbers as the page needs them, with few digits.

use cede_data::Participant;

/// Rounded to thousandths.
pub(super) fn milli(value: f32) -> f64 {
    (f64::from(value) * 1000.0).round() / 1000.0
}

/// Rounded to hundredths, which is enough for drawing and takes a third of the bytes.
pub(super) fn centi(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

/// The points of a vehicle's route.
pub(super) fn route(vehicle: &Participant) -> Vec<[f64; 2]> {
    let points = vehicle.route.points().iter();
    points
        .map(|p| [p.x, p.y].map(|c| centi(f64::from(c))))
        .collect()
}
