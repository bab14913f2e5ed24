//! Where a vehicle is beside its route, and how it turns, within what the junction allows.

use crate::plane::{Place, Size, along, direction, left};
use crate::polyline::Polyline;
use crate::rng::Rng;

/// A steady offset to the side and a turn, which together move no point of the footprint farther than the
/// tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sway {
    aside: f64,
    /// Tangent of the angle.
    turn: f64,
    /// Metres of arc length from one side to the other and back; 0: always on the same side.
    wave: f64,
    /// It turns from so many metres before a kink to as many after it.
    reach: f64,
    /// See [`Polyline::turning_place`].
    ease: f64,
}

/// A junction allows a vehicle to turn within so much of its length before and after a kink.
const TURNING: f64 = 0.6;

impl Default for Sway {
    /// Never beside its route; it turns within 10 cm.
    fn default() -> Self {
        Self {
            aside: 0.0,
            turn: 0.0,
            wave: 0.0,
            reach: 0.1,
            ease: 1.0,
        }
    }
}

impl Sway {
    /// One of a vehicle of this `size`; the whole of the `tolerance` is used.
    #[must_use]
    pub fn random(tolerance: f64, size: Size, rng: &mut Rng) -> Self {
        let share = rng.pick(&[0.0, 0.0, 1.0, 1.0, 0.5]);
        let (aside, turned) = (tolerance * (1.0 - share), tolerance * share);
        Self {
            aside: 0.99 * aside * rng.sign(),
            // A turn by x moves a corner by 2 r sin(x / 2) ≤ r tan x.
            turn: 0.99 * turned / size.radius() * rng.sign(),
            wave: rng.pick(&[0.0, 0.0, 10.0, 30.0]),
            reach: TURNING * size.length * rng.pick(&[0.02, 0.5, 0.99, 0.99]),
            ease: rng.pick(&[1.0, 1.0, 0.2]),
        }
    }

    /// On its lane, in ways in which a vehicle of this `size` may turn: at the kink alone, or by half well before it and after
    /// it; and with `more`, some in between.
    #[must_use]
    pub fn turns(size: Size, more: bool) -> Vec<Self> {
        let extremes = [(0.02, 1.0), (1.0, 0.0)];
        let between = [(0.5, 1.0), (0.99, 1.0), (0.99, 0.2)];
        let ways = extremes.iter().chain(between.iter().filter(|_| more));
        let way = |&(share, ease): &(f64, f64)| Self {
            reach: TURNING * size.length * share,
            ease,
            ..Self::default()
        };
        ways.map(way).collect()
    }

    /// It turns from so many metres before a kink to as many after it.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Where a vehicle is at arc length `s` of its lane `line`.
    #[must_use]
    pub fn place(&self, line: &Polyline, s: f64) -> Place {
        self.displace(line.turning_place(s, self.reach, self.ease), s)
    }

    /// Where a vehicle is whose place on its route at arc length `s` is `nominal`.
    fn displace(&self, nominal: Place, s: f64) -> Place {
        if self.aside == 0.0 && self.turn == 0.0 {
            return nominal;
        }
        let share = if self.wave > 0.0 {
            1.0 - 4.0 * ((s / self.wave).fract() - 0.5).abs()
        } else {
            1.0
        };
        let side = left(nominal.to);
        Place {
            at: along(nominal.at, side, share * self.aside),
            to: direction(along(nominal.to, side, share * self.turn)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::{minus, norm};

    #[test]
    fn no_corner_leaves_the_tolerance() {
        let size = Size {
            length: 12.0,
            width: 2.55,
        };
        let mut rng = Rng::new(6);
        let mut worst = 0.0_f64;
        for _ in 0..200 {
            let sway = Sway::random(0.1, size, &mut rng);
            let nominal = Place {
                at: [3.0, 4.0],
                to: [0.6, 0.8],
            };
            let there = sway.displace(nominal, rng.within(0.0, 100.0));
            let corner = |place: Place| {
                let front = along(place.at, place.to, 0.5 * size.length);
                along(front, left(place.to), 0.5 * size.width)
            };
            worst = worst.max(norm(minus(corner(there), corner(nominal))));
        }
        assert!(worst > 0.09 && worst <= 0.1, "{worst}");
    }
}
