//! The safety shield: no proposal passes that could lead to a collision within the contract.
//!
//! A proposed acceleration is accepted if, after one period of it, some fail-safe [`Plan`] is
//! verified against everything that the others can do from now. Otherwise the nearest accepted
//! acceleration of a fixed grid is taken; otherwise the next command of the plan that was verified last;
//! and if there is none, the ego brakes and says so. `docs/theorem.md` has the theorem.

pub mod actuation;
mod bounds;
pub mod choice;
mod clock;
mod contract;
pub(crate) mod door;
mod hazard;
mod hidden;
pub mod margin;
mod memory;
mod own;
mod plan;
pub(crate) mod precedence;
pub mod reach;
pub(crate) mod rules;
#[cfg(test)]
mod tests;
pub(crate) mod tracks;
mod unwatched;
mod verified;
pub(crate) mod waiting;
mod walkers;

pub use bounds::Bounds;
pub use contract::{Contract, ContractBuilder, ContractError, Ego, Follower, Other, Precedence};
pub use hidden::{MAX_SIGHTS, SightError};
pub use plan::Plan;
use rules::{Rules, Sound};

use crate::decision::{Action, Breach, Cause, Decision, Intervention, Reason};
use crate::fault::Fault;
use crate::headroom::{Headroom, Room};
use crate::instant::Instant;
use crate::junction::zone::FAR;
use crate::junction::{Class, Junction, MAX_OTHERS, PathId, RightOfWay, Way};
use crate::observation::{Observation, Sight, Vehicle};
use crate::real::Real;
use actuation::Inherited;
use choice::{allowed, most, nearest};
use clock::{Clock, Tick};
use core::marker::PhantomData;
use door::Admitted;
use hazard::{Hazard, Hazards, Passage, Who};
use memory::Memory;
use own::Own;
use precedence::{PairMemory, Right};
use tracks::{Findings, Tracks};
use verified::{Verified, best, passage_margin, spare};
use waiting::{Presence, RestState, Sighting};

/// An ego without a safe plan that is less than this (m) in a zone stays there.
const NOSE: f32 = 0.5;

/// Periods since the last call above which nothing is known any more of who rested.
const LOST: u16 = 16;

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

/// Why an approach cannot begin.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum EnterError {
    /// The junction has no such path, or has not prepared it to be entered.
    Path {
        /// Its number.
        path: PathId,
    },
    /// In a lane that the ego shares with another path, nobody could tell who is ahead: `position_error` of the contract
    /// is too large for it.
    PositionError {
        /// The other path.
        path: PathId,
        /// The contract's value in m.
        value: f32,
        /// It must be less than this (m): a quarter of the width of the lane's band, and of the two lengths together.
        below: f32,
    },
}

impl core::fmt::Display for EnterError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Path { path } => write!(
                f,
                "path {} is not one that the junction lets an ego enter by",
                path.index()
            ),
            Self::PositionError { path, value, below } => write!(
                f,
                "position_error = {value} is outside [0, {below}): in the lane shared with path {} \
                 it would not tell who is ahead",
                path.index()
            ),
        }
    }
}

impl core::error::Error for EnterError {}

/// Why control cannot be handed over.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum NotReady {
    /// The ego's state cannot be trusted.
    Fault(Fault),
    /// No plan is safe. What stands in the way of the one that goes farthest, by how many metres it falls short, and
    /// what is wrong with the tracks, if something is.
    NoPlan {
        /// What stands in the way.
        reason: Reason,
        /// Metres to spare of the best plan, negative.
        margin: f32,
        /// What is wrong with the tracks.
        fault: Option<Fault>,
    },
}

impl core::fmt::Display for NotReady {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Fault(fault) => write!(f, "not ready: {fault}"),
            Self::NoPlan { reason, fault, .. } => {
                write!(f, "no plan is safe: {reason}")?;
                fault.map_or(Ok(()), |fault| write!(f, "; {fault}"))
            }
        }
    }
}

impl core::error::Error for NotReady {}

/// What a decision is made of, once the observation is noted.
struct Scene<'s> {
    ego: &'s Own,
    hazards: &'s Hazards,
    /// What acts until the command is followed.
    inherited: &'s Inherited<f32>,
    /// The hardest acceleration that may be commanded.
    most: f32,
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
        tells_apart(&contract, way)?;
        Ok(Self {
            contract,
            way,
            clock: Clock::default(),
            memory: Memory::new(),
            tracks: Tracks::new(),
            presence: Presence::default(),
            replaced: false,
            last: Decision::none(&contract),
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

    /// Assumes `contract` from the next decision on. The remembered plan is kept if it is safe under it.
    ///
    /// # Errors
    /// [`EnterError::PositionError`]; nothing is changed then.
    pub fn set_contract(&mut self, contract: Contract) -> Result<(), EnterError> {
        tells_apart(&contract, self.way)?;
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
            self.memory.forget_commands();
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
        let mut hazards = Hazards::new();
        hazards.add::<N, R>(contract, self.way, (&ego, &next.tracks), findings.closed);
        let inherited = &self.memory.inherited(contract, now);
        let most = most(contract, ego.speed, inherited.bounds()[1]);
        wait_at_line::<R>(contract, self.way, &ego, (inherited, most), &mut hazards);
        let scene = Scene {
            ego: &ego,
            hazards: &hazards,
            inherited,
            most,
        };
        let braking = -contract.ego.braking;
        let accepted = |a| Some(scene.check::<R>(contract, a)).filter(|v| v.margin >= 0.0);
        match nearest(&contract.ego, most, braking, accepted) {
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
        let ego = Own::new(contract, &ego.vehicle, -FAR);
        let mut tracks = Tracks::<N>::new();
        let now = Instant::default();
        let findings = tracks.note::<R>(contract, self.way, now, &ego, observation);
        if let Some(fault) = findings.fault {
            return Err(fault);
        }
        settle::<N, R>(contract, self.way, &ego, &mut tracks);
        let mut hazards = Hazards::new();
        hazards.add::<N, R>(contract, self.way, (&ego, &tracks), findings.closed);
        let inherited = &Inherited::all(contract, [previous; 2]);
        let most = most(contract, ego.speed, previous);
        wait_at_line::<R>(contract, self.way, &ego, (inherited, most), &mut hazards);
        let scene = Scene {
            ego: &ego,
            hazards: &hazards,
            inherited,
            most,
        };
        let acceleration = allowed(&contract.ego, scene.most, acceleration);
        Ok(scene.check::<R>(contract, acceleration).margin)
    }

    /// The same shield; its rules need not be `Clone`.
    fn copy(&self) -> Self {
        Self {
            tracks: self.tracks.clone(),
            memory: self.memory.clone(),
            rules: PhantomData,
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

    /// The ego's own state cannot be trusted: it carries on with the plan, if its commands were given in time and the
    /// contract is the one for which it was verified.
    fn blind(&mut self, (now, tick): (Instant, Tick), fault: Fault, on_time: bool) -> Decision {
        self.tracks.coast::<R>(&self.contract, now);
        self.wait((now, tick), None);
        if !on_time || self.replaced {
            self.void();
        }
        let [_, in_effect] = self.memory.inherited(&self.contract, now).bounds();
        let speed = self.memory.least_speed(&self.contract, now);
        let acceleration = self.carry_on(most(&self.contract, speed, in_effect));
        let plan = self.memory.plan();
        let mut headroom = Headroom::NONE;
        headroom.note_fault(fault);
        Decision {
            acceleration,
            cause: Cause::Fallback(if plan.is_some() { fault } else { Fault::NoPlan }),
            margin: 0.0,
            plan,
            fault: Some(fault),
            headroom,
            ..Decision::none(&self.contract)
        }
    }

    /// Notes what is seen and who goes first.
    fn look(
        &mut self,
        when: (Instant, Tick),
        ego: &Own,
        observation: &Observation<'_>,
    ) -> Findings {
        let (now, _) = when;
        let findings = self
            .tracks
            .note::<R>(&self.contract, self.way, now, ego, observation);
        self.wait(when, Some(ego));
        settle::<N, R>(&self.contract, self.way, ego, &mut self.tracks);
        findings
    }

    /// Notes who has arrived and who rests, and over whom the ego has precedence.
    fn wait(&mut self, (now, tick): (Instant, Tick), ego: Option<&Own>) {
        let contract = &self.contract;
        let Some(rule) = contract.precedence else {
            return;
        };
        let periods = match tick {
            Tick::First => 1,
            Tick::Next { periods, .. } => periods,
            Tick::Repeated | Tick::Backwards => 0,
        };
        let mine = Sighting::of_ego(contract, ego);
        let unseen = |sighting: Sighting| Sighting {
            rest: RestState::Perhaps,
            ..sighting
        };
        if periods > LOST {
            self.presence.forget();
            self.tracks.iter_mut().for_each(|other| other.pair.forget());
        }
        if periods == 0 {
            self.presence.note_again(mine.rest);
            for other in self.tracks.iter_mut() {
                other.pair.other.note_again(other.sighting(contract).rest);
            }
        }
        // A call that is not on time says nothing of how long somebody has moved or rested.
        let on_time = !matches!(tick, Tick::Next { on_time: false, .. });
        let line = |path: PathId| self.way.path(path).map_or(FAR, |path| path.line());
        // Of the periods in which there was no call, nothing is known.
        for missed in (0..periods.min(LOST)).rev() {
            let seen = |sighting: Sighting| {
                if missed == 0 && on_time {
                    sighting
                } else {
                    unseen(sighting)
                }
            };
            let own = line(self.way.ego());
            self.presence.note(contract, rule, own, seen(mine), now);
            for other in self.tracks.iter_mut() {
                let its = seen(other.sighting(contract));
                other
                    .pair
                    .other
                    .note(contract, rule, line(other.path), its, now);
                let Some(mut right) = right(self.way, other.path) else {
                    continue;
                };
                if ego.is_none() {
                    right.in_turns = RightOfWay::Unsettled;
                }
                other.pair.pass::<R>(contract, rule, right, &self.presence);
            }
        }
        for other in self.tracks.iter_mut() {
            let Some(conflict) = self.way.conflict(other.path) else {
                continue;
            };
            let right = Right::of(conflict, self.way.ego(), other.path);
            other.claims = other.pair.claims(contract, rule, right, &self.presence);
            if let Some(ego) = ego.filter(|_| other.claims != precedence::ALL) {
                other
                    .pair
                    .hold::<R>(contract, &self.presence, conflict.zones(), ego.s);
                other.claims = other.pair.claims(contract, rule, right, &self.presence);
            }
        }
    }

    fn judge(
        &mut self,
        when: (Instant, Tick),
        ego: &Vehicle,
        observation: &Observation<'_>,
        (proposal, recheck): (f32, bool),
    ) -> Decision {
        let (now, _) = when;
        let (ego, moved) = self.memory.note(&self.contract, ego, now);
        let (ego, deviated) = (&ego, moved.is_some_and(|rooms| !Room::hold(rooms)));
        if deviated {
            self.tracks.count_on_nothing();
        }
        let mut findings = self.look(when, ego, observation);
        if let Some(rooms) = moved {
            findings.headroom.note_ego(rooms);
        }
        let mut hazards = Hazards::new();
        hazards.add::<N, R>(
            &self.contract,
            self.way,
            (ego, &self.tracks),
            findings.closed,
        );
        let inherited = &self.memory.inherited(&self.contract, now);
        let most = most(&self.contract, ego.speed, inherited.bounds()[1]);
        let acts = (inherited, most);
        wait_at_line::<R>(&self.contract, self.way, ego, acts, &mut hazards);
        let scene = Scene {
            ego,
            hazards: &hazards,
            inherited,
            most,
        };
        self.verify_again(&scene, now, deviated || recheck);
        let breach = if deviated {
            Some(Breach::Ego)
        } else {
            findings.breach.map(Breach::Other)
        };
        Decision {
            breach,
            fault: findings.fault,
            unwatched: findings.closed.map(|closed| closed.number),
            headroom: findings.headroom,
            ..self.decide(&scene, now, proposal)
        }
    }

    /// Voids the remembered plan unless it is safe against whoever it was not verified against, or against `all`.
    fn verify_again(&mut self, scene: &Scene<'_>, now: Instant, all: bool) {
        let Some(plan) = self.memory.plan() else {
            return;
        };
        let contract = &self.contract;
        let command = allowed(&contract.ego, scene.most, next(contract, plan));
        let departure = R::departure(contract, scene.ego.speed, scene.inherited, command);
        // A part of the slack is for what rounding has taken since the plan was verified.
        let rounding = 0.2 * contract.slack;
        let holds = |hazard: &Hazard| {
            R::keeps(spare::<R>(contract, hazard, &departure, R::tail(plan)) + rounding)
        };
        let watched = |hazard: &&Hazard| (all || hazard.suspect) && !hazard.is_closed();
        let watched_hold = scene.hazards.iter().filter(watched).all(holds);
        let context = (contract, self.way);
        let unwatched_hold = self
            .tracks
            .unwatched_hold::<R>(context, scene.ego, all, |hazards| hazards.iter().all(holds));
        if !(watched_hold && unwatched_hold) {
            self.void();
        } else {
            self.tracks.hidden.holds = true;
            if all {
                self.memory.confirmed(now);
            }
        }
    }

    fn void(&mut self) {
        self.memory.void();
        self.tracks.count_on_nothing();
    }

    fn decide(&mut self, scene: &Scene<'_>, now: Instant, proposal: f32) -> Decision {
        let contract = self.contract;
        let wanted = allowed(&contract.ego, scene.most, proposal);
        let verdict = scene.check::<R>(&contract, wanted);
        let accepted = |a| Some(scene.check::<R>(&contract, a)).filter(|v| v.margin >= 0.0);
        let found = if verdict.margin >= 0.0 {
            Some((wanted, verdict))
        } else {
            let nearest = nearest(&contract.ego, scene.most, wanted, accepted);
            nearest.filter(|&(found, _)| self.is_nearer(scene, wanted, found))
        };
        let planned = found.is_some() || self.memory.plan().is_some();
        let cause = if !planned {
            Cause::Fallback(Fault::NoPlan)
        } else if !proposal.is_finite() {
            Cause::Fallback(Fault::Proposal)
        } else if verdict.margin >= 0.0 {
            Cause::Policy
        } else {
            Cause::Shielded(Intervention {
                action: if found.is_some() {
                    Action::Nearest
                } else {
                    Action::Remembered
                },
                reason: scene.reason::<R>(&contract, wanted),
            })
        };
        let acceleration = match found {
            Some((acceleration, verified)) => {
                self.memory.verified(verified.plan, now);
                self.tracks.unwatched_avoided();
                self.count_on(scene.hazards, verified);
                acceleration
            }
            None if !planned && scene.leaves::<R>(&contract) => {
                allowed(&contract.ego, scene.most, contract.ego.go)
            }
            None => self.carry_on(scene.most),
        };
        Decision {
            acceleration,
            cause,
            margin: found.map_or(verdict.margin, |(_, verified)| verified.margin),
            plan: self.memory.plan(),
            ..Decision::none(&contract)
        }
    }

    /// Whether `found` (m/s²) is nearer to what is `wanted` than the next command of the remembered plan. With sensing
    /// errors a plan that is carried on may go where a fresh one, of the same commands, would have to stop.
    fn is_nearer(&self, scene: &Scene<'_>, wanted: f32, found: f32) -> bool {
        self.memory.plan().is_none_or(|plan| {
            let next = allowed(&self.contract.ego, scene.most, next(&self.contract, plan));
            (found - wanted).abs() <= (next - wanted).abs()
        })
    }

    /// Notes which lanes the plan enters ahead of somebody.
    fn count_on(&mut self, hazards: &Hazards, verified: Verified) {
        self.tracks.iter_mut().for_each(|other| other.counted = 0);
        for hazard in hazards
            .iter()
            .filter(|hazard| hazard.target <= verified.passes)
        {
            let (Passage::Ahead { .. }, Who::Watched { place, .. }) = (hazard.passage, hazard.who)
            else {
                continue;
            };
            if let Some(other) = self.tracks.iter_mut().nth(place.into()) {
                other.counted |= 1 << hazard.zone;
            }
        }
    }

    /// The next command of the remembered plan, which is then one command shorter; without one, all the braking there is.
    fn carry_on(&mut self, most: f32) -> f32 {
        let contract = &self.contract;
        let Some(plan) = self.memory.plan() else {
            return -contract.ego.emergency;
        };
        self.memory.shorten(R::tail);
        allowed(&contract.ego, most, next(contract, plan))
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

/// Why the ego does not pass somebody out of sight on `path`, whom it would have passed after `clears` (s).
fn hidden_reason(contract: &Contract, path: PathId, passage: Passage, clears: f32) -> Reason {
    let (distance, speed) = match passage {
        Passage::Before { distance, speed } => (distance, speed),
        Passage::Ahead { gap, speed, .. } => (gap, speed),
        Passage::Walks { .. } | Passage::Never => (0.0, 0.0),
    };
    Reason::Hidden {
        path: u8::try_from(path.index()).unwrap_or(u8::MAX),
        arrives: margin::arrival(contract, distance, speed),
        clears,
    }
}

/// The next command (m/s²) of a plan.
const fn next(contract: &Contract, plan: Plan) -> f32 {
    if plan.go > 0 {
        contract.ego.go
    } else {
        -contract.ego.braking
    }
}

/// Has the ego wait at its line, if the junction was told it.
fn wait_at_line<R: Rules>(
    contract: &Contract,
    way: Way<'_>,
    ego: &Own,
    (inherited, most): (&Inherited<f32>, f32),
    hazards: &mut Hazards,
) {
    let Some(path) = way.path(way.ego()).filter(|path| path.waits_at_line()) else {
        return;
    };
    let brakes = allowed(&contract.ego, most, -contract.ego.braking);
    let departure = R::departure(contract, ego.speed, inherited, brakes);
    let stop = R::rest(contract, departure.braking, 0.0) + contract.slack;
    hazards.wait_at(path.line() - ego.s - contract.position_error, stop);
}

/// Which of the ego and an other on `path` goes first; nothing, if they do not meet.
fn right(way: Way<'_>, path: PathId) -> Option<Right> {
    Some(Right::of(way.conflict(path)?, way.ego(), path))
}

/// Whether in every lane that the ego shares, sensed positions tell who is ahead.
fn tells_apart(contract: &Contract, way: Way<'_>) -> Result<(), EnterError> {
    let length = |path| way.path(path).map_or(0.0, |path| path.footprint().length);
    let driven = |&(path, _): &(PathId, _)| {
        let path = way.path(path);
        path.is_some_and(|path| path.class() != Class::Pedestrian)
    };
    for (path, conflict) in way.conflicts().filter(driven) {
        let touching = length(way.ego()) + length(path);
        for zone in conflict.zones().filter(|zone| zone.is_lane()) {
            let band = zone.lead.to - zone.lead.from;
            let below = 0.25 * if band < touching { band } else { touching };
            let value = contract.position_error;
            if value >= below {
                return Err(EnterError::PositionError { path, value, below });
            }
        }
    }
    Ok(())
}

/// Notes in which lanes the ego is ahead, and the others keep their distance.
fn settle<const N: usize, R: Rules>(
    contract: &Contract,
    way: Way<'_>,
    ego: &Own,
    tracks: &mut Tracks<N>,
) {
    for other in tracks.iter_mut() {
        if let Some(conflict) = way.conflict(other.path) {
            hazard::settle::<R>(contract, conflict.zones(), ego, other);
        }
    }
}

impl Scene<'_> {
    /// The best plan after one period at `command`.
    fn check<R: Rules>(&self, contract: &Contract, command: f32) -> Verified {
        let departure = R::departure(contract, self.ego.speed, self.inherited, command);
        best::<R>(contract, self.hazards, &departure)
    }

    /// Whether an ego without a safe plan accelerates out of its zones instead of braking: it stands in zones, none
    /// of the others may be in its own, and nobody stands in the way until the ego would be at rest again.
    fn leaves<R: Rules>(&self, contract: &Contract) -> bool {
        let go = allowed(&contract.ego, self.most, contract.ego.go);
        let departure = R::departure(contract, self.ego.speed, self.inherited, go);
        let rest = R::rest(contract, departure.braking, 0.0);
        let outside = |passage| match passage {
            Passage::Before { distance, .. } | Passage::Walks { distance, .. } => distance > 0.0,
            // It comes from behind.
            Passage::Ahead { gap, .. } => gap > 0.0,
            Passage::Never => false,
        };
        let inside = |limit: f32| limit < -NOSE;
        let stands_in_one = self.hazards.iter().any(|hazard| inside(hazard.limit));
        stands_in_one
            && self.hazards.iter().all(|hazard| {
                let free = outside(hazard.passage);
                let short = R::stops_short(contract, hazard.limit, rest) >= 0.0;
                free || (!inside(hazard.limit) && short)
            })
    }

    /// Why `command` is refused: what stands in the way of the plan that goes farthest.
    fn reason<R: Rules>(&self, contract: &Contract, command: f32) -> Reason {
        let departure = R::departure(contract, self.ego.speed, self.inherited, command);
        let mut needs = R::rest(contract, departure.braking, 0.0);
        let mut stop = Reason::Stop {
            other: 0,
            available: 0.0,
            needs,
        };
        for hazard in self.hazards.iter() {
            if R::stops_short(contract, hazard.rest, needs) >= 0.0 {
                continue;
            }
            let (clears, ego_speed) = margin::clearing(contract, departure.least, hazard.target);
            let other = match hazard.who {
                Who::Watched { number, .. } | Who::Unwatched(number) => number,
                Who::Hidden(_) => 0,
            };
            stop = Reason::Stop {
                other,
                available: hazard.rest,
                needs,
            };
            if passage_margin::<R>(contract, hazard, clears, ego_speed) >= 0.0 {
                needs = R::rest(contract, departure.most, clears);
                continue;
            }
            if let Who::Hidden(path) = hazard.who {
                return hidden_reason(contract, path, hazard.passage, clears);
            }
            return match hazard.passage {
                Passage::Before { distance, speed } => Reason::Arrival {
                    other,
                    arrives: margin::arrival(contract, distance, speed),
                    clears,
                },
                Passage::Ahead { gap, speed, .. } => {
                    let rush = R::rush(contract, speed, clears);
                    Reason::Entry {
                        other,
                        gap: gap - rush.distance,
                        needs: R::safe_gap(contract, rush.speed, ego_speed),
                    }
                }
                Passage::Walks { distance, speed } => Reason::Arrival {
                    other,
                    arrives: Real::max(distance, 0.0) / speed,
                    clears,
                },
                Passage::Never => stop,
            };
        }
        stop
    }
}
