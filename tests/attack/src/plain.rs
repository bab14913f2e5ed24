//! The plain rule to compare with: brake at 3 m/s² when times in a zone overlap.

use crate::body::Body;
use crate::motion::State;
use crate::numbers::Numbers;
use crate::proposer;
use crate::rng::Rng;
use crate::setup::Setup;
use crate::sight::{Shown, Sight};
use crate::site::Area;

/// Braking of the rule in m/s².
const BRAKING: f64 = 3.0;

/// Seconds that are kept between two who pass.
const HEADWAY: f64 = 1.0;

/// Nobody looks farther ahead than this (s).
const AHEAD: f64 = 6.0;

/// A driver that keeps the plain rule.
#[derive(Clone, Debug)]
pub struct Plain {
    me: usize,
    driver: proposer::Driver,
    sights: Vec<Sight>,
    rng: Rng,
}

impl Plain {
    /// The driver of vehicle `me` of `count`.
    #[must_use]
    pub fn new(
        setup: &Setup<'_>,
        count: usize,
        me: usize,
        driver: proposer::Driver,
        mut rng: Rng,
    ) -> Self {
        let sight = |number| Sight::new(&setup.sensing, number as u16, &mut rng);
        Self {
            me,
            driver,
            sights: (0..count).map(sight).collect(),
            rng,
        }
    }

    /// The command for the next period.
    pub fn decide(&mut self, setup: &Setup<'_>, numbers: &Numbers, bodies: &[Body]) -> f64 {
        let wanted = f64::from(self.driver.propose(numbers, bodies[self.me].state.v));
        let wanted = if wanted.is_finite() { wanted } else { 0.0 };
        let mut sense = |j: usize| {
            let shown = self.sights[j].shown(&setup.sensing, false, &mut self.rng);
            let [place, speed] = self.sights[j].errors();
            let State { s, v } = bodies[j].state;
            let scale = setup.sensing.scale;
            let state = State {
                s: s + scale * place * numbers.position_error,
                v: (v + scale * speed * numbers.speed_error).max(0.0),
            };
            (shown == Shown::Seen || j == self.me).then_some(state)
        };
        let Some(ego) = sense(self.me) else {
            return wanted;
        };
        let others = (0..bodies.len()).filter(|&j| j != self.me && !bodies[j].gone);
        let danger = others
            .filter_map(|j| sense(j).map(|state| (j, state)))
            .any(|(j, other)| {
                let areas = setup.site.areas(bodies[self.me].lane, bodies[j].lane);
                areas.iter().any(|area| meets(area, ego, other))
            });
        let limited = wanted.clamp(-numbers.ego.braking, numbers.ego.acceleration);
        if danger {
            -BRAKING.min(numbers.ego.braking)
        } else {
            limited
        }
    }
}

/// From when to when a vehicle at constant speed is in a zone, in s from now.
fn stay(state: State, zone: [f64; 2]) -> [f64; 2] {
    let v = state.v.max(0.3);
    [(zone[0] - state.s) / v, (zone[1] - state.s) / v]
}

/// Whether the ego is still before the zone and both would be there at once.
fn meets(area: &Area, ego: State, other: State) -> bool {
    let ([a, b], [c, d]) = (stay(ego, area.ego), stay(other, area.other));
    let ahead = ego.s < area.ego[0] || area.lane;
    if area.lane && ego.s > area.ego[0] {
        let gap = other.s - ego.s + area.lead[0];
        return gap > 0.0 && gap < 2.0 + ego.v + ego.v * ego.v / 6.0 - other.v * other.v / 16.0;
    }
    ahead && a < AHEAD && a < d + HEADWAY && c < b + HEADWAY && d > 0.0
}
