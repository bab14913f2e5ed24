//! Pedestrians: they may turn back at any time, and are never faster than their pace.

use super::Prey;
use crate::rng::Rng;

/// How a pedestrian chooses where to walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gait {
    /// To and fro, or nowhere.
    Random,
    /// Into the zone, and to and fro in it.
    Dart,
    /// Stands until the ego is about to go or cannot stop any more, then darts.
    Lurk,
    /// From one end to the other, turning back on the way.
    Stroll,
}

impl Gait {
    /// One of them.
    #[must_use]
    pub fn random(rng: &mut Rng) -> Self {
        rng.pick(&[
            Self::Random,
            Self::Dart,
            Self::Lurk,
            Self::Lurk,
            Self::Lurk,
            Self::Stroll,
        ])
    }
}

/// A pedestrian.
#[derive(Clone, Debug)]
pub struct Walker {
    gait: Gait,
    pace: f64,
    /// How fast it walks, in m/s; below 0 back.
    pub velocity: f64,
    /// It has begun to dart.
    darts: bool,
    rng: Rng,
}

/// Braking in m/s² with which an ego that lurkers watch might still stop.
const STOPS: f64 = 3.0;

impl Walker {
    /// One that is never faster than `pace`.
    #[must_use]
    pub fn new(gait: Gait, pace: f64, rng: Rng) -> Self {
        Self {
            gait,
            pace,
            velocity: 0.0,
            darts: false,
            rng,
        }
    }

    /// Chooses how to walk on from arc length `s`.
    pub fn choose(&mut self, s: f64, prey: Option<Prey<'_>>) {
        match self.gait {
            Gait::Random if self.rng.chance(0.3) => {
                let any = self.rng.within(-self.pace, self.pace);
                self.velocity = self.rng.pick(&[self.pace, -self.pace, 0.0, any]);
            }
            Gait::Random => {}
            Gait::Dart => self.dart(s, prey),
            Gait::Lurk => {
                self.darts |= prey.is_some_and(|prey| cannot_stop(prey) || self.rng.chance(0.02));
                if self.darts {
                    self.dart(s, prey);
                }
            }
            Gait::Stroll => {
                if self.velocity == 0.0 || self.rng.chance(0.05) {
                    self.velocity = self.pace * self.rng.sign();
                }
            }
        }
    }

    /// To the middle of the nearest zone.
    fn dart(&mut self, s: f64, prey: Option<Prey<'_>>) {
        let middles = prey.into_iter().flat_map(|prey| prey.areas);
        let middles = middles.map(|area| 0.5 * (area.other[0] + area.other[1]));
        let nearest = middles.min_by(|a, b| (a - s).abs().total_cmp(&(b - s).abs()));
        if let Some(middle) = nearest {
            self.velocity = self.pace.copysign(middle - s);
        }
    }
}

/// Whether the ego may go on through a zone, or is too near to it to stop comfortably.
fn cannot_stop(prey: Prey<'_>) -> bool {
    let rest = prey.state.rest(STOPS);
    let before = |from: f64| prey.state.s < from && rest >= from;
    prey.go > 0 || prey.areas.iter().any(|area| before(area.ego[0]))
}
