//! Thousands of encounters at once: the simulator that drivers are trained on.
//!
//! Encounters are stepped in [`Block`]s of eight, structure of arrays, so that
//! kinematics, collisions and rewards compile to vector instructions. Nothing is
//! allocated after construction. A block draws its encounters from a generator of its own, so the
//! results have the same bits on any number of threads.
//!
//! ```no_run
//! # use cede_sim::batch::{Batch, LANES, Library};
//! # fn f(encounters: &[cede_data::Encounter]) -> Result<(), cede_sim::batch::LibraryError> {
//! let library = Library::new(encounters, cede_controller::Footprint::PAPER)?;
//! let mut batch = Batch::<2>::new(&library, 4096, 7);
//! batch.for_each(|library, block| {
//!     let coast = [[0.0; LANES]; 2]; // decided from block.vehicles(), block.distance(…)
//!     block.advance(library, &coast);
//!     // Here the terminal states and block.reward() can be stored.
//!     block.restart(library);
//! });
//! # Ok(()) }
//! ```

mod block;
mod library;
mod motion;

pub use block::{Block, Outcome};
pub use library::{Library, LibraryError};
pub use motion::Motion;

use rayon::prelude::*;

/// Encounters in a block.
pub const LANES: usize = 8;

/// One number for each encounter of a block.
pub type Lanes = [f32; LANES];

/// Blocks that a thread takes at a time at least; a step of fewer is over before it is handed out.
const GRAIN: usize = 32;

/// Many encounters of `N` vehicles (2 to 8), stepped in parallel.
#[derive(Clone, Debug)]
pub struct Batch<'a, const N: usize> {
    library: &'a Library,
    blocks: Vec<Block<N>>,
}

impl<'a, const N: usize> Batch<'a, N> {
    /// At least `encounters` of them (rounded up to whole blocks), drawn from `library` by `seed`.
    #[must_use]
    pub fn new(library: &'a Library, encounters: usize, seed: u64) -> Self {
        let blocks = (0_u64..)
            .take(encounters.div_ceil(LANES))
            .map(|stream| Block::new(library, seed, stream))
            .collect();
        Self { library, blocks }
    }

    /// The blocks, in their fixed order.
    #[must_use]
    pub fn blocks(&self) -> &[Block<N>] {
        &self.blocks
    }

    /// The blocks, to be stepped together with data of one's own (zip them).
    pub fn blocks_mut(&mut self) -> &mut [Block<N>] {
        &mut self.blocks
    }

    /// Runs `work` on every block, on the threads of rayon's current pool.
    pub fn for_each(&mut self, work: impl Fn(&Library, &mut Block<N>) + Sync) {
        let library = self.library;
        self.blocks
            .par_iter_mut()
            .with_min_len(GRAIN)
            .for_each(|block| work(library, block));
    }
}
