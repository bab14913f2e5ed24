//! Programs that a command runs. They end with it.

use std::io::{self, BufRead as _, BufReader};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The one that runs.
static RUNNING: Mutex<Option<Child>> = Mutex::new(None);

fn running() -> MutexGuard<'static, Option<Child>> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs a program, which gets no input. Gives its exit status and what it printed on both streams, in order; `each` is
/// told each line as it comes.
///
/// # Errors
/// If it does not start, or what it prints cannot be read.
pub(crate) fn run(
    mut command: Command,
    mut each: impl FnMut(&str),
) -> io::Result<(ExitStatus, String)> {
    let (output, input) = io::pipe()?;
    command.stdin(Stdio::null()).stdout(input.try_clone()?);
    command.stderr(input);
    // Of a process group of its own, so that what it starts can be ended with it.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    {
        let mut running = running();
        *running = Some(command.spawn()?);
    }
    // The output ends when nobody can write to it any more.
    drop(command);
    let mut said = String::new();
    for line in BufReader::new(output).split(b'\n') {
        let line = String::from_utf8_lossy(&line?).into_owned();
        each(&line);
        said += &line;
        said.push('\n');
    }
    let child = running().take();
    let mut child = child.ok_or_else(|| io::Error::other("the program is gone"))?;
    Ok((child.wait()?, said))
}

/// Ends the program that runs, and what it has started, for a command that is about to end itself. From now on, threads
/// that start one wait for that end.
pub(crate) fn abandon() {
    let mut running = running();
    if let Some(child) = running.as_mut() {
        #[cfg(unix)]
        let _ = Command::new("kill")
            .args(["-KILL", "--", &format!("-{}", child.id())])
            .status();
        // One that has ended by itself is no failure.
        let _ = child.kill();
    }
    std::mem::forget(running);
}
