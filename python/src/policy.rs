//! Policies: the embedded one, weights files, ONNX.

use crate::error::{error, named};
use cede_controller::policy::embedded;
use cede_controller::{FeatureSet, Orientation, OrientationError, Perspective, Policy as Network};
use cede_formats::cede;
use cede_formats::onnx::{self, Told};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};

/// A network that drives. Its weights stay in memory to the program's end.
#[pyclass(frozen, module = "cede", from_py_object)]
#[derive(Clone, Copy)]
pub(crate) struct Policy(pub(crate) Network<'static>);

const PERSPECTIVES: [(&str, Perspective); 2] =
    [("ego", Perspective::Ego), ("joint", Perspective::Joint)];

#[pymethods]
impl Policy {
    /// The policy that ships: trained on synthetic scenarios alone.
    #[staticmethod]
    pub(crate) fn embedded() -> PyResult<Self> {
        Network::new(embedded::words()).map(Self).map_err(error)
    }

    /// The policy of a `.cede` file.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        cede::load(&path).map(Self).map_err(error)
    }

    /// The policy of an ONNX file.
    #[staticmethod]
    #[pyo3(signature = (path, features = None, perspective = None))]
    fn from_onnx(
        path: PathBuf,
        features: Option<&str>,
        perspective: Option<&str>,
    ) -> PyResult<Self> {
        let sets = FeatureSet::ALL.map(|set| (set.name(), set));
        let told = Told {
            features: features
                .map(|name| named("features", name, &sets))
                .transpose()?,
            perspective: perspective
                .map(|name| named("perspective", name, &PERSPECTIVES))
                .transpose()?,
        };
        imported(&path, told).map(Self)
    }

    /// The same network, showing a social value orientation (degrees): 0 an egoist, 45 as learned, 90 an altruist.
    pub(crate) fn oriented(&self, svo: f32) -> PyResult<Self> {
        let wrong = |what: OrientationError| error(format!("svo = {svo}: {what}"));
        let orientation = Orientation::from_degrees(svo).map_err(wrong)?;
        self.0.oriented(orientation).map(Self).map_err(wrong)
    }

    /// The orientation that it shows (degrees).
    #[getter]
    fn svo(&self) -> f32 {
        self.0.orientation().radians().to_degrees()
    }

    #[getter]
    fn features(&self) -> &'static str {
        self.0.weights().features().name()
    }

    #[getter]
    fn perspective(&self) -> &'static str {
        let own = self.0.weights().perspective();
        let found = PERSPECTIVES.into_iter().find(|&(_, known)| known == own);
        found.map_or("", |(name, _)| name)
    }

    /// Neurons of a hidden layer.
    #[getter]
    fn width(&self) -> usize {
        self.0.weights().network().width()
    }

    fn __repr__(&self) -> String {
        let (features, perspective, width) = (self.features(), self.perspective(), self.width());
        format!("Policy(features='{features}', perspective='{perspective}', width={width})")
    }
}

/// The policy that an ONNX file holds.
fn imported(path: &Path, told: Told) -> PyResult<Network<'static>> {
    let wrong = |what: &dyn std::fmt::Display| error(format!("{}: {what}", path.display()));
    let bytes = std::fs::read(path).map_err(|e| wrong(&e))?;
    let words = onnx::import(&bytes, told).map_err(|e| wrong(&e))?;
    cede::keep(&words).map_err(|e| wrong(&e))
}
