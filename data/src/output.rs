//! Output files appear whole or not at all.
//!
//! A file is written under a temporary name in its own folder and renamed when
//! it is complete, so an interrupted run, a full disk or a failing writer
//! leaves the old file, if there was one, and nothing half-written. A program
//! that ends while another thread writes calls [`abandon`] first.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// An output file could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {}", .path.display(), reason(.source))]
pub struct OutputError {
    /// The file that was to be written.
    pub path: PathBuf,
    /// What the operating system said.
    pub source: io::Error,
}

impl OutputError {
    /// What the user can do about it, in one sentence.
    #[must_use]
    pub fn mend(&self) -> &'static str {
        match self.source.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                "free some space, or name a file on another disk; the previous file, if any, is untouched"
            }
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                "name a file in a folder that you may write to"
            }
            _ => "check the path; the previous file, if any, is untouched",
        }
    }
}

fn reason(source: &io::Error) -> String {
    match source.kind() {
        io::ErrorKind::StorageFull => "the disk is full".to_owned(),
        io::ErrorKind::QuotaExceeded => "the disk quota is used up".to_owned(),
        _ => source.to_string(),
    }
}

/// Writes the file at `path` through `fill`, creating its folder if need be.
///
/// Until `fill` has succeeded and everything is on its way to the disk, `path`
/// is not touched; then it is replaced in one step. A link stays, and what it leads to is replaced. A pipe or a
/// device, such as `/dev/null`, is written to.
///
/// # Errors
/// When the folder cannot be made, `fill` fails, or the disk refuses.
pub fn write(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), OutputError> {
    replace(path, fill).map_err(|source| OutputError {
        path: path.to_owned(),
        source,
    })
}

/// Checks that a file can be written at `path`, creating its folder if need be: for a command that works long
/// before it writes.
///
/// # Errors
/// When the folder cannot be made or written to, or `path` is a folder.
pub fn check(path: &Path) -> Result<(), OutputError> {
    let checked = place(path).and_then(|place| match place {
        Place::File { folder, .. } => Listed::temporary_in(&folder).map(drop),
        Place::Stream(_) => Ok(()),
    });
    checked.map_err(|source| OutputError {
        path: path.to_owned(),
        source,
    })
}

/// What a path leads to.
enum Place {
    /// A file, which may not exist yet, in a folder that does.
    File { file: PathBuf, folder: PathBuf },
    /// A pipe or a device, which is written to and never replaced.
    Stream(PathBuf),
}

fn place(path: &Path) -> io::Result<Place> {
    let file = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if let Ok(known) = std::fs::metadata(path) {
        if known.is_dir() {
            return Err(io::Error::other("this is a folder, not a file"));
        }
        if !known.is_file() {
            return Ok(Place::Stream(path.to_owned()));
        }
    }
    let folder = match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    };
    std::fs::create_dir_all(&folder).map_err(|error| no_folder(&folder, error))?;
    Ok(Place::File { file, folder })
}

/// Why `folder` cannot be made: often a file is in the way.
fn no_folder(folder: &Path, error: io::Error) -> io::Error {
    match folder.ancestors().find(|ancestor| ancestor.is_file()) {
        Some(file) => io::Error::other(format!("{} is a file, not a folder", file.display())),
        None => error,
    }
}

fn replace(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let (path, folder) = match place(path)? {
        Place::File { file, folder } => (file, folder),
        Place::Stream(stream) => {
            let mut writer = BufWriter::new(File::options().write(true).open(stream)?);
            fill(&mut writer)?;
            return writer.flush();
        }
    };
    let (file, _listed) = Listed::temporary_in(&folder)?;
    let mut writer = BufWriter::new(file);
    fill(&mut writer)?;
    let file = writer.into_inner()?;
    file.as_file().sync_data()?;
    let _held = unfinished();
    file.persist(path)?;
    Ok(())
}

/// Temporary names of the files that are being written.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Deletes what is half-written, for a program that is about to end. From now on, threads that write wait for
/// that end.
pub fn abandon() {
    let files = unfinished();
    for file in files.iter() {
        // What cannot be deleted stays: there is nobody left to tell.
        let _ = std::fs::remove_file(file);
    }
    std::mem::forget(files);
}

/// A temporary file's place among those that [`abandon`] deletes, for as long as this lives.
struct Listed(PathBuf);

impl Listed {
    fn temporary_in(folder: &Path) -> io::Result<(NamedTempFile, Self)> {
        let mut files = unfinished();
        let file = temporary_in(folder)?;
        let path = file.path().to_owned();
        files.push(path.clone());
        Ok((file, Self(path)))
    }
}

impl Drop for Listed {
    fn drop(&mut self) {
        unfinished().retain(|path| *path != self.0);
    }
}

fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".cede-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As any new file: readable by whom the umask allows, not by the owner alone.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files_in(folder: &Path) -> Vec<String> {
        let name = |entry: io::Result<std::fs::DirEntry>| {
            entry.unwrap().file_name().to_string_lossy().into_owned()
        };
        std::fs::read_dir(folder).unwrap().map(name).collect()
    }

    #[test]
    fn a_file_appears_whole_in_a_new_folder() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/er/table.csv");
        write(&path, |out| out.write_all(b"whole")).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"whole");
        assert_eq!(files_in(path.parent().unwrap()), ["table.csv"]);
    }

    #[test]
    fn what_cannot_be_written_is_known_before_the_work() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "old").unwrap();
        for (path, why) in [
            (file.join("table.csv"), "file is a file, not a folder"),
            (file.join("deep/table.csv"), "file is a file, not a folder"),
            (folder.path().to_owned(), "this is a folder, not a file"),
        ] {
            let told = check(&path).unwrap_err().to_string();
            assert!(told.ends_with(why), "{told}");
            let told = write(&path, |_| Ok(())).unwrap_err().to_string();
            assert!(told.ends_with(why), "{told}");
        }
        check(&file).unwrap();
        check(&folder.path().join("new/table.csv")).unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), b"old");
    }

    #[cfg(unix)]
    #[test]
    fn links_and_devices_are_not_replaced() {
        use std::os::unix::fs::FileTypeExt;
        let folder = tempfile::tempdir().unwrap();
        let [link, file] = ["link", "file"].map(|name| folder.path().join(name));
        std::fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write(&link, |out| out.write_all(b"new")).unwrap();
        assert!(link.is_symlink());
        assert_eq!(std::fs::read(&file).unwrap(), b"new");
        write(Path::new("/dev/null"), |out| out.write_all(b"lost")).unwrap();
        let kind = std::fs::metadata("/dev/null").unwrap().file_type();
        assert!(kind.is_char_device());
    }

    #[test]
    fn a_failing_writer_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        std::fs::write(&path, "old").unwrap();
        let full = |out: &mut dyn Write| {
            out.write_all(b"half")?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        };
        let error = write(&path, full).unwrap_err();
        assert!(error.to_string().ends_with("table.csv: the disk is full"));
        assert!(error.mend().starts_with("free some space"));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(files_in(folder.path()), ["table.csv"]);
    }
}
