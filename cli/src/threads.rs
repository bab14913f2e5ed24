//! The option `--threads`.

use crate::failure::Failure;
use std::thread::available_parallelism;

/// Maximum number of threads per core.
const A_CORE: usize = 4;

/// The number of threads.
#[derive(Clone, Copy, clap::Args)]
pub(crate) struct Threads {
    /// Number of threads, at most four per core; 0: one per core. The result does not depend on it
    #[arg(long, default_value_t = 0, value_name = "N")]
    threads: usize,
}

impl Threads {
    /// Starts the threads. Warns if there are fewer than requested.
    ///
    /// # Errors
    /// The system cannot start them.
    pub(crate) fn start(self) -> Result<(), Failure> {
        let most = available_parallelism().map_or(1, usize::from) * A_CORE;
        if self.threads > most {
            let asked = self.threads;
            note!("--threads {asked}: {most} are used, {A_CORE} per core");
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads.min(most));
        pool.build_global()
            .map_err(|error| Failure::input(error, "lower --threads"))
    }
}
