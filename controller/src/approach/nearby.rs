//! The tracks that the ego has yet to pass, and what they are to it.

use crate::junction::zone::Zone;
use crate::junction::{Class, ConflictKind, Path, RouteConflict, Way};
use crate::observation::{Track, Vehicle};
use crate::policy::traffic::{NearbyVehicle, TrafficContext};
use crate::shield::Contract;
use crate::shield::door::{self, Admitted};
use heapless::Vec;

/// A track on a path that has a zone ahead with the ego's.
pub(super) struct Nearby<'j> {
    pub(super) number: u16,
    pub(super) vehicle: Vehicle,
    pub(super) path: &'j Path,
    pub(super) conflict: &'j RouteConflict,
}

impl Nearby<'_> {
    /// Whether the two have yet to meet: in some zone neither has passed it. In a lane that they share they have met
    /// once either has reached the conflict point: it leads.
    pub(super) fn meets(&self, ego: &Vehicle) -> bool {
        let conflict = self.conflict;
        conflict.zones().any(|zone| {
            let (ego_end, other_end) = match zone.kind {
                ConflictKind::Following | ConflictKind::Merging => {
                    (conflict.ego_conflict, conflict.other_conflict)
                }
                _ => (zone.ego.to, zone.other.to),
            };
            ego.s < ego_end && self.vehicle.s < other_end
        })
    }

    /// Metres that the ego still has to where the two meet; negative past it.
    fn away(&self, ego: &Vehicle) -> f32 {
        self.conflict.ego_conflict - ego.s
    }
}

/// The tracks that have a zone ahead with the ego, on each of their paths: of more than `N` the nearest. A track with a
/// fault is not there.
pub(super) fn nearby<'j, const N: usize>(
    way: Way<'j>,
    contract: &Contract,
    ego: &Vehicle,
    tracks: &[Track],
) -> Vec<Nearby<'j>, N> {
    let mut nearest: Vec<Nearby<'j>, N> = Vec::new();
    // Of pedestrians the policy knows nothing.
    let driven = tracks
        .iter()
        .filter(|track| track.class != Class::Pedestrian);
    let candidates =
        driven.flat_map(|track| track.candidates().map(move |candidate| (track, candidate)));
    for (track, candidate) in candidates {
        let there = way.path(candidate.path).zip(way.conflict(candidate.path));
        let Some((path, conflict)) = there else {
            continue;
        };
        let Ok(Admitted { vehicle, .. }) = door::track(way, contract, track, candidate) else {
            continue;
        };
        let ahead = |zone: &Zone| ego.s < zone.ego.to && vehicle.s < zone.other.to;
        if !conflict.zones().any(ahead) {
            continue;
        }
        let mut found = Nearby {
            number: track.number,
            vehicle,
            path,
            conflict,
        };
        if nearest.is_full() {
            for other in &mut nearest {
                if other.away(ego) > found.away(ego) {
                    core::mem::swap(other, &mut found);
                }
            }
        } else {
            // There is room.
            let _ = nearest.push(found);
        }
    }
    nearest
}

/// What all the others but track `except` are to the ego.
pub(super) fn traffic<const N: usize>(
    ego: &Vehicle,
    nearby: &Vec<Nearby<'_>, N>,
    except: u16,
) -> TrafficContext {
    let others = nearby.iter().filter(|other| other.number != except);
    let there = others.map(|other| NearbyVehicle {
        conflict: other.conflict,
        s: other.vehicle.s,
        speed: other.vehicle.speed,
    });
    TrafficContext::new(ego.s, there)
}
