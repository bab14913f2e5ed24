//! One scenario, tick by tick.

use crate::actuator::Actuator;
use crate::body::Body;
use crate::human::{CHOICE, Duty, Human, Meeting, Prey, Walker};
use crate::judge::Judge;
use crate::motion::TICK;
use crate::numbers::{Means, Numbers};
use crate::outcome::{Outcome, Overlap};
use crate::pilot::Pilot;
use crate::plain::Plain;
use crate::proposer;
use crate::rng::Rng;
use crate::scenario::can_begin;
use crate::setup::{Car, Driver, Setup};
use cede_controller::dangerous::Rules;

/// Who drives a vehicle now.
#[derive(Clone, Debug)]
enum Mind<'s, R: Rules> {
    Shielded(Box<Pilot<'s, R>>),
    /// A shield that will take over, and who drives until then.
    Waiting(Box<Pilot<'s, R>>, Human),
    Plain(Box<Plain>),
    Human(Human),
    Walker(Walker),
}

/// When a mind acts next.
#[derive(Clone, Copy, Debug)]
struct Clock {
    /// On time, in ticks.
    due: u64,
    /// With its deviation.
    next: u64,
    period: u64,
    /// The largest deviation.
    jitter: u64,
}

/// Everything that moves.
#[derive(Debug)]
pub struct World<'s, R: Rules> {
    setup: &'s Setup<'s>,
    numbers: Numbers,
    bodies: Vec<Body>,
    minds: Vec<Mind<'s, R>>,
    clocks: Vec<Clock>,
    /// What vehicle i owes vehicle j, at i × count + j.
    duties: Vec<Duty>,
    /// Vehicles that others have to be courteous to: those with a shield, switched on or not, or the plain rule.
    driven: Vec<usize>,
    lines: Vec<f64>,
    /// Where each vehicle has passed all crossings with those that are there.
    clear: Vec<f64>,
    judge: Judge,
    outcome: Outcome,
    rng: Rng,
    /// Prints what happens.
    trace: bool,
}

/// Plays a scenario to its end.
///
/// With `trace` it prints every decision.
#[must_use]
pub fn play<R: Rules + Clone>(setup: &Setup<'_>, trace: bool) -> Outcome {
    match World::<R>::new(setup, trace) {
        Some(mut world) => {
            world.run();
            world.finish()
        }
        None => Outcome::default(),
    }
}

fn ticks(seconds: f64) -> u64 {
    (seconds / TICK + 1e-6) as u64
}

fn body(setup: &Setup<'_>, numbers: &Numbers, car: &Car, rng: &mut Rng) -> Body {
    let outside = setup.outside;
    let latency = ticks(numbers.latency * outside.latency);
    Body {
        lane: car.lane,
        state: car.start,
        sway: car.sway,
        cap: car.cap,
        actuator: Actuator::new(
            car.takeover,
            latency,
            outside.weakness,
            numbers.drivetrain,
            car.acceleration,
            rng.fork(),
        ),
        felt: car.acceleration,
        gone: false,
    }
}

impl<'s, R: Rules + Clone> World<'s, R> {
    fn new(setup: &'s Setup<'s>, trace: bool) -> Option<Self> {
        let mut rng = Rng::new(setup.seed);
        let numbers = Numbers::of(&setup.contract);
        let cars = &setup.cars;
        let bodies: Vec<Body> = cars
            .iter()
            .map(|car| body(setup, &numbers, car, &mut rng))
            .collect();
        let minds = (0..cars.len())
            .map(|i| mind(setup, &numbers, &bodies, i, &mut rng))
            .collect::<Option<Vec<_>>>()?;
        let clocks = minds
            .iter()
            .map(|mind| clock(mind, &numbers, setup.outside.jitter, &mut rng))
            .collect();
        let driven = minds.iter().filter(|mind| is_driven(mind));
        let outcome = Outcome {
            shielded: driven.count() as u64,
            closest: f64::INFINITY,
            ..Outcome::default()
        };
        Some(Self {
            setup,
            numbers,
            duties: vec![Duty::default(); cars.len() * cars.len()],
            driven: (0..cars.len()).filter(|&i| is_driven(&minds[i])).collect(),
            lines: cars.iter().map(|car| setup.site.line(car.lane)).collect(),
            clear: (0..cars.len()).map(|i| clear(setup, i)).collect(),
            judge: Judge::new(cars.len()),
            bodies,
            minds,
            clocks,
            outcome,
            rng,
            trace,
        })
    }

    fn run(&mut self) {
        for tick in 0..self.setup.ticks {
            for i in 0..self.minds.len() {
                if self.clocks[i].next == tick && !self.bodies[i].gone {
                    if !self.act(i, tick) {
                        return;
                    }
                    self.tick_clock(i);
                }
            }
            self.advance(tick);
            if self.overlaps(tick) {
                return;
            }
            if tick % 20 == 0 && self.is_over() {
                return;
            }
        }
    }

    fn finish(mut self) -> Outcome {
        self.outcome.verified = self.minds.iter().all(|mind| match mind {
            Mind::Shielded(pilot) => pilot.verified,
            // It stands in for an other until its shield is ready.
            Mind::Waiting(..) | Mind::Human(_) | Mind::Plain(_) | Mind::Walker(_) => true,
        });
        let passed = |i: &usize| {
            is_driven(&self.minds[*i])
                && (self.bodies[*i].gone || self.bodies[*i].state.s >= self.clear[*i])
        };
        self.outcome.through = (0..self.minds.len()).filter(passed).count() as u64;
        self.outcome.closest = self.judge.closest;
        self.outcome
    }

    /// Vehicle `i` decides; false if the scenario ends because of it.
    fn act(&mut self, i: usize, tick: u64) -> bool {
        let (setup, numbers) = (self.setup, self.numbers);
        match &mut self.minds[i] {
            Mind::Shielded(pilot) => {
                let first = !pilot.verified;
                let command = pilot.decide(setup, &numbers, &self.bodies, tick, &mut self.outcome);
                let Some(command) = command else { return false };
                let verified = pilot.verified;
                self.bodies[i].actuator.command(tick, command);
                self.say(i, tick);
                // A scenario that begins without a plan promises nothing.
                !first || verified
            }
            Mind::Plain(plain) => {
                let command = plain.decide(setup, &numbers, &self.bodies);
                self.outcome.steps += 1;
                self.bodies[i].actuator.command(tick, command);
                true
            }
            Mind::Waiting(..) => self.hand_over(i, tick),
            Mind::Human(_) => {
                self.choose(i);
                true
            }
            Mind::Walker(_) => {
                self.choose_way(i);
                true
            }
        }
    }

    /// The shield of vehicle `i` takes over if it is ready; until then its human chooses.
    fn hand_over(&mut self, i: usize, tick: u64) -> bool {
        let Driver::Shielded { from, .. } = self.setup.cars[i].driver else {
            return true;
        };
        let may = tick >= from && self.may_begin(i);
        if let Mind::Waiting(pilot, _) = &mut self.minds[i]
            && may
            && pilot.ready(self.setup, &self.bodies, tick)
        {
            // What its human did is in effect until the first command is.
            let body = &mut self.bodies[i];
            body.actuator = Actuator::new(
                self.setup.cars[i].takeover,
                ticks(self.numbers.latency * self.setup.outside.latency),
                self.setup.outside.weakness,
                self.numbers.drivetrain,
                body.felt,
                self.rng.fork(),
            );
            self.minds[i] = Mind::Shielded(pilot.clone());
            return self.act(i, tick);
        }
        self.choose(i);
        true
    }

    /// Whether the contract lets control of vehicle `i` be handed over now.
    fn may_begin(&self, i: usize) -> bool {
        let ego = self.numbers.ego;
        let me = &self.bodies[i];
        let mut others = self
            .bodies
            .iter()
            .enumerate()
            .filter(|&(j, body)| j != i && !body.gone);
        (-ego.braking..=ego.acceleration).contains(&me.felt)
            && others.all(|(_, other)| {
                let [me, other] = [me, other].map(|body| (body.lane, body.state));
                can_begin(self.setup.site, &self.numbers, me, other)
            })
    }

    /// The human of vehicle `i` chooses.
    fn choose(&mut self, i: usize) {
        let prey = self.prey(i);
        let me = self.bodies[i].state;
        let (Mind::Human(human) | Mind::Waiting(_, human)) = &mut self.minds[i] else {
            return;
        };
        human.choose(&self.numbers, me, prey);
    }

    /// The pedestrian `i` chooses how to walk on, and is after whichever driven vehicle is nearest to its way.
    fn choose_way(&mut self, i: usize) {
        let me = &self.bodies[i];
        let ahead = |&j: &usize| {
            let ego = &self.bodies[j];
            let areas = self.setup.site.areas(ego.lane, me.lane).iter();
            let starts = areas.filter(|area| ego.state.s < area.ego[1]);
            let nearest = starts.map(|area| area.ego[0] - ego.state.s);
            (!ego.gone).then(|| nearest.reduce(f64::min)).flatten()
        };
        let driven = self.driven.iter().copied();
        let near = driven.filter_map(|j| Some((ahead(&j)?, j)));
        let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0));
        let prey = nearest.map(|(_, j)| self.prey_of(i, j));
        let s = me.state.s;
        if let Mind::Walker(walker) = &mut self.minds[i] {
            walker.choose(s, prey);
        }
    }

    /// Whom the human of vehicle `i` is after: the driven vehicle whose common zone is nearest.
    fn prey(&self, i: usize) -> Option<Prey<'s>> {
        let me = &self.bodies[i];
        let driven = self.driven.iter().copied();
        let others = driven.filter(|&j| j != i && !self.bodies[j].gone);
        let meeting = others.filter_map(|j| {
            let ego = &self.bodies[j];
            let areas = self.setup.site.areas(ego.lane, me.lane);
            let ahead = areas
                .iter()
                .filter(|area| ego.state.s < area.ego[1] && me.state.s < area.other[1]);
            let nearest = ahead.map(|area| area.other[0]).reduce(f64::min)?;
            Some((nearest, j))
        });
        let (_, j) = meeting.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(self.prey_of(i, j))
    }

    /// What the one at place `i` knows of vehicle `j`.
    fn prey_of(&self, i: usize, j: usize) -> Prey<'s> {
        let go = match &self.minds[j] {
            Mind::Shielded(pilot) => pilot.plan().map_or(0, |plan| plan.go),
            _ => 0,
        };
        let [me, ego] = [i, j].map(|at| &self.bodies[at]);
        Prey {
            state: ego.state,
            command: ego.felt,
            go,
            areas: self.setup.site.areas(ego.lane, me.lane),
        }
    }

    /// One tick of motion of everybody.
    fn advance(&mut self, tick: u64) {
        for i in 0..self.bodies.len() {
            if self.bodies[i].gone {
                continue;
            }
            let acceleration = match &self.minds[i] {
                Mind::Walker(walker) => {
                    self.bodies[i].walk(self.setup.site, walker.velocity);
                    continue;
                }
                Mind::Shielded(_) | Mind::Plain(_) => self.bodies[i].actuator.acceleration(tick),
                Mind::Human(human) => self.humanly(i, tick, human.wanted()),
                Mind::Waiting(_, human) => {
                    let ego = self.numbers.ego;
                    let wanted = human.wanted().clamp(-ego.braking, ego.acceleration);
                    // What it does acts on until the shield's first command is followed: others fear no more speed.
                    let room = (ego.speed - self.bodies[i].state.v).max(0.0);
                    let wanted = wanted.min(room / (TICK + self.numbers.response()));
                    self.humanly(i, tick, wanted)
                }
            };
            self.bodies[i].go(self.setup.site, acceleration);
        }
    }

    /// What the contract lets the human of vehicle `i` do of what it wants.
    fn humanly(&mut self, i: usize, tick: u64, wanted: f64) -> f64 {
        let (site, count) = (self.setup.site, self.bodies.len());
        let mut limit = wanted;
        for &j in &self.driven {
            let (me, ego) = (&self.bodies[i], &self.bodies[j]);
            let areas = site.areas(ego.lane, me.lane);
            let shared = site.shared(ego.lane, me.lane);
            if i == j || ego.gone || (areas.is_empty() && shared.is_empty()) {
                continue;
            }
            let meeting = Meeting {
                ego: ego.state,
                me: me.state,
                areas,
                shared,
                ego_line: self.lines[j],
                line: self.lines[i],
                first: site.goes_first(me.lane, ego.lane),
                priority: site.priority,
            };
            let duty = &mut self.duties[i * count + j];
            limit = duty.limit(&self.numbers, &meeting, tick as f64 * TICK, limit);
        }
        limit
    }

    /// Whether a shielded vehicle with a verified plan touches anybody.
    fn overlaps(&mut self, tick: u64) -> bool {
        for i in 0..self.minds.len() {
            let flagged = match &self.minds[i] {
                Mind::Shielded(pilot) if pilot.guarded => pilot.flagged,
                Mind::Plain(_) => false,
                _ => continue,
            };
            if self.bodies[i].gone {
                continue;
            }
            for j in (0..self.minds.len()).filter(|&j| j != i && !self.bodies[j].gone) {
                if matches!(&self.minds[i], Mind::Shielded(pilot) if !pilot.expects(j)) {
                    continue;
                }
                let pair = [i, j].map(|k| self.bodies[k].seen(self.setup.site));
                if self.judge.touch(tick, (i, j), pair) {
                    self.found(i, j, tick, flagged);
                    return true;
                }
            }
        }
        false
    }

    fn found(&mut self, ego: usize, other: usize, tick: u64, flagged: bool) {
        let speeds = [ego, other].map(|i| self.bodies[i].state.v);
        self.outcome
            .complain(tick, || format!("vehicles {ego} and {other} overlap"));
        self.outcome.overlap = Some(Overlap {
            ego,
            other,
            tick,
            speeds,
            flagged,
        });
    }

    /// Whether all driven vehicles are through, with some room behind them.
    fn is_over(&self) -> bool {
        self.driven.iter().all(|&i| {
            let body = &self.bodies[i];
            body.gone || body.state.s > self.clear[i] + 12.0
        })
    }

    fn tick_clock(&mut self, i: usize) {
        let outside = self.setup.outside;
        let clock = &mut self.clocks[i];
        clock.due += clock.period;
        let shielded = matches!(self.minds[i], Mind::Shielded(_));
        while shielded && outside.missed > 0.0 && self.rng.chance(outside.missed) {
            clock.due += clock.period;
            // Nobody promises anything until it is called again.
            if let Mind::Shielded(pilot) = &mut self.minds[i] {
                pilot.guarded = false;
            }
        }
        let away = away(clock.jitter, &mut self.rng);
        clock.next = clock.due.saturating_add_signed(away).max(clock.next + 1);
    }

    fn say(&self, i: usize, tick: u64) {
        if !self.trace {
            return;
        }
        let Mind::Shielded(pilot) = &self.minds[i] else {
            return;
        };
        let Some(decision) = pilot.last else { return };
        println!(
            "{:7.3} s: vehicle {i}: {:6.2} m/s², {:8.2} m to spare, plan {:?}: {decision}",
            tick as f64 * TICK,
            decision.acceleration,
            decision.margin,
            decision.plan.map(|plan| plan.go),
        );
        for (j, body) in self
            .bodies
            .iter()
            .enumerate()
            .filter(|(_, body)| !body.gone)
        {
            let (lane, state) = (body.lane, body.state);
            let number = if i == j {
                String::new()
            } else {
                format!("track {}", pilot.number(j))
            };
            println!(
                "           {j} on lane {lane}: s {:8.3} m, v {:6.3} m/s, a {:6.2} m/s² {number}",
                state.s, state.v, body.felt
            );
        }
    }
}

fn mind<'s, R: Rules + Clone>(
    setup: &'s Setup<'s>,
    numbers: &Numbers,
    bodies: &[Body],
    i: usize,
    rng: &mut Rng,
) -> Option<Mind<'s, R>> {
    let factor = setup.outside.others;
    let means = Means {
        speed: numbers.other.speed,
        acceleration: factor * numbers.other.acceleration,
        braking: factor * numbers.other.braking,
    };
    let human = |manner: &crate::human::Manner, rng: &mut Rng| {
        Human::new(manner.clone(), means, rng.fork())
    };
    let driver = |proposer, rng: &mut Rng| proposer::Driver::new(proposer, rng.fork());
    Some(match &setup.cars[i].driver {
        Driver::Human(manner) => Mind::Human(human(manner, rng)),
        Driver::Walker(gait) => {
            let pace = setup.site.lanes[setup.cars[i].lane].pace;
            Mind::Walker(Walker::new(*gait, pace, rng.fork()))
        }
        Driver::Plain { proposer } => {
            let driver = driver(*proposer, rng);
            Mind::Plain(Box::new(Plain::new(
                setup,
                bodies.len(),
                i,
                driver,
                rng.fork(),
            )))
        }
        Driver::Shielded {
            proposer,
            from,
            before,
        } => {
            let driver = driver(*proposer, rng);
            let pilot = Box::new(Pilot::new(setup, bodies, i, driver, rng.fork()).ok()?);
            if *from == 0 {
                Mind::Shielded(pilot)
            } else {
                Mind::Waiting(pilot, human(before, rng))
            }
        }
    })
}

fn is_driven<R: Rules>(mind: &Mind<'_, R>) -> bool {
    !matches!(mind, Mind::Human(_) | Mind::Walker(_))
}

fn clock<R: Rules>(mind: &Mind<'_, R>, numbers: &Numbers, outside: f64, rng: &mut Rng) -> Clock {
    let (period, jitter) = match mind {
        Mind::Human(_) | Mind::Walker(_) => (ticks(CHOICE), 0),
        _ => (
            ticks(numbers.period),
            ticks(numbers.jitter + outside * numbers.period),
        ),
    };
    let due = jitter + rng.below(period as usize) as u64;
    Clock {
        due,
        next: due.saturating_add_signed(away(jitter, rng)),
        period,
        jitter,
    }
}

/// A deviation of a call from its time, in ticks.
fn away(jitter: u64, rng: &mut Rng) -> i64 {
    let jitter = jitter as i64;
    match jitter {
        0 => 0,
        _ if rng.chance(0.5) => jitter * rng.sign() as i64,
        _ => rng.below(2 * jitter as usize + 1) as i64 - jitter,
    }
}

/// Where vehicle `i` has passed all crossings with the others that are there; near the end of its lane, if it has none.
fn clear(setup: &Setup<'_>, i: usize) -> f64 {
    let lane = setup.cars[i].lane;
    let others = setup.cars.iter().enumerate().filter(|&(j, _)| j != i);
    let areas = others.flat_map(|(_, other)| setup.site.areas(lane, other.lane));
    let ends = areas.filter(|area| !area.lane).map(|area| area.ego[1]);
    let length = setup.site.lanes[lane].line.length();
    ends.filter(|&end| end < length)
        .fold(0.6 * length, f64::max)
        .min(length - 20.0)
}
