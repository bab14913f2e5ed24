//! The safety shield: no proposal passes that could lead to a collision within the contract.
//!
//! A proposed acceleration is accepted if, after one period of it, some fail-safe [`Plan`] is
//! verified against everything that the others can do from now. Otherwise the nearest accepted
//! acceleration of a fixed grid is taken; otherwise the next command of the plan that was verified last;
//! and if there is none, the ego brakes and says so. `docs/theorem.md` has the theorem.

pub mod actuation;
mod bounds;
pub mod choice;
mod claims;
mod clock;
pub(crate) mod contract;
mod decide;
pub(crate) mod door;
mod error;
mod findings;
mod hazard;
mod hazards;
mod hidden;
mod judge;
mod lane;
pub mod margin;
mod memory;
mod other;
mod own;
pub(crate) mod precedence;
pub mod reach;
mod reason;
pub(crate) mod rules;
mod scene;
#[cfg(test)]
mod tests;
mod tracks;
mod unwatched;
mod verified;
pub(crate) mod waiting;
mod walkers;

pub use crate::plan::Plan;
pub use bounds::Bounds;
pub use contract::{
    Contract, ContractBuilder, ContractError, Ego, FLIGHTS, Follower, Other, Precedence,
};
pub use error::{EnterError, NotReady};
pub use hidden::{MAX_SIGHTS, SightError};
use rules::{Rules, Sound};

use crate::decision::Decision;
use crate::fault::Fault;
use crate::headroom::Room;
use crate::instant::Instant;
use crate::junction::{Junction, MAX_OTHERS, PathId, Way};
use crate::observation::{Observation, Sight};
use actuation::Inherited;
use choice::{allowed, nearest};
use clock::{Clock, Tick};
use core::marker::PhantomData;
use door::Admitted;
use hazards::Hazards;
use memory::Memory;
use own::Own;
use precedence::PairMemory;
use scene::Scene;
use tracks::Tracks;
use waiting::Presence;

/// The shield of one vehicle on its way through one junction. It watches up to `N` others that matter, at most
/// [`MAX_OTHERS`], each on one path.
///
/// Filters the proposals of any driver. It borrows the junction, so that what it remembers cannot be used at another one:
///
/// ```compile_fail,E0505
/// use cede_controller::{Contract, Junction, PathId, Shield};
///
/// fn two(first: Junction<2, 16>, path: PathId) {
///     let shield = Shield::<8>::enter(Contract::WORST_CASE, &first, path);
///     drop(first);
///     let _ = shield;
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Shield<'j, const N: usize = MAX_OTHERS, R: Rules = Sound> {
    contract: Contract,
    way: Way<'j>,
    clock: Clock,
    memory: Memory,
    tracks: Tracks<N>,
    /// How the ego came to its line.
    presence: Presence,
    /// The contract was replaced: the remembered plan has not been verified under it.
    replaced: bool,
    last: Decision,
    rules: PhantomData<R>,
}

impl<'j, const N: usize> Shield<'j, N> {
    /// A shield for an ego that enters `junction` by `path`. It has seen nothing yet.
    ///
    /// # Errors
    /// See [`EnterError`].
    pub fn enter<const Q: usize, const P: usize, const E: usize>(
        contract: Contract,
        junction: &'j Junction<Q, P, E>,
        path: PathId,
    ) -> Result<Self, EnterError> {
        Self::with_rules(contract, junction, path)
    }
}

impl<'j, const N: usize, R: Rules> Shield<'j, N, R> {
    /// Room for one other at least, and for no more than there are hazards.
    const ROOM: () = assert!(
        N >= 1 && N <= MAX_OTHERS,
        "a shield watches 1 to MAX_OTHERS others"
    );

    /// A shield with rules of its own, which are not proved: see [`Rules`].
    ///
    /// # Errors
    /// See [`EnterError`].
    pub fn with_rules<const Q: usize, const P: usize, const E: usize>(
        contract: Contract,
        junction: &'j Junction<Q, P, E>,
        path: PathId,
    ) -> Result<Self, EnterError> {
        let () = Self::ROOM;
        let way = junction.way(path).ok_or(EnterError::Path { path })?;
        lane::tells_apart(&contract, way)?;
        Ok(Self {
            contract,
            way,
            clock: Clock::default(),
            memory: Memory::new(),
            tracks: Tracks::new(),
            presence: Presence::default(),
            replaced: false,
            last: Decision::none(-contract.ego.braking),
            rules: PhantomData,
        })
    }

    /// What it assumes.
    #[must_use]
    pub const fn contract(&self) -> &Contract {
        &self.contract
    }

    /// The ego's way through the junction.
    #[must_use]
    pub const fn way(&self) -> Way<'j> {
        self.way
    }

    /// The plan that it falls back on; none if nothing has been verified, or if it is void since.
    #[must_use]
    pub fn plan(&self) -> Option<Plan> {
        self.memory.plan()
    }

    /// Whether the ego has precedence over track `number`, on every path that it may be on, since the last decision.
    #[must_use]
    pub fn goes_before(&self, number: u16) -> bool {
        let mut claims = (self.tracks.iter().filter(|other| other.number == number))
            .map(|other| other.claims == precedence::ALL);
        claims
            .next()
            .is_some_and(|first| first && claims.all(|it| it))
    }

    /// Assumes `contract` from the last decision on: of what others have done since then, too. The remembered plan is kept if it
    /// is safe under it, commands in flight act as the former contract has it, and whoever keeps its distance behind the ego
    /// is expected to keep it as before.
    ///
    /// # Errors
    /// [`EnterError::PositionError`]; nothing is changed then.
    pub fn set_contract(&mut self, contract: Contract) -> Result<(), EnterError> {
        lane::tells_apart(&contract, self.way)?;
        if contract.precedence != self.contract.precedence
            || contract.period != self.contract.period
        {
            // What was counted by the former rule says nothing about this one.
            self.presence = Presence::default();
            for other in self.tracks.iter_mut() {
                other.pair = PairMemory::default();
                other.pair.forget();
            }
        }
        if let Some(now) = self.clock.last() {
            self.tracks.rebase::<R>(&self.contract, now);
        }
        self.memory.forget_ego();
        if !contract.acts_as(&self.contract) {
            self.memory.forget_commands(&self.contract);
        }
        self.replaced |= !contract.keeps_plans_of(&self.contract);
        self.contract = contract;
        Ok(())
    }

    /// The track with this number is known not to be there any more. Without it, a track that is not seen is expected
    /// to be somewhere until it has certainly left.
    pub fn forget(&mut self, number: u16) {
        self.tracks.forget(number);
    }

    /// Says of some paths how much of them is in sight at `now`, for the call at that time: before each of these places somebody
    /// may be, and is expected to be in every decision to come. Where nothing is said of a path that was named before, those who
    /// were out of sight may have come on, as far as the contract lets them. A path that is never named is in sight.
    ///
    /// A path of which the view may ever be limited should be named from the first call on: one that is named later is news,
    /// and may leave the ego without a plan. Nobody out of sight is assumed to give way.
    ///
    /// # Errors
    /// See [`SightError`]; nothing is changed then.
    pub fn set_sight(&mut self, now: Instant, sights: &[Sight]) -> Result<(), SightError> {
        self.tracks.hidden.tell(self.way, now, sights)
    }

    /// The acceleration for the period that begins `now`: `proposal` (m/s²) if it is safe.
    ///
    /// To be called once a period. The same `now` again gives the same decision, an earlier one the last decision with
    /// [`Fault::Backwards`]. After a call that is not on time the remembered plan is kept only if it is still safe.
    ///
    /// Cost: O(tracks × N), and at most 14 candidates × one clearing time for each zone. The acceleration is
    /// finite and within the contract's, whatever the bits of the observation and the proposal.
    // Not inlined, so that its stack is not on top of the policy's.
    #[inline(never)]
    pub fn filter(
        &mut self,
        now: Instant,
        observation: &Observation<'_>,
        proposal: f32,
    ) -> Decision {
        let tick = self.clock.tick(&self.contract, now);
        match tick {
            Tick::Repeated => return self.last,
            Tick::Backwards => {
                return Decision {
                    fault: Some(Fault::Backwards),
                    ..self.last
                };
            }
            Tick::First | Tick::Next { .. } => {}
        }
        let on_time = self.memory.call(&self.contract, now);
        let mut decision = match door::ego(self.way, &self.contract, &observation.ego) {
            Ok(Admitted { vehicle, pose }) => {
                let recheck = !on_time || self.replaced;
                self.replaced = false;
                let mut decision =
                    self.judge((now, tick), &vehicle, observation, (proposal, recheck));
                decision.headroom.note_pose(None, pose);
                decision
            }
            Err(fault) => self.blind((now, tick), fault, on_time),
        };
        decision.headroom.period = jitter_left(tick);
        if let Some(fault) = self.off_period(tick) {
            decision.fault = decision.fault.or(Some(fault));
        }
        self.memory
            .command(&self.contract, decision.acceleration, now);
        self.last = decision;
        decision
    }

    /// Whether a plan is safe from `now` on, before control is handed over: metres to spare of the best one. Remembers
    /// nothing.
    ///
    /// # Errors
    /// Why there is none.
    pub fn ready(&self, now: Instant, observation: &Observation<'_>) -> Result<f32, NotReady> {
        let contract = &self.contract;
        let ego = door::ego(self.way, contract, &observation.ego).map_err(NotReady::Fault)?;
        let mut next = self.copy();
        let (ego, _) = next.memory.note(contract, &ego.vehicle, now);
        let findings = next.look((now, Tick::First), &ego, observation);
        let inherited = &self.memory.inherited(contract, now);
        let acts = (inherited, inherited.bounds()[1]);
        let (context, known) = ((contract, self.way), (&ego, &next.tracks));
        let mut hazards = Hazards::new();
        let mut scene = Scene::new::<N, R>(context, known, findings.closed, acts, &mut hazards);
        scene.wait_at_line::<R>(contract, self.way, false);
        let braking = -contract.ego.braking;
        let accepted = |a| Some(scene.check::<R>(contract, a)).filter(|v| v.margin >= 0.0);
        match nearest(&contract.ego, scene.most, braking, accepted) {
            Some((_, verified)) => Ok(verified.margin),
            None => Err(NotReady::NoPlan {
                reason: scene.reason::<R>(contract, braking),
                margin: scene.check::<R>(contract, braking).margin,
                fault: findings.fault,
            }),
        }
    }

    /// Metres to spare of the best plan after one period at `acceleration` (m/s²), given now while `previous`
    /// (m/s²) is in effect; not negative exactly if the shield would accept it. Remembers nothing, knows nobody but whom
    /// it sees, and assumes no precedence.
    ///
    /// # Errors
    /// The fault of the observation, or of an acceleration that is not a number.
    pub fn margin(
        &self,
        observation: &Observation<'_>,
        previous: f32,
        acceleration: f32,
    ) -> Result<f32, Fault> {
        if !(previous.is_finite() && acceleration.is_finite()) {
            return Err(Fault::Proposal);
        }
        let contract = &self.contract;
        let ego = door::ego(self.way, contract, &observation.ego)?;
        let ego = Own::new(contract, &ego.vehicle, f32::NEG_INFINITY);
        let mut tracks = Tracks::<N>::new();
        let now = Instant::default();
        let findings = tracks.note::<R>(contract, self.way, now, &ego, observation);
        if let Some(fault) = findings.fault {
            return Err(fault);
        }
        tracks.settle::<R>(contract, self.way, &ego);
        let acts = (&Inherited::all(contract, [previous; 2]), previous);
        let (context, known) = ((contract, self.way), (&ego, &tracks));
        let mut hazards = Hazards::new();
        let mut scene = Scene::new::<N, R>(context, known, findings.closed, acts, &mut hazards);
        scene.wait_at_line::<R>(contract, self.way, false);
        let acceleration = allowed(&contract.ego, scene.most, acceleration);
        Ok(scene.check::<R>(contract, acceleration).margin)
    }

    /// The same shield; its rules need not be `Clone`.
    fn copy(&self) -> Self {
        Self {
            tracks: self.tracks.clone(),
            memory: self.memory.clone(),
            ..*self
        }
    }

    /// Whether a call at `now` is a new one.
    pub(crate) fn is_new(&self, now: Instant) -> bool {
        self.clock.last().is_none_or(|last| now > last)
    }

    /// Why the time of a call is wrong, if it is.
    fn off_period(&self, tick: Tick) -> Option<Fault> {
        match tick {
            Tick::Next {
                elapsed,
                on_time: false,
                ..
            } => Some(Fault::OffPeriod {
                elapsed: elapsed as f32 * 1.0e-6,
                period: self.contract.period,
            }),
            _ => None,
        }
    }
}

/// What a call leaves of the jitter (s), if there was one before it.
fn jitter_left(tick: Tick) -> Option<Room> {
    match tick {
        Tick::Next { left, .. } => {
            let [left, most] = left.map(|micros| micros as f32 * 1.0e-6);
            Some(Room::of(left, most))
        }
        _ => None,
    }
}
