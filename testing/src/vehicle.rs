//! What the vehicle really achieves, to be held against what its contract counts on.

use cede_controller::{Contract, ContractError, Footprint};

/// The measured numbers of a vehicle. A number that is left out is taken from the contract.
///
/// ```
/// use cede_controller::Footprint;
/// use cede_testing::Vehicle;
///
/// let vehicle = Vehicle::new(Footprint { length: 4.6, width: 1.9 }).braking(4.0).latency(0.08);
/// assert_eq!(vehicle.braking, Some(4.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Vehicle {
    /// What it covers; both sides in (0, 40] m.
    pub footprint: Footprint,
    /// Braking that it achieves on the worst road that is allowed, in m/s², above 0.
    pub braking: Option<f32>,
    /// Acceleration that it achieves fully loaded, in m/s², above 0.
    pub acceleration: Option<f32>,
    /// Longest time in s from a command to its effect, in [0, 10].
    pub latency: Option<f32>,
    /// Longest time in s by which a call is off the grid of periods, in [0, 1].
    pub jitter: Option<f32>,
    /// Largest error of a sensed arc length in m, in [0, 10].
    pub position_error: Option<f32>,
    /// Largest error of a sensed speed in m/s, in [0, 10].
    pub speed_error: Option<f32>,
}

impl Vehicle {
    /// A vehicle that achieves what its contract says.
    #[must_use]
    pub const fn new(footprint: Footprint) -> Self {
        Self {
            footprint,
            braking: None,
            acceleration: None,
            latency: None,
            jitter: None,
            position_error: None,
            speed_error: None,
        }
    }

    /// Sets [`Vehicle::braking`] (m/s²).
    #[must_use]
    pub const fn braking(mut self, braking: f32) -> Self {
        self.braking = Some(braking);
        self
    }

    /// Sets [`Vehicle::acceleration`] (m/s²).
    #[must_use]
    pub const fn acceleration(mut self, acceleration: f32) -> Self {
        self.acceleration = Some(acceleration);
        self
    }

    /// Sets [`Vehicle::latency`] (s).
    #[must_use]
    pub const fn latency(mut self, latency: f32) -> Self {
        self.latency = Some(latency);
        self
    }

    /// Sets [`Vehicle::jitter`] (s).
    #[must_use]
    pub const fn jitter(mut self, jitter: f32) -> Self {
        self.jitter = Some(jitter);
        self
    }

    /// Sets [`Vehicle::position_error`] (m).
    #[must_use]
    pub const fn position_error(mut self, position_error: f32) -> Self {
        self.position_error = Some(position_error);
        self
    }

    /// Sets [`Vehicle::speed_error`] (m/s).
    #[must_use]
    pub const fn speed_error(mut self, speed_error: f32) -> Self {
        self.speed_error = Some(speed_error);
        self
    }

    /// The first number that is out of its range, as in `braking = -4 is outside (0, 20]`.
    ///
    /// # Errors
    /// That sentence.
    pub fn check(&self) -> Result<(), String> {
        let ranges = [
            ("length", Some(self.footprint.length), 0.0, 40.0, true),
            ("width", Some(self.footprint.width), 0.0, 40.0, true),
            ("braking", self.braking, 0.0, 20.0, true),
            ("acceleration", self.acceleration, 0.0, 20.0, true),
            ("latency", self.latency, 0.0, 10.0, false),
            ("jitter", self.jitter, 0.0, 1.0, false),
            ("position_error", self.position_error, 0.0, 10.0, false),
            ("speed_error", self.speed_error, 0.0, 10.0, false),
        ];
        for (name, value, low, high, open) in ranges {
            let Some(value) = value else { continue };
            let above = if open { value > low } else { value >= low };
            if !(above && value <= high) {
                let bracket = if open { '(' } else { '[' };
                return Err(format!(
                    "{name} = {value} is outside {bracket}{low}, {high}]"
                ));
            }
        }
        Ok(())
    }

    /// The numbers of a contract that are bolder than this vehicle, in the order in which they matter.
    #[must_use]
    pub fn bolder(&self, contract: &Contract) -> Vec<Bold> {
        let ego = contract.ego();
        let more = |field, contract: f32, vehicle: Option<f32>, measured| {
            let vehicle = vehicle.filter(|vehicle| contract > *vehicle)?;
            Some(Bold {
                field,
                contract,
                vehicle,
                measured,
            })
        };
        let less = |field, contract: f32, vehicle: Option<f32>, measured| {
            let vehicle = vehicle.filter(|vehicle| contract < *vehicle)?;
            Some(Bold {
                field,
                contract,
                vehicle,
                measured,
            })
        };
        [
            more("ego.braking", ego.braking, self.braking, "braking"),
            less("latency", contract.latency(), self.latency, "latency"),
            more("ego.go", ego.go, self.acceleration, "acceleration"),
            more(
                "ego.acceleration",
                ego.acceleration,
                self.acceleration,
                "acceleration",
            ),
            less(
                "position_error",
                contract.position_error(),
                self.position_error,
                "position_error",
            ),
            less(
                "speed_error",
                contract.speed_error(),
                self.speed_error,
                "speed_error",
            ),
            less("jitter", contract.jitter(), self.jitter, "jitter"),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}

impl From<Footprint> for Vehicle {
    fn from(footprint: Footprint) -> Self {
        Self::new(footprint)
    }
}

/// A number of a contract that is bolder than the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Bold {
    /// Path of the contract's field, as in `ego.braking`.
    pub field: &'static str,
    /// What the contract counts on, in the field's unit.
    pub contract: f32,
    /// What the vehicle achieves, in the same unit.
    pub vehicle: f32,
    /// Name of the vehicle's number.
    measured: &'static str,
}

impl Bold {
    /// `contract` with this number changed to what the vehicle achieves.
    ///
    /// # Errors
    /// The number of the contract that has to change as well.
    pub fn mend(&self, contract: &Contract) -> Result<Contract, ContractError> {
        mend(contract, std::slice::from_ref(self))
    }
}

/// `contract` with all these numbers changed to what the vehicle achieves.
///
/// # Errors
/// The number of the contract that has to change as well.
pub fn mend(contract: &Contract, bold: &[Bold]) -> Result<Contract, ContractError> {
    let mut builder = contract.to_builder();
    for Bold { field, vehicle, .. } in bold {
        builder = match *field {
            "ego.braking" => builder.ego_braking(*vehicle),
            "latency" => builder.latency(*vehicle),
            // No command is harder than what is achieved, and `go` is one.
            "ego.go" => builder.ego_go(*vehicle),
            "ego.acceleration" => builder
                .ego_acceleration(*vehicle)
                .ego_go(contract.ego().go.min(*vehicle)),
            "position_error" => builder.position_error(*vehicle),
            "speed_error" => builder.speed_error(*vehicle),
            _ => builder.jitter(*vehicle),
        };
    }
    builder.build()
}

impl std::fmt::Display for Bold {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            field,
            contract,
            vehicle,
            measured,
        } = self;
        write!(
            f,
            "change {field} in the contract from {contract} to {vehicle}: the vehicle's {measured} is {vehicle}"
        )
    }
}

/// What is true of the vehicle in a closed loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Truth {
    pub(crate) braking: f64,
    pub(crate) acceleration: f64,
    pub(crate) latency: f64,
    pub(crate) jitter: f64,
    pub(crate) position_error: f64,
    pub(crate) speed_error: f64,
}

impl Truth {
    /// The vehicle as it was measured.
    pub(crate) fn measured(vehicle: &Vehicle, contract: &Contract) -> Self {
        let of = |measured: Option<f32>, otherwise: f32| f64::from(measured.unwrap_or(otherwise));
        let ego = contract.ego();
        Self {
            braking: of(vehicle.braking, ego.braking),
            acceleration: of(vehicle.acceleration, ego.acceleration),
            latency: of(vehicle.latency, contract.latency()),
            jitter: of(vehicle.jitter, contract.jitter()),
            position_error: of(vehicle.position_error, contract.position_error()),
            speed_error: of(vehicle.speed_error, contract.speed_error()),
        }
    }

    /// A vehicle that just keeps the contract.
    pub(crate) fn as_contracted(contract: &Contract) -> Self {
        let footprint = Footprint::PAPER;
        Self::measured(&Vehicle::new(footprint), contract)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_bolder_than_the_vehicle_are_named_with_their_mend() {
        let contract = Contract::builder().ego_braking(6.0).build().unwrap();
        let vehicle = Vehicle::new(Footprint::PAPER).braking(4.0).latency(0.05);
        let bold = vehicle.bolder(&contract);
        assert_eq!(bold.len(), 1);
        assert_eq!(
            bold[0].to_string(),
            "change ego.braking in the contract from 6 to 4: the vehicle's braking is 4"
        );
        let mended = bold[0].mend(&contract).unwrap();
        assert_eq!(mended.ego().braking, 4.0);
        assert!(vehicle.bolder(&mended).is_empty());
    }

    #[test]
    fn a_mend_that_is_not_enough_names_the_other_number() {
        let vehicle = Vehicle::new(Footprint::PAPER).latency(1.2);
        let bold = vehicle.bolder(&Contract::WORST_CASE);
        let error = bold[0].mend(&Contract::WORST_CASE).unwrap_err();
        assert_eq!(error.field(), "latency");
    }

    #[test]
    fn numbers_out_of_range_are_named() {
        let vehicle = Vehicle::new(Footprint::PAPER).braking(-4.0);
        assert_eq!(
            vehicle.check().unwrap_err(),
            "braking = -4 is outside (0, 20]"
        );
        let nan = Vehicle::new(Footprint::PAPER).latency(f32::NAN);
        assert!(nan.check().is_err());
    }
}
