//! The judge of collisions: a rapier2d world that holds every vehicle as a cuboid.
//!
//! The simulator's own box test ([`cede_controller::separation`]) is fast; this one is an independent implementation, and
//! slow (a microsecond or two a step). The collisions of campaigns are counted by the judge, and the fast
//! test, which ends episodes, is held to agree with it (`sim/tests/agreement.rs`).

use cede_controller::{Footprint, Point, Pose};
use rapier2d::math::{Pose as Placement, Rotation, Vector};
use rapier2d::prelude::*;

/// A world of vehicles that says which of them touch.
pub struct Judge {
    bodies: RigidBodySet,
    colliders: ColliderSet,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    pipeline: CollisionPipeline,
    /// Of every vehicle, in the order of the footprints.
    vehicles: Vec<(RigidBodyHandle, ColliderHandle)>,
}

impl Judge {
    /// A world of as many vehicles as `footprints`, none of them there yet.
    #[must_use]
    pub fn new(footprints: &[Footprint]) -> Self {
        let mut bodies = RigidBodySet::new();
        let mut colliders = ColliderSet::new();
        let vehicles = footprints
            .iter()
            .map(|footprint| {
                // The judge is told where vehicles are; it does not push them.
                let body = bodies.insert(RigidBodyBuilder::kinematic_position_based());
                let cuboid = ColliderBuilder::cuboid(0.5 * footprint.length, 0.5 * footprint.width)
                    .sensor(true)
                    .enabled(false)
                    .active_collision_types(ActiveCollisionTypes::KINEMATIC_KINEMATIC);
                (
                    body,
                    colliders.insert_with_parent(cuboid, body, &mut bodies),
                )
            })
            .collect();
        Self {
            bodies,
            colliders,
            islands: IslandManager::new(),
            broad_phase: BroadPhaseBvh::new(),
            narrow_phase: NarrowPhase::new(),
            pipeline: CollisionPipeline::new(),
            vehicles,
        }
    }

    /// Moves the vehicles to `poses` (`None`: not there) and gives the pairs (i, j), i < j, that
    /// touch, in order.
    ///
    /// Vehicles without an entry stay where they were. Distances are resolved to about 10⁻⁵ m
    /// however far the vehicles are from the origin, as long as they are within 100 m of each other.
    pub fn touching(&mut self, poses: &[Option<Pose>]) -> impl Iterator<Item = (usize, usize)> {
        // Rapier multiplies absolute coordinates by rotations, which at 1 km from the origin costs
        // tenths of a millimetre; so its world is centred on the first vehicle.
        let origin = poses
            .iter()
            .flatten()
            .next()
            .map_or(Point::origin(), |pose| pose.position);
        for (&(body, collider), pose) in self.vehicles.iter().zip(poses) {
            if let Some(collider) = self.colliders.get_mut(collider)
                && collider.is_enabled() != pose.is_some()
            {
                collider.set_enabled(pose.is_some());
            }
            if let (Some(body), Some(pose)) = (self.bodies.get_mut(body), pose) {
                body.set_position(placement(pose, origin), true);
            }
        }
        self.pipeline.step(
            0.0,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &(),
            &(),
        );
        let count = self.vehicles.len();
        let pairs = (0..count).flat_map(move |i| (i + 1..count).map(move |j| (i, j)));
        pairs.filter(|&(i, j)| self.intersect(i, j))
    }

    fn intersect(&self, i: usize, j: usize) -> bool {
        match (self.vehicles.get(i), self.vehicles.get(j)) {
            (Some(&(_, a)), Some(&(_, b))) => {
                self.narrow_phase.intersection_pair(a, b) == Some(true)
            }
            _ => false,
        }
    }
}

fn placement(pose: &Pose, origin: Point) -> Placement {
    let offset = pose.position - origin;
    let rotation = Rotation::from_cos_sin_unchecked(pose.direction.x, pose.direction.y);
    Placement::from_parts(Vector::new(offset.x, offset.y), rotation)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cede_controller::geometry::unit;

    fn at(x: f32, y: f32) -> Option<Pose> {
        Some(Pose {
            position: Point::new(x, y),
            direction: unit(1.0, 0.0),
        })
    }

    fn touching(judge: &mut Judge, poses: &[Option<Pose>]) -> Vec<(usize, usize)> {
        judge.touching(poses).collect()
    }

    #[test]
    fn vehicles_touch_part_vanish_and_return() {
        let mut judge = Judge::new(&[Footprint::PAPER; 3]);
        let apart = [at(1000.0, 0.0), at(1006.0, 0.0), at(1000.0, 3.0)];
        let close = [at(1000.0, 0.0), at(1004.9, 0.0), at(1000.0, 1.9)];
        let gone = [close[0], None, close[2]];
        for _ in 0..2 {
            assert!(touching(&mut judge, &apart).is_empty());
            assert_eq!(touching(&mut judge, &close), [(0, 1), (0, 2), (1, 2)]);
            assert_eq!(touching(&mut judge, &gone), [(0, 2)]);
            assert_eq!(touching(&mut judge, &close), [(0, 1), (0, 2), (1, 2)]);
        }
        assert!(touching(&mut judge, &[None; 3]).is_empty());
        assert_eq!(touching(&mut judge, &close), [(0, 1), (0, 2), (1, 2)]);
    }

    #[test]
    fn a_repeated_pose_keeps_its_verdict() {
        let mut judge = Judge::new(&[Footprint::PAPER; 2]);
        let close = [at(0.0, 0.0), at(4.0, 0.0)];
        assert_eq!(touching(&mut judge, &close), [(0, 1)]);
        assert_eq!(touching(&mut judge, &close), [(0, 1)]);
    }
}
