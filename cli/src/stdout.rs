//! What is printed: `print!`, `println!` and `eprintln!` as std's, but a reader that has seen enough (`| head`) is no
//! failure. The command goes on, without printing, so that its files and its exit code are those it
//! would have had.

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

/// As std's, but where stderr cannot be written to, nothing is said.
macro_rules! eprintln {
    ($($what:tt)*) => { $crate::stdout::tell(format_args!($($what)*)) };
}

/// Prints a line on stderr.
pub(crate) fn tell(what: Arguments<'_>) {
    // There is no other place to complain at.
    let _ = writeln!(io::stderr(), "{what}");
}

/// Prints; where that is impossible for another reason than a closed pipe (a full disk), the program ends
/// with exit code 3.
pub(crate) fn write(what: Arguments<'_>) {
    match io::stdout().lock().write_fmt(what) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            eprintln!("cannot write to standard output: {error}");
            process::exit(3);
        }
        _ => {}
    }
}
