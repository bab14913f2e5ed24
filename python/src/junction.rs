//! Junctions from polylines.

use crate::error::{error, named};
use crate::names::{CONTROLS, PRIORITIES, class_named};
use crate::observation::Vehicle;
use cede_controller::{
    Class, ConflictKind, Control, Footprint, Junction as Prepared, JunctionError, PathId, Point,
    Polyline, Priority, RightOfWay, Route, RouteConflict, Span, Way,
};
use numpy::{AllowTypeChange, PyArray2, PyArrayLike2};
use pyo3::prelude::*;
use std::sync::Arc;

/// The most points of one polyline.
const POINTS: usize = 1024;

/// Stack (bytes) on which a junction is built: the largest is built by value.
const STACK: usize = 64 << 20;

/// A junction of one of three capacities, so that a small one stays small.
pub(crate) enum Capacity {
    Small(Box<Prepared<8, 512>>),
    Medium(Box<Prepared<32, 2048>>),
    Large(Box<Prepared<128, 8192>>),
}

/// Calls `$body` with the prepared junction, whatever its capacity.
macro_rules! with_prepared {
    ($capacity:expr, $junction:ident => $body:expr) => {
        match $capacity {
            $crate::junction::Capacity::Small($junction) => $body,
            $crate::junction::Capacity::Medium($junction) => $body,
            $crate::junction::Capacity::Large($junction) => $body,
        }
    };
}
pub(crate) use with_prepared;

impl Capacity {
    fn way(&self, ego: PathId) -> Option<Way<'_>> {
        with_prepared!(self, junction => junction.way(ego))
    }

    fn paths(&self) -> usize {
        with_prepared!(self, junction => junction.paths().len())
    }

    fn tolerance(&self) -> f32 {
        with_prepared!(self, junction => junction.tolerance())
    }
}

/// A path as the builder was given it.
#[derive(Clone)]
struct Draft {
    /// Its points, or the path whose points it takes.
    points: Result<Box<Route<POINTS>>, PathId>,
    class: Class,
    footprint: Footprint,
    line: Option<f32>,
    control: Control,
    /// From where on (m), and how fast (m/s).
    limits: Vec<(f32, f32)>,
    /// Of pedestrians, m/s.
    pace: Option<f32>,
    /// In the order of turns.
    place: Option<u16>,
}

/// Collects what a junction is built from. A call that raises changes nothing.
#[pyclass(name = "JunctionBuilder", module = "cede")]
pub(crate) struct Builder {
    tolerance: f32,
    lateral: Option<f32>,
    paths: Vec<Draft>,
    rights: Vec<(PathId, PathId, Priority)>,
}

#[pymethods]
impl Builder {
    #[new]
    #[pyo3(signature = (tolerance = 0.1, lateral = None))]
    fn new(tolerance: f32, lateral: Option<f32>) -> Self {
        Self {
            tolerance,
            lateral,
            paths: Vec::new(),
            rights: Vec::new(),
        }
    }

    /// Adds a path along `points`, an array of shape (n, 2) or a list of pairs, in metres.
    #[pyo3(signature = (points, *, kind = "car", length = 5.0, width = 2.0, line = None, control = "unknown", limits = Vec::new(), pace = None, order = None))]
    #[allow(clippy::too_many_arguments)]
    fn path(
        &mut self,
        points: PyArrayLike2<'_, f64, AllowTypeChange>,
        kind: &str,
        length: f32,
        width: f32,
        line: Option<f32>,
        control: &str,
        limits: Vec<(f32, f32)>,
        pace: Option<f32>,
        order: Option<u16>,
    ) -> PyResult<u8> {
        let points = points.as_array();
        if points.ncols() != 2 {
            let shape = points.shape();
            return Err(error(format!("points: shape {shape:?} is not (n, 2)")));
        }
        let route = points
            .rows()
            .into_iter()
            .map(|p| Point::new(p[0] as f32, p[1] as f32));
        let route = Route::new(route).map_err(|wrong| {
            error(format!(
                "points of path {}: {wrong}; a route has 2 to {POINTS}",
                self.paths.len()
            ))
        })?;
        let control = named("control", control, &CONTROLS)?;
        self.push(Draft {
            points: Ok(Box::new(route)),
            class: class_named(kind)?,
            footprint: Footprint { length, width },
            line,
            control,
            limits,
            pace,
            place: order,
        })
    }

    /// Adds a path along the points of path `of`, for another class of vehicles.
    #[pyo3(signature = (of, kind, length, width, line = None, order = None))]
    fn variant(
        &mut self,
        of: u8,
        kind: &str,
        length: f32,
        width: f32,
        line: Option<f32>,
        order: Option<u16>,
    ) -> PyResult<u8> {
        let of = self.known(of)?;
        let control = self
            .paths
            .get(of.index())
            .map_or(Control::Unknown, |path| path.control);
        self.push(Draft {
            points: Err(of),
            class: class_named(kind)?,
            footprint: Footprint { length, width },
            line,
            control,
            // It has those of the other path.
            limits: Vec::new(),
            pace: None,
            place: order,
        })
    }

    /// Says that vehicles of path `first` have the right of way over those of path `second`, and when it counts.
    #[pyo3(signature = (first, second, priority = "first-come"))]
    fn right_of_way(&mut self, first: u8, second: u8, priority: &str) -> PyResult<()> {
        let priority = named("priority", priority, &PRIORITIES)?;
        let rights = (self.known(first)?, self.known(second)?, priority);
        self.rights.push(rights);
        Ok(())
    }

    fn build(&self, py: Python<'_>) -> PyResult<Junction> {
        py.detach(|| self.prepared())
            .map(|built| Junction(Arc::new(built)))
    }
}

impl Builder {
    fn push(&mut self, path: Draft) -> PyResult<u8> {
        let number = u8::try_from(self.paths.len()).map_err(|_| error("more than 256 paths"))?;
        self.paths.push(path);
        Ok(number)
    }

    fn known(&self, path: u8) -> PyResult<PathId> {
        let paths = self.paths.len();
        if usize::from(path) < paths {
            return Ok(PathId::new(path));
        }
        Err(error(format!(
            "path {path}: there are {paths}, counted from 0"
        )))
    }

    /// The junction, built on a stack that has room for it.
    fn prepared(&self) -> PyResult<Capacity> {
        std::thread::scope(|scope| {
            let builder = std::thread::Builder::new().stack_size(STACK);
            let building = builder
                .spawn_scoped(scope, || self.of_least_capacity())
                .map_err(error)?;
            let built = building
                .join()
                .map_err(|_| error("the junction cannot be built"))?;
            built.map_err(error)
        })
    }

    fn of_least_capacity(&self) -> Result<Capacity, JunctionError> {
        match self.fill().map(Capacity::Small) {
            Err(JunctionError::TooManyPaths { .. } | JunctionError::TooManyPoints { .. }) => {}
            built => return built,
        }
        match self.fill().map(Capacity::Medium) {
            Err(JunctionError::TooManyPaths { .. } | JunctionError::TooManyPoints { .. }) => {}
            built => return built,
        }
        self.fill().map(Capacity::Large)
    }

    fn fill<const R: usize, const P: usize>(&self) -> Result<Box<Prepared<R, P>>, JunctionError> {
        let mut builder = Prepared::<R, P>::builder();
        builder.tolerance(self.tolerance);
        if let Some(lateral) = self.lateral {
            builder.lateral(lateral);
        }
        for draft in &self.paths {
            let id = match &draft.points {
                Ok(route) => builder.path(route, draft.class, draft.footprint)?,
                Err(of) => builder.variant(*of, draft.class, draft.footprint)?,
            };
            if let Some(s) = draft.line {
                builder.line(id, s)?;
            }
            builder.control(id, draft.control)?;
            if let Some(pace) = draft.pace {
                builder.pace(id, pace)?;
            }
            if let Some(place) = draft.place {
                builder.order(id, place)?;
            }
            for &(from, speed) in &draft.limits {
                builder.speed_limit(id, from, speed)?;
            }
        }
        for &(first, second, priority) in &self.rights {
            builder.priority(first, second, priority)?;
        }
        builder.build().map(Box::new)
    }
}

/// A junction: its paths, and how each two of them meet. Prepared once for all vehicles.
#[pyclass(frozen, module = "cede")]
pub(crate) struct Junction(pub(crate) Arc<Capacity>);

#[pymethods]
impl Junction {
    #[staticmethod]
    #[pyo3(signature = (tolerance = 0.1, lateral = None))]
    fn builder(tolerance: f32, lateral: Option<f32>) -> Builder {
        Builder::new(tolerance, lateral)
    }

    fn __len__(&self) -> usize {
        self.0.paths()
    }

    #[getter]
    fn tolerance(&self) -> f32 {
        self.0.tolerance()
    }

    fn points<'py>(&self, py: Python<'py>, path: u8) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let line = self.polyline(path)?;
        let points: Vec<Vec<f32>> = line.points().iter().map(|p| vec![p.x, p.y]).collect();
        PyArray2::from_vec2(py, &points).map_err(error)
    }

    fn length(&self, path: u8) -> PyResult<f32> {
        Ok(self.polyline(path)?.length())
    }

    /// Arc length (m) of the footprint's centre while a vehicle waits at its line.
    fn line(&self, path: u8) -> PyResult<f32> {
        let way = self.way(path)?;
        Ok(way.path(PathId::new(path)).map_or(0.0, |path| path.line()))
    }

    /// The speed (m/s) that limits and bends allow an ego on `path` at arc length `s` (m); infinite without them.
    fn allowed_speed(&self, path: u8, s: f32) -> PyResult<f32> {
        Ok(self.way(path)?.profile().speed(s))
    }

    /// The largest acceleration (m/s²) with which an ego on `path` keeps to limits and bends; infinite without them.
    #[pyo3(signature = (path, s, speed, response = 0.1))]
    fn allowed_acceleration(&self, path: u8, s: f32, speed: f32, response: f32) -> PyResult<f32> {
        Ok(self.way(path)?.profile().acceleration(s, speed, response))
    }

    /// A vehicle on `path` at arc length `s` (m), exactly on it.
    fn vehicle(&self, path: u8, s: f32, speed: f32) -> PyResult<Vehicle> {
        Ok(Vehicle::at(s, speed, self.polyline(path)?.pose(s)))
    }

    /// Arc length (m) of the point of `path` nearest to (x, y).
    fn project(&self, path: u8, x: f32, y: f32) -> PyResult<f32> {
        Ok(self.polyline(path)?.project(Point::new(x, y)))
    }

    /// How path `ego` meets path `other`.
    fn conflict(&self, ego: u8, other: u8) -> PyResult<Conflict> {
        let way = self.way(ego)?;
        let found = way
            .conflict(PathId::new(other))
            .ok_or_else(|| self.unknown(other))?;
        Ok(Conflict(*found))
    }

    fn __repr__(&self) -> String {
        format!("Junction({} paths)", self.0.paths())
    }
}

impl Junction {
    fn way(&self, path: u8) -> PyResult<Way<'_>> {
        self.0
            .way(PathId::new(path))
            .ok_or_else(|| self.unknown(path))
    }

    /// The line of a path, which a pedestrian's is, too: no vehicle can enter by it.
    fn polyline(&self, path: u8) -> PyResult<Polyline<'_>> {
        let mut ways = (0..=u8::MAX).filter_map(|ego| self.0.way(PathId::new(ego)));
        let found = ways.next().and_then(|way| way.polyline(PathId::new(path)));
        found.ok_or_else(|| self.unknown(path))
    }

    fn unknown(&self, path: u8) -> PyErr {
        error(format!(
            "path {path}: there are {}, counted from 0",
            self.0.paths()
        ))
    }
}

/// From where to where (m).
type Ends = (f32, f32);

/// How the ego's path meets one other's.
#[pyclass(frozen, module = "cede")]
pub(crate) struct Conflict(RouteConflict);

#[pymethods]
impl Conflict {
    #[getter]
    fn kind(&self) -> &'static str {
        kind_name(self.0.kind)
    }

    #[getter]
    fn ego_conflict(&self) -> f32 {
        self.0.ego_conflict
    }

    #[getter]
    fn other_conflict(&self) -> f32 {
        self.0.other_conflict
    }

    #[getter]
    fn right_of_way(&self) -> &'static str {
        match self.0.right_of_way {
            RightOfWay::Ego => "ego",
            RightOfWay::Other => "other",
            RightOfWay::Unsettled => "unsettled",
        }
    }

    /// When the right of way counts.
    #[getter]
    fn priority(&self) -> &'static str {
        let found = PRIORITIES.iter().find(|(_, it)| *it == self.0.priority);
        found.map_or("", |(name, _)| name)
    }

    /// Where the footprints can touch: the kind, and from where to where (m) on either path.
    #[getter]
    fn zones(&self) -> Vec<(&'static str, Ends, Ends)> {
        let ends = |span: Span| (span.from, span.to);
        let zones = self.0.zones();
        zones
            .map(|zone| (kind_name(zone.kind), ends(zone.ego), ends(zone.other)))
            .collect()
    }

    fn __repr__(&self) -> String {
        format!(
            "Conflict({}, right_of_way='{}')",
            self.kind(),
            self.right_of_way()
        )
    }
}

/// The name of a kind of conflict.
pub(crate) fn kind_name(kind: ConflictKind) -> &'static str {
    match kind {
        ConflictKind::Crossing => "crossing",
        ConflictKind::Merging => "merging",
        ConflictKind::Following => "following",
        ConflictKind::None => "none",
    }
}
