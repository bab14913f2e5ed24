//! Where encounters come from: a folder of recordings, or the synthetic generator.

use crate::failure::Failure;
use cede_data::Dataset;
use clap::builder::RangedU64ValueParser;
use std::path::Path;

/// Default site of the recordings.
const SITE: &str = "EP0";
/// Default number of synthetic encounters.
const ENCOUNTERS: usize = 1000;

/// The options that name a data set.
#[derive(clap::Args)]
pub(crate) struct Source {
    /// Folder of recordings, or `synthetic`: the embedded generator
    #[arg(long, value_name = "DIR|synthetic")]
    pub(crate) data: String,
    /// Site of the recordings: `EP0`, `MA`, or the path of a site description [default: EP0]
    #[arg(long)]
    site: Option<String>,
    /// Number of synthetic encounters, at least [default: 1000]
    #[arg(long, value_name = "N", value_parser = at_least_one())]
    encounters: Option<usize>,
}

/// Reads a number from 1 on.
pub(crate) fn at_least_one() -> RangedU64ValueParser<usize> {
    RangedU64ValueParser::new().range(1..)
}

impl Source {
    /// Reads the recordings, or generates encounters from `seed`. The data set may be empty.
    ///
    /// # Errors
    /// An option belongs to the other kind of data, or the recordings cannot be used.
    pub(crate) fn load(&self, seed: u64) -> Result<Dataset, Failure> {
        if self.is_synthetic() {
            if self.site.is_some() {
                return Err(Failure::ignored("--site", "--data synthetic"));
            }
            return Ok(Dataset::synthetic(self.encounters(), seed));
        }
        if self.encounters.is_some() {
            return Err(self.for_synthetic("--encounters"));
        }
        Ok(Dataset::load(Path::new(&self.data), self.site())?)
    }

    /// The same with the seed from `option`, which only synthetic encounters use; without it from `default`.
    ///
    /// # Errors
    /// As [`Source::load`].
    pub(crate) fn load_seeded(
        &self,
        option: &str,
        seed: Option<u64>,
        default: u64,
    ) -> Result<Dataset, Failure> {
        if seed.is_some() && !self.is_synthetic() {
            return Err(self.for_synthetic(option));
        }
        self.load(seed.unwrap_or(default))
    }

    /// The error for `option`, which needs synthetic data, with recorded data.
    fn for_synthetic(&self, option: &str) -> Failure {
        Failure::ignored(option, &format!("the recordings in {}", self.data))
    }

    /// Whether the encounters are generated.
    pub(crate) fn is_synthetic(&self) -> bool {
        self.data == "synthetic"
    }

    /// Site of the recordings.
    pub(crate) fn site(&self) -> &str {
        self.site.as_deref().unwrap_or(SITE)
    }

    /// Number of synthetic encounters, at least.
    pub(crate) fn encounters(&self) -> usize {
        self.encounters.unwrap_or(ENCOUNTERS)
    }
}

/// Checks that the data set contains encounters.
///
/// # Errors
/// The data set is empty.
pub(crate) fn not_empty(dataset: &Dataset) -> Result<(), Failure> {
    if dataset.encounters.is_empty() {
        return Err(Failure::input(
            format!(
                "no encounters in the recordings of site {}",
                dataset.site.name
            ),
            "see what is there with `cede data inspect`, or name another folder or site",
        ));
    }
    Ok(())
}
