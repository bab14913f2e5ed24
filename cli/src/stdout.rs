//! `print!`, `println!` and `eprintln!` that accept a closed pipe (`| head`). The command continues without
//! printing, so that its files and its exit code do not depend on the reader.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::process;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// As std's; see [`crate::stdout`].
macro_rules! print {
    ($($what:tt)*) => { $crate::stdout::write(format_args!($($what)*)) };
}

/// As std's; see [`crate::stdout`].
macro_rules! println {
    () => { print!("\n") };
    ($($what:tt)*) => { print!("{}\n", format_args!($($what)*)) };
}

/// Tells on stderr what is neither the result nor an error, unless `--quiet` is given.
macro_rules! note {
    ($($what:tt)*) => { $crate::stdout::note(format_args!($($what)*)) };
}

/// As std's, but ignores errors of stderr.
macro_rules! eprintln {
    ($($what:tt)*) => { $crate::stdout::tell(format_args!($($what)*)) };
}

static QUIET: AtomicBool = AtomicBool::new(false);

/// Whether notes are left out, from now on.
pub(crate) fn set_quiet(quiet: bool) {
    QUIET.store(quiet, Relaxed);
}

/// Whether notes are left out.
pub(crate) fn is_quiet() -> bool {
    QUIET.load(Relaxed)
}

/// See [`note!`].
pub(crate) fn note(what: Arguments<'_>) {
    if !is_quiet() {
        tell(what);
    }
}

/// Prints a line on stderr.
pub(crate) fn tell(what: Arguments<'_>) {
    // There is no other stream to report this error to.
    let _ = writeln!(io::stderr(), "{what}");
}

/// Prints. If this fails for another reason than a closed pipe (for example a full disk), the program
/// exits with code 3.
pub(crate) fn write(what: Arguments<'_>) {
    match io::stdout().lock().write_fmt(what) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            eprintln!("cannot write to standard output: {error}");
            process::exit(3);
        }
        _ => {}
    }
}
