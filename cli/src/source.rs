//! Where encounters come from: recordings, CommonRoad scenarios, or the synthetic generator.

use crate::failure::Failure;
use cede_data::Dataset;
use clap::builder::{NonEmptyStringValueParser, RangedU64ValueParser};
use std::path::Path;

/// Default site of the recordings.
const SITE: &str = "EP0";
/// The mend where there are no encounters.
const INSPECT: &str = "see what is there with `cede data inspect`, or name another folder or site";
/// Default number of synthetic encounters.
const ENCOUNTERS: usize = 1000;

/// The options that name a data set.
#[derive(clap::Args)]
pub(crate) struct Source {
    /// Folder of recordings, a CommonRoad scenario (.xml) or a folder of them, or `synthetic`: the embedded generator
    #[arg(long, value_name = "DIR|synthetic", value_parser = NonEmptyStringValueParser::new())]
    pub(crate) data: String,
    /// Sites of the recordings, separated by commas: `EP0`, `MA`, the name of a folder (described by NAME.toml beside
    /// it), or the path of a site description; `all`: every folder of recordings in DIR [default: EP0]. Scenarios are
    /// sites of their own
    #[arg(long, value_delimiter = ',', value_name = "NAME[,NAME…]|all", value_parser = NonEmptyStringValueParser::new())]
    site: Vec<String>,
    /// Number of synthetic encounters, at least [default: 1000]
    #[arg(long, value_name = "N", value_parser = some_encounters())]
    encounters: Option<usize>,
}

/// Reads a number of synthetic encounters: those that memory holds.
pub(crate) fn some_encounters() -> RangedU64ValueParser<usize> {
    RangedU64ValueParser::new().range(1..=1_000_000)
}

impl Source {
    /// Reads the recordings of every site, or generates encounters from `seed`. There is at least one data
    /// set, and each site occurs once. A data set may be empty.
    ///
    /// # Errors
    /// An option belongs to the other kind of data, or the recordings cannot be used.
    pub(crate) fn load(&self, seed: u64) -> Result<Vec<Dataset>, Failure> {
        if self.is_synthetic() {
            if !self.site.is_empty() {
                return Err(Failure::ignored("--site", "--data synthetic"));
            }
            return Ok(vec![Dataset::synthetic(self.encounters(), seed)]);
        }
        if self.encounters.is_some() {
            return Err(self.for_synthetic("--encounters"));
        }
        let dir = Path::new(&self.data);
        let names = match self.site.as_slice() {
            _ if self.is_all() => Dataset::sites(dir)?,
            [] => vec![SITE.to_owned()],
            names => names.to_vec(),
        };
        let mut sites: Vec<Dataset> = Vec::new();
        for name in names {
            let dataset = recorded(dir, name.trim())?;
            if sites
                .iter()
                .all(|known| known.site.name != dataset.site.name)
            {
                sites.push(dataset);
            }
        }
        Ok(sites)
    }

    /// Those of `sites` that have encounters: all that are named. Of `--site all`, those without are left out, and stderr
    /// says so.
    ///
    /// # Errors
    /// A site that is named has no encounters, or none of all has.
    pub(crate) fn occupied(&self, sites: Vec<Dataset>) -> Result<Vec<Dataset>, Failure> {
        if !self.is_all() {
            sites.iter().try_for_each(not_empty)?;
            return Ok(sites);
        }
        let (occupied, empty): (Vec<_>, Vec<_>) = sites
            .into_iter()
            .partition(|dataset| !dataset.encounters.is_empty());
        for dataset in empty {
            note!("left out: site {} has no encounters", dataset.site.name);
        }
        if occupied.is_empty() {
            return Err(Failure::input(
                format!("no encounters at any site in {}", self.data),
                INSPECT,
            ));
        }
        Ok(occupied)
    }

    /// The same as [`Source::load`], with the seed from `option`, which only synthetic encounters use; without it from `default`.
    ///
    /// # Errors
    /// As [`Source::load`].
    pub(crate) fn load_seeded(
        &self,
        option: &str,
        seed: Option<u64>,
        default: u64,
    ) -> Result<Vec<Dataset>, Failure> {
        if seed.is_some() && !self.is_synthetic() {
            return Err(self.for_synthetic(option));
        }
        self.load(seed.unwrap_or(default))
    }

    /// The error for `option`, which needs synthetic data, with recorded data.
    fn for_synthetic(&self, option: &str) -> Failure {
        Failure::ignored(option, &format!("the recordings in {}", self.data))
    }

    /// [`Source::load_seeded`] for a command that works on one site.
    ///
    /// # Errors
    /// As [`Source::load_seeded`], or there are several sites.
    pub(crate) fn load_one_seeded(
        &self,
        option: &str,
        seed: Option<u64>,
        default: u64,
    ) -> Result<Dataset, Failure> {
        one(self.load_seeded(option, seed, default)?)
    }

    /// Whether the encounters are generated.
    pub(crate) fn is_synthetic(&self) -> bool {
        self.data == "synthetic"
    }

    /// Whether several sites are named.
    pub(crate) fn is_several(&self) -> bool {
        self.site.len() > 1 || self.is_all()
    }

    /// Whether the sites are all those in the folder.
    pub(crate) fn is_all(&self) -> bool {
        self.site == ["all"]
    }

    /// The sites of the recordings, as they are named on the command line.
    pub(crate) fn sites(&self) -> String {
        if self.site.is_empty() {
            SITE.to_owned()
        } else {
            self.site.join(",")
        }
    }

    /// Number of synthetic encounters, at least.
    pub(crate) fn encounters(&self) -> usize {
        self.encounters.unwrap_or(ENCOUNTERS)
    }
}

/// The recordings of `site` in `dir`. If nothing describes the site, stderr says so.
///
/// # Errors
/// They cannot be used.
pub(crate) fn recorded(dir: &Path, site: &str) -> Result<Dataset, Failure> {
    let dataset = Dataset::load(dir, site)?;
    if let Some(remark) = dataset.site.remark() {
        note!("{remark}");
    }
    Ok(dataset)
}

/// The only one of `sites`.
///
/// # Errors
/// There are several.
fn one(sites: Vec<Dataset>) -> Result<Dataset, Failure> {
    let several =
        || Failure::Usage("this command works on one site: name it with --site".to_owned());
    let [site] = <[Dataset; 1]>::try_from(sites).map_err(|_| several())?;
    Ok(site)
}

/// The sites' names, as in `EP0,MA`.
pub(crate) fn names(sites: &[Dataset]) -> String {
    let names: Vec<_> = sites
        .iter()
        .map(|dataset| dataset.site.name.as_str())
        .collect();
    names.join(",")
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
            INSPECT,
        ));
    }
    Ok(())
}
