//! What an approach can be asked between two decisions.

use crate::approach::{cede_approach, current};
use crate::contract::{cede_contract, plain};
use crate::decision::cede_fault;
use crate::memory::{checked, offer, write};
use crate::observation::{Seen, cede_observation};
use crate::status::cede_status;

/// The plan that the shield falls back on.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct cede_plan {
    /// For so many periods it accelerates at ego_go; then it brakes.
    pub go: u16,
    /// 1 if there is a plan; 0 is no guarantee.
    pub exists: u8,
    /// 0.
    pub reserved: u8,
}

/// How fast the ego may drive along its path, whoever is there: by speed limits, and in bends.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct cede_profile {
    /// The speed (m/s) that is allowed at this place; infinite, if nothing bounds it there.
    pub speed: f32,
    /// The largest acceleration (m/s^2) that keeps to the profile; infinite, if nothing bounds it.
    pub acceleration: f32,
}

/// The plan that the shield falls back on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_approach_plan(
    approach: *const cede_approach,
    plan: *mut cede_plan,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe {
        current(approach).and_then(|entered| {
            let there = entered.approach.plan();
            let result = cede_plan {
                go: there.map_or(0, |plan| plan.go),
                exists: there.is_some().into(),
                reserved: 0,
            };
            write(plan, result)
        })
    }
    .into()
}

/// The contract that it drives within.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_approach_contract(
    approach: *const cede_approach,
    contract: *mut cede_contract,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe {
        current(approach)
            .and_then(|entered| write(contract, plain(entered.approach.shield().contract())))
    }
    .into()
}

/// Writes 1 if the ego has precedence over the track with this number, on every path that the track may be on, since the last
/// decision; else 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_approach_goes_before(
    approach: *const cede_approach,
    number: u16,
    first: *mut u8,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe {
        current(approach).and_then(|entered| {
            let goes = entered.approach.shield().goes_before(number);
            write(first, goes.into())
        })
    }
    .into()
}

/// Metres to spare of the best plan after one period at `acceleration` (m/s^2), given now while `previous` (m/s^2) is in
/// effect; not negative exactly if the shield would accept it. It knows nobody but whom it sees, assumes no precedence, and
/// remembers nothing.
///
/// CEDE_STATUS_INPUT_FAULT: `fault`, which may be null, says what is wrong with the observation or an acceleration.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_approach_margin(
    approach: *const cede_approach,
    observation: *const cede_observation,
    previous: f32,
    acceleration: f32,
    margin: *mut f32,
    fault: *mut cede_fault,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe {
        spare(
            approach,
            observation,
            [previous, acceleration],
            margin,
            fault,
        )
    }
    .into()
}

unsafe fn spare(
    approach: *const cede_approach,
    observation: *const cede_observation,
    [previous, acceleration]: [f32; 2],
    margin: *mut f32,
    fault: *mut cede_fault,
) -> Result<(), cede_status> {
    checked(margin)?;
    // SAFETY: by the header's contract of pointers.
    unsafe {
        let mut seen = Seen::nothing();
        seen.copy(observation)?;
        let shield = current(approach)?.approach.shield();
        match shield.margin(&seen.observation(), previous, acceleration) {
            Ok(metres) => write(margin, metres),
            Err(why) => {
                offer(fault, why.into())?;
                Err(cede_status::InputFault)
            }
        }
    }
}

/// What bounds the ego at arc length `s` (m) of its path with `speed` (m/s), whoever is there: it comes down to a lower speed
/// ahead at 1.5 m/s^2. For a driver of one's own; cede_approach_decide() keeps to it already.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_approach_profile(
    approach: *const cede_approach,
    s: f32,
    speed: f32,
    profile: *mut cede_profile,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe {
        current(approach).and_then(|entered| {
            let shield = entered.approach.shield();
            let (allowed, response) = (shield.way().profile(), shield.contract().response());
            let result = cede_profile {
                speed: allowed.speed(s),
                acceleration: allowed.acceleration(s, speed, response),
            };
            write(profile, result)
        })
    }
    .into()
}
