//! The traffic around a pair: who is ahead in the ego's lane, and who else is about to cross its way.

use crate::junction::conflict::RouteConflict;
use crate::junction::kind::ConflictKind;
use crate::policy::pair::{Crosser, Leader};

/// What surrounds the ego, beside the other vehicle of the pair.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrafficContext {
    /// The nearest vehicle ahead in the ego's lane.
    pub leader: Option<Leader>,
    /// The vehicle not in that lane that is nearest to where its route meets the ego's, or just there.
    pub crosser: Option<Crosser>,
}

/// A vehicle around a pair.
#[derive(Clone, Copy, Debug)]
pub struct NearbyVehicle<'m> {
    /// How the ego's route meets its own.
    pub conflict: &'m RouteConflict,
    /// Arc length (m) on its own route.
    pub s: f32,
    /// Speed in m/s, never negative.
    pub speed: f32,
}

impl TrafficContext {
    /// What the vehicles `around` are to an ego at arc length `ego` (m).
    ///
    /// Cost: O(vehicles).
    #[must_use]
    pub fn new<'m>(ego: f32, around: impl IntoIterator<Item = NearbyVehicle<'m>>) -> Self {
        let mut nearest = Self::default();
        for vehicle in around {
            let leader = vehicle.leads(ego);
            let crosser = match leader {
                Some(_) => None,
                None => vehicle.crosses(ego),
            };
            nearest = nearest.nearest(Self { leader, crosser });
        }
        nearest
    }

    /// The nearer of the two leaders and of the two crossers.
    #[must_use]
    pub fn nearest(self, other: Self) -> Self {
        let leader = match (self.leader, other.leader) {
            (Some(known), Some(new)) if new.gap < known.gap => Some(new),
            (known, new) => known.or(new),
        };
        let crosser = match (self.crosser, other.crosser) {
            (Some(known), Some(new)) if new.its_distance < known.its_distance => Some(new),
            (known, new) => known.or(new),
        };
        Self { leader, crosser }
    }
}

impl NearbyVehicle<'_> {
    fn leads(&self, ego: f32) -> Option<Leader> {
        let mut lanes = self.conflict.zones().filter(|zone| zone.is_lane());
        lanes.find_map(|zone| {
            let gap = zone.lead.from - (ego - self.s);
            (zone.other.contains(self.s) && gap >= 0.0).then_some(Leader {
                gap,
                speed: self.speed,
            })
        })
    }

    /// In some zone where the two cross or merge, neither has passed it.
    fn crosses(&self, ego: f32) -> Option<Crosser> {
        let meets = |kind| matches!(kind, ConflictKind::Crossing | ConflictKind::Merging);
        let ahead = self
            .conflict
            .zones()
            .any(|zone| meets(zone.kind) && ego < zone.ego.to && self.s < zone.other.to);
        ahead.then_some(Crosser {
            distance: self.conflict.ego_conflict - ego,
            its_distance: self.conflict.other_conflict - self.s,
            its_speed: self.speed,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Footprint, Point};
    use crate::junction::{Class, Junction, Route};

    fn route(points: [(f32, f32); 2]) -> Route<4> {
        Route::new(points.map(|(x, y)| Point::new(x, y))).unwrap()
    }

    #[test]
    fn the_nearest_ahead_leads_and_the_nearest_to_the_crossing_crosses() {
        let east = route([(-30.0, 0.0), (30.0, 0.0)]);
        let behind_it = route([(-30.0, 0.0), (30.0, 0.01)]);
        let north = route([(0.0, -40.0), (0.0, 40.0)]);
        let mut builder = Junction::<3, 6, 1>::builder();
        let [own, lane, crossing] = [&east, &behind_it, &north]
            .map(|route| builder.path(route, Class::Car, Footprint::PAPER).unwrap());
        let junction = builder.tolerance(0.0).clone().build().unwrap();
        let [lane, crossing] = [lane, crossing].map(|path| junction.conflict(own, path).unwrap());
        let at = |conflict, s, speed| NearbyVehicle { conflict, s, speed };
        let seen = TrafficContext::new(
            10.0,
            [
                at(lane, 25.0, 4.0),
                at(lane, 20.0, 3.0),
                at(lane, 2.0, 9.0),
                at(crossing, 10.0, 8.0),
                at(crossing, 30.0, 5.0),
                at(crossing, 70.0, 7.0),
            ],
        );
        let leader = seen.leader.unwrap();
        assert_eq!(leader.speed, 3.0);
        assert!((leader.gap - 5.0).abs() < 0.2, "{}", leader.gap);
        assert_eq!(
            seen.crosser,
            Some(Crosser {
                distance: 15.0,
                its_distance: 5.0,
                its_speed: 5.0
            })
        );
        assert_eq!(TrafficContext::new(10.0, []), TrafficContext::default());
    }
}
