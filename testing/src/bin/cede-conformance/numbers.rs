//! A vehicle on the command line.

use cede_controller::Footprint;
use cede_testing::Vehicle;

/// The vehicle of `length=4.6,width=1.9,…`.
///
/// # Errors
/// A sentence with the key and its value.
pub(crate) fn vehicle(text: &str) -> Result<Vehicle, String> {
    let mut vehicle = Vehicle::new(Footprint::PAPER);
    for pair in text
        .split(',')
        .map(str::trim)
        .filter(|pair| !pair.is_empty())
    {
        let (key, value) = pair
            .split_once('=')
            .ok_or_else(|| format!("--vehicle: `{pair}` is not KEY=VALUE"))?;
        let number = value
            .trim()
            .parse()
            .map_err(|_| format!("--vehicle: {key} = `{value}` is not a number"))?;
        vehicle = set(vehicle, key.trim(), number)?;
    }
    vehicle
        .check()
        .map_err(|error| format!("--vehicle: {error}"))?;
    Ok(vehicle)
}

fn set(mut vehicle: Vehicle, key: &str, number: f32) -> Result<Vehicle, String> {
    match key {
        "length" => vehicle.footprint.length = number,
        "width" => vehicle.footprint.width = number,
        "braking" => vehicle.braking = Some(number),
        "acceleration" => vehicle.acceleration = Some(number),
        "latency" => vehicle.latency = Some(number),
        "jitter" => vehicle.jitter = Some(number),
        "position_error" => vehicle.position_error = Some(number),
        "speed_error" => vehicle.speed_error = Some(number),
        _ => {
            return Err(format!(
                "--vehicle: there is no `{key}`; there are length, width, braking, acceleration, latency, jitter, \
                 position_error, speed_error"
            ));
        }
    }
    Ok(vehicle)
}
