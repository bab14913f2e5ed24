//! The solver: Z3, as a program of its own.

use super::formula::Script;
use std::collections::HashMap;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// A quantity of a witness.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// What it is called in the lemma.
    pub name: &'static str,
    /// Its value, to a few digits.
    pub value: f64,
    /// Its SI unit.
    pub unit: &'static str,
}

/// What the solver says.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// Nothing contradicts the lemma: it is proved.
    Unsat,
    /// This does.
    Sat(Vec<Quantity>),
    /// It came to no answer, and says so in these words.
    Unknown(String),
}

/// The solver cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SolverError {
    /// There is none, or it does not start.
    #[error("cannot run the solver {}: {source}", .path.display())]
    Missing {
        /// The program.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// It is not Z3.
    #[error("{} is not Z3: it says {said:?}", .path.display())]
    Other {
        /// The program.
        path: PathBuf,
        /// Its answer to `--version`.
        said: String,
    },
}

impl SolverError {
    /// What the user can do about it, in one sentence.
    #[must_use]
    pub fn mend(&self) -> &'static str {
        "install z3 (Debian: apt-get install z3), or name the program with --solver"
    }
}

/// Z3, found on this machine.
#[derive(Clone, Debug)]
pub struct Solver {
    path: PathBuf,
    version: String,
}

impl Solver {
    /// The program at `path`, or `z3` on the search path.
    ///
    /// # Errors
    /// If there is none, or it is another program.
    pub fn find(path: Option<&Path>) -> Result<Self, SolverError> {
        let path = path.unwrap_or(Path::new("z3")).to_owned();
        match Command::new(&path).arg("--version").output() {
            Ok(output) => {
                let said = String::from_utf8_lossy(&output.stdout);
                let said = said.lines().next().unwrap_or_default().to_owned();
                match said.strip_prefix("Z3 version ") {
                    Some(version) => Ok(Self {
                        version: version.to_owned(),
                        path,
                    }),
                    None => Err(SolverError::Other { path, said }),
                }
            }
            Err(source) => Err(SolverError::Missing { path, source }),
        }
    }

    /// As it calls itself.
    #[must_use]
    pub fn version(&self) -> &str {
        &self.version
    }

    /// Its answer, within `limit`.
    ///
    /// # Errors
    /// If it does not start.
    pub fn ask(&self, script: &Script, limit: Duration) -> Result<Answer, SolverError> {
        let said = self.run(script, limit).map_err(|source| {
            let path = self.path.clone();
            SolverError::Missing { path, source }
        })?;
        Ok(answer(script, &said))
    }

    fn run(&self, script: &Script, limit: Duration) -> std::io::Result<String> {
        let mut command = Command::new(&self.path);
        command
            .arg("-in")
            .arg(format!("-T:{}", limit.as_secs().max(1)))
            .arg("pp.decimal=true")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let (id, input, output) = {
            let mut running = running();
            let mut child = command.spawn()?;
            let (id, input, output) = (child.id(), child.stdin.take(), child.stdout.take());
            running.insert(id, child);
            (id, input, output)
        };
        if let Some(mut input) = input {
            let names: Vec<&str> = script.symbols.iter().map(|s| s.name).collect();
            let values = format!("(get-value ({}))\n", names.join(" "));
            // Whatever it makes of it is in what it says.
            let _ = input.write_all((script.text.clone() + &values).as_bytes());
        }
        let mut said = Vec::new();
        let read = output.map_or(Ok(0), |mut output| output.read_to_end(&mut said));
        // It has said all: it ends now.
        if let Some(mut child) = running().remove(&id) {
            child.wait()?;
        }
        read?;
        Ok(String::from_utf8_lossy(&said).into_owned())
    }
}

/// The solvers at work, by their process numbers.
static RUNNING: LazyLock<Mutex<HashMap<u32, Child>>> = LazyLock::new(Mutex::default);

fn running() -> MutexGuard<'static, HashMap<u32, Child>> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends the solvers at work, for a program that is about to end itself. From now on, threads that ask one wait for
/// that end.
pub fn abandon() {
    let mut solvers = running();
    for solver in solvers.values_mut() {
        // One that has ended by itself is no failure.
        let _ = solver.kill();
    }
    std::mem::forget(solvers);
}

fn answer(script: &Script, said: &str) -> Answer {
    let (verdict, rest) = said.split_once('\n').unwrap_or((said, ""));
    match verdict {
        "unsat" => Answer::Unsat,
        "sat" => {
            let witness = script.symbols.iter().filter_map(|symbol| {
                Some(Quantity {
                    name: symbol.name,
                    value: value(rest, symbol.name)?,
                    unit: symbol.unit,
                })
            });
            Answer::Sat(witness.collect())
        }
        _ => Answer::Unknown(said.trim().to_owned()),
    }
}

/// The value of `name` in Z3's list: `(name 1.5)`, `(name (- 0.3333?))` or `(name (/ 1.0 3.0))`.
fn value(list: &str, name: &str) -> Option<f64> {
    let from = list.split_once(&format!("({name} "))?.1;
    let mut tokens = from
        .split(|c: char| c.is_whitespace() || c == '(' || c == ')')
        .filter(|token| !token.is_empty());
    expression(&mut tokens)
}

fn expression<'a>(tokens: &mut impl Iterator<Item = &'a str>) -> Option<f64> {
    match tokens.next()? {
        "-" => Some(-expression(tokens)?),
        "/" => Some(expression(tokens)? / expression(tokens)?),
        number => number.trim_end_matches('?').parse().ok(),
    }
}
