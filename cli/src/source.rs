//! Where encounters come from: a folder of recordings, or the synthetic generator.

use crate::failure::Failure;
use cede_data::Dataset;
use std::path::Path;

/// The options that name a data set.
#[derive(clap::Args)]
pub(crate) struct Source {
    /// Folder of recordings, or `synthetic`: the embedded generator
    #[arg(long, value_name = "DIR|synthetic")]
    pub(crate) data: String,
    /// Site of the recordings: `EP0`, `MA`, or the path of a site description
    #[arg(long, default_value = "EP0")]
    pub(crate) site: String,
    /// Number of synthetic encounters, at least
    #[arg(long, default_value_t = 1000, value_name = "N")]
    pub(crate) encounters: usize,
}

impl Source {
    /// Reads the recordings, or generates encounters from `seed`.
    pub(crate) fn load(&self, seed: u64) -> Result<Dataset, Failure> {
        if self.data == "synthetic" {
            return Ok(Dataset::synthetic(self.encounters, seed));
        }
        Ok(Dataset::load(Path::new(&self.data), &self.site)?)
    }
}
