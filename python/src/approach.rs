//! Drives, approaches, and the shield alone.

use crate::contract::Contract;
use crate::decision::Decision;
use crate::error::{error, named, wrong_number};
use crate::junction::{Capacity, Junction, with_prepared};
use crate::observation::{Track, Vehicle};
use crate::policy::Policy;
use cede_controller::{
    self as cede, EnterError, Instant, NotReady, Observation, Part, PathId, Sight,
};
use pyo3::prelude::*;
use self_cell::self_cell;
use std::sync::Arc;

const PARTS: [(&str, Part); 2] = [("left", Part::Left), ("other", Part::Other)];

/// What drives a vehicle, at every intersection.
#[pyclass(frozen, module = "cede")]
pub(crate) struct Drive(cede::Drive<'static>);

#[pymethods]
impl Drive {
    #[new]
    #[pyo3(signature = (policy = None, contract = None, *, part = "left", svo = None, estimates = false))]
    fn new(
        policy: Option<Policy>,
        contract: Option<Contract>,
        part: &str,
        svo: Option<f32>,
        estimates: bool,
    ) -> PyResult<Self> {
        let policy = policy.map_or_else(Policy::embedded, Ok)?;
        let policy = svo.map_or(Ok(policy), |svo| policy.oriented(svo))?;
        let part = named("part", part, &PARTS)?;
        let mut drive = cede::Drive::new(policy.0, numbers(contract), part);
        drive.set_estimates(estimates);
        Ok(Self(drive))
    }

    /// Begins to approach `junction` on `path`.
    fn enter(&self, py: Python<'_>, junction: &Junction, path: u8) -> PyResult<Approach> {
        let path = PathId::new(path);
        let entered = Entered::try_new(
            junction.0.clone(),
            |junction| with_prepared!(&**junction, prepared => self.0.enter(&**prepared, path)),
        );
        entered.map(Approach).map_err(|wrong| refused(py, &wrong))
    }
}

fn numbers(contract: Option<Contract>) -> cede::Contract {
    contract.map_or(cede::Contract::WORST_CASE, |contract| contract.0)
}

type Driving<'j> = cede::Approach<'j, 'static>;
type Guarding<'j> = cede::Shield<'j>;

self_cell!(
    /// An approach, and the junction that it borrows.
    struct Entered {
        owner: Arc<Capacity>,
        #[covariant]
        dependent: Driving,
    }
);

self_cell!(
    /// A shield, and the junction that it borrows.
    struct Guarded {
        owner: Arc<Capacity>,
        #[covariant]
        dependent: Guarding,
    }
);

/// One vehicle on its way through one junction.
#[pyclass(module = "cede")]
pub(crate) struct Approach(Entered);

#[pymethods]
impl Approach {
    /// The ego's acceleration for the period that begins `now` (s). To be called once a period.
    #[pyo3(signature = (now, ego, tracks = Vec::new(), most = None))]
    fn decide(
        &mut self,
        now: f64,
        ego: Vehicle,
        tracks: Vec<Track>,
        most: Option<f32>,
    ) -> PyResult<Decision> {
        let (now, tracks) = (instant(now)?, sensed(&tracks));
        let seen = Observation {
            ego: ego.state(),
            tracks: &tracks,
        };
        let decided = self.0.with_dependent_mut(|_, approach| match most {
            Some(most) => approach.decide_up_to(now, &seen, most),
            None => approach.decide(now, &seen),
        });
        Ok(Decision(decided))
    }

    /// Metres to spare of the best plan, before control is handed over. Raises if none is safe.
    #[pyo3(signature = (now, ego, tracks = Vec::new()))]
    fn ready(&self, now: f64, ego: Vehicle, tracks: Vec<Track>) -> PyResult<f32> {
        ready(self.0.borrow_dependent().shield(), now, &ego, &tracks)
    }

    /// What the policy alone would do (m/s²): to measure what the shield costs, never to drive.
    #[pyo3(signature = (ego, tracks = Vec::new()))]
    fn proposal(&mut self, ego: Vehicle, tracks: Vec<Track>) -> f32 {
        let tracks = sensed(&tracks);
        let seen = Observation {
            ego: ego.state(),
            tracks: &tracks,
        };
        self.0
            .with_dependent_mut(|_, approach| approach.proposal(&seen))
    }

    /// For so many periods the remembered plan accelerates before it brakes; `None` is no guarantee.
    #[getter]
    fn plan(&self) -> Option<u16> {
        self.0.borrow_dependent().plan().map(|plan| plan.go)
    }

    #[getter]
    fn contract(&self) -> Contract {
        Contract(*self.0.borrow_dependent().shield().contract())
    }

    fn set_policy(&mut self, policy: Policy) {
        self.0
            .with_dependent_mut(|_, approach| approach.set_policy(policy.0));
    }

    fn set_contract(&mut self, py: Python<'_>, contract: Contract) -> PyResult<()> {
        let set = self
            .0
            .with_dependent_mut(|_, approach| approach.set_contract(contract.0));
        set.map_err(|wrong| refused(py, &wrong))
    }

    /// How much of some paths is in sight at `now` (s): path, from where on (m), and the most speed (m/s) out of sight.
    fn set_sight(&mut self, now: f64, sights: Vec<(u8, f32, f32)>) -> PyResult<()> {
        let (now, sights) = (instant(now)?, seen_from(&sights));
        let set = self
            .0
            .with_dependent_mut(|_, approach| approach.set_sight(now, &sights));
        set.map_err(error)
    }

    /// The track with this number is known not to be there any more.
    fn forget(&mut self, number: u16) {
        self.0
            .with_dependent_mut(|_, approach| approach.forget(number));
    }
}

/// The shield of one vehicle on its way through one junction: filters the proposals of any driver.
#[pyclass(module = "cede")]
pub(crate) struct Shield(Guarded);

#[pymethods]
impl Shield {
    #[new]
    #[pyo3(signature = (junction, path, contract = None))]
    fn new(
        py: Python<'_>,
        junction: &Junction,
        path: u8,
        contract: Option<Contract>,
    ) -> PyResult<Self> {
        let (contract, path) = (numbers(contract), PathId::new(path));
        let guarded = Guarded::try_new(
            junction.0.clone(),
            |junction| with_prepared!(&**junction, prepared => cede::Shield::enter(contract, &**prepared, path)),
        );
        guarded.map(Self).map_err(|wrong| refused(py, &wrong))
    }

    /// `proposal` (m/s²) if it is safe, else the nearest that is. To be called once a period.
    #[pyo3(signature = (now, ego, tracks, proposal))]
    fn filter(
        &mut self,
        now: f64,
        ego: Vehicle,
        tracks: Vec<Track>,
        proposal: f32,
    ) -> PyResult<Decision> {
        let (now, tracks) = (instant(now)?, sensed(&tracks));
        let seen = Observation {
            ego: ego.state(),
            tracks: &tracks,
        };
        let decided = self
            .0
            .with_dependent_mut(|_, shield| shield.filter(now, &seen, proposal));
        Ok(Decision(decided))
    }

    /// Metres to spare of the best plan, before control is handed over. Raises if none is safe.
    #[pyo3(signature = (now, ego, tracks = Vec::new()))]
    fn ready(&self, now: f64, ego: Vehicle, tracks: Vec<Track>) -> PyResult<f32> {
        ready(self.0.borrow_dependent(), now, &ego, &tracks)
    }

    #[getter]
    fn plan(&self) -> Option<u16> {
        self.0.borrow_dependent().plan().map(|plan| plan.go)
    }

    /// How much of some paths is in sight at `now` (s): path, from where on (m), and the most speed (m/s) out of sight.
    fn set_sight(&mut self, now: f64, sights: Vec<(u8, f32, f32)>) -> PyResult<()> {
        let (now, sights) = (instant(now)?, seen_from(&sights));
        let set = self
            .0
            .with_dependent_mut(|_, shield| shield.set_sight(now, &sights));
        set.map_err(error)
    }

    /// The track with this number is known not to be there any more.
    fn forget(&mut self, number: u16) {
        self.0.with_dependent_mut(|_, shield| shield.forget(number));
    }
}

fn ready(shield: &Guarding<'_>, now: f64, ego: &Vehicle, tracks: &[Track]) -> PyResult<f32> {
    let (now, tracks) = (instant(now)?, sensed(tracks));
    let seen = Observation {
        ego: ego.state(),
        tracks: &tracks,
    };
    shield
        .ready(now, &seen)
        .map_err(|wrong: NotReady| error(wrong))
}

fn seen_from(sights: &[(u8, f32, f32)]) -> Vec<Sight> {
    let sight = |&(path, from, speed)| Sight {
        path: PathId::new(path),
        from,
        speed,
    };
    sights.iter().map(sight).collect()
}

fn sensed(tracks: &[Track]) -> Vec<cede::Track> {
    tracks.iter().map(|track| track.0).collect()
}

/// The moment `now` (s).
fn instant(now: f64) -> PyResult<Instant> {
    if (0.0..=1.0e12).contains(&now) {
        return Ok(Instant::from_micros((now * 1.0e6).round() as u64));
    }
    Err(error(format!("now = {now} s is outside [0, 1e12]")))
}

fn refused(py: Python<'_>, wrong: &EnterError) -> PyErr {
    match *wrong {
        EnterError::PositionError { value, .. } => wrong_number(py, "position_error", value, wrong),
        _ => error(wrong),
    }
}
