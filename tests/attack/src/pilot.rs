//! A driver behind the shield that is attacked: the only place that calls it.

use crate::body::Body;
use crate::corner::Corner;
use crate::hidden::{Course, fits};
use crate::lane::Leg;
use crate::look::Look;
use crate::motion::TICK;
use crate::numbers::Numbers;
use crate::outcome::Outcome;
use crate::proposer;
use crate::rng::Rng;
use crate::scenario::can_begin;
use crate::setup::Setup;
use crate::sight::Sight;
use crate::sight::View;
use cede_controller::dangerous::Rules;
use cede_controller::{Decision, EnterError, Instant, Observation, Plan, Shield, SightError};
use std::collections::VecDeque;

/// Others that a shield watches.
pub const ROOM: usize = 8;

/// One that nobody expects comes into sight at a decision with this probability.
const SURPRISE: f64 = 0.08;

/// The same call is made twice with this probability.
const REPEATED: f64 = 0.01;

/// A shield and its driver, on the way through one junction after the other.
#[derive(Clone, Debug)]
pub struct Pilot<'s, R: Rules> {
    me: usize,
    shield: Shield<'s, ROOM, R>,
    junction: usize,
    driver: proposer::Driver,
    sights: Vec<Sight>,
    corners: Vec<Corner>,
    /// A plan has been verified, in this junction.
    pub verified: bool,
    /// The guarantee holds: for ever since then, or where the contract is broken, while there is a plan.
    pub guarded: bool,
    /// A breach or a fault has been reported.
    pub flagged: bool,
    /// What was decided last.
    pub last: Option<Decision>,
    /// The last commands, newest first: those that may still act.
    commands: VecDeque<f64>,
    /// What the clock shows at tick 0, in µs.
    epoch: u64,
    /// Observations that stay as they are: how many, and what.
    frozen: Option<(u32, Look)>,
    rng: Rng,
}

impl<'s, R: Rules + Clone> Pilot<'s, R> {
    /// The pilot of vehicle `me` among `bodies`, on the way through the first junction of its lane.
    ///
    /// # Errors
    /// If the controller refuses it.
    pub fn new(
        setup: &Setup<'s>,
        bodies: &[Body],
        me: usize,
        driver: proposer::Driver,
        mut rng: Rng,
    ) -> Result<Self, EnterError> {
        let leg = setup.site.lanes[bodies[me].lane].legs[0];
        let numbers = crate::sight::numbers(bodies.len(), &mut rng);
        let mut sights: Vec<Sight> = numbers
            .into_iter()
            .map(|number| Sight::new(&setup.sensing, number, &mut rng))
            .collect();
        sights[me].hidden = false;
        let corners = if setup.sensing.view == View::Whole {
            Vec::new()
        } else {
            Corner::all(setup, &bodies[me], leg.junction, &mut rng)
        };
        let fastest = f64::from(setup.contract.other().max_speed);
        for (sight, body) in sights.iter_mut().zip(bodies) {
            // Nobody who is faster than the contract says is out of sight.
            sight.hidden |= body.state.v <= fastest && behind(&corners, body);
        }
        Ok(Self {
            me,
            shield: enter(setup, leg)?,
            junction: leg.junction,
            driver,
            sights,
            corners,
            verified: false,
            guarded: false,
            flagged: false,
            last: None,
            commands: VecDeque::new(),
            epoch: rng.bits() >> 20,
            frozen: None,
            rng,
        })
    }

    /// What is left of the plan.
    #[must_use]
    pub fn plan(&self) -> Option<Plan> {
        self.shield.plan()
    }

    /// The number of vehicle `other`'s track.
    #[must_use]
    pub fn number(&self, other: usize) -> u16 {
        self.sights[other].number
    }

    /// Whether it has ever seen vehicle `other`, or has to expect it.
    #[must_use]
    pub fn expects(&self, other: usize) -> bool {
        !self.sights[other].hidden || !self.corners.is_empty()
    }

    fn now(&self, tick: u64) -> Instant {
        Instant::from_micros(self.epoch + tick * (TICK * 1e6) as u64)
    }

    fn look(&mut self, setup: &Setup<'s>, bodies: &[Body]) -> Option<Look> {
        self.pass_corners(bodies);
        let me = (self.me, self.junction, !self.verified);
        let look = Look::new(setup, bodies, me, &mut self.sights, &mut self.rng)?;
        if setup.sensing.frozen == 0 {
            return Some(look);
        }
        Some(self.frozen(setup.sensing.frozen, look))
    }

    /// Whoever comes out from behind a corner is seen from then on.
    fn pass_corners(&mut self, bodies: &[Body]) {
        if self.corners.is_empty() {
            return;
        }
        for corner in &mut self.corners {
            corner.pass(&mut self.rng);
        }
        for (sight, body) in self.sights.iter_mut().zip(bodies) {
            sight.hidden &= behind(&self.corners, body);
        }
    }

    /// Tells the shield what is in sight.
    fn tell(&mut self, setup: &Setup<'s>, now: Instant) -> Result<(), SightError> {
        if setup.sensing.view == View::Untold {
            return Ok(());
        }
        let speed = setup.contract.other().max_speed;
        let corners = self.corners.iter().map(|corner| corner.sight(speed));
        let sights: Vec<_> = corners.collect();
        self.shield.set_sight(now, &sights)
    }

    /// Outside of the contract: an old look instead of a new one.
    fn frozen(&mut self, periods: u32, look: Look) -> Look {
        match &mut self.frozen {
            Some((left, old)) if *left > 0 => {
                *left -= 1;
                old.clone()
            }
            _ => {
                let left = if self.rng.chance(0.02) { periods } else { 0 };
                self.frozen = Some((left, look.clone()));
                look
            }
        }
    }

    /// Whether control may be handed over at `tick`.
    pub fn ready(&mut self, setup: &Setup<'s>, bodies: &[Body], tick: u64) -> bool {
        let now = self.now(tick);
        self.look(setup, bodies).is_some_and(|look| {
            let told = self.tell(setup, now);
            let ready = self.shield.ready(now, &look.observation());
            !look.faulty && told.is_ok() && ready.is_ok()
        })
    }

    /// The command for the period that begins at `tick`; none if the vehicle is in no junction any more.
    pub fn decide(
        &mut self,
        setup: &Setup<'s>,
        numbers: &Numbers,
        bodies: &[Body],
        tick: u64,
        outcome: &mut Outcome,
    ) -> Option<f64> {
        self.enter_next(setup, bodies, tick);
        if setup.sensing.surprises {
            self.surprise(setup, numbers, bodies);
        }
        let proposal = self.driver.propose(numbers, bodies[self.me].state.v);
        let mut look = self.look(setup, bodies)?;
        let now = self.now(tick);
        if let Err(refused) = self.tell(setup, now) {
            outcome.faults += 1;
            outcome.complain(tick, || format!("vehicle {}: {refused}", self.me));
        }
        // Those for whom a plan without them leaves no room have been seen before it was made.
        let announced = !setup.sensing.surprises && setup.sensing.view == View::Whole;
        while announced && self.sights.iter().any(|sight| sight.hidden) {
            let mut unawares = self.shield.clone();
            let decision = unawares.filter(now, &look.observation(), proposal);
            if !self.reveals(setup, numbers, bodies, &decision) {
                break;
            }
            look = self.look(setup, bodies)?;
        }
        let decision = self.shield.filter(now, &look.observation(), proposal);
        if self.rng.chance(REPEATED) {
            let again = self.shield.filter(now, &look.observation(), -proposal);
            // Not by value: a fault may hold what is not a number.
            let differs = again != decision && format!("{again:?}") != format!("{decision:?}");
            if differs {
                outcome.different += 1;
                outcome.complain(tick, || format!("vehicle {}: once more: {again}", self.me));
            }
        }
        self.note(setup, tick, &decision, &look, outcome);
        let may_act = (numbers.response() / numbers.period).ceil() as usize + 1;
        self.commands.push_front(decision.acceleration.into());
        self.commands.truncate(may_act);
        Some(decision.acceleration.into())
    }

    /// Shows those for whom the plan of `decision` leaves no room any more; whether there are any.
    fn reveals(
        &mut self,
        setup: &Setup<'s>,
        numbers: &Numbers,
        bodies: &[Body],
        decision: &Decision,
    ) -> bool {
        let ego = &bodies[self.me];
        let acts = self.commands.iter().copied().fold(ego.felt, f64::max);
        let plan = decision.plan.map(|plan| Course {
            acts,
            command: decision.acceleration.into(),
            go: plan.go,
        });
        let mut some = false;
        for (sight, body) in self
            .sights
            .iter_mut()
            .zip(bodies)
            .filter(|(sight, _)| sight.hidden)
        {
            let areas = setup.site.areas(ego.lane, body.lane);
            let fits = plan.is_some_and(|plan| fits(numbers, ego.state, plan, body.state, areas));
            some |= !fits;
            sight.hidden = fits;
        }
        some
    }

    /// Shows one or the other who was not seen before, unless it is too near behind the ego in its lane.
    fn surprise(&mut self, setup: &Setup<'s>, numbers: &Numbers, bodies: &[Body]) {
        let ego = &bodies[self.me];
        for (sight, body) in self.sights.iter_mut().zip(bodies) {
            let [me, other] = [ego, body].map(|body| (body.lane, body.state));
            if sight.hidden
                && self.rng.chance(SURPRISE)
                && can_begin(setup.site, numbers, me, other)
            {
                sight.hidden = false;
            }
        }
    }

    fn note(
        &mut self,
        setup: &Setup<'s>,
        tick: u64,
        decision: &Decision,
        look: &Look,
        outcome: &mut Outcome,
    ) {
        let (sensing, missed) = (&setup.sensing, setup.outside.missed > 0.0);
        outcome.steps += 1;
        let planned = decision.plan.is_some();
        if let Some(breach) = decision.breach {
            outcome.breaches += 1;
            outcome.complain(tick, || format!("vehicle {}: breach {breach:?}", self.me));
        }
        if let Some(fault) = decision.fault.filter(|_| !look.faulty && !missed) {
            outcome.faults += 1;
            outcome.complain(tick, || format!("vehicle {}: fault: {fault}", self.me));
        }
        if self.verified && !planned && !sensing.surprises {
            outcome.unplanned += 1;
            outcome.complain(tick, || format!("vehicle {}: no plan: {decision}", self.me));
        }
        outcome.interventions += u64::from(decision.cause != cede_controller::Cause::Policy);
        outcome.unwatched += u64::from(decision.unwatched.is_some());
        self.flagged |= decision.breach.is_some() || decision.fault.is_some() || !planned;
        self.verified |= planned;
        self.guarded = planned || (self.verified && !sensing.surprises);
        if let Some(plan) = decision.plan.filter(|plan| plan.go > 0)
            && self.rng.chance(sensing.blinds)
        {
            let more = self.rng.below(20) as u32;
            self.sights[self.me].blind(u32::from(plan.go) + more);
        }
        self.last = Some(*decision);
    }

    /// Goes over to the next junction once nothing of this one is left ahead and there is a plan for that one.
    fn enter_next(&mut self, setup: &Setup<'s>, bodies: &[Body], tick: u64) {
        let me = &bodies[self.me];
        let lane = &setup.site.lanes[me.lane];
        let next = lane
            .legs
            .iter()
            .find(|leg| leg.junction == self.junction + 1);
        let Some(next) = next.filter(|next| me.state.s > next.offset) else {
            return;
        };
        let here = |body: &&Body| {
            let legs = &setup.site.lanes[body.lane].legs;
            body.lane != me.lane && legs.iter().any(|leg| leg.junction == self.junction)
        };
        let others = bodies.iter().filter(here);
        let mut areas = others.flat_map(|other| setup.site.areas(me.lane, other.lane));
        let clear = areas.all(|area| me.state.s > area.ego[1] + 3.0);
        if clear && let Ok(shield) = enter(setup, *next) {
            let mut ahead = self.clone();
            ahead.shield = shield;
            ahead.junction += 1;
            ahead.verified = false;
            if !ahead.corners.is_empty() {
                ahead.corners.clear();
                ahead.sights.iter_mut().for_each(|it| it.hidden = false);
            }
            if ahead.ready(setup, bodies, tick) {
                *self = ahead;
            }
        }
    }
}

/// Whether a vehicle is out of sight.
fn behind(corners: &[Corner], body: &Body) -> bool {
    corners.iter().any(|corner| corner.hides(body))
}

fn enter<'s, R: Rules>(setup: &Setup<'s>, leg: Leg) -> Result<Shield<'s, ROOM, R>, EnterError> {
    Shield::with_rules(
        setup.contract,
        &*setup.site.junctions[leg.junction],
        leg.path,
    )
}

impl Look {
    /// For the shield.
    #[must_use]
    pub fn observation(&self) -> Observation<'_> {
        Observation {
            ego: self.ego,
            tracks: &self.tracks,
        }
    }
}
