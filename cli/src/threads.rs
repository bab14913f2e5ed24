//! The option `--threads`.

use crate::failure::Failure;
use std::thread::available_parallelism;

/// More threads than this a core do not help.
const A_CORE: usize = 4;

/// How many threads work.
#[derive(Clone, Copy, clap::Args)]
pub(crate) struct Threads {
    /// Number of threads, at most four a core; 0: one a core. The result does not depend on it
    #[arg(long, default_value_t = 0, value_name = "N")]
    threads: usize,
}

impl Threads {
    /// Starts them. Says so if there are fewer than were asked for.
    ///
    /// # Errors
    /// The system refuses to.
    pub(crate) fn start(self) -> Result<(), Failure> {
        let most = available_parallelism().map_or(1, usize::from) * A_CORE;
        if self.threads > most {
            let asked = self.threads;
            eprintln!("--threads {asked}: {most} are used, {A_CORE} a core");
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads.min(most));
        pool.build_global()
            .map_err(|error| Failure::input(error, "ask for fewer with --threads"))
    }
}
