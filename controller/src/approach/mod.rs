//! One intersection, from entry to exit: what a driver sees there, through policy and shield, becomes a decision.

mod ask;
mod drive;
mod nearby;
#[cfg(feature = "estimates")]
mod shown;
#[cfg(test)]
mod tests;

pub use drive::Drive;

use crate::decision::{Decision, Prediction};
use crate::instant::Instant;
use crate::junction::{MAX_OTHERS, Path};
use crate::observation::{Observation, Sight, Vehicle};
use crate::policy::pair::Part;
use crate::policy::traffic::TrafficContext;
use crate::policy::{Orientation, OrientationError, Policy};
use crate::shield::{Contract, EnterError, NotReady, Plan, Shield, SightError};
use heapless::Vec;

/// Acceleration (m/s²) that is proposed when there is nobody left to meet.
pub const FREE: f32 = 1.0;

/// An ego that is slower than this (m/s) and has precedence sets off.
const SLOW: f32 = 2.0;
/// Braking (m/s²) to its line, up to which an ego with a driver of its own leaves everything to that one.
pub const GENTLE: f32 = 1.5;

/// One vehicle on its way through one junction, which it borrows.
///
/// Plan, precedence, tracks and SVO live as long as it: the next intersection begins with a new one.
#[derive(Clone, Debug)]
pub struct Approach<'j, 'w, const N: usize = MAX_OTHERS> {
    policy: Policy<'w>,
    part: Part,
    shield: Shield<'j, N>,
    /// The ego's SVO towards each track at the last step.
    orientations: Vec<(u16, f32), N>,
    /// What the tracks have shown that the policy was asked about last, if that is wanted.
    #[cfg(feature = "estimates")]
    filters: Option<shown::Filters>,
    /// See [`Approach::set_traffic`].
    around: TrafficContext,
    prediction: Option<Prediction>,
}

/// What is wanted of the ego, in m/s².
struct Wanted {
    most: f32,
    /// At least, for those over whom it has precedence.
    first: f32,
    /// With nobody left to meet.
    free: f32,
    /// The policy is asked from where stopping at the line takes more braking than this, up to the line; always, if it
    /// is 0.
    gentle: f32,
}

impl<'j, 'w, const N: usize> Approach<'j, 'w, N> {
    /// The shield.
    #[must_use]
    pub const fn shield(&self) -> &Shield<'j, N> {
        &self.shield
    }

    /// The plan that the shield falls back on; none is no guarantee.
    #[must_use]
    pub fn plan(&self) -> Option<Plan> {
        self.shield.plan()
    }

    /// Drives with `policy` from the next decision on.
    pub const fn set_policy(&mut self, policy: Policy<'w>) {
        self.policy = policy;
    }

    /// Shows `orientation` from the next decision on: 0 an egoist, π/4 as learned, π/2 an altruist.
    ///
    /// It reaches the policy's proposals alone: neither the shield nor what the ego does with its precedence
    /// ([`Approach::decide`]) depends on it.
    ///
    /// # Errors
    /// See [`Policy::oriented`]; nothing is changed then.
    pub fn set_orientation(&mut self, orientation: Orientation) -> Result<(), OrientationError> {
        self.policy = self.policy.oriented(orientation)?;
        Ok(())
    }

    /// Whether the orientation that the other shows is estimated from the next decision on, of the one that the policy is
    /// asked about: [`Prediction::shown`]. It changes no command.
    ///
    /// Cost: five more passes through the network in each decision.
    #[cfg(feature = "estimates")]
    pub fn set_estimates(&mut self, wanted: bool) {
        self.filters = match (wanted, self.filters.take()) {
            (true, known) => Some(known.unwrap_or_default()),
            (false, _) => None,
        };
    }

    /// Drives within `contract` from the next decision on. The remembered plan is kept if it is safe under it.
    ///
    /// # Errors
    /// [`EnterError::PositionError`]; nothing is changed then.
    pub fn set_contract(&mut self, contract: Contract) -> Result<(), EnterError> {
        self.shield.set_contract(contract)
    }

    /// Tells the policy of traffic that is not on the junction's paths, for the decisions to come; the shield
    /// considers the tracks alone.
    pub const fn set_traffic(&mut self, around: TrafficContext) {
        self.around = around;
    }

    /// See [`Shield::set_sight`].
    ///
    /// # Errors
    /// See [`SightError`]; nothing is changed then.
    pub fn set_sight(&mut self, now: Instant, sights: &[Sight]) -> Result<(), SightError> {
        self.shield.set_sight(now, sights)
    }

    /// See [`Shield::forget`].
    pub fn forget(&mut self, number: u16) {
        self.shield.forget(number);
    }

    /// Whether a plan is safe before control is handed over. See [`Shield::ready`].
    ///
    /// # Errors
    /// Why there is none.
    pub fn ready(&self, now: Instant, observation: &Observation<'_>) -> Result<f32, NotReady> {
        self.shield.ready(now, observation)
    }

    /// The ego's acceleration for the period that begins `now`. To be called once a period.
    ///
    /// The policy is asked about one of those whom the ego has yet to meet: of those who do not wait for it, the one that
    /// arrives first at the conflict point. Its proposal passes to the shield, which considers everybody. With nobody left
    /// to meet, the ego accelerates gently up to the contract's speed. Nothing is proposed that exceeds the speed limits of
    /// its path, or the junction's lateral acceleration in bends ([`crate::Profile`]). For those over whom it has
    /// precedence it does not brake, and sets off. See [`Shield::filter`].
    ///
    /// Cost: one pass through the network, two with another orientation than the learned, and the shield's. The
    /// acceleration is finite and within the contract's, whatever the bits of the observation.
    pub fn decide(&mut self, now: Instant, observation: &Observation<'_>) -> Decision {
        let first = if observation.ego.speed > SLOW {
            0.0
        } else {
            FREE
        };
        let wanted = Wanted {
            most: f32::INFINITY,
            first,
            free: FREE,
            gentle: 0.0,
        };
        self.decide_for(now, observation, &wanted)
    }

    /// [`Approach::decide`] for a vehicle that has a driver of its own for everything but the others at the junction, of
    /// its speed limit, curves and leader for example: no more than `most` (m/s²) is proposed, and `most` where nobody is
    /// left to meet who goes first, while braking at [`GENTLE`] still stops the ego at its line, and past the line: whoever
    /// has entered leaves the junction. NaN counts as full braking.
    pub fn decide_up_to(
        &mut self,
        now: Instant,
        observation: &Observation<'_>,
        most: f32,
    ) -> Decision {
        let wanted = Wanted {
            most,
            first: most,
            free: most,
            gentle: GENTLE,
        };
        self.decide_for(now, observation, &wanted)
    }

    fn decide_for(
        &mut self,
        now: Instant,
        observation: &Observation<'_>,
        wanted: &Wanted,
    ) -> Decision {
        let mut proposed = 0.0;
        if self.shield.is_new(now) {
            // The shield finds a fault again and carries on with its plan.
            if let Ok((asked, limit)) = self.ask(Some(now), observation, wanted.first) {
                self.prediction = asked.map(|(_, prediction)| prediction);
                proposed = match asked {
                    None => wanted.free,
                    Some((acceleration, _))
                        if acceleration < wanted.most
                            && self.is_near(&observation.ego, wanted.gentle) =>
                    {
                        acceleration
                    }
                    Some(_) => wanted.most,
                };
                if limit < proposed {
                    proposed = limit;
                }
            } else {
                self.prediction = None;
            }
        }
        Decision {
            prediction: self.prediction,
            ..self.shield.filter(now, observation, proposed)
        }
    }

    /// Whether the ego has to brake by more than `gentle` (m/s²) to stop at its line, and is not past it. Without `gentle`
    /// braking it always is.
    fn is_near(&self, ego: &Vehicle, gentle: f32) -> bool {
        let way = self.shield.way();
        let line = way.path(way.ego()).map_or(0.0, Path::line);
        let braking = ego.speed * ego.speed >= 2.0 * gentle * (line - ego.s);
        gentle == 0.0 || braking && ego.s <= line
    }

    /// What the policy alone would do (m/s², within ± 3): to measure what the shield costs, never to drive.
    ///
    /// To be called once a period instead of [`Approach::decide`]; 0 if the ego's state has a fault.
    ///
    /// Cost: one pass through the network. Finite and within ± 3.
    pub fn proposal(&mut self, observation: &Observation<'_>) -> f32 {
        self.ask(None, observation, f32::MIN)
            .map_or(0.0, |(asked, _)| {
                asked.map_or(FREE, |(acceleration, _)| acceleration)
            })
    }
}
