//! All vehicles and their shields, step by step.

use crate::body::Body;
use crate::setting::{ARRIVED, Setting};
use crate::watch::{Look, Watch};
use cede_controller::Instant;
use cede_controller::dangerous::{Rules, Sound};
use core::fmt::Debug;
use core::marker::PhantomData;
use stateright::{Model, Property};

/// Never do two rely on precedence over each other.
pub const NEVER_BOTH: &str = "never both";

/// Nobody relies on what the other could still rely on less than two periods ago.
pub const NOT_AT_ONCE: &str = "not at once";

/// Somebody relies on precedence at some time: the model is not empty.
pub const SOMEBODY: &str = "somebody";

/// Everything at one moment.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct World<const N: usize> {
    /// Steps since the beginning, up to when all have arrived.
    time: u8,
    /// Steps since a period of the grid began.
    step: u8,
    /// Disturbances that may still happen.
    left: u8,
    /// The vehicles.
    pub bodies: [Body; N],
    /// Their shields.
    pub watches: [Watch<N>; N],
    /// Steps since each has relied on precedence over each other, up to two periods.
    since: [[u8; N]; N],
}

/// What everybody does in one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Step<const N: usize> {
    bodies: [Body; N],
    looks: [Look<N>; N],
    /// The first shield is switched on before.
    starts: bool,
    cost: u8,
}

/// A setting with the rules of `R`.
#[derive(Clone, Debug)]
pub struct Watched<const N: usize, R = Sound> {
    setting: Setting<N>,
    /// A late shield takes everybody for one that has just moved.
    hasty: bool,
    rules: PhantomData<R>,
}

impl<const N: usize, R: Rules> Watched<N, R> {
    /// The setting with these rules.
    pub const fn new(setting: Setting<N>) -> Self {
        Self {
            setting,
            hasty: false,
            rules: PhantomData,
        }
    }

    /// The same, where a shield that is switched on late takes everybody for one that has just moved.
    #[must_use]
    pub fn hasty(self) -> Self {
        Self {
            hasty: true,
            ..self
        }
    }

    /// Steps of two periods.
    const fn two_periods(&self) -> u8 {
        2 * self.setting.grain
    }

    /// Whether shield `own` may be called in this step, and whether it must be.
    fn due(&self, own: usize, step: u8, watch: &Watch<N>) -> (bool, bool) {
        let setting = &self.setting;
        let grain = setting.grain;
        // Steps since the earliest moment of its call.
        let open = (step + 2 * grain - setting.phases[own] + setting.jitter) % grain;
        let may = open <= 2 * setting.jitter && !watch.called && watch.on;
        (may, open == 2 * setting.jitter)
    }

    fn body_steps(&self, world: &World<N>) -> Vec<([Body; N], u8)> {
        let mut all = vec![(world.bodies, 0)];
        for i in 0..N {
            let next = world.bodies[i].next(&self.setting);
            let with = |&(bodies, cost): &([Body; N], u8)| {
                let extend = move |&(body, more): &(Body, u8)| {
                    let mut bodies = bodies;
                    bodies[i] = body;
                    (bodies, cost + more)
                };
                next.iter().map(extend).collect::<Vec<_>>()
            };
            all = all.iter().flat_map(with).collect();
            all.retain(|&(_, cost)| cost <= world.left);
        }
        all
    }

    fn look_steps(&self, world: &World<N>, step: Step<N>) -> Vec<Step<N>> {
        let mut all = vec![step];
        for own in 0..N {
            let mut watch = world.watches[own];
            watch.on |= own == 0 && step.starts;
            let next = (world.step + 1) % self.setting.grain;
            let (may, must) = self.due(own, next, &watch);
            if !may {
                continue;
            }
            let looks = watch.looks(&self.setting, own, (&step.bodies, world.left));
            let mut with = Vec::new();
            for step in all {
                if !must {
                    with.push(step);
                }
                with.extend(looks.iter().filter_map(|&(look, more)| {
                    let mut step = step;
                    step.looks[own] = look;
                    step.cost += more;
                    (step.cost <= world.left).then_some(step)
                }));
            }
            all = with;
        }
        all
    }

    /// The window of a shield's call is over: its next period begins.
    fn reopen(&self, world: &mut World<N>) {
        let setting = &self.setting;
        for own in 0..N {
            let after = (world.step + 2 * setting.grain - setting.phases[own] + setting.jitter)
                % setting.grain;
            if after == 2 * setting.jitter {
                world.watches[own].called = false;
            }
        }
    }

    fn now(&self, world: &World<N>) -> Instant {
        let micros =
            f64::from(self.setting.contract.period()) * 1e6 / f64::from(self.setting.grain);
        // A whole number; the beginning is not at 0, so that there is a time before it.
        Instant::from_micros(1_000_000 + u64::from(world.time) * micros.round() as u64)
    }
}

impl<const N: usize> World<N> {
    /// Whether `one` relies on precedence over `two`, who can still stop.
    #[must_use]
    pub fn relies(&self, one: usize, two: usize) -> bool {
        self.watches[one].claims(two) && self.bodies[two].is_outside()
    }

    fn pairs() -> impl Iterator<Item = (usize, usize)> {
        (0..N).flat_map(|one| (0..N).map(move |two| (one, two)))
    }

    fn both(&self) -> bool {
        Self::pairs().any(|(one, two)| one < two && self.relies(one, two) && self.relies(two, one))
    }

    fn at_once(&self, periods: u8) -> bool {
        let mut pairs = Self::pairs().filter(|(one, two)| one != two);
        pairs.any(|(one, two)| self.relies(one, two) && self.since[two][one] < periods)
    }
}

impl<const N: usize, R: Rules> Model for Watched<N, R>
where
    R: Send + Sync + 'static,
{
    type State = World<N>;
    type Action = Step<N>;

    fn init_states(&self) -> Vec<World<N>> {
        let setting = &self.setting;
        let world = |on: bool| {
            let mut watches = [Watch::new(true); N];
            watches[0] = Watch::new(on);
            let bodies = setting.starts.map(|place| Body {
                place,
                speed: if place < ARRIVED { setting.top } else { 0 },
            });
            World {
                time: 0,
                step: setting.grain - 1,
                left: setting.disturbances,
                bodies,
                watches,
                since: [[self.two_periods(); N]; N],
            }
        };
        let mut all = vec![world(true)];
        if setting.late {
            all.push(world(false));
        }
        all
    }

    fn actions(&self, world: &World<N>, actions: &mut Vec<Step<N>>) {
        for (bodies, cost) in self.body_steps(world) {
            let step = Step {
                bodies,
                looks: [Look::Nothing; N],
                starts: false,
                cost,
            };
            actions.extend(self.look_steps(world, step));
            if !world.watches[0].on {
                let starts = true;
                actions.extend(self.look_steps(world, Step { starts, ..step }));
            }
        }
    }

    fn next_state(&self, last: &World<N>, step: Step<N>) -> Option<World<N>> {
        let setting = &self.setting;
        let mut world = last.clone();
        world.time = (world.time + 1).min(setting.arrive_by);
        world.step = (world.step + 1) % setting.grain;
        world.left -= step.cost;
        world.bodies = step.bodies;
        if step.starts {
            world.watches[0].on = true;
            if self.hasty {
                world.watches[0].assume_motion(setting);
            }
        }
        let now = self.now(&world);
        for own in 0..N {
            let seen = (&step.bodies, now);
            world.watches[own].does::<R>(setting, own, seen, step.looks[own]);
        }
        self.reopen(&mut world);
        for (one, two) in World::<N>::pairs() {
            let since = &mut world.since[one][two];
            *since = (*since + 1).min(self.two_periods());
            if world.watches[one].claims(two) && world.bodies[two].is_outside() {
                world.since[one][two] = 0;
            }
        }
        Some(world)
    }

    fn properties(&self) -> Vec<Property<Self>> {
        vec![
            Property::always(NEVER_BOTH, |_, world: &World<N>| !world.both()),
            Property::always(NOT_AT_ONCE, |model: &Self, world: &World<N>| {
                !world.at_once(model.two_periods())
            }),
            Property::sometimes(SOMEBODY, |_, world: &World<N>| {
                World::<N>::pairs().any(|(one, two)| world.relies(one, two))
            }),
        ]
    }

    fn within_boundary(&self, world: &World<N>) -> bool {
        let setting = &self.setting;
        let arrives =
            world.time < setting.arrive_by || world.bodies.iter().all(|body| body.place >= ARRIVED);
        let mut watches = (0_usize..).zip(&world.watches);
        let rests = watches.all(|(own, watch)| watch.longest(own) <= setting.longest);
        arrives && rests
    }
}
