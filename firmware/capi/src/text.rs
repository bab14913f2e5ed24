//! Numbers as text, for a log or a diagnostic tool. Texts are constants; they may change between versions, numbers do not.

use crate::decision::{ACTION, BREACH, CAUSE, CONDITION, FAULT, FIELD, REASON, SUBJECT};
use crate::field::CONTRACT_FIELD;
use crate::junction::{CLASS, CONFLICT, CONTROL, PRIORITY, RIGHT};
use crate::status::STATUS;
use core::ffi::{CStr, c_char};

fn text<T: Copy + PartialEq>(table: &[(T, &'static CStr)], number: T) -> *const c_char {
    let known = table.iter().find(|(known, _)| *known == number);
    known.map_or(c"unknown", |(_, text)| text).as_ptr()
}

/// What a cede_status says; "unknown" for a number that is none. Never null.
#[unsafe(no_mangle)]
pub extern "C" fn cede_status_text(status: i32) -> *const c_char {
    text(STATUS, status)
}

/// What a cede_cause says.
#[unsafe(no_mangle)]
pub extern "C" fn cede_cause_text(cause: u8) -> *const c_char {
    text(CAUSE, cause)
}

/// What a cede_action says.
#[unsafe(no_mangle)]
pub extern "C" fn cede_action_text(action: u8) -> *const c_char {
    text(ACTION, action)
}

/// What a cede_reason_kind says.
#[unsafe(no_mangle)]
pub extern "C" fn cede_reason_text(reason: u8) -> *const c_char {
    text(REASON, reason)
}

/// What a cede_fault_kind says.
#[unsafe(no_mangle)]
pub extern "C" fn cede_fault_text(fault: u8) -> *const c_char {
    text(FAULT, fault)
}

/// What a cede_subject says.
#[unsafe(no_mangle)]
pub extern "C" fn cede_subject_text(subject: u8) -> *const c_char {
    text(SUBJECT, subject)
}

/// What a cede_field says.
#[unsafe(no_mangle)]
pub extern "C" fn cede_field_text(field: u8) -> *const c_char {
    text(FIELD, field)
}

/// What a cede_breach says.
#[unsafe(no_mangle)]
pub extern "C" fn cede_breach_text(breach: u8) -> *const c_char {
    text(BREACH, breach)
}

/// What a cede_condition says.
#[unsafe(no_mangle)]
pub extern "C" fn cede_condition_text(condition: u8) -> *const c_char {
    text(CONDITION, condition)
}

/// The name of a cede_contract_field, as in "ego.braking".
#[unsafe(no_mangle)]
pub extern "C" fn cede_contract_field_text(field: u8) -> *const c_char {
    text(CONTRACT_FIELD, field)
}

/// What a cede_conflict_kind says.
#[unsafe(no_mangle)]
pub extern "C" fn cede_conflict_text(kind: u8) -> *const c_char {
    text(CONFLICT, kind)
}

/// What a cede_right says.
#[unsafe(no_mangle)]
pub extern "C" fn cede_right_text(right: u8) -> *const c_char {
    text(RIGHT, right)
}

/// What a cede_priority says.
#[unsafe(no_mangle)]
pub extern "C" fn cede_priority_text(priority: u8) -> *const c_char {
    text(PRIORITY, priority)
}

/// What a cede_control says.
#[unsafe(no_mangle)]
pub extern "C" fn cede_control_text(control: u8) -> *const c_char {
    text(CONTROL, control)
}

/// What a CEDE_CLASS_... says.
#[unsafe(no_mangle)]
pub extern "C" fn cede_class_text(vehicle_class: u8) -> *const c_char {
    text(CLASS, vehicle_class)
}
