#![no_main]
//! Scene descriptions (TOML).

use cede_data::Site;
use cede_fuzz::with_file;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    with_file("site.toml", bytes, |path| {
        let _ = Site::named(path.to_str().expect("a path in Unicode"));
    });
});
