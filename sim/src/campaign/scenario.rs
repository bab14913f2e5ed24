//! Random scenarios: vehicles on random routes through one intersection.

use super::OTHERS;
use crate::meeting::{conflict, crossroads};
use cede_controller::kinematics::State;
use cede_controller::separation::OrientedBox;
use cede_controller::shield::margin::safe_gap;
use cede_controller::{
    Class, Contract, ContractBuilder, Footprint, Junction, Point, Precedence, Route, RouteConflict,
    Vector, Zone,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f32::consts::{FRAC_PI_2, TAU};

/// What kind of scenarios a campaign runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// What the shields assume, and the others keep.
    pub contract: Contract,
    /// Vehicles, at least 2 and at most 9.
    pub vehicles: usize,
    /// Every vehicle is shielded, not only the first.
    pub everyone: bool,
    /// Probability at each step that a shielded vehicle's sensors go blind for up to 4 s.
    pub blackouts: f64,
    /// Everybody leaves by one and the same arm, so that all routes merge.
    pub one_exit: bool,
    /// Vehicles begin at rest near their zones.
    pub at_rest: bool,
    /// Length in steps.
    pub steps: u32,
}

impl Setup {
    /// One careless shielded vehicle among three adversaries; sensors are exact.
    pub const ADVERSARIES: Self = Self {
        contract: Contract::WORST_CASE,
        vehicles: 4,
        everyone: false,
        blackouts: 0.0,
        one_exit: false,
        at_rest: false,
        steps: 150,
    };

    /// Every vehicle is shielded; they drive a little slower than the others that they fear.
    ///
    /// # Panics
    /// If `contract` does not allow for 14 m/s: its rule of precedence together with a speed error of some m/s.
    #[must_use]
    pub const fn everyone(contract: Contract, vehicles: usize) -> Self {
        let mut setup = Self::ADVERSARIES;
        setup.contract = valid(contract.to_builder().ego_max_speed(14.0));
        setup.vehicles = vehicles;
        setup.everyone = true;
        setup
    }

    /// The set-ups of a campaign, each with its name.
    #[must_use]
    pub fn all() -> [(&'static str, Self); 14] {
        let among = |vehicles| Self {
            vehicles,
            ..Self::ADVERSARIES
        };
        let noisy = |mut setup: Self| {
            let sensed = setup.contract.to_builder();
            setup.contract = valid(sensed.position_error(0.3).speed_error(0.3));
            setup
        };
        let (worst, stop) = (Contract::WORST_CASE, Contract::ALL_WAY_STOP);
        let blind = |blackouts, setup| Self { blackouts, ..setup };
        let merging = |setup| Self {
            one_exit: true,
            ..setup
        };
        let at_rest = Self {
            at_rest: true,
            steps: 600,
            ..Self::everyone(stop, 3)
        };
        let mut turns = Self {
            steps: 200,
            ..at_rest
        };
        let mut rule = Precedence::ALL_WAY_STOP;
        rule.patience = 5;
        let impatient = turns.contract.to_builder().precedence(Some(rule));
        turns.contract = valid(impatient.speed_error(0.3));
        let mut slow = among(3);
        slow.contract = valid(slow.contract.to_builder().ego_max_speed(1.5));
        [
            ("one adversary", among(2)),
            ("three adversaries", among(4)),
            ("eight adversaries", among(9)),
            ("merging", merging(among(3))),
            ("slow among fast", slow),
            ("sensing errors", noisy(among(3))),
            ("blackouts", noisy(blind(0.02, among(3)))),
            ("often blind", blind(0.06, among(7))),
            ("mostly blind", blind(0.3, among(5))),
            ("all shielded", Self::everyone(worst, 4)),
            ("all shielded, merging", merging(Self::everyone(worst, 4))),
            ("all shielded, precedence", Self::everyone(stop, 5)),
            ("from rest, precedence", at_rest),
            ("from rest, short turns", turns),
        ]
    }
}

/// A vehicle of a scenario.
#[derive(Clone, Debug)]
pub(super) struct Entrant {
    pub(super) route: Route<POINTS>,
    pub(super) start: State,
    /// What tracking calls it.
    pub(super) number: u16,
}

/// Most vehicles of a scenario.
const VEHICLES: usize = OTHERS + 1;

/// Points of a route, at most.
const POINTS: usize = 32;

/// A junction with a path for each vehicle of a scenario, followed exactly.
pub(super) type Crossing = Junction<VEHICLES, { VEHICLES * POINTS }>;

/// Vehicles that are about to meet.
#[derive(Clone, Debug)]
pub struct Scenario {
    pub(super) setup: Setup,
    /// The speed (m/s) beyond which shielded vehicles do not accelerate, whatever is commanded.
    pub(super) limit: f32,
    pub(super) vehicles: Vec<Entrant>,
    /// Path i is that of vehicle i.
    pub(super) junction: Crossing,
}

/// Where a lane enters or leaves the intersection, and the outward direction there.
#[derive(Clone, Copy)]
struct Gate {
    at: Point,
    outward: Vector,
}

/// How often a place for a vehicle is looked for.
const ATTEMPTS: u32 = 20;

/// Metres from a route's start to where its lane begins to bend.
const APPROACH: f32 = 60.0;

/// Metres from where its lane has bent to a route's end: a path may be 512 m long.
const EXIT: f32 = 400.0;

impl Scenario {
    /// The scenario of `setup` that [`campaign`](super::campaign) runs with `seed`.
    #[must_use]
    pub fn of_seed(setup: Setup, seed: u64) -> Option<Self> {
        Self::random(setup, &mut Pcg64::seed_from_u64(seed))
    }

    /// The junction of its vehicles.
    #[must_use]
    pub const fn junction(&self) -> &Crossing {
        &self.junction
    }

    /// A random scenario with as many vehicles as `setup` asks for, or fewer if there is no room;
    /// `None` without room for two, or if their number is out of range.
    #[must_use]
    pub fn random(setup: Setup, rng: &mut Pcg64) -> Option<Self> {
        if setup.vehicles < 2 || setup.vehicles > OTHERS + 1 {
            return None;
        }
        let layout = Layout::random(rng);
        let mut placed: Vec<(Route<POINTS>, State)> = Vec::new();
        for _ in 0..setup.vehicles {
            let mut candidates = (0..ATTEMPTS)
                .filter_map(|_| Some((layout.route(setup, rng)?, start(setup, rng))))
                .filter(|candidate| fits(setup, candidate, &placed));
            if let Some(found) = candidates.next() {
                placed.push(found);
            }
        }
        if placed.len() < 2 {
            return None;
        }
        let junction = junction(&placed)?;
        let limit = limit(setup, rng);
        let vehicles = (0..).zip(placed).map(|(i, (route, start))| Entrant {
            route,
            start,
            // Different for each, and otherwise anything.
            number: 16 * rng.random_range(0..4096) + i,
        });
        Some(Self {
            setup,
            limit,
            vehicles: vehicles.collect(),
            junction,
        })
    }
}

/// The contract of a set-up.
///
/// # Panics
/// If a number is out of its range.
const fn valid(numbers: ContractBuilder) -> Contract {
    match numbers.build() {
        Ok(contract) => contract,
        Err(_) => panic!("a number of a set-up's contract is out of its range"),
    }
}

/// A shielded vehicle's limiter errs as its sensors do. One that no shielded vehicle has to fear may do without:
/// the guarantee holds either way.
fn limit(setup: Setup, rng: &mut Pcg64) -> f32 {
    let contract = setup.contract;
    if setup.everyone || rng.random_bool(0.5) {
        contract.ego().max_speed + contract.speed_error() * rng.random_range(-1.0..=1.0_f32)
    } else {
        f32::INFINITY
    }
}

/// The junction of all vehicles; in a tie, vehicles with lower numbers go first.
fn junction(placed: &[(Route<POINTS>, State)]) -> Option<Crossing> {
    let mut builder = Crossing::builder();
    builder.tolerance(0.0);
    let mut paths = Vec::new();
    for (route, _) in placed {
        let path = builder.path(route, Class::Car, Footprint::PAPER).ok()?;
        for &first in &paths {
            builder.right_of_way(first, path).ok()?;
        }
        paths.push(path);
    }
    builder.build().ok()
}

fn start(setup: Setup, rng: &mut Pcg64) -> State {
    if setup.at_rest {
        return State {
            s: APPROACH - rng.random_range(2.0..8.0),
            v: 0.0,
        };
    }
    State {
        s: APPROACH - rng.random_range(-15.0..45.0_f32),
        v: if rng.random_bool(0.2) {
            0.0
        } else {
            rng.random_range(0.0..14.0)
        },
    }
}

/// Whether a vehicle has room among those that are there: nobody overlaps, and whoever is behind another
/// in its lane can stop behind it.
fn fits(
    setup: Setup,
    (route, start): &(Route<POINTS>, State),
    placed: &[(Route<POINTS>, State)],
) -> bool {
    let covers = |route: &Route<POINTS>, state: &State| {
        OrientedBox::new(route.pose(state.s), Footprint::PAPER)
    };
    let here = covers(route, start);
    placed.iter().all(|(other_route, other)| {
        let apart = here.separation(&covers(other_route, other)) > 0.5;
        // In the order of the scenario's junction: where two meet often, their zones depend on it.
        let routes = [other_route, route].map(|route| (route, Footprint::PAPER));
        apart
            && crossroads(routes).is_ok_and(|junction| {
                let conflict = conflict(&junction, 0);
                let zones = || conflict.into_iter().flat_map(RouteConflict::zones);
                zones().all(|zone| leaves_room(setup, zone, other, start))
                    && zones().all(|zone| leaves_room(setup, &zone.swapped(), start, other))
            })
    })
}

/// Whether one who is behind `ego` in the lane of `zone` can still stop behind it. Who is ahead is what a
/// shield thinks, or may think with its sensing errors: two that begin side by side where lanes run
/// together have no room.
fn leaves_room(setup: Setup, zone: &Zone, ego: &State, other: &State) -> bool {
    let contract = &setup.contract;
    let (lead, error) = (ego.s - other.s, contract.position_error());
    let entered = ego.s + 2.0 * error >= zone.ego.from && other.s <= zone.other.to;
    let ahead = zone.is_lane() && entered && lead + 2.0 * error >= zone.middle();
    !ahead || lead - zone.lead.to >= safe_gap(contract, other.v, ego.v)
}

/// The arms of an intersection.
struct Layout {
    arms: Vec<f32>,
    /// Half the distance between the two directions' lanes, in m.
    offset: f32,
    /// From the centre to where lanes begin to bend, in m.
    radius: f32,
}

impl Layout {
    fn random(rng: &mut Pcg64) -> Self {
        let turn = rng.random_range(0.0..TAU);
        let arms = (0..4_u8)
            .map(|i| turn + FRAC_PI_2 * f32::from(i) + rng.random_range(-0.4..0.4_f32))
            .collect();
        Self {
            arms,
            offset: rng.random_range(1.2..2.2),
            radius: rng.random_range(6.0..12.0),
        }
    }

    fn route(&self, setup: Setup, rng: &mut Pcg64) -> Option<Route<POINTS>> {
        let to = if setup.one_exit {
            0
        } else {
            rng.random_range(0..self.arms.len())
        };
        let from = (to + rng.random_range(1..self.arms.len())) % self.arms.len();
        let (entry, exit) = (self.gate(from, -1.0), self.gate(to, 1.0));
        let far = |gate: Gate, distance: f32| gate.at + gate.outward * distance;
        // A cubic curve with its inner control points 0.55 of the radius inwards, in 12 pieces.
        let inner = 0.55 * self.radius;
        let control = [entry.at, far(entry, -inner), far(exit, -inner), exit.at];
        let bend = (0..=12_u8).map(|i| bezier(control, f32::from(i) / 12.0));
        let points = std::iter::once(far(entry, APPROACH))
            .chain(bend)
            .chain(std::iter::once(far(exit, EXIT)));
        Route::new(points).ok()
    }

    /// The lane of arm `arm` that enters (`side` = −1) or leaves (`side` = 1), on the right-hand side.
    fn gate(&self, arm: usize, side: f32) -> Gate {
        let angle = self.arms[arm];
        let outward = Vector::new(angle.cos(), angle.sin());
        let right = Vector::new(outward.y, -outward.x);
        Gate {
            at: Point::from(outward * self.radius + right * (side * self.offset)),
            outward,
        }
    }
}

fn bezier(control: [Point; 4], t: f32) -> Point {
    let [a, b, c, d] = control.map(|point| point.coords);
    let u = 1.0 - t;
    Point::from(a * (u * u * u) + b * (3.0 * u * u * t) + c * (3.0 * u * t * t) + d * (t * t * t))
}
