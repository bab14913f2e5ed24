//! Vehicles and tracks as they are sensed.

use crate::error::error;
use crate::names::class_named;
use cede_controller::geometry::{Point, Pose, unit};
use cede_controller::{MAX_CANDIDATES, PathId, Track as Sensed, Vehicle as State};
use pyo3::prelude::*;

/// A vehicle as it is sensed on a path.
#[pyclass(frozen, get_all, eq, module = "cede", from_py_object)]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Vehicle {
    pub(crate) s: f32,
    pub(crate) speed: f32,
    pub(crate) x: f32,
    pub(crate) y: f32,
    pub(crate) heading: f32,
}

#[pymethods]
impl Vehicle {
    #[new]
    fn new(s: f32, speed: f32, x: f32, y: f32, heading: f32) -> Self {
        Self {
            s,
            speed,
            x,
            y,
            heading,
        }
    }

    fn __repr__(&self) -> String {
        let Self {
            s,
            speed,
            x,
            y,
            heading,
        } = self;
        format!("Vehicle(s={s}, speed={speed}, x={x}, y={y}, heading={heading})")
    }
}

impl Vehicle {
    pub(crate) fn at(s: f32, speed: f32, pose: Pose) -> Self {
        let Pose {
            position,
            direction,
        } = pose;
        let heading = direction.y.atan2(direction.x);
        Self {
            s,
            speed,
            x: position.x,
            y: position.y,
            heading,
        }
    }

    pub(crate) fn state(&self) -> State {
        let direction = unit(self.heading.cos(), self.heading.sin());
        State {
            s: self.s,
            speed: self.speed,
            pose: Pose {
                position: Point::new(self.x, self.y),
                direction,
            },
        }
    }
}

/// Another vehicle, as tracking reports it.
#[pyclass(frozen, module = "cede", from_py_object)]
#[derive(Clone, Copy)]
pub(crate) struct Track(pub(crate) Sensed);

#[pymethods]
impl Track {
    #[new]
    #[pyo3(signature = (number, path, vehicle, *, kind = "car", or_on = Vec::new()))]
    fn new(
        number: u16,
        path: u8,
        vehicle: Vehicle,
        kind: &str,
        or_on: Vec<(u8, f32)>,
    ) -> PyResult<Self> {
        let mut track =
            Sensed::on(number, PathId::new(path), vehicle.state()).class(class_named(kind)?);
        for (path, s) in or_on {
            track = track.or(PathId::new(path), s).ok_or_else(|| {
                error(format!(
                    "track {number}: more than {MAX_CANDIDATES} paths that it may be on"
                ))
            })?;
        }
        Ok(Self(track))
    }

    #[getter]
    fn number(&self) -> u16 {
        self.0.number
    }

    #[getter]
    fn speed(&self) -> f32 {
        self.0.speed
    }

    /// The paths that it may be on, each with the arc length (m) there.
    #[getter]
    fn candidates(&self) -> Vec<(usize, f32)> {
        self.0
            .candidates()
            .map(|on| (on.path.index(), on.s))
            .collect()
    }

    fn __repr__(&self) -> String {
        let (number, speed, on) = (self.0.number, self.0.speed, self.candidates());
        format!("Track(number={number}, speed={speed}, candidates={on:?})")
    }
}
