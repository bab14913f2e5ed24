//! Parts of the (s, t) plane that no zone holds.

use super::Zone;
use crate::interval::Interval;

/// Metres by which a zone counts as longer for either vehicle: where a path's direction changes, overlaps reach to its very
/// border.
const SEAM: f64 = 1e-3;

/// Places of ego and other, and the lead: all pairs (s, t) with s, t and s − t in these closed intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    pub(super) ego: Interval,
    pub(super) other: Interval,
    pub(super) lead: Interval,
}

impl Cell {
    /// All pairs of these places.
    pub(super) fn all(ego: Interval, other: Interval) -> Self {
        let lead = ego.sub(other);
        Self { ego, other, lead }
    }

    /// The cell, each interval as narrow as the others make it; none if it is empty.
    pub(super) fn narrowed(self) -> Option<Self> {
        let ego = both(self.ego, self.other.add(self.lead))?;
        let other = both(self.other, ego.sub(self.lead))?;
        let lead = both(self.lead, ego.sub(other))?;
        Some(Self { ego, other, lead })
    }

    /// The part at these places.
    pub(super) fn at(self, ego: Interval, other: Interval) -> Option<Self> {
        let ego = both(self.ego, ego)?;
        let other = both(self.other, other)?;
        Self { ego, other, ..self }.narrowed()
    }

    /// What no zone holds, nor comes nearer to than [`SEAM`], in parts.
    pub(super) fn outside(self, zones: &[Zone]) -> Vec<Self> {
        let mut parts = vec![self];
        for zone in zones {
            parts = parts.iter().flat_map(|part| part.without(zone)).collect();
        }
        parts
    }

    fn without(mut self, zone: &Zone) -> Vec<Self> {
        let mut parts = Vec::new();
        let longer = |[from, to]: [f64; 2]| [from - SEAM, to + SEAM];
        let spans = [longer(zone.ego), longer(zone.other), zone.lead];
        for (side, [from, to]) in (0..3).zip(spans) {
            let whole = self.side(side);
            let below = Interval::new(f64::NEG_INFINITY, from);
            let above = Interval::new(to, f64::INFINITY);
            for beyond in [below, above] {
                parts.extend(both(whole, beyond).and_then(|rest| self.with(side, rest).narrowed()));
            }
            match both(whole, Interval::new(from, to)) {
                Some(inside) => self = self.with(side, inside),
                None => break,
            }
        }
        parts
    }

    fn side(&self, side: usize) -> Interval {
        match side {
            0 => self.ego,
            1 => self.other,
            _ => self.lead,
        }
    }

    /// The cell with another interval of the ego (0), the other (1) or the lead (2).
    fn with(mut self, side: usize, interval: Interval) -> Self {
        match side {
            0 => self.ego = interval,
            1 => self.other = interval,
            _ => self.lead = interval,
        }
        self
    }

    /// Two halves, by the places of the ego or of the other.
    pub(super) fn halves(self, of_ego: bool) -> impl Iterator<Item = Self> {
        let side = usize::from(!of_ego);
        let whole = self.side(side);
        let middle = whole.middle();
        let halves = [
            Interval::new(whole.lo, middle),
            Interval::new(middle, whole.hi),
        ];
        halves
            .into_iter()
            .filter_map(move |half| self.with(side, half).narrowed())
    }

    /// A pair in it, as near as rounding lets it be.
    pub(super) fn middle(&self) -> (f64, f64) {
        let s = self.ego.middle();
        let t = s - self
            .lead
            .clamp(s - self.other.hi, s - self.other.lo)
            .middle();
        (s, t)
    }

    /// At least the least value of `slopes`·(s, t) in it, counted from the places `origin`.
    ///
    /// a s + b t = (a − l) s + (b + l) t + l (s − t) for every l; the best one is 0, a or −b.
    pub(super) fn least(&self, slopes: [Interval; 2], origin: [f64; 2]) -> f64 {
        let [a, b] = slopes;
        let [s, t] = origin.map(Interval::point);
        let (ego, other, lead) = (self.ego.sub(s), self.other.sub(t), self.lead.sub(s.sub(t)));
        let shares = [0.0, a.middle(), -b.middle()].map(Interval::point);
        let bound = |l: Interval| {
            let parts = [a.sub(l).mul(ego), b.add(l).mul(other), l.mul(lead)];
            parts[0].add(parts[1]).add(parts[2]).lo
        };
        shares
            .into_iter()
            .map(bound)
            .fold(f64::NEG_INFINITY, f64::max)
    }
}

/// What both hold; none if that is nothing.
fn both(a: Interval, b: Interval) -> Option<Interval> {
    a.meets(b)
        .then(|| Interval::new(a.lo.max(b.lo), a.hi.min(b.hi)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn spans() -> impl Strategy<Value = [f64; 2]> {
        (0.0..10.0_f64, 0.0..5.0_f64).prop_map(|(from, more)| [from, from + more])
    }

    fn zone() -> impl Strategy<Value = Zone> {
        (spans(), spans(), spans()).prop_map(|(ego, other, [from, to])| Zone {
            ego,
            other,
            lead: [from - 5.0, to - 5.0],
            lane: false,
        })
    }

    fn holds(zone: &Zone, s: f64, t: f64) -> bool {
        let inside = |[from, to]: [f64; 2], more: f64, x: f64| from - more < x && x < to + more;
        inside(zone.ego, SEAM, s) && inside(zone.other, SEAM, t) && inside(zone.lead, 0.0, s - t)
    }

    proptest! {
        /// A pair is in a zone or in a part outside, and a bound on a part holds there.
        #[test]
        fn every_pair_outside_is_in_a_part(
            zones in prop::collection::vec(zone(), 0..4),
            places in prop::collection::vec((0.0..15.0_f64, 0.0..15.0_f64), 64),
            slopes in [-2.0..2.0_f64, -2.0..2.0_f64],
        ) {
            let whole = Interval::new(0.0, 15.0);
            let parts = Cell::all(whole, whole).outside(&zones);
            for (s, t) in places {
                let held = |part: &&Cell| {
                    part.ego.contains(s) && part.other.contains(t) && part.lead.contains(s - t)
                };
                let found: Vec<_> = parts.iter().filter(held).collect();
                let inside = zones.iter().any(|zone| holds(zone, s, t));
                prop_assert!(inside || !found.is_empty(), "({s}, {t})");
                for part in found {
                    let value = slopes[0] * (s - 1.0) + slopes[1] * (t - 2.0);
                    let least = part.least(slopes.map(Interval::point), [1.0, 2.0]);
                    prop_assert!(least <= value + 1e-9, "{least} > {value}");
                }
            }
        }
    }
}
