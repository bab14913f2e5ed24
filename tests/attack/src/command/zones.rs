//! `cede-attack zones`.

use super::{count, family};
use cede_attack::audit;
use cede_attack::scenario::{FAMILIES, Family};
use clap::Args as ClapArgs;

/// Searches for overlaps that no conflict zone covers.
#[derive(ClapArgs)]
pub(crate) struct Args {
    /// Sites of each family.
    #[arg(long, default_value = "40", value_parser = count)]
    sites: u64,
    /// Descents for each two lanes.
    #[arg(long, default_value = "300", value_parser = count)]
    starts: u64,
    /// Seed of the first site's first scenario.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Only this family; may be given more than once.
    #[arg(long = "family", value_parser = family)]
    families: Vec<&'static Family>,
}

impl Args {
    pub(crate) fn run(self) -> bool {
        let all: Vec<&Family> = FAMILIES.iter().collect();
        let families = if self.families.is_empty() {
            &all
        } else {
            &self.families
        };
        let mut covered = true;
        for family in families {
            let found = audit::of_family(family, self.seed, self.sites, self.starts as u32);
            println!(
                "{:14} {:>7} pairs of lanes, {} with a gap",
                family.name, found.pairs, found.gaps
            );
            if let Some((seed, [a, b], gap)) = found.deepest {
                println!(
                    "    {:.4} m deep: site of seed {seed}, lanes {a} and {b} at {:?} m",
                    gap.depth, gap.at
                );
            }
            covered &= found.gaps == 0;
        }
        covered
    }
}
