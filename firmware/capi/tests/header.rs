//! The header that is checked in is the one that the crate has, and each of its numbers has a text.

use std::path::{Path, PathBuf};

fn here(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// With `UPDATE_HEADER` in the environment, writes it instead.
#[test]
fn the_header_is_up_to_date() {
    let config = cbindgen::Config::from_file(here("cbindgen.toml")).unwrap();
    let mut text = Vec::new();
    cbindgen::Builder::new()
        .with_config(config)
        .with_crate(here(""))
        .generate()
        .unwrap()
        .write(&mut text);
    let file = here("include/cede.h");
    if std::env::var_os("UPDATE_HEADER").is_some() {
        std::fs::write(&file, &text).unwrap();
    }
    let is_same = std::fs::read(&file).is_ok_and(|known| known == text);
    assert!(
        is_same,
        "include/cede.h is not what the crate has: in firmware/capi: UPDATE_HEADER=1 cargo test --test header"
    );
}

/// Each number of an enumeration of the header has a text of its own.
#[test]
fn every_number_has_a_text() {
    type Text = extern "C" fn(u8) -> *const std::ffi::c_char;
    let texts: [(&str, Text); 13] = [
        ("CEDE_CAUSE_", cede::cede_cause_text),
        ("CEDE_ACTION_", cede::cede_action_text),
        ("CEDE_REASON_KIND_", cede::cede_reason_text),
        ("CEDE_FAULT_KIND_", cede::cede_fault_text),
        ("CEDE_SUBJECT_", cede::cede_subject_text),
        ("CEDE_FIELD_", cede::cede_field_text),
        ("CEDE_BREACH_", cede::cede_breach_text),
        ("CEDE_CONDITION_", cede::cede_condition_text),
        ("CEDE_CONTRACT_FIELD_", cede::cede_contract_field_text),
        ("CEDE_CONFLICT_KIND_", cede::cede_conflict_text),
        ("CEDE_RIGHT_", cede::cede_right_text),
        ("CEDE_PRIORITY_", cede::cede_priority_text),
        ("CEDE_CONTROL_", cede::cede_control_text),
    ];
    let header = std::fs::read_to_string(here("include/cede.h")).unwrap();
    let mut numbers = 0;
    for line in header.lines() {
        let Some((name, number)) = line.trim().trim_end_matches(',').split_once(" = ") else {
            continue;
        };
        let number: i32 = number.parse().unwrap();
        let text = match texts.iter().find(|(prefix, _)| name.starts_with(prefix)) {
            Some((_, text)) => text(u8::try_from(number).unwrap()),
            None => {
                assert!(name.starts_with("CEDE_STATUS_"), "{name}");
                cede::cede_status_text(number)
            }
        };
        // SAFETY: the texts are constants that end with a zero.
        let text = unsafe { std::ffi::CStr::from_ptr(text) };
        assert_ne!(text, c"unknown", "{name}");
        numbers += 1;
    }
    assert!(numbers > 90, "{numbers}");
}
