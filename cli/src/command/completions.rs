//! `cede completions`.

use crate::failure::Failure;
use clap_complete::Shell;

/// The text below the options in `cede help completions`.
const HELP: &str = "\
bash: cede completions bash > ~/.local/share/bash-completion/completions/cede
zsh:  cede completions zsh > \"${fpath[1]}/_cede\"
fish: cede completions fish > ~/.config/fish/completions/cede.fish";

/// Options of `cede completions`.
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub(crate) struct Args {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Runs the command, for the `grammar` of the command line.
pub(crate) fn run(args: &Args, mut grammar: clap::Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut grammar, "cede", &mut script);
    print!("{}", String::from_utf8_lossy(&script));
    Ok(())
}
