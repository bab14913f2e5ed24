//! Ctrl-C and SIGTERM: exit code 4 within a second, after saving if the command saves its work.

use crate::child;
use crate::failure::Failure;
use cede_data::output;
use cede_verify::lemma;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

/// Time that a command has for saving its work.
const GRACE: Duration = Duration::from_millis(800);
/// Time that a message may take if nobody reads stderr.
const PATIENCE: Duration = Duration::from_millis(100);

static DEFERRED: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);

/// Makes Ctrl-C and SIGTERM end the program with exit code 4.
pub(crate) fn install() {
    // Without a handler the system's default applies, which also ends the program.
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

/// Ends the program. Removes temporary files and stops solvers and other programs.
fn end() {
    let (said, waits) = mpsc::channel();
    // Another thread may hold the lock on stderr while it writes a message that nobody reads.
    thread::spawn(move || {
        eprintln!("interrupted");
        said.send(())
    });
    let _ = waits.recv_timeout(PATIENCE);
    lemma::abandon();
    child::abandon();
    output::abandon();
    process::exit(4);
}

/// From now on [`check`] handles the first Ctrl-C, if the command calls it within the time for saving.
pub(crate) fn defer() {
    DEFERRED.store(true, Relaxed);
}

/// Called where a command can stop.
///
/// # Errors
/// [`Failure::Interrupted`] if the user has interrupted the command.
pub(crate) fn check() -> Result<(), Failure> {
    if ASKED.load(Relaxed) {
        return Err(Failure::Interrupted);
    }
    Ok(())
}
