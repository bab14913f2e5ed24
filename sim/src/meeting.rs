//! An encounter and the junction that its two judged vehicles drive through.

use cede_controller::junction::MAX_PATH_LENGTH;
use cede_controller::kinematics::State;
use cede_controller::{
    Class, Footprint, Instant, Junction, JunctionBuilder, JunctionError, PathId, Route,
    RouteConflict, RouteError, Vehicle,
};
use cede_data::encounter::{Encounter, Participant, Role, SimRoute};
use thiserror::Error;

/// Points of two [`SimRoute`]s, at most.
const POINTS: usize = 256;

/// A junction of two paths, both of which can be entered.
pub type Crossroads = Junction<2, POINTS>;

/// As far (m) as a path of a [`Meeting`] goes: a little less than it may, for rounding. A vehicle beyond that has left
/// the junction, hundreds of metres past its record.
pub const REACH: f32 = MAX_PATH_LENGTH - 1.0;

/// Microseconds of a step of the simulation.
const STEP_MICROS: u64 = 100_000;

/// Why two routes are no junction: nothing is promised there.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum NoJunction {
    /// A route cannot be extended.
    #[error(transparent)]
    Route(#[from] RouteError),
    /// The routes are not paths of a junction.
    #[error(transparent)]
    Junction(#[from] JunctionError),
}

/// An encounter, and the junction of its two judged vehicles, which their shields borrow.
#[derive(Clone, Debug)]
pub struct Meeting<'e> {
    /// The encounter.
    pub encounter: &'e Encounter,
    /// Path 0 is the left-turner's, path 1 the other's. They begin where the routes begin and go on straight past their
    /// ends, as the simulation does.
    pub junction: Crossroads,
}

impl<'e> Meeting<'e> {
    /// Prepares `encounter` to be driven.
    ///
    /// Cost: about 0.2 ms.
    ///
    /// # Errors
    /// See [`NoJunction`].
    pub fn new(encounter: &'e Encounter) -> Result<Self, NoJunction> {
        let junction = judged(encounter, |_| REACH, |_| Footprint::PAPER)?;
        Ok(Self {
            encounter,
            junction,
        })
    }

    /// How the path of judged vehicle `index` meets that of the other.
    #[must_use]
    pub fn conflict(&self, index: usize) -> Option<&RouteConflict> {
        conflict(&self.junction, index)
    }
}

/// The junction of an encounter's judged vehicles, of the sizes `body`, as far as they were recorded.
///
/// # Errors
/// See [`NoJunction`].
pub(crate) fn recorded(
    encounter: &Encounter,
    body: impl Fn(&Participant) -> Footprint,
) -> Result<Crossroads, NoJunction> {
    let reach = |vehicle: &Participant| vehicle.record.last().map_or(0.0, |sample| sample.s);
    judged(encounter, reach, body)
}

/// The junction of the judged vehicles, of the sizes `body`, whose paths go on straight until their lengths are
/// `reach` (m).
fn judged(
    encounter: &Encounter,
    reach: impl Fn(&Participant) -> f32,
    body: impl Fn(&Participant) -> Footprint,
) -> Result<Crossroads, NoJunction> {
    let [left, other] = Role::BOTH.map(|role| {
        let vehicle = encounter.judged(role);
        let more = (reach(vehicle) - vehicle.route.length()).max(0.0);
        vehicle.route.extended(0.0, more)
    });
    let [left_body, other_body] = Role::BOTH.map(|role| body(encounter.judged(role)));
    let mut builder = builder([(&left?, left_body), (&other?, other_body)])?;
    for role in Role::BOTH {
        let control = encounter.judged(role).entry.control;
        builder.control(path(role as usize), control)?;
    }
    if let Some(first) = encounter.rights.settled() {
        let [first, second] = [first as usize, 1 - first as usize].map(path);
        builder.right_of_way(first, second)?;
    }
    Ok(builder.build()?)
}

/// The junction of two routes that are followed exactly.
///
/// # Errors
/// If one of the routes is no path of a junction.
pub fn crossroads<const Q: usize>(
    routes: [(&Route<Q>, Footprint); 2],
) -> Result<Crossroads, JunctionError> {
    builder(routes)?.build()
}

fn builder<const Q: usize>(
    routes: [(&Route<Q>, Footprint); 2],
) -> Result<JunctionBuilder<2, POINTS, 2>, JunctionError> {
    let mut builder = Crossroads::builder();
    builder.tolerance(0.0);
    for (route, footprint) in routes {
        builder.path(route, Class::Car, footprint)?;
    }
    Ok(builder)
}

/// How path `index` of `junction`, 0 or 1, meets the other one.
pub fn conflict(junction: &Crossroads, index: usize) -> Option<&RouteConflict> {
    let other = 1_usize.checked_sub(index)?;
    junction.conflict(path(index), path(other))
}

/// Path number `index` of a junction of a few.
#[must_use]
pub const fn path(index: usize) -> PathId {
    PathId::new(index as u8)
}

/// When step number `step` begins.
#[must_use]
pub const fn instant(step: u32) -> Instant {
    Instant::from_micros(step as u64 * STEP_MICROS)
}

/// A vehicle that is sensed exactly.
#[must_use]
pub fn sensed(route: &SimRoute, state: State) -> Vehicle {
    Vehicle {
        s: state.s,
        speed: state.v,
        pose: route.pose(state.s),
    }
}
