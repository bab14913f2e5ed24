//! How two routes can meet, and who may go first where they do.

use crate::junction::kind::ConflictKind;
use crate::junction::meeting;
use crate::junction::zone::{Body, MAX_ZONES, Zone, Zones, zone_with_itself, zones};

/// Who may go first, by the rules of the road and the order of arrival.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RightOfWay {
    /// The ego.
    Ego,
    /// The other.
    Other,
    /// Not settled, or not known.
    #[default]
    Unsettled,
}

impl RightOfWay {
    /// The same right as the other vehicle sees it.
    #[must_use]
    pub const fn opposite(self) -> Self {
        match self {
            Self::Ego => Self::Other,
            Self::Other => Self::Ego,
            Self::Unsettled => Self::Unsettled,
        }
    }
}

/// When a right of way counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Priority {
    /// If both arrive at once: whoever arrives first goes first, as at an all-way stop.
    #[default]
    FirstCome,
    /// Whoever arrives first, until both rest: then they take turns, so that four who each wait for the one on
    /// their right do not wait for ever.
    Unsigned,
    /// The same as signs and markings give it: whoever has to give way waits four times as long before they take turns.
    Signed,
}

/// How the ego's route meets one other's. Arc lengths are the respective vehicle's own, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RouteConflict {
    /// How the routes conflict first, along the ego's.
    pub kind: ConflictKind,
    /// Where the ego has reached the conflict point: the first point of its route within
    /// [`crate::CONFLICT_RADIUS`] of the routes' first crossing. Routes that run together without crossing
    /// have it at the entry of their zone; routes that do not meet, at their end.
    pub ego_conflict: f32,
    /// The same for the other.
    pub other_conflict: f32,
    /// Who has the right of way; unsettled unless the builder was told.
    pub right_of_way: RightOfWay,
    /// When the right of way counts.
    pub priority: Priority,
    pub(crate) zones: Zones,
}

impl RouteConflict {
    /// Of routes that do not meet; a place to fill.
    pub(crate) const NONE: Self = Self {
        kind: ConflictKind::None,
        ego_conflict: 0.0,
        other_conflict: 0.0,
        right_of_way: RightOfWay::Unsettled,
        priority: Priority::FirstCome,
        zones: [None; MAX_ZONES],
    };

    /// How the routes of two bodies meet; the right of way is unsettled.
    // Not inlined, so that the stack of its polygons is free again when the caller goes on.
    #[inline(never)]
    pub(crate) fn between(ego: &Body<'_>, other: &Body<'_>) -> Self {
        let zones = zones(ego, other);
        let first = first(&zones);
        let (ego_conflict, other_conflict) =
            meeting::conflict_points(ego.polyline, other.polyline, &zones, first);
        Self {
            kind: kind(first),
            ego_conflict,
            other_conflict,
            right_of_way: RightOfWay::Unsettled,
            priority: Priority::FirstCome,
            zones,
        }
    }

    /// How two vehicles on one route meet: in a lane, from its start on. None if the route comes back to itself.
    #[inline(never)]
    pub(crate) fn with_itself(body: &Body<'_>) -> Option<Self> {
        Some(Self {
            kind: ConflictKind::Following,
            zones: [Some(zone_with_itself(body)?), None, None],
            ..Self::NONE
        })
    }

    /// Where the footprints can touch; at most [`MAX_ZONES`], in no particular order.
    pub fn zones(&self) -> impl Iterator<Item = &Zone> {
        self.zones.iter().flatten()
    }

    /// The same conflict as the other vehicle sees it: `swapped` twice is the conflict itself.
    #[must_use]
    pub fn swapped(&self) -> Self {
        let zones = self.zones.map(|zone| zone.map(|zone| zone.swapped()));
        Self {
            kind: kind(first(&zones)),
            ego_conflict: self.other_conflict,
            other_conflict: self.ego_conflict,
            right_of_way: self.right_of_way.opposite(),
            zones,
            ..*self
        }
    }
}

/// The zone that the ego reaches first.
fn first(zones: &Zones) -> Option<&Zone> {
    zones
        .iter()
        .flatten()
        .reduce(|first, zone| match zone.ego.from < first.ego.from {
            true => zone,
            false => first,
        })
}

fn kind(first: Option<&Zone>) -> ConflictKind {
    first.map_or(ConflictKind::None, |zone| zone.kind)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Footprint, Point};
    use crate::junction::route::Route;
    use crate::junction::zone::Span;

    #[test]
    fn swapped_twice_is_the_conflict_itself() {
        let route = |points: &[(f32, f32)]| {
            Route::<8>::new(points.iter().map(|&(x, y)| Point::new(x, y))).unwrap()
        };
        let ego = route(&[(-40.0, 0.0), (40.0, 0.0)]);
        let other = route(&[(0.0, -40.0), (0.0, 20.0), (20.0, 20.0), (20.0, -20.0)]);
        let [ego, other] = [&ego, &other].map(|r| Body::new(r.polyline(), Footprint::PAPER, 0.1));
        let mut conflict = RouteConflict::between(&ego, &other);
        conflict.right_of_way = RightOfWay::Ego;
        let swapped = conflict.swapped();
        assert_eq!(swapped.right_of_way, RightOfWay::Other);
        assert_eq!(swapped.zones().count(), 2);
        assert_eq!(swapped.ego_conflict, conflict.other_conflict);
        assert_eq!(swapped.swapped(), conflict);
    }

    fn zone(ego: f32, other: f32, kind: ConflictKind) -> Zone {
        let span = |from| Span {
            from,
            to: from + 9.0,
        };
        let lead = Span {
            from: -5.0,
            to: 5.0,
        };
        let (ego, other) = (span(ego), span(other));
        Zone {
            ego,
            other,
            lead,
            kind,
        }
    }

    #[test]
    fn routes_meet_like_the_zone_that_comes_first_for_each_of_them() {
        let crossing = zone(10.0, 50.0, ConflictKind::Crossing);
        let lane = zone(20.0, 30.0, ConflictKind::Merging);
        let conflict = RouteConflict {
            kind: ConflictKind::Crossing,
            zones: [Some(lane), Some(crossing), None],
            ..RouteConflict::NONE
        };
        assert_eq!(first(&conflict.zones), Some(&crossing));
        assert_eq!(conflict.swapped().kind, ConflictKind::Merging);
        // Of two that begin at one place, the first.
        let other = zone(20.0, 90.0, ConflictKind::Crossing);
        assert_eq!(first(&[Some(lane), Some(other), None]), Some(&lane));
    }
}
