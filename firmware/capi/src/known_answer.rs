//! What the network gives for fixed inputs, and the decisions of a short encounter, as one number that is known.

use crate::approach::{cede_approach, cede_approach_decide, cede_approach_enter};
use crate::contract::plain;
use crate::decision::cede_decision;
use crate::drive::{CEDE_DRIVE_WORDS, CEDE_PART_LEFT, cede_drive, cede_drive_init};
use crate::junction::{
    cede_footprint, cede_junction, cede_junction_add_path, cede_junction_build, cede_junction_init,
    cede_junction_pose, cede_junction_set_right_of_way,
};
use crate::memory::{checked, write};
use crate::object::{checksum_step, lend};
use crate::observation::{
    CEDE_CLASS_CAR, cede_candidate, cede_observation, cede_point, cede_track, cede_vehicle,
};
use crate::policy::cede_policy;
use crate::status::cede_status;
use cede_controller::Contract;
use core::ptr::null_mut;

/// What cede_known_answer() finds with the embedded policy.
pub const CEDE_EMBEDDED_ANSWER: u32 = 0x2992df39;

/// How often the network is asked, and about how many numbers: those that it has no input for are ignored.
const INPUTS: u32 = 64;
const MOST_INPUTS: usize = 32;
/// Periods of the encounter.
const STEPS: u32 = 48;
/// The one in which the ego's speed is not known.
const DEAD: u32 = 40;
/// In s.
const PERIOD: f32 = 0.1;
const CAR: cede_footprint = cede_footprint {
    length: 4.6,
    width: 1.9,
};
/// The ego's path, number 0.
const LEFT: [cede_point; 5] = [
    at(-40.0, -2.0),
    at(-6.0, -2.0),
    at(0.0, 0.0),
    at(2.0, 6.0),
    at(2.0, 40.0),
];
/// The other's, number 1.
const ONCOMING: [cede_point; 2] = [at(40.0, 2.0), at(-40.0, 2.0)];

/// Asks the policy's network about 64 inputs, drives a short encounter with it, and writes a number that stands for all bits of
/// what comes out: a test of compiler, flash, core and FPU by everything that deciding uses, and one that fails if any of it
/// computes something else than where the number was found. `answer` is CEDE_EMBEDDED_ANSWER for the embedded policy; for another one it is what a host
/// writes.
///
/// `junction` and `approach` are storage for the test, whatever was in it; nothing that is used may be there afterwards, and
/// they can be used for others. It takes as long as a junction and 48 decisions.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_known_answer(
    policy: *const cede_policy,
    junction: *mut cede_junction,
    approach: *mut cede_approach,
    answer: *mut u32,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe {
        checked(answer)
            .and_then(|()| build(junction))
            .and_then(|()| enter(policy, junction, approach))
            .and_then(|()| Ok(drive(junction, approach)? ^ network(policy)?))
            .and_then(|found| write(answer, found))
    }
    .into()
}

// Not inlined, none of the three: the stack of one is free when the next is called.
#[inline(never)]
unsafe fn build(junction: *mut cede_junction) -> Result<(), cede_status> {
    let mut number = 0;
    // SAFETY: by the header's contract of pointers; the others are this function's.
    unsafe {
        done(cede_junction_init(junction))?;
        for path in [&LEFT[..], &ONCOMING] {
            let (points, count) = (path.as_ptr(), path.len() as u32);
            let (class, none) = (CEDE_CLASS_CAR, null_mut());
            done(cede_junction_add_path(
                junction,
                points,
                count,
                class,
                &CAR,
                &mut number,
                none,
            ))?;
        }
        done(cede_junction_set_right_of_way(junction, 1, 0, null_mut()))?;
        done(cede_junction_build(junction, null_mut()))
    }
}

#[inline(never)]
unsafe fn enter(
    policy: *const cede_policy,
    junction: *const cede_junction,
    approach: *mut cede_approach,
) -> Result<(), cede_status> {
    let mut contract = plain(&Contract::WORST_CASE);
    contract.position_error = 0.1;
    contract.speed_error = 0.1;
    let mut drive = cede_drive {
        storage: [0; CEDE_DRIVE_WORDS],
    };
    let (part, none) = (CEDE_PART_LEFT, null_mut());
    // SAFETY: by the header's contract of pointers; the others are this function's.
    unsafe {
        done(cede_drive_init(&mut drive, policy, &contract, part, none))?;
        done(cede_approach_enter(approach, &drive, junction, 0, none))
    }
}

#[inline(never)]
unsafe fn drive(
    junction: *const cede_junction,
    approach: *mut cede_approach,
) -> Result<u32, cede_status> {
    let (mut ego, mut other) = (moving(18.0, 6.0), moving(10.0, 8.0));
    let mut decision = cede_decision::NONE;
    let mut answer = 0;
    for step in 0..STEPS {
        // SAFETY: by the header's contract of pointers; the others are this function's.
        unsafe {
            done(cede_junction_pose(junction, 0, ego.s, &mut ego.pose))?;
            done(cede_junction_pose(junction, 1, other.s, &mut other.pose))?;
            let track = track(&other);
            let mut seen = cede_observation {
                ego,
                tracks: &track,
                track_count: 1,
            };
            if step == DEAD {
                seen.ego.speed = f32::NAN;
            }
            let now = u64::from(step + 1) * 100_000;
            done(cede_approach_decide(approach, now, &seen, &mut decision))?;
        }
        answer = mixed(answer, &decision);
        advance(&mut ego, decision.acceleration);
        advance(&mut other, 0.0);
    }
    Ok(answer)
}

/// Over inputs far beyond those of an encounter, so that hardly a neuron stays silent.
#[inline(never)]
unsafe fn network(policy: *const cede_policy) -> Result<u32, cede_status> {
    // SAFETY: the header's contract of pointers.
    let weights = unsafe { lend(policy) }?.policy.weights();
    let (mut random, mut answer) = (1_u32, 0);
    for _ in 0..INPUTS {
        let mut inputs = [0.0; MOST_INPUTS];
        for input in &mut inputs {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // In [-4, 4), exactly.
            *input = (random >> 8) as f32 / (1 << 21) as f32 - 4.0;
        }
        let outputs = weights.network().forward(&inputs).map(f32::to_bits);
        answer = outputs.into_iter().fold(answer, checksum_step);
    }
    Ok(answer)
}

fn done(status: cede_status) -> Result<(), cede_status> {
    match status {
        cede_status::Ok => Ok(()),
        other => Err(other),
    }
}

const fn at(x: f32, y: f32) -> cede_point {
    cede_point { x, y }
}

fn moving(s: f32, speed: f32) -> cede_vehicle {
    cede_vehicle {
        s,
        speed,
        ..cede_vehicle::default()
    }
}

fn track(other: &cede_vehicle) -> cede_track {
    let mut track = cede_track {
        number: 17,
        vehicle_class: CEDE_CLASS_CAR,
        candidate_count: 1,
        speed: other.speed,
        pose: other.pose,
        ..cede_track::default()
    };
    track.candidates[0] = cede_candidate {
        s: other.s,
        path: 1,
        reserved: [0; 3],
    };
    track
}

fn advance(vehicle: &mut cede_vehicle, acceleration: f32) {
    let speed = vehicle.speed + acceleration * PERIOD;
    let speed = if speed > 0.0 { speed } else { 0.0 };
    vehicle.s += 0.5 * (vehicle.speed + speed) * PERIOD;
    vehicle.speed = speed;
}

/// Each step is a bijection of what there was: no difference is lost but by chance.
fn mixed(answer: u32, decision: &cede_decision) -> u32 {
    let (reason, prediction) = (&decision.reason, &decision.prediction);
    let kinds = [
        decision.cause as u8,
        decision.action as u8,
        decision.breach as u8,
        reason.kind as u8,
    ];
    let words = [
        u32::from_le_bytes(kinds),
        u32::from(decision.plan_go),
        decision.acceleration.to_bits(),
        decision.margin.to_bits(),
        reason.available.to_bits(),
        reason.needed.to_bits(),
        prediction.svo.to_bits(),
        prediction.acceleration.to_bits(),
        decision.headroom.ego_position.left.to_bits(),
    ];
    words.into_iter().fold(answer, checksum_step)
}
