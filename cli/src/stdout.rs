//! `print!`, `println!` and `eprintln!` that accept a closed pipe (`| head`). The command continues without
//! printing, so that its files and its exit code do not depend on the reader.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::process;

/// As std's; see [`crate::stdout`].
macro_rules! print {
    ($($what:tt)*) => { $crate::stdout::write(format_args!($($what)*)) };
}

/// As std's; see [`crate::stdout`].
macro_rules! println {
    () => { print!("\n") };
    ($($what:tt)*) => { print!("{}\n", format_args!($($what)*)) };
}

/// As std's, but ignores errors of stderr.
macro_rules! eprintln {
    ($($what:tt)*) => { $crate::stdout::tell(format_args!($($what)*)) };
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
