//! A closed loop: driver and world, period by period.

use crate::case::{Case, Proposals, quarters};
use crate::pilot::Pilot;
use crate::place::TestJunction;
use crate::subject::Subject;
use crate::trace::{Moment, Trace};
use crate::vehicle::Truth;
use crate::world::{Overlap, Seen, World};
use cede_controller::dangerous::Rules;
use cede_controller::{Contract, Decision};

/// Why a case does not count, or what is wrong in it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Miss {
    /// It is no case of this check.
    Skip(String),
    /// The check fails.
    Broken(String),
}

impl Miss {
    #[expect(clippy::needless_pass_by_value, reason = "to be handed to `map_err`")]
    pub(crate) fn skip(why: impl ToString) -> Self {
        Self::Skip(why.to_string())
    }

    #[expect(clippy::needless_pass_by_value, reason = "to be handed to `map_err`")]
    pub(crate) fn broken(what: impl ToString) -> Self {
        Self::Broken(what.to_string())
    }
}

/// What a check says of one case.
pub(crate) type Verdict = Result<(), Miss>;

/// What happens at one call.
pub(crate) struct Call<'c, 'j, 'w, R: Rules> {
    pub(crate) seen: &'c Seen,
    /// What is proposed in m/s², unless the policy proposes.
    pub(crate) proposal: Option<f32>,
    /// The driver before it decides.
    pub(crate) before: &'c Pilot<'j, 'w, R>,
    pub(crate) decision: &'c Decision,
    pub(crate) world: &'c World<'j>,
}

/// The junction of a case.
///
/// # Errors
/// The vehicle's footprint is out of range.
pub(crate) fn junction(case: &Case, subject: &Subject<'_>) -> Result<TestJunction, Miss> {
    case.place
        .junction(subject.vehicle.footprint)
        .map_err(Miss::skip)
}

/// What is proposed at period number `step`.
pub(crate) fn proposal(case: &Case, contract: &Contract, step: u32) -> Option<f32> {
    let ego = contract.ego();
    match &case.proposals {
        Proposals::Policy => None,
        Proposals::Reckless => Some(ego.acceleration),
        Proposals::Script(script) => {
            let share = f32::from(quarters(script, step).unwrap_or(4)) / 4.0;
            Some(
                share
                    * if share < 0.0 {
                        ego.braking
                    } else {
                        ego.acceleration
                    },
            )
        }
    }
}

/// Drives `case` with a vehicle of which `truth` is true, and lets `watch` judge every call and the end.
///
/// # Errors
/// What `watch` says, or that the case does not start within the contract.
pub(crate) fn drive<'j, R: Rules + Clone>(
    subject: &Subject<'_>,
    (case, junction): (&'j Case, &'j TestJunction),
    truth: &Truth,
    mut watch: impl FnMut(&Call<'_, 'j, '_, R>) -> Verdict,
) -> Result<World<'j>, Miss> {
    let contract = subject.contract;
    let mut pilot = Pilot::<R>::enter(subject.policy, contract, junction).map_err(Miss::skip)?;
    let footprint = subject.vehicle.footprint;
    let mut world =
        World::new((case, junction), footprint, (&contract, truth)).map_err(Miss::skip)?;
    while let Some(seen) = world.look() {
        if world.step == 0 {
            pilot
                .ready(&seen)
                .map_err(|why| Miss::skip(format!("not ready: {why}")))?;
        }
        let proposal = proposal(case, &contract, world.step);
        let before = pilot.clone();
        let decision = pilot.decide(&seen, proposal);
        watch(&Call {
            seen: &seen,
            proposal,
            before: &before,
            decision: &decision,
            world: &world,
        })?;
        let start = world.step == 0;
        world.go(decision.acceleration);
        if start && world.others.iter().any(|other| other.plan() == Some(None)) {
            return Err(Miss::skip("another with a shield has no plan at the start"));
        }
    }
    Ok(world)
}

/// The first overlap of `case`, if there is one.
///
/// # Errors
/// That the case does not start within the contract.
pub(crate) fn overlap<R: Rules + Clone>(
    subject: &Subject<'_>,
    case: &Case,
    truth: &Truth,
) -> Result<Option<Overlap>, Miss> {
    let junction = junction(case, subject)?;
    let world = drive::<R>(subject, (case, &junction), truth, |_| Ok(()))?;
    Ok(world.overlap)
}

/// The case in words, and what happens in it.
pub(crate) fn explain<R: Rules + Clone>(
    subject: &Subject<'_>,
    case: &Case,
    truth: &Truth,
) -> String {
    let Ok(junction) = junction(case, subject) else {
        return case.to_string();
    };
    let mut trace = Trace::new(case, &junction);
    let ends = drive::<R>(subject, (case, &junction), truth, |call| {
        trace.moments.push(Moment::of(call.world, call.decision));
        Ok(())
    });
    if let Ok(Some(overlap)) = ends.map(|world| world.overlap) {
        trace.overlap = Some(overlap);
    }
    format!("{case}\n\n{trace}")
}

/// Seconds until the ego is through, driven by its policy; none if it is not within `duration` (s).
///
/// # Errors
/// That the case does not start within the contract, or that vehicles overlap.
pub(crate) fn journey<R: Rules + Clone>(
    subject: &Subject<'_>,
    case: &Case,
    duration: f64,
) -> Result<Option<f64>, Miss> {
    let junction = junction(case, subject)?;
    let contract = subject.contract;
    let mut pilot = Pilot::<R>::enter(subject.policy, contract, &junction).map_err(Miss::skip)?;
    let start = World::new(
        (case, &junction),
        subject.vehicle.footprint,
        (&contract, &subject.as_contracted()),
    );
    let mut world = start.map_err(Miss::skip)?;
    world.duration = duration;
    while let Some(seen) = world.look() {
        if world.is_through() {
            return Ok(Some(world.time()));
        }
        if world.step == 0 {
            pilot.ready(&seen).map_err(Miss::skip)?;
        }
        let decision = pilot.decide(&seen, None);
        world.go(decision.acceleration);
    }
    match world.overlap {
        Some(overlap) => Err(Miss::broken(overlap)),
        None => Ok(world.is_through().then_some(world.time())),
    }
}
