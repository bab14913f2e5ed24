//! `cede play`: the playground of `docs/play`, from this binary alone.

mod server;

use crate::failure::Failure;
use cede_data::output;
use server::Server;
use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The text below the options in `cede help play`.
const HELP: &str = "\
The page drives with the controller itself, compiled to WebAssembly; it asks nothing of a network. With --out the
folder's index.html can be opened from the disk. Serving ends by Ctrl-C, with exit code 4.";

/// Options of `cede play`.
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub(crate) struct Args {
    /// The port of this machine at which the page is served; by default a free one
    #[arg(long, value_name = "N", conflicts_with = "out")]
    port: Option<u16>,
    /// Write the page into this folder instead of serving it
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Do not open a browser; without a terminal none is opened
    #[arg(long, conflicts_with = "out")]
    no_open: bool,
}

/// A file of the page.
struct Asset {
    name: &'static str,
    kind: &'static str,
    text: &'static str,
}

/// The file `$name` of `docs/play`.
macro_rules! asset {
    ($name:literal, $kind:literal) => {
        Asset {
            name: $name,
            kind: $kind,
            text: include_str!(concat!("../../../docs/play/", $name)),
        }
    };
}

/// The page; the first file is what a browser opens.
const PAGE: [Asset; 10] = [
    asset!("index.html", "text/html; charset=utf-8"),
    asset!("style.css", "text/css; charset=utf-8"),
    asset!("module.js", "text/javascript; charset=utf-8"),
    asset!("controller.js", "text/javascript; charset=utf-8"),
    asset!("sites.js", "text/javascript; charset=utf-8"),
    asset!("drivers.js", "text/javascript; charset=utf-8"),
    asset!("world.js", "text/javascript; charset=utf-8"),
    asset!("view.js", "text/javascript; charset=utf-8"),
    asset!("panel.js", "text/javascript; charset=utf-8"),
    asset!("page.js", "text/javascript; charset=utf-8"),
];

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if let Some(folder) = &args.out {
        return write(folder);
    }
    let port = args.port.unwrap_or(0);
    let server = Server::bind(port).map_err(|error| {
        let mend = "leave out --port for a free one, or name another";
        Failure::input(format!("cannot serve at port {port}: {error}"), mend)
    })?;
    println!("{}  (Ctrl-C ends it)", server.address());
    if !args.no_open && io::stdout().is_terminal() {
        open(&server.address());
    }
    server.serve(&PAGE);
    Ok(())
}

fn write(folder: &Path) -> Result<(), Failure> {
    for asset in &PAGE {
        output::write(&folder.join(asset.name), |file| {
            file.write_all(asset.text.as_bytes())
        })?;
    }
    println!("{}", folder.join(PAGE[0].name).display());
    Ok(())
}

/// Opens a browser, if the system has a way to; the address is printed in any case.
fn open(address: &str) {
    let (program, options): (_, &[&str]) = if cfg!(target_os = "windows") {
        ("cmd", &["/C", "start"])
    } else if cfg!(target_os = "macos") {
        ("open", &[])
    } else {
        ("xdg-open", &[])
    };
    let _ = Command::new(program)
        .args(options)
        .arg(address)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
}
