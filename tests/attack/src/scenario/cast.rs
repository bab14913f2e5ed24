//! Who is where at the beginning.

use crate::actuator::Takeover;
use crate::body::KERB;
use crate::human::{Gait, Manner};
use crate::motion::State;
use crate::numbers::Numbers;
use crate::plane::separation;
use crate::proposer::Proposer;
use crate::rng::Rng;
use crate::setup::{Car, Driver};
use crate::shared::{EARLY, Shared};
use crate::site::{Area, Site};
use crate::sway::Sway;

/// How a scenario's vehicles begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// On the way, before or in the junction.
    Moving,
    /// Most of them at rest near their lines.
    Rest,
    /// On the way, well before their lines.
    Far,
    /// One behind the other in the first lane.
    Queue,
    /// Bumper to bumper in the first lane and in one across, most at rest.
    Platoon,
    /// The others at rest in the junction and around it, shielded vehicles on the way to it.
    Jam,
}

/// What humans are like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Manners {
    /// They aim at shielded vehicles.
    Hostile,
    /// They do not look.
    Gentle,
    /// They accelerate as a search says.
    Searched,
    /// They stop and go.
    Queueing,
    /// They stand, and leave one after the other.
    Leaving,
}

/// Who takes part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cast {
    /// Vehicles.
    pub vehicles: usize,
    /// How many of them have the shield.
    pub shielded: usize,
    /// How they begin.
    pub start: Start,
    /// Probability that a shield is switched on late.
    pub late: f64,
    /// What the others are like.
    pub manners: Manners,
    /// Shielded vehicles are those of the first lane.
    pub first_lane: bool,
    /// Shielded vehicles let their turns pass.
    pub hesitant: bool,
    /// On foot.
    pub walkers: usize,
}

/// How often a place for a vehicle is looked for.
const ATTEMPTS: u32 = 25;

impl Cast {
    /// One shielded vehicle among `others` that are hostile.
    #[must_use]
    pub const fn one(others: usize) -> Self {
        Self {
            vehicles: others + 1,
            shielded: 1,
            start: Start::Moving,
            late: 0.0,
            manners: Manners::Hostile,
            first_lane: false,
            hesitant: false,
            walkers: 0,
        }
    }

    /// All vehicles are shielded.
    #[must_use]
    pub const fn all(vehicles: usize) -> Self {
        Self {
            shielded: vehicles,
            ..Self::one(vehicles - 1)
        }
    }

    /// The vehicles; none if there is no room for two.
    #[must_use]
    pub fn cars(&self, site: &Site, numbers: &Numbers, rng: &mut Rng) -> Option<Vec<Car>> {
        let mut cars: Vec<Car> = Vec::new();
        for number in 0..self.vehicles {
            let found = (0..ATTEMPTS).find_map(|_| {
                let car = self.car(number, site, numbers, rng);
                let fits = cars.iter().all(|there| fit(site, numbers, there, &car));
                fits.then_some(car)
            });
            if let Some(car) = found {
                cars.push(car);
            } else if number == 0 {
                return None;
            }
        }
        let walks = site.roads() < site.lanes.len();
        let walkers = (0..self.walkers).filter(|_| walks);
        cars.extend(walkers.map(|_| walker(site, rng)));
        (cars.len() >= 2).then_some(cars)
    }

    fn lane(&self, number: usize, site: &Site, rng: &mut Rng) -> usize {
        if self.first_lane && number == 0 {
            return 0;
        }
        match self.start {
            Start::Queue if rng.chance(0.75) => 0,
            Start::Platoon if rng.chance(0.6) => 0,
            Start::Platoon if rng.chance(0.7) => 1,
            _ => rng.below(site.roads()),
        }
    }

    fn car(&self, number: usize, site: &Site, numbers: &Numbers, rng: &mut Rng) -> Car {
        let shielded = number < self.shielded;
        let lane = self.lane(number, site, rng);
        let fastest = if shielded {
            numbers.ego.speed
        } else {
            numbers.other.speed
        };
        let start = self.state(site, (lane, shielded), fastest, rng);
        let driver = if shielded {
            self.shielded(numbers, rng)
        } else {
            Driver::Human(self.manner(rng))
        };
        let ego = numbers.ego;
        let limiter = numbers.ego.speed + numbers.speed_error * rng.within(-1.0, 1.0);
        let limited = rng.chance(0.5);
        let any = rng.within(-ego.braking, ego.acceleration);
        let acceleration = rng.pick(&[0.0, -ego.braking, ego.acceleration, any]);
        // One that others fear keeps their bound on speed, before its shield does, too.
        let late = numbers.response().max(0.5);
        let fast = start.v + late * acceleration.max(0.0) > numbers.ego.speed;
        Car {
            lane,
            start,
            acceleration: if fast { 0.0 } else { acceleration },
            driver,
            cap: match (shielded, limited) {
                (true, true) => limiter.min(numbers.other.speed),
                (true, false) => f64::INFINITY,
                _ => numbers.other.speed,
            },
            takeover: rng.pick(&Takeover::ALL),
            sway: Sway::random(site.tolerance, site.lanes[lane].size, rng),
        }
    }

    fn state(
        &self,
        site: &Site,
        (lane, shielded): (usize, bool),
        fastest: f64,
        rng: &mut Rng,
    ) -> State {
        let length = site.lanes[lane].line.length();
        let line = site.line(lane).min(0.7 * length);
        let rests = rng.chance(0.15);
        let (ahead, v) = match self.start {
            Start::Moving => (rng.within(-50.0, 10.0), rng.within(0.0, fastest)),
            Start::Far => (rng.within(-70.0, -14.0), rng.within(0.0, fastest)),
            Start::Queue => (rng.within(-60.0, 30.0), rng.within(0.0, fastest)),
            Start::Platoon => {
                let slot = rng.below(12) as f64 - 8.0;
                let apart = site.lanes[lane].size.length + rng.within(0.7, 3.0);
                let slow = rng.within(0.0, 0.3 * fastest);
                (slot * apart, rng.pick(&[0.0, 0.0, slow]))
            }
            Start::Jam if shielded => (rng.within(-60.0, -5.0), rng.within(0.0, fastest)),
            Start::Jam => {
                let slow = rng.within(0.0, 2.0);
                (rng.within(-18.0, 25.0), rng.pick(&[0.0, 0.0, 0.0, slow]))
            }
            Start::Rest => {
                let near = rng.chance(0.7);
                let v = if near {
                    0.0
                } else {
                    rng.within(0.0, 0.6 * fastest)
                };
                (
                    if near {
                        rng.within(-9.0, -0.3)
                    } else {
                        rng.within(-40.0, -8.0)
                    },
                    v,
                )
            }
        };
        State {
            s: (line + ahead).clamp(2.0, length - 25.0),
            v: if rests { 0.0 } else { v },
        }
    }

    fn shielded(&self, numbers: &Numbers, rng: &mut Rng) -> Driver {
        let late = rng.chance(self.late);
        let before = if rng.chance(0.5) {
            Manner::Coast
        } else {
            Manner::Stand
        };
        let from = 1 + rng.below(1200) as u64;
        let mut proposer = if self.hesitant {
            let any = rng.below(40) as u32;
            let periods = rng.pick(&[0, any, any]);
            Proposer::Hesitates { periods }
        } else {
            Proposer::random(rng)
        };
        if let Proposer::Speed { wanted } = &mut proposer {
            *wanted = wanted.min(numbers.ego.speed);
        }
        Driver::Shielded {
            proposer,
            from: if late { from } else { 0 },
            before,
        }
    }

    fn manner(&self, rng: &mut Rng) -> Manner {
        match self.manners {
            Manners::Hostile => Manner::random(rng),
            Manners::Gentle => Manner::gentle(rng),
            Manners::Queueing => Manner::queueing(rng),
            Manners::Leaving => Manner::leaving(rng),
            Manners::Searched => Manner::Profile(vec![0.0; 24]),
        }
    }
}

/// Somebody on foot.
fn walker(site: &Site, rng: &mut Rng) -> Car {
    let roads = site.roads();
    let lane = roads + rng.below(site.lanes.len() - roads);
    let there = &site.lanes[lane];
    Car {
        lane,
        start: State {
            s: rng.within(KERB, there.line.length() - KERB),
            v: 0.0,
        },
        acceleration: 0.0,
        driver: Driver::Walker(Gait::random(rng)),
        cap: there.pace,
        takeover: Takeover::Prompt,
        sway: Sway::random(site.tolerance, there.size, rng),
    }
}

/// Whether two vehicles can begin like this, if they matter to each other.
fn fit(site: &Site, numbers: &Numbers, a: &Car, b: &Car) -> bool {
    let shielded = |car: &Car| matches!(car.driver, Driver::Shielded { .. });
    let [one, two] = [a, b].map(|car| (car.lane, car.start));
    !(shielded(a) || shielded(b))
        || can_begin(site, numbers, one, two) && can_begin(site, numbers, two, one)
}

/// Whether control of a vehicle can be handed over while there is another: they are apart, and that one is not behind
/// it in its lane, or has the safe gap. Each is a lane and a motion.
#[must_use]
pub fn can_begin(
    site: &Site,
    numbers: &Numbers,
    ego: (usize, State),
    other: (usize, State),
) -> bool {
    let place = |(lane, state): (usize, State)| site.lanes[lane].line.place(state.s);
    let size = |(lane, _): (usize, State)| site.lanes[lane].size;
    let gap = separation(place(ego), size(ego), place(other), size(other));
    let shared = site.shared(ego.0, other.0);
    let keeps = shared
        .iter()
        .all(|shared| has_gap(numbers, shared, ego.1, other.1));
    let promised = site
        .areas(ego.0, other.0)
        .iter()
        .all(|area| is_promised(numbers, area, ego.1, other.1));
    gap > 0.5 + 2.0 * site.tolerance && keeps && promised
}

/// Whether `other` has the gap that the manual's U5 demands of it: behind `ego` in what the junction calls a lane, be it a
/// crossing at a small angle in which no two drivers would see one.
fn is_promised(numbers: &Numbers, area: &Area, ego: State, other: State) -> bool {
    let error = 2.0 * numbers.position_error + 0.1;
    let lead = ego.s - other.s;
    let inside = ego.s + error >= area.ego[0] && ego.s - error <= area.ego[1];
    let ahead = lead + 2.0 * error >= 0.5 * (area.lead[0] + area.lead[1]);
    if !(area.lane && inside && ahead && other.s - error <= area.other[1]) {
        return true;
    }
    let faster = other.v + 2.0 * numbers.speed_error;
    let slower = (ego.v - 2.0 * numbers.speed_error).max(0.0);
    lead - 2.0 * error - area.lead[1] >= numbers.safe_gap(faster, slower)
}

/// Whether `other` is not behind `ego` in a lane, as far as sensors tell, or can stop there.
#[must_use]
pub(super) fn has_gap(numbers: &Numbers, shared: &Shared, ego: State, other: State) -> bool {
    let error = 2.0 * numbers.position_error + 0.1;
    // Until the first decision both move on.
    let soon = numbers.period + 2.0 * numbers.jitter;
    let early = EARLY + error + (ego.v + soon) * soon;
    let relation = shared.relation(ego.s, other.s, early);
    // One beside the ego may be taken for one behind it.
    let beyond = 2.0 * error + ego.v * soon;
    let Some(relation) = relation.filter(|relation| relation.front <= beyond) else {
        return true;
    };
    let error_v = 2.0 * numbers.speed_error;
    let faster = other.v + error_v + numbers.other.acceleration * soon;
    let slower = (ego.v - error_v - numbers.ego.braking * soon).max(0.0);
    let nearer = 2.0 * error + (faster - slower).max(0.0) * soon;
    relation.gap >= numbers.safe_gap(faster, slower) + nearer
}
