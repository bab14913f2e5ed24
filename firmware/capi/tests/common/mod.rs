//! A left turn across an oncoming vehicle, by the functions that C calls.
#![allow(dead_code, reason = "each test uses its part")]

use cede::*;
use std::ptr::{from_mut, from_ref, null_mut};

pub(crate) const OK: cede_status = cede_status::Ok;

pub(crate) const CAR: cede_footprint = cede_footprint {
    length: 4.6,
    width: 1.9,
};
pub(crate) const MINE: [(f32, f32); 5] = [
    (-40.0, -2.0),
    (-6.0, -2.0),
    (0.0, 0.0),
    (2.0, 6.0),
    (2.0, 40.0),
];
pub(crate) const THEIRS: [(f32, f32); 2] = [(40.0, 2.0), (-40.0, 2.0)];

/// All objects, where they stay.
pub(crate) struct World {
    pub(crate) policy: cede_policy,
    pub(crate) drive: cede_drive,
    pub(crate) junction: cede_junction,
    pub(crate) approach: cede_approach,
}

impl World {
    /// Storage of which nothing was made.
    pub(crate) fn empty() -> Box<Self> {
        Box::new(Self {
            policy: cede_policy {
                storage: [0; CEDE_POLICY_WORDS],
            },
            drive: cede_drive {
                storage: [0; CEDE_DRIVE_WORDS],
            },
            junction: cede_junction {
                storage: [0; CEDE_JUNCTION_WORDS],
            },
            approach: cede_approach {
                storage: [0; CEDE_APPROACH_WORDS],
            },
        })
    }

    /// The ego is about to turn left, within the contract.
    pub(crate) fn new(contract: &cede_contract) -> Box<Self> {
        let mut world = Self::empty();
        let (left, oncoming) = world.junction();
        assert_eq!((left, oncoming), (0, 1));
        assert_eq!(world.drive(contract), OK);
        assert_eq!(world.enter(left), OK);
        world
    }

    /// Builds the junction; the numbers of the two paths.
    pub(crate) fn junction(&mut self) -> (u8, u8) {
        // SAFETY: as the header says.
        unsafe {
            assert_eq!(cede_junction_init(&mut self.junction), OK);
            let left = self.path(&points(&MINE));
            let oncoming = self.path(&points(&THEIRS));
            let right =
                cede_junction_set_right_of_way(&mut self.junction, oncoming, left, null_mut());
            assert_eq!(right, OK);
            assert_eq!(cede_junction_build(&mut self.junction, null_mut()), OK);
            (left, oncoming)
        }
    }

    pub(crate) fn path(&mut self, points: &[cede_point]) -> u8 {
        let mut path = 0;
        // SAFETY: as the header says.
        let status = unsafe {
            cede_junction_add_path(
                &mut self.junction,
                points.as_ptr(),
                points.len() as u32,
                CEDE_CLASS_CAR,
                &CAR,
                &mut path,
                null_mut(),
            )
        };
        assert_eq!(status, OK);
        path
    }

    pub(crate) fn drive(&mut self, contract: &cede_contract) -> cede_status {
        // SAFETY: as the header says.
        unsafe {
            assert_eq!(cede_policy_init_embedded(&mut self.policy), OK);
            let part = CEDE_PART_LEFT;
            cede_drive_init(&mut self.drive, &self.policy, contract, part, null_mut())
        }
    }

    pub(crate) fn enter(&mut self, path: u8) -> cede_status {
        // SAFETY: as the header says.
        unsafe {
            cede_approach_enter(
                &mut self.approach,
                &self.drive,
                &self.junction,
                path,
                null_mut(),
            )
        }
    }

    pub(crate) fn decide(
        &mut self,
        now_us: u64,
        seen: &cede_observation,
    ) -> (cede_status, cede_decision) {
        let mut decision = no_decision();
        // SAFETY: as the header says.
        let status = unsafe {
            cede_approach_decide(from_mut(&mut self.approach), now_us, seen, &mut decision)
        };
        (status, decision)
    }
}

/// What no function returns.
pub(crate) fn no_decision() -> cede_decision {
    // SAFETY: zero is a value of each of its numbers.
    let mut decision: cede_decision = unsafe { std::mem::zeroed() };
    decision.acceleration = f32::NAN;
    decision
}

pub(crate) fn worst_case() -> cede_contract {
    plain(&cede_controller::Contract::WORST_CASE)
}

pub(crate) fn points(of: &[(f32, f32)]) -> Vec<cede_point> {
    of.iter().map(|&(x, y)| cede_point { x, y }).collect()
}

/// The ego 15 m along its path; the oncoming vehicle is track 17.
pub(crate) fn track() -> cede_track {
    let mut track = cede_track {
        number: 17,
        candidate_count: 1,
        speed: 8.0,
        pose: pose(20.0, 2.0, -1.0),
        ..cede_track::default()
    };
    track.candidates[0] = cede_candidate {
        s: 20.0,
        path: 1,
        reserved: [0; 3],
    };
    track
}

pub(crate) fn ego() -> cede_vehicle {
    cede_vehicle {
        s: 15.0,
        speed: 6.0,
        pose: pose(-25.0, -2.0, 1.0),
    }
}

pub(crate) fn seen(tracks: &[cede_track]) -> cede_observation {
    cede_observation {
        ego: ego(),
        tracks: tracks.as_ptr(),
        track_count: tracks.len() as u32,
    }
}

fn pose(x: f32, y: f32, east: f32) -> cede_pose {
    cede_pose {
        position: cede_point { x, y },
        direction: cede_point { x: east, y: 0.0 },
    }
}

/// A pointer that is one byte off.
pub(crate) fn off<T>(of: &T) -> *const T {
    from_ref(of).wrapping_byte_add(1)
}

/// The same, to write to.
pub(crate) fn off_mut<T>(of: &mut T) -> *mut T {
    from_mut(of).wrapping_byte_add(1)
}
