//! Ctrl-C and SIGTERM: exit code 4, at once, or after what is under way has been saved, but within a second.

use crate::failure::Failure;
use cede_data::output;
use cede_verify::lemma;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

/// How long a command has to save what was done.
const GRACE: Duration = Duration::from_millis(800);
/// How long a message may take where nobody reads it.
const PATIENCE: Duration = Duration::from_millis(100);

static DEFERRED: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);

/// Makes Ctrl-C (and SIGTERM) end the program with exit code 4.
pub(crate) fn install() {
    // Where no handler can be set the system's own stays, and the program still ends.
    let _ = ctrlc::set_handler(|| {
        let again = ASKED.swap(true, Relaxed);
        if again || !DEFERRED.load(Relaxed) {
            end();
        }
        thread::spawn(|| {
            thread::sleep(GRACE);
            end();
        });
    });
}

/// Ends the program; nothing half-written and no solver stays.
fn end() {
    let (said, waits) = mpsc::channel();
    // Another thread may be stuck in a message, with the lock on stderr, because nobody reads it.
    thread::spawn(move || {
        eprintln!("interrupted");
        said.send(())
    });
    let _ = waits.recv_timeout(PATIENCE);
    lemma::abandon();
    output::abandon();
    process::exit(4);
}

/// From now on the first Ctrl-C is left to [`check`], if the command comes there soon.
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
