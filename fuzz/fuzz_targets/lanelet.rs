#![no_main]
//! Lanelet2 maps (OSM XML).

use cede_data::lanelet;
use cede_fuzz::with_file;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    with_file("map.osm", bytes, |path| {
        let _ = lanelet::read(path);
    });
});
