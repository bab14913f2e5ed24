//! `cede data new-site`: a first scene description, to be corrected by hand.

use crate::failure::Failure;
use cede_data::{Dataset, Site, draft, output};
use std::path::{Path, PathBuf};

/// The text below the options in `cede help data new-site`.
const HELP: &str = "\
The draft names the arms of the junction, what vehicles do between them, and which movements meet; docs/your-own-site.md
tells what to look at.";

/// Options of `cede data new-site`.
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub(crate) struct Args {
    /// Folder of the site's recordings
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// Name of the site [default: the folder's]
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// The description to write; an earlier file is not replaced
    #[arg(long, value_name = "FILE.toml", value_parser = toml)]
    out: PathBuf,
}

/// The path of a description.
fn toml(path: &str) -> Result<PathBuf, &'static str> {
    let path = PathBuf::from(path);
    if path.extension().is_some_and(|ending| ending == "toml") {
        Ok(path)
    } else {
        Err("scene descriptions are TOML: the file's name has to end in .toml")
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if args.out.exists() {
        let problem = format!("{} exists", args.out.display());
        return Err(Failure::input(
            problem,
            "name another file, or move it away",
        ));
    }
    output::check(&args.out)?;
    let folder = args.folder()?;
    let loaded = Dataset::load(&args.data, &folder)?;
    let name = args.name.as_ref().unwrap_or(&loaded.site.name);
    let mut site = Site::by_headings(name);
    site.folder = folder;
    let dataset = Dataset::new(site, loaded.recordings, loaded.map);
    let text = draft(&dataset).ok_or_else(|| {
        let problem = format!(
            "{}: the tracks show no arms of a junction",
            args.data.display()
        );
        let mend =
            "give more recordings, or leave out --site: the rule on headings needs no description";
        Failure::input(problem, mend)
    })?;
    output::write(&args.out, |file| file.write_all(text.as_bytes()))?;
    args.tell(dataset)
}

impl Args {
    /// Name of the folder of the recordings.
    fn folder(&self) -> Result<String, Failure> {
        let unreadable = |error| {
            Failure::input(
                format!("{}: {error}", self.data.display()),
                "check the path",
            )
        };
        let whole = self.data.canonicalize().map_err(unreadable)?;
        let name = whole.file_name().unwrap_or(whole.as_os_str());
        Ok(name.to_string_lossy().into_owned())
    }

    /// Says what the draft finds.
    fn tell(&self, dataset: Dataset) -> Result<(), Failure> {
        let by_headings = dataset.encounters.len();
        let site = Site::named(&self.out.to_string_lossy())?;
        let drafted = Dataset::new(site, dataset.recordings, dataset.map);
        let (out, data) = (self.out.display(), Path::display(&self.data));
        println!("{out}");
        println!(
            "encounters: {} by the draft, {by_headings} by the rule on headings alone",
            drafted.encounters.len()
        );
        note!("look at it: cede data inspect --data {data} --site {out}");
        Ok(())
    }
}
