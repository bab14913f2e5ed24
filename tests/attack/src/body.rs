//! A vehicle's body: it moves along its lane as its drivetrain, its limiter or its human says.

use crate::actuator::Actuator;
use crate::judge::Seen;
use crate::lane::Leg;
use crate::motion::{State, TICK};
use crate::plane::Place;
use crate::site::Site;
use crate::sway::Sway;

/// One that is so near (m) to the end of its lane is gone.
const END: f64 = 4.0;

/// One on foot stays so far (m) from the ends of its way.
pub const KERB: f64 = 0.7;

/// A vehicle on its lane, or somebody on foot.
#[derive(Clone, Debug)]
pub struct Body {
    /// Its lane.
    pub lane: usize,
    /// Its motion.
    pub state: State,
    /// Where it is beside its lane.
    pub sway: Sway,
    /// It does not accelerate beyond this speed.
    pub cap: f64,
    /// Its drivetrain.
    pub actuator: Actuator,
    /// The acceleration of the last tick.
    pub felt: f64,
    /// It has left by the end of its lane.
    pub gone: bool,
}

impl Body {
    /// Moves for one tick at `acceleration`.
    pub fn go(&mut self, site: &Site, acceleration: f64) {
        self.felt = acceleration;
        self.state = self.state.after(acceleration, TICK, self.cap);
        self.gone = self.state.s > site.lanes[self.lane].line.length() - END;
    }

    /// Walks for one tick at `velocity` (m/s, below 0 back), and stays on its way.
    pub fn walk(&mut self, site: &Site, velocity: f64) {
        let end = site.lanes[self.lane].line.length() - KERB;
        self.felt = 0.0;
        self.state = State {
            s: (self.state.s + velocity * TICK).clamp(KERB, end),
            v: velocity.abs(),
        };
    }

    /// As the judge sees it: one on foot may be at its highest speed at once.
    #[must_use]
    pub fn seen<'s>(&self, site: &'s Site) -> Seen<'s> {
        let lane = &site.lanes[self.lane];
        Seen {
            lane,
            sway: self.sway,
            state: State {
                v: self.state.v.max(lane.pace),
                ..self.state
            },
        }
    }

    /// Where it is.
    #[must_use]
    pub fn place(&self, site: &Site) -> Place {
        self.seen(site).place()
    }

    /// The part of its lane in `junction`, if it is there now.
    #[must_use]
    pub fn leg(&self, site: &Site, junction: usize) -> Option<Leg> {
        let legs = &site.lanes[self.lane].legs;
        let leg = legs.iter().find(|leg| leg.junction == junction)?;
        let along = self.state.s - leg.offset;
        (!self.gone && (0.0..leg.length).contains(&along)).then_some(*leg)
    }
}
