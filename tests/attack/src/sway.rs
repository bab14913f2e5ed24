//! Where a vehicle is beside its route, within the junction's tolerance.

use crate::plane::{Place, along, direction, left};
use crate::rng::Rng;

/// A steady offset to the side and a turn, which together move no point of the footprint farther than the
/// tolerance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sway {
    aside: f64,
    /// Tangent of the angle.
    turn: f64,
    /// Metres of arc length from one side to the other and back; 0: always on the same side.
    wave: f64,
}

impl Sway {
    /// One of a vehicle whose corners are `radius` m from its centre; the whole of the `tolerance` is used.
    #[must_use]
    pub fn random(tolerance: f64, radius: f64, rng: &mut Rng) -> Self {
        let share = rng.pick(&[0.0, 0.0, 1.0, 1.0, 0.5]);
        let (aside, turned) = (tolerance * (1.0 - share), tolerance * share);
        Self {
            aside: 0.99 * aside * rng.sign(),
            // A turn by x moves a corner by 2 r sin(x / 2) ≤ r tan x.
            turn: 0.99 * turned / radius * rng.sign(),
            wave: rng.pick(&[0.0, 0.0, 10.0, 30.0]),
        }
    }

    /// Where a vehicle is whose place on its route at arc length `s` is `nominal`.
    #[must_use]
    pub fn displace(&self, nominal: Place, s: f64) -> Place {
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
    use crate::plane::{Size, minus, norm};

    #[test]
    fn no_corner_leaves_the_tolerance() {
        let size = Size {
            length: 12.0,
            width: 2.55,
        };
        let mut rng = Rng::new(6);
        let mut worst = 0.0_f64;
        for _ in 0..200 {
            let sway = Sway::random(0.1, size.radius(), &mut rng);
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
