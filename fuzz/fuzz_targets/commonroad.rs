#![no_main]
//! CommonRoad scenarios (XML), and the search for encounters in those that are accepted.

use cede_data::Dataset;
use cede_fuzz::with_file;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    with_file("scenario.xml", bytes, |path| {
        let _ = Dataset::load(path, "EP0");
    });
});
