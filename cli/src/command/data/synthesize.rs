//! `cede data synthesize`: synthetic recordings as files.

use crate::failure::Failure;
use crate::source::some_encounters;
use cede_data::output;
use cede_data::synthetic::{self, WrittenSite};
use std::path::PathBuf;

/// Options of `cede data synthesize`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder for the recordings, maps and scene descriptions
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// At least so many encounters (whole recordings are written)
    #[arg(long, default_value_t = 1000, value_name = "N", value_parser = some_encounters())]
    encounters: usize,
    /// The same seed gives the same files
    #[arg(long, default_value_t = 0, value_name = "S")]
    seed: u64,
    /// Remove what an earlier run wrote in DIR; otherwise DIR has to be empty
    #[arg(long)]
    overwrite: bool,
    /// Print the counts as one JSON object
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    output::check(&args.out.join("SITE.toml"))?;
    args.make_room()?;
    let sites = synthetic::write(&args.out, args.encounters, args.seed)?;
    if args.json {
        let json = |site: &WrittenSite| {
            serde_json::json!({
                "site": site.name, "recordings": site.files.len(), "encounters": site.encounters,
            })
        };
        let sites: Vec<_> = sites.iter().map(json).collect();
        return super::print_json(&serde_json::json!({ "folder": args.out, "sites": sites }));
    }
    println!("site          recordings  encounters");
    for site in &sites {
        let (name, files) = (&site.name, site.files.len());
        println!("{name:<12}  {files:>10}  {:>10}", site.encounters);
    }
    let total: usize = sites.iter().map(|site| site.encounters).sum();
    println!("{total} encounters in {}", args.out.display());
    if let Some(site) = sites.first() {
        note!(
            "read a site with: --data {} --site {}",
            args.out.display(),
            site.name
        );
    }
    Ok(())
}

impl Args {
    /// Makes sure that no recording of an earlier run stays beside a map of this one.
    fn make_room(&self) -> Result<(), Failure> {
        if self.overwrite {
            return Ok(synthetic::remove(&self.out)?);
        }
        let out = self.out.display();
        let unreadable = |error| Failure::input(format!("{out}: {error}"), "name another folder");
        match self.out.read_dir().map_err(unreadable)?.next() {
            None => Ok(()),
            Some(_) => Err(Failure::input(
                format!(
                    "{out} is not empty: recordings of an earlier run would stay among the new ones"
                ),
                "name another folder, or add --overwrite, which removes what an earlier run wrote there",
            )),
        }
    }
}
