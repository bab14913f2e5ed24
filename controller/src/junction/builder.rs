//! Builds a junction from routes, footprints, lines and rights of way.

use crate::geometry::{Footprint, Point, length};
use crate::junction::conflict::{Priority, RightOfWay, RouteConflict};
use crate::junction::control::Control;
use crate::junction::error::JunctionError;
use crate::junction::kind::ConflictKind;
use crate::junction::path::{
    Class, MAX_FOOTPRINT, MAX_PACE, MAX_PATH_LENGTH, MAX_SPEED_LIMIT, PACE, Path, PathId,
    SpeedLimit,
};
use crate::junction::polyline::Polyline;
use crate::junction::polyline::within;
use crate::junction::prepared::{Junction, MAX_LATERAL, MAX_TOLERANCE};
use crate::junction::route::Route;
use crate::junction::zone::{Body, sharp_kink};
use crate::real::Real;
use heapless::Vec;

/// The tolerance (m) of a junction that was not given one.
const TOLERANCE: f32 = 0.1;

/// Collects what a [`Junction`] is built from. A call that returns an error changes nothing.
#[derive(Clone, Debug)]
pub struct JunctionBuilder<const R: usize, const P: usize, const E: usize> {
    /// Its conflicts hold nothing but rights of way until it is built.
    junction: Junction<R, P, E>,
    /// The lines that were given, for each path.
    lines: Vec<Option<f32>, R>,
}

impl<const R: usize, const P: usize, const E: usize> Default for JunctionBuilder<R, P, E> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const R: usize, const P: usize, const E: usize> Junction<R, P, E> {
    /// A builder without paths.
    #[must_use]
    pub fn builder() -> JunctionBuilder<R, P, E> {
        JunctionBuilder::new()
    }
}

impl<const R: usize, const P: usize, const E: usize> JunctionBuilder<R, P, E> {
    /// A builder without paths.
    #[must_use]
    pub fn new() -> Self {
        Self {
            junction: Junction {
                paths: Vec::new(),
                points: Vec::new(),
                arc: Vec::new(),
                conflicts: Vec::new(),
                limits: Vec::new(),
                tolerance: TOLERANCE,
                lateral: f32::INFINITY,
            },
            lines: Vec::new(),
        }
    }

    /// How far (m) any point of a vehicle's footprint may be from where it is on its route:
    /// [0, [`MAX_TOLERANCE`]], 0.1 unless it is set. All zones are larger by it.
    pub const fn tolerance(&mut self, tolerance: f32) -> &mut Self {
        self.junction.tolerance = tolerance;
        self
    }

    /// The lateral acceleration (m/s²), at most, that the ego is to have in bends: (0, [`MAX_LATERAL`]]; bends do not slow it
    /// down unless it is set. It bounds proposals; plans know nothing of it.
    pub const fn lateral(&mut self, lateral: f32) -> &mut Self {
        self.junction.lateral = lateral;
        self
    }

    /// Adds a path along `route` for vehicles of `class`, whose largest footprint is `footprint`.
    ///
    /// Points that are within 1 mm of the straight line past them are left out: they cost time and memory, and
    /// zones are larger than they need be by more than that.
    ///
    /// The first `E` paths are those that can be entered. Cost: O(points).
    ///
    /// # Errors
    /// [`JunctionError::TooManyPaths`], [`JunctionError::TooManyPoints`], [`JunctionError::Footprint`],
    /// [`JunctionError::TooLong`], [`JunctionError::Kink`].
    pub fn path<const Q: usize>(
        &mut self,
        route: &Route<Q>,
        class: Class,
        footprint: Footprint,
    ) -> Result<PathId, JunctionError> {
        let id = self.next_id()?;
        checked_footprint(id, footprint)?;
        checked_polyline(id, route.polyline())?;
        let start = self.junction.points.len();
        let kept = kept_points(route.points());
        if kept.clone().any(|i| !self.push_point(route, i)) {
            self.junction.points.truncate(start);
            self.junction.arc.truncate(start);
            return Err(JunctionError::TooManyPoints {
                path: id,
                points: start + kept.count(),
                capacity: P,
            });
        }
        let end = self.junction.points.len();
        self.push(Path {
            class,
            footprint,
            exit: route.pose(route.length()).direction,
            line: 0.0,
            waits_at_line: false,
            control: Control::Unknown,
            pace: PACE,
            order: id.index() as u16,
            range: start..end,
        })?;
        Ok(id)
    }

    /// Adds a path along the points of path `of`, for another class of vehicles. It takes no points.
    ///
    /// # Errors
    /// [`JunctionError::UnknownPath`], [`JunctionError::TooManyPaths`], [`JunctionError::Footprint`].
    pub fn variant(
        &mut self,
        of: PathId,
        class: Class,
        footprint: Footprint,
    ) -> Result<PathId, JunctionError> {
        let path = self.known(of)?.clone();
        let id = self.next_id()?;
        checked_footprint(id, footprint)?;
        self.push(Path {
            class,
            footprint,
            order: id.index() as u16,
            ..path
        })?;
        let limits = self.junction.limits.get(of.index()).cloned();
        if let (Some(its), Some(limits)) = (self.junction.limits.get_mut(id.index()), limits) {
            *its = limits;
        }
        Ok(id)
    }

    /// Sets the line of `path`: the arc length `s` (m) of the footprint's centre while the vehicle waits there. An ego
    /// that has not passed it does so only with a plan that clears every zone of a crossing or a merge.
    ///
    /// Unless it is set, the line is where the footprint comes to the first zone of kind
    /// [`ConflictKind::Crossing`] or [`ConflictKind::Merging`] with any other path; the end of the path
    /// if it has none.
    ///
    /// # Errors
    /// [`JunctionError::UnknownPath`]; [`JunctionError::Line`] if `s` is not in [0, length].
    pub fn line(&mut self, path: PathId, s: f32) -> Result<(), JunctionError> {
        self.known(path)?;
        let length = self.junction.polyline(path).map_or(0.0, Polyline::length);
        if !(s >= 0.0 && s <= length) {
            return Err(JunctionError::Line {
                path,
                value: s,
                length,
            });
        }
        if let Some(line) = self.lines.get_mut(path.index()) {
            *line = Some(s);
        }
        Ok(())
    }

    /// Says that an ego on `path` drives at `speed` (m/s) or slower from arc length `from` (m) on, until the next limit; nothing
    /// is said of others, nor of paths that cannot be entered. It bounds proposals; plans know nothing of it.
    ///
    /// # Errors
    /// [`JunctionError::UnknownPath`], [`JunctionError::SpeedLimit`], [`JunctionError::TooManyLimits`].
    pub fn speed_limit(
        &mut self,
        path: PathId,
        from: f32,
        speed: f32,
    ) -> Result<(), JunctionError> {
        self.known(path)?;
        let length = self.junction.polyline(path).map_or(0.0, Polyline::length);
        if !(speed > 0.0 && speed <= MAX_SPEED_LIMIT && from >= 0.0 && from <= length) {
            return Err(JunctionError::SpeedLimit {
                path,
                from,
                speed,
                length,
            });
        }
        if let Some(limits) = self.junction.limits.get_mut(path.index()) {
            let full = JunctionError::TooManyLimits { path };
            limits.push(SpeedLimit { from, speed }).map_err(|_| full)?;
            for i in (1..limits.len()).rev() {
                if let Some([before, after]) = limits.get_mut(i - 1..=i)
                    && after.from < before.from
                {
                    core::mem::swap(before, after);
                }
            }
        }
        Ok(())
    }

    /// Sets the highest speed (m/s) of pedestrians on `path`, either way: (0, [`MAX_PACE`]], [`PACE`] unless it is set. Of other
    /// classes it says nothing.
    ///
    /// # Errors
    /// [`JunctionError::UnknownPath`], [`JunctionError::Pace`].
    pub fn pace(&mut self, path: PathId, pace: f32) -> Result<(), JunctionError> {
        self.known(path)?;
        if !(pace > 0.0 && pace <= MAX_PACE) {
            return Err(JunctionError::Pace { path, value: pace });
        }
        if let Some(path) = self.junction.paths.get_mut(path.index()) {
            path.pace = pace;
        }
        Ok(())
    }

    /// Sets the place of `path` in the order in which vehicles at rest take turns, its number unless it is set: of two, the one
    /// with the larger place has the first turns. Shields that are to trust each other have to agree on it (U7 of the manual);
    /// where each builds its own junction, with its own numbers, this is how they do.
    ///
    /// # Errors
    /// [`JunctionError::UnknownPath`].
    pub fn order(&mut self, path: PathId, place: u16) -> Result<(), JunctionError> {
        self.known(path)?;
        if let Some(path) = self.junction.paths.get_mut(path.index()) {
            path.order = place;
        }
        Ok(())
    }

    /// Says what obliges vehicles of `path` to give way: what a policy is told, and no shield counts on.
    ///
    /// # Errors
    /// [`JunctionError::UnknownPath`].
    pub fn control(&mut self, path: PathId, control: Control) -> Result<(), JunctionError> {
        self.known(path)?;
        if let Some(path) = self.junction.paths.get_mut(path.index()) {
            path.control = control;
        }
        Ok(())
    }

    /// Says that vehicles of path `first` go before those of path `second` if they arrive at once.
    ///
    /// The last call for two paths counts.
    ///
    /// # Errors
    /// [`JunctionError::UnknownPath`]; [`JunctionError::RightOfWay`] if it is one path.
    pub fn right_of_way(&mut self, first: PathId, second: PathId) -> Result<(), JunctionError> {
        self.priority(first, second, Priority::FirstCome)
    }

    /// Says that vehicles of path `first` have the right of way over those of path `second`, and when it counts.
    ///
    /// The last call for two paths counts.
    ///
    /// # Errors
    /// [`JunctionError::UnknownPath`]; [`JunctionError::RightOfWay`] if it is one path.
    pub fn priority(
        &mut self,
        first: PathId,
        second: PathId,
        priority: Priority,
    ) -> Result<(), JunctionError> {
        self.known(first)?;
        self.known(second)?;
        if first == second {
            return Err(JunctionError::RightOfWay { path: first });
        }
        let mut set = |ego: PathId, other: PathId, right_of_way| {
            if let Some(conflict) = self.slot(ego.index(), other.index()) {
                (conflict.right_of_way, conflict.priority) = (right_of_way, priority);
            }
        };
        set(first, second, RightOfWay::Ego);
        set(second, first, RightOfWay::Other);
        Ok(())
    }

    /// The junction.
    ///
    /// Cost: a look at each two paths, and polygons where they are near each other: about
    /// 2 ms on a desktop for 12 paths of 64 points (`benches/junction.rs`).
    ///
    /// # Errors
    /// [`JunctionError::NoPaths`], [`JunctionError::Tolerance`], [`JunctionError::Returns`].
    pub fn build(mut self) -> Result<Junction<R, P, E>, JunctionError> {
        self.build_in_place()?;
        Ok(self.junction)
    }

    /// [`JunctionBuilder::build`] where the builder is, for a memory without room for a second junction.
    ///
    /// # Errors
    /// As [`JunctionBuilder::build`].
    // Not inlined, so that the stack of `fill` is free again when the junction is moved.
    #[inline(never)]
    pub fn build_in_place(&mut self) -> Result<&Junction<R, P, E>, JunctionError> {
        let value = self.junction.tolerance;
        if !(0.0..=MAX_TOLERANCE).contains(&value) {
            return Err(JunctionError::Tolerance { value });
        }
        if self.junction.paths.is_empty() {
            return Err(JunctionError::NoPaths);
        }
        let value = self.junction.lateral;
        if !(value > 0.0 && (value <= MAX_LATERAL || value.is_infinite())) {
            return Err(JunctionError::Lateral { value });
        }
        self.fill()?;
        Ok(&self.junction)
    }

    /// Fills in conflicts and lines.
    // Not inlined, like `meet`: it works where the builder is, and no copy of a row is on the stack.
    #[inline(never)]
    fn fill(&mut self) -> Result<(), JunctionError> {
        for path in &mut self.junction.paths {
            path.line = f32::INFINITY;
        }
        let count = self.junction.paths.len();
        for a in 0..count {
            for b in a..count {
                match self.between(a, b) {
                    Some(conflict) => self.keep(a, b, &conflict),
                    // Two different paths always have one, and numbers of paths fit.
                    None => {
                        let path = PathId::new(u8::try_from(a).unwrap_or(u8::MAX));
                        return Err(JunctionError::Returns { path });
                    }
                }
            }
        }
        for i in 0..count {
            self.settle_line(i);
        }
        Ok(())
    }

    #[inline(never)]
    fn between(&self, a: usize, b: usize) -> Option<RouteConflict> {
        let body = |i: usize| {
            let path = self.junction.paths.get(i)?;
            let points = self.junction.points.get(path.range.clone())?;
            let arc = self.junction.arc.get(path.range.clone())?;
            let polyline = Polyline::new(points, arc);
            Some(Body::new(polyline, path.footprint, self.junction.tolerance))
        };
        if a == b {
            RouteConflict::with_itself(&body(a)?)
        } else {
            Some(RouteConflict::between(&body(a)?, &body(b)?))
        }
    }

    /// Keeps how paths `a` and `b` meet for each of the two that can be entered, and for their lines.
    fn keep(&mut self, a: usize, b: usize, conflict: &RouteConflict) {
        if a != b {
            self.lower_line(
                a,
                conflict
                    .zones()
                    .filter(|z| stops(z.kind))
                    .map(|z| z.ego.from),
            );
            self.lower_line(
                b,
                conflict
                    .zones()
                    .filter(|z| stops(z.kind))
                    .map(|z| z.other.from),
            );
            self.store(b, a, || conflict.swapped());
        }
        self.store(a, b, || *conflict);
    }

    fn store(&mut self, ego: usize, other: usize, conflict: impl Fn() -> RouteConflict) {
        if let Some(slot) = self.slot(ego, other) {
            let (right_of_way, priority) = (slot.right_of_way, slot.priority);
            *slot = RouteConflict {
                right_of_way,
                priority,
                ..conflict()
            };
        }
    }

    fn lower_line(&mut self, i: usize, entries: impl Iterator<Item = f32>) {
        if let Some(path) = self.junction.paths.get_mut(i) {
            path.line = entries.fold(path.line, Real::min);
        }
    }

    fn settle_line(&mut self, i: usize) {
        let given = self.lines.get(i).copied().flatten();
        if let Some(path) = self.junction.paths.get_mut(i) {
            let last = path.range.end.saturating_sub(1);
            let length = self.junction.arc.get(last).copied().unwrap_or(0.0);
            path.waits_at_line = given.is_some();
            path.line = given.unwrap_or(within(path.line, length));
        }
    }

    fn slot(&mut self, ego: usize, other: usize) -> Option<&mut RouteConflict> {
        self.junction.conflicts.get_mut(ego)?.get_mut(other)
    }

    fn known(&self, path: PathId) -> Result<&Path, JunctionError> {
        self.junction.path(path).ok_or(JunctionError::UnknownPath {
            path,
            paths: self.junction.paths.len(),
        })
    }

    /// Whether there was room for point `i` of the route.
    fn push_point<const Q: usize>(&mut self, route: &Route<Q>, i: usize) -> bool {
        let (Some(&point), Some(&arc)) = (route.points().get(i), route.arc().get(i)) else {
            return false;
        };
        self.junction.points.push(point).is_ok() && self.junction.arc.push(arc).is_ok()
    }

    /// The number of the next path.
    fn next_id(&self) -> Result<PathId, JunctionError> {
        let capacity = R.min(256);
        let next = self.junction.paths.len();
        match u8::try_from(next) {
            Ok(number) if next < R => Ok(PathId::new(number)),
            _ => Err(JunctionError::TooManyPaths { capacity }),
        }
    }

    fn push(&mut self, path: Path) -> Result<(), JunctionError> {
        let full = JunctionError::TooManyPaths { capacity: R };
        self.junction.paths.push(path).map_err(|_| full)?;
        // There is room for the first `E`.
        let _ = self.junction.conflicts.push([RouteConflict::NONE; R]);
        let _ = self.junction.limits.push(Vec::new());
        self.lines.push(None).map_err(|_| full)
    }
}

/// A point that is so near (m) to the straight line past it is left out of a path.
const STRAIGHT: f32 = 1.0e-3;

/// The most points in a row that are left out: they are looked at again for each point that follows them.
const LEFT_OUT: usize = 16;

/// The numbers of the points that a path keeps: the ends, and where it bends.
fn kept_points(points: &[Point]) -> impl Iterator<Item = usize> + Clone + '_ {
    core::iter::successors(Some(0), |&from| {
        let farthest = points.len().checked_sub(1)?;
        let mut to = from + 1;
        while to < farthest && to - from <= LEFT_OUT && is_straight(points, from, to + 1) {
            to += 1;
        }
        (to <= farthest).then_some(to)
    })
}

/// Whether all points between two are near the straight line from one to the other, and in order along it.
fn is_straight(points: &[Point], from: usize, to: usize) -> bool {
    let (Some(start), Some(end)) = (points.get(from), points.get(to)) else {
        return false;
    };
    let along = end - start;
    let far = length(&along);
    let mut last = 0.0;
    // The first of the two is on the line.
    let between = points.get(from..to).unwrap_or_default();
    between.iter().all(|point| {
        let (ahead, beside) = (along.dot(&(point - start)), along.perp(&(point - start)));
        let forwards = ahead >= last;
        last = ahead;
        forwards && ahead <= far * far && beside.abs() <= STRAIGHT * far
    })
}

/// Whether a vehicle waits for the others before a zone of this kind.
const fn stops(kind: ConflictKind) -> bool {
    matches!(kind, ConflictKind::Crossing | ConflictKind::Merging)
}

fn checked_footprint(path: PathId, footprint: Footprint) -> Result<(), JunctionError> {
    let Footprint { length, width } = footprint;
    let good = |side: f32| side > 0.0 && side <= MAX_FOOTPRINT;
    if good(length) && good(width) {
        return Ok(());
    }
    Err(JunctionError::Footprint {
        path,
        length,
        width,
    })
}

fn checked_polyline(path: PathId, polyline: Polyline<'_>) -> Result<(), JunctionError> {
    let length = polyline.length();
    if length > MAX_PATH_LENGTH {
        return Err(JunctionError::TooLong { path, length });
    }
    match sharp_kink(polyline) {
        Some((at, degrees)) => Err(JunctionError::Kink { path, at, degrees }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_that_turn_back_are_not_on_a_straight_line() {
        let straight = |xs: &[f32], beside: f32| {
            let points = xs.iter().zip((0_u8..).map(|i| beside * f32::from(i % 2)));
            let points: std::vec::Vec<_> = points.map(|(&x, y)| Point::new(x, y)).collect();
            is_straight(&points, 0, points.len() - 1)
        };
        assert!(straight(&[0.0, 4.0, 10.0], 0.0) && straight(&[0.0, 4.0, 10.0], 0.0009));
        assert!(!straight(&[0.0, 4.0, 10.0], 0.0011));
        assert!(!straight(&[0.0, 6.0, 4.0, 10.0], 0.0), "back");
        assert!(!straight(&[0.0, 11.0, 10.0], 0.0), "beyond the end");
        assert!(!straight(&[0.0, -1.0, 10.0], 0.0), "before the start");
    }
}
