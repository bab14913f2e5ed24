//! `cede man`.

use crate::failure::Failure;
use cede_data::output;
use clap::Command;
use clap_mangen::Man;
use std::path::{Path, PathBuf};

/// Options of `cede man`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder for the pages, as in `share/man/man1`
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Runs the command, for the `grammar` of the command line.
pub(crate) fn run(args: &Args, mut grammar: Command) -> Result<(), Failure> {
    grammar.build();
    write(&grammar, "cede".to_owned(), &args.out)?;
    println!("{}", args.out.join("cede.1").display());
    Ok(())
}

/// Writes the page called `name` on `command`, and those on its commands.
fn write(command: &Command, name: String, folder: &Path) -> Result<(), Failure> {
    let commands = command.get_subcommands();
    for inner in commands.filter(|inner| inner.get_name() != "help") {
        write(inner, format!("{name}-{}", inner.get_name()), folder)?;
    }
    let path = folder.join(format!("{name}.1"));
    let page = Man::new(command.clone().name(name));
    output::write(&path, |mut file| page.render(&mut file))?;
    Ok(())
}
