//! Lanes of which a part is out of sight, behind a corner or a lorry.

use crate::body::Body;
use crate::lane::Leg;
use crate::rng::Rng;
use crate::setup::Setup;
use cede_controller::Sight;

/// A shield is told of so many lanes at most; others are in sight.
const LANES: usize = 8;

/// A corner is somewhere else from one decision to the next with this probability: something moves into the way, or out of it.
const MOVES: f64 = 0.04;

/// A lane that is in sight from some place on.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    lane: usize,
    leg: Leg,
    /// Where its vehicles wait, m along its path.
    line: f64,
    /// The place, m along its path.
    from: f32,
}

impl Corner {
    /// Those of vehicle `me` in a `junction`: of lanes that meet its own farther on.
    #[must_use]
    pub fn all(setup: &Setup<'_>, me: &Body, junction: usize, rng: &mut Rng) -> Vec<Self> {
        let site = setup.site;
        let numbered = site.lanes.iter().enumerate();
        let meets = numbered.filter(|&(lane, _)| {
            let mut areas = site.areas(me.lane, lane).iter().peekable();
            lane != me.lane
                && areas.peek().is_some()
                && areas.all(|area| !area.lane || area.ego[0] > me.state.s)
        });
        let corners = meets.filter_map(|(lane, there)| {
            let leg = *there.legs.iter().find(|leg| leg.junction == junction)?;
            let line = site.line(lane) - leg.offset;
            Some((lane, leg, line))
        });
        let taken: Vec<_> = corners.take(LANES).collect();
        let placed = taken.into_iter().map(|(lane, leg, line)| {
            let mut corner = Self {
                lane,
                leg,
                line,
                from: 0.0,
            };
            corner.place(rng);
            corner
        });
        placed.collect()
    }

    fn place(&mut self, rng: &mut Rng) {
        let far = rng.pick(&[10.0, 40.0, 80.0]);
        let from = self.line - rng.within(-5.0, far);
        self.from = from.clamp(0.0, self.leg.length - 1.0) as f32;
    }

    /// From one decision to the next.
    pub fn pass(&mut self, rng: &mut Rng) {
        if rng.chance(MOVES) {
            self.place(rng);
        }
    }

    /// Whether a vehicle is behind it.
    #[must_use]
    pub fn hides(&self, body: &Body) -> bool {
        body.lane == self.lane && body.state.s - self.leg.offset < f64::from(self.from)
    }

    /// What the shield is told; nobody there is faster than `speed` (m/s).
    #[must_use]
    pub fn sight(&self, speed: f32) -> Sight {
        Sight {
            path: self.leg.path,
            from: self.from,
            speed,
        }
    }
}
