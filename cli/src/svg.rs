//! Drawings as files.

use crate::failure::Failure;
use cede_data::output;
use std::path::{Path, PathBuf};

/// The path of a drawing, as an option has it.
pub(crate) fn path(text: &str) -> Result<PathBuf, &'static str> {
    let path = PathBuf::from(text);
    if path.extension().is_some_and(|ending| ending == "svg") {
        Ok(path)
    } else {
        Err("drawings are SVG: the file's name has to end in .svg")
    }
}

/// Writes `svg` to `path`.
pub(crate) fn save(path: &Path, svg: &str) -> Result<(), Failure> {
    output::write(path, |out| out.write_all(svg.as_bytes()))?;
    note!("drawn in {}", path.display());
    Ok(())
}
