//! Conflict zones: where, along two routes, two footprints can touch.
//!
//! A pair of arc lengths (s, t), the ego's and the other's, is *occupied* if the
//! two footprints overlap there. On one segment of each route the vehicles move
//! without turning, so the separating-axis test of the two rectangles is linear
//! in s and t: the occupied set is the segments' rectangle in the (s, t) plane cut
//! by eight half-planes, a convex polygon, computed exactly. Where a route changes
//! its direction the vehicle takes all directions in between: turns on the spot, each
//! taken for one rectangle that covers it. A [`Zone`] bounds each connected set of polygons by an
//! interval of s, one of t and one of s − t.
//!
//! Nothing is sampled, so nothing is missed between samples. Footprints are inflated on every side by
//! [`INFLATION`] for rounding and by the junction's tolerance.

mod band;
mod body;
mod cell;
mod clip;
#[cfg(test)]
mod cover;
mod join;
mod near;
mod patch;

use crate::junction::kind::ConflictKind;
use crate::real::Real;
use band::Band;
pub(crate) use body::{Body, sharp_kink};
use body::{Motion, Stage};
use cell::Cell;
use clip::{limits, meet};
use join::{covered, insert};
use near::near_pieces;
use patch::Patch;

/// Most zones of one pair of routes; if the routes meet more often, the last zone covers the rest.
pub const MAX_ZONES: usize = 3;

/// Stands for "without end" (m): larger than any arc length, and finite, so that no NaN can arise.
pub const FAR: f32 = 1.0e6;

/// Every footprint is taken to be larger by this (m) on each side.
pub const INFLATION: f32 = 0.02;

/// A lane's band is at most this many times as wide as the two vehicles are long together: in a wider one, the one who
/// is ahead along its route may be in front of the other.
pub(crate) const WIDEST: f32 = 2.0;

/// Zones whose intervals come as near as this (m) are one; also how near to a route's end its end is.
const TOUCHING: f32 = 1.0e-3;

/// A closed interval, `from` ≤ `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Lower end.
    pub from: f32,
    /// Upper end.
    pub to: f32,
}

impl Span {
    /// Of a route, and beyond both of its ends.
    const EVERYWHERE: Self = Self::around(FAR);

    /// All that is at most `most` from 0.
    const fn around(most: f32) -> Self {
        Self {
            from: -most,
            to: most,
        }
    }

    /// The smallest interval that holds both.
    fn hull(self, other: Self) -> Self {
        let (from, to) = (self.including(other.from), self.including(other.to));
        Self {
            from: from.from,
            to: to.to,
        }
    }

    fn including(self, value: f32) -> Self {
        Self {
            from: Real::min(self.from, value),
            to: Real::max(self.to, value),
        }
    }

    fn touches(self, other: Self) -> bool {
        self.from <= other.to + TOUCHING && other.from <= self.to + TOUCHING
    }

    /// Whether `value` is in the interval, ends included.
    #[must_use]
    pub fn contains(self, value: f32) -> bool {
        self.from <= value && value <= self.to
    }
}

/// A stretch of the ego's route and one of the other's in which their footprints can touch.
///
/// Outside of it they cannot: wherever the vehicles overlap, the ego's arc length
/// is in `ego`, the other's is in `other` **and** their difference is in `lead`.
/// An end of ± [`FAR`] stands for a zone that goes on past the end of a route.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zone {
    /// Arc lengths (m) of the ego.
    pub ego: Span,
    /// Arc lengths (m) of the other.
    pub other: Span,
    /// The ego's arc length minus the other's (m). In a lane that both share: above it the ego is
    /// ahead of the other, below it behind, and the distance from it is the gap between bumpers.
    pub lead: Span,
    /// [`ConflictKind::Merging`] or [`ConflictKind::Following`] in a shared lane, else
    /// [`ConflictKind::Crossing`]. A route met head-on counts as crossing.
    pub kind: ConflictKind,
}

impl Zone {
    /// The same zone as the other vehicle sees it.
    #[must_use]
    pub fn swapped(&self) -> Self {
        Self {
            ego: self.other,
            other: self.ego,
            lead: Span {
                from: -self.lead.to,
                to: -self.lead.from,
            },
            kind: self.kind,
        }
    }

    /// The lead (m) above which the ego is the one ahead in a lane, and below which it is behind.
    #[must_use]
    pub fn middle(&self) -> f32 {
        0.5 * (self.lead.from + self.lead.to)
    }

    /// Whether both vehicles run along one lane in it.
    #[must_use]
    pub fn is_lane(&self) -> bool {
        matches!(self.kind, ConflictKind::Merging | ConflictKind::Following)
    }
}

/// The zones of a pair of routes, in no particular order.
pub(crate) type Zones = [Option<Zone>; MAX_ZONES];

/// The zones of two routes.
///
/// Cost: a few comparisons for each pair of segments that are near each other, and a polygon of at most
/// 12 corners for each at which the footprints touch.
pub(crate) fn zones(ego: &Body<'_>, other: &Body<'_>) -> Zones {
    let mut patches = [None; MAX_ZONES];
    near_pieces(ego, other, &mut |a, b| meet_stages(&mut patches, a, b));
    let (ego, other) = (ego.footprint(), other.footprint());
    patches.map(|patch| patch.map(|patch| patch.zone(ego, other)))
}

/// The zone of two vehicles on one route: a lane throughout, with a band that is the same for both. None if the route
/// comes back to itself: then the one who is ahead along it may be in front of the other.
pub(crate) fn zone_with_itself(body: &Body<'_>) -> Option<Zone> {
    let apart = body.footprint().length + INFLATION;
    let mut band = Band::new(apart);
    // The half in which the ego is ahead is the same, mirrored.
    near_pieces(body, body, &mut |behind, ahead| {
        if behind.straight().arc <= ahead.straight().arc {
            band.widen_by_stages(behind, ahead);
        }
    });
    if band.widest > WIDEST * apart || band.head_on {
        return None;
    }
    Some(Zone {
        ego: Span::EVERYWHERE,
        other: Span::EVERYWHERE,
        lead: Span::around(band.widest),
        kind: ConflictKind::Following,
    })
}

/// Adds what is occupied on one segment of each route, and in the turns at its ends.
fn meet_stages(patches: &mut [Option<Patch>; MAX_ZONES], a: &Stage, b: &Stage) {
    let turning = a.turns_at_all() || b.turns_at_all();
    let along = Cell::of(a.straight(), b.straight());
    let around = Cell::of_turns(a, b);
    // Most pairs that are near each other are covered or never touch: then no motion is looked at for itself.
    if (around.is_some() || !turning) && covered(patches, &along)
        || turning && limits(&a.whole(), &b.whole()).is_none()
    {
        return;
    }
    meet_motions(patches, a.straight(), b.straight());
    if !turning || around.is_some_and(|cell| covered(patches, &cell)) {
        return;
    }
    a.turns_with(b, &mut |a, b| add(patches, a, b));
}

/// Adds what is occupied in two motions, unless that is known to change nothing.
fn add(patches: &mut [Option<Patch>; MAX_ZONES], a: &Motion, b: &Motion) {
    if !covered(patches, &Cell::of(a, b)) {
        meet_motions(patches, a, b);
    }
}

fn meet_motions(patches: &mut [Option<Patch>; MAX_ZONES], a: &Motion, b: &Motion) {
    if let Some(patch) = meet(a, b) {
        insert(patches, patch);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Footprint, Point};
    use crate::junction::route::Route;

    fn route(points: &[(f32, f32)]) -> Route<16> {
        Route::new(points.iter().map(|&(x, y)| Point::new(x, y))).unwrap()
    }

    fn conflicts(ego: &[(f32, f32)], other: &[(f32, f32)]) -> std::vec::Vec<Zone> {
        let (ego, other) = (route(ego), route(other));
        let paper = Footprint::PAPER;
        let [ego, other] = [&ego, &other].map(|r| Body::new(r.polyline(), paper, 0.0));
        let found = zones(&ego, &other);
        let swapped = zones(&other, &ego);
        let found: std::vec::Vec<Zone> = found.into_iter().flatten().collect();
        for zone in swapped.into_iter().flatten() {
            let same = |z: &Zone| {
                let near =
                    |a: Span, b: Span| (a.from - b.from).abs() < 1e-3 && (a.to - b.to).abs() < 1e-3;
                let z = z.swapped();
                near(z.ego, zone.ego)
                    && near(z.other, zone.other)
                    && near(z.lead, zone.lead)
                    && z.kind == zone.kind
            };
            assert!(found.iter().any(same), "{zone:?} is not in {found:?}");
        }
        found
    }

    fn near(interval: Span, from: f32, to: f32) {
        let good = (interval.from - from).abs() < 0.11 && (interval.to - to).abs() < 0.11;
        assert!(good, "{interval:?} is not [{from}, {to}]");
    }

    #[test]
    fn a_right_angle_has_one_zone_of_the_footprints_size() {
        let zones = conflicts(&[(-30.0, 0.0), (30.0, 0.0)], &[(0.0, -40.0), (0.0, 40.0)]);
        assert_eq!(zones.len(), 1);
        assert_eq!(zones[0].kind, ConflictKind::Crossing);
        near(zones[0].ego, 26.5, 33.5);
        near(zones[0].other, 36.5, 43.5);
        near(zones[0].lead, -17.0, -3.0);
    }

    #[test]
    fn a_detour_that_crosses_twice_has_two_zones() {
        let detour = [
            (-30.0, 0.0),
            (-20.0, 0.0),
            (-20.0, 20.0),
            (20.0, 20.0),
            (20.0, 0.0),
            (40.0, 0.0),
        ];
        let zones = conflicts(&[(-40.0, 10.0), (40.0, 10.0)], &detour);
        assert_eq!(zones.len(), 2);
        assert!(zones.iter().all(|z| z.kind == ConflictKind::Crossing));
    }

    #[test]
    fn a_merge_shares_the_lane_to_its_end_and_beyond() {
        let main = [(-50.0, 0.0), (50.0, 0.0)];
        let ramp = [(-40.0, -30.0), (-10.0, -5.0), (0.0, 0.0), (30.0, 0.0)];
        let zones = conflicts(&ramp, &main);
        assert_eq!(zones.len(), 1);
        assert_eq!(zones[0].kind, ConflictKind::Merging);
        assert_eq!((zones[0].ego.to, zones[0].other.to), (FAR, FAR));
        assert!(zones[0].lead.to - zones[0].lead.from < 13.0, "{zones:?}");
        // The corner of the zone is in the band: the one who is in it first is ahead.
        let corner = zones[0].ego.from - zones[0].other.from;
        assert!(zones[0].lead.contains(corner));
    }

    #[test]
    fn one_lane_from_the_start_is_following() {
        let zones = conflicts(&[(0.0, 0.0), (80.0, 0.0)], &[(20.0, 0.0), (60.0, 0.0)]);
        assert_eq!(zones[0].kind, ConflictKind::Following);
        near(zones[0].lead, 15.0, 25.0);
        assert_eq!(zones[0].other.from, -FAR);
    }

    #[test]
    fn routes_apart_have_no_zone_and_head_on_ones_cross() {
        let east = [(0.0, 0.0), (50.0, 0.0)];
        assert!(conflicts(&east, &[(0.0, 2.2), (50.0, 2.2)]).is_empty());
        assert_eq!(conflicts(&east, &[(0.0, 1.9), (50.0, 1.9)]).len(), 1);
        let head_on = conflicts(&east, &[(50.0, 0.0), (0.0, 0.0)]);
        assert_eq!(head_on[0].kind, ConflictKind::Crossing);
        assert_eq!(
            head_on[0].ego,
            Span {
                from: -FAR,
                to: FAR
            }
        );
    }

    #[test]
    fn a_route_that_begins_in_the_zone_has_been_in_it_for_ever() {
        let zones = conflicts(&[(-1.0, 0.0), (30.0, 0.0)], &[(0.0, -40.0), (0.0, 40.0)]);
        assert_eq!(zones[0].ego.from, -FAR);
        near(zones[0].other, 36.5, 43.5);
    }

    #[test]
    fn more_conflicts_than_capacity_are_all_covered() {
        let mut weave = std::vec::Vec::new();
        for i in 0..6_u8 {
            let x = 12.0 * f32::from(i);
            let side = if i % 2 == 0 { 20.0 } else { -20.0 };
            weave.extend([(x, -side), (x, side)]);
        }
        let zones = conflicts_unchecked(&[(-20.0, 0.0), (90.0, 0.0)], &weave);
        assert_eq!(zones.len(), MAX_ZONES);
        for i in 0..6_u8 {
            let s = 20.0 + 12.0 * f32::from(i);
            assert!(zones.iter().any(|z| z.ego.contains(s)), "{s} in {zones:?}");
        }
    }

    fn conflicts_unchecked(ego: &[(f32, f32)], other: &[(f32, f32)]) -> std::vec::Vec<Zone> {
        let paper = Footprint::PAPER;
        let (ego, other) = (route(ego), route(other));
        let [ego, other] = [&ego, &other].map(|r| Body::new(r.polyline(), paper, 0.0));
        let found = zones(&ego, &other);
        found.into_iter().flatten().collect()
    }

    #[test]
    fn intervals_hold_their_ends_and_touch_within_a_millimetre() {
        let span = |from, to| Span { from, to };
        let one = span(2.0, 5.0);
        assert!([2.0, 3.0, 5.0].into_iter().all(|x| one.contains(x)));
        assert!(![1.99, 5.01].into_iter().any(|x| one.contains(x)));
        assert_eq!(
            [1.0, 3.0, 7.0].map(|x| one.including(x)),
            [span(1.0, 5.0), one, span(2.0, 7.0)]
        );
        assert_eq!(one.hull(span(4.0, 9.0)), span(2.0, 9.0));
        assert_eq!(one.hull(span(-1.0, 3.0)), span(-1.0, 5.0));
        for (other, touches) in [
            ((5.0009, 9.0), true),
            ((5.0012, 9.0), false),
            ((0.0, 1.9991), true),
            ((0.0, 1.9988), false),
        ] {
            let other = span(other.0, other.1);
            assert_eq!(
                (one.touches(other), other.touches(one)),
                (touches, touches),
                "{other:?}"
            );
        }
    }

    #[test]
    fn the_middle_of_a_band_is_half_way_and_swapped_it_is_the_negative() {
        let zone = conflicts(
            &[(-50.0, 0.0), (50.0, 0.0)],
            &[(-30.0, -30.0), (0.0, 0.0), (50.0, 0.0)],
        )[0];
        let middle = zone.middle();
        assert!((middle - zone.lead.from - (zone.lead.to - middle)).abs() < 1e-4);
        assert!(middle.abs() > 1.0 && zone.swapped().middle() == -middle);
        assert_eq!(zone.swapped().swapped(), zone);
    }

    /// 5 m and 2 m, the inflation for either, and how far a lane is beside the other.
    #[test]
    fn a_band_is_as_wide_as_both_are_long() {
        let zone =
            |beside: f32| conflicts(&[(0.0, 0.0), (80.0, 0.0)], &[(0.0, beside), (80.0, beside)]);
        let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-3, "{a}, {b}");
        for beside in [0.0, 1.5, 2.03] {
            let lead = zone(beside)[0].lead;
            near(lead.from, -5.06);
            near(lead.to, 5.06);
        }
        assert!(zone(2.05).is_empty());
    }
}
