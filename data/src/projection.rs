//! From degrees to the site's metres: how the Lanelet2 maps of the recordings are laid out.
//!
//! Transverse Mercator on WGS 84, UTM zone 31, seen from (0°, 0°): Krüger's
//! series as in Karney, *Transverse Mercator with an accuracy of a few
//! nanometers* (2011), to the fourth order, which is exact to a micrometre here.

const SEMI_MAJOR_AXIS: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;
const SCALE: f64 = 0.9996;
const CENTRAL_MERIDIAN_DEGREES: f64 = 3.0;

/// Metres east and north of (0°, 0°) of a latitude and longitude in degrees.
#[must_use]
pub fn to_metres(latitude: f64, longitude: f64) -> [f64; 2] {
    let [origin_x, origin_y] = mercator(0.0, 0.0);
    let [x, y] = mercator(latitude, longitude);
    [x - origin_x, y - origin_y]
}

/// Latitude and longitude in degrees of a point in metres, within some kilometres of the origin.
///
/// Newton's method on [`to_metres`] with the derivative at the origin; exact to a nanometre.
#[must_use]
pub fn to_degrees(point: [f64; 2]) -> [f64; 2] {
    let small = 1e-3;
    let [ax, ay] = to_metres(small, 0.0).map(|metres| metres / small);
    let [bx, by] = to_metres(0.0, small).map(|metres| metres / small);
    let determinant = ax * by - bx * ay;
    let (mut latitude, mut longitude) = (0.0, 0.0);
    for _ in 0..8 {
        let [x, y] = to_metres(latitude, longitude);
        let (dx, dy) = (point[0] - x, point[1] - y);
        latitude += (dx * by - dy * bx) / determinant;
        longitude += (dy * ax - dx * ay) / determinant;
    }
    [latitude, longitude]
}

fn mercator(latitude: f64, longitude: f64) -> [f64; 2] {
    let n = FLATTENING / (2.0 - FLATTENING);
    let radius = SEMI_MAJOR_AXIS / (1.0 + n) * (1.0 + n.powi(2) / 4.0 + n.powi(4) / 64.0);
    let series = [
        n / 2.0 - 2.0 / 3.0 * n.powi(2) + 5.0 / 16.0 * n.powi(3) + 41.0 / 180.0 * n.powi(4),
        13.0 / 48.0 * n.powi(2) - 3.0 / 5.0 * n.powi(3) + 557.0 / 1440.0 * n.powi(4),
        61.0 / 240.0 * n.powi(3) - 103.0 / 140.0 * n.powi(4),
        49_561.0 / 161_280.0 * n.powi(4),
    ];
    let eccentricity = 2.0 * n.sqrt() / (1.0 + n);
    let sine = latitude.to_radians().sin();
    let (sin, cos) = (longitude - CENTRAL_MERIDIAN_DEGREES)
        .to_radians()
        .sin_cos();
    let conformal = (sine.atanh() - eccentricity * (eccentricity * sine).atanh()).sinh();
    let xi = conformal.atan2(cos);
    let eta = (sin / conformal.hypot(1.0)).atanh();
    let (mut north, mut east) = (xi, eta);
    for (order, term) in (1..).zip(series) {
        let k = 2.0 * f64::from(order);
        north += term * (k * xi).sin() * (k * eta).cosh();
        east += term * (k * xi).cos() * (k * eta).sinh();
    }
    [SCALE * radius * east, SCALE * radius * north]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_origin_lies_where_the_standard_has_it() {
        // UTM zone 31 at (0°, 0°): easting 166 021.443 m with the false easting of 500 km.
        let [x, y] = mercator(0.0, 0.0);
        assert!((x + 500_000.0 - 166_021.443_1).abs() < 1e-4, "{x}");
        assert!(y.abs() < 1e-9);
    }

    #[test]
    fn degrees_and_metres_are_inverse() {
        for point in [
            [0.0, 0.0],
            [1000.0, 1000.0],
            [-3000.0, 500.0],
            [20.5, -8000.0],
        ] {
            let [latitude, longitude] = to_degrees(point);
            let [x, y] = to_metres(latitude, longitude);
            assert!((x - point[0]).hypot(y - point[1]) < 1e-8, "{point:?}");
        }
    }
}
