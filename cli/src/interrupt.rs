//! Ctrl-C: exit code 4, at once, or after what is under way has been saved.

use crate::failure::Failure;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

static DEFERRED: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);

/// Makes Ctrl-C (and SIGTERM) end the program with exit code 4.
pub(crate) fn install() {
    // Where no handler can be set the system's own stays, and the program still ends.
    let _ = ctrlc::set_handler(|| {
        let again = ASKED.swap(true, Relaxed);
        if again || !DEFERRED.load(Relaxed) {
            eprintln!("interrupted");
            process::exit(4);
        }
    });
}

/// From now on the first Ctrl-C is left to [`check`]; the second still ends the program.
pub(crate) fn defer() {
    DEFERRED.store(true, Relaxed);
}

/// A place at which a command can stop.
///
/// # Errors
/// [`Failure::Interrupted`] if the user has asked to stop.
pub(crate) fn check() -> Result<(), Failure> {
    if ASKED.load(Relaxed) {
        return Err(Failure::Interrupted);
    }
    Ok(())
}
