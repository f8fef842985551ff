//! Files that are written whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::TempPath;

use crate::report::charts::ChartError;

/// Why a file or folder could not be written.
#[derive(Debug, thiserror::Error)]
pub(crate) enum WriteError {
    #[error("{}: cannot be written: {error}", path.display())]
    File { path: PathBuf, error: io::Error },
    #[error("{}: the folder cannot be made: {error}", path.display())]
    Folder { path: PathBuf, error: io::Error },
    #[error("{}: no files can be made in this folder: {error}", path.display())]
    NotWritable { path: PathBuf, error: io::Error },
    #[error(transparent)]
    Chart(#[from] ChartError),
    #[error("the report cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

/// Makes a folder if need be and tries that files can be made in it, so that a bad path is found before a long run.
///
/// # Errors
/// A folder that cannot be made or written to.
pub(crate) fn prepare(folder: &Path) -> Result<(), WriteError> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    fs::create_dir_all(folder).map_err(|error| WriteError::Folder { path: folder.to_path_buf(), error })?;
    tempfile::NamedTempFile::new_in(folder)
        .map(drop)
        .map_err(|error| WriteError::NotWritable { path: folder.to_path_buf(), error })
}

/// [`prepare`] for the folder of a file, unless the file is a device or a pipe.
///
/// # Errors
/// A folder that cannot be made or written to.
pub(crate) fn prepare_for(file: &Path) -> Result<(), WriteError> {
    match fs::metadata(file) {
        Ok(there) if !there.is_file() && !there.is_dir() => Ok(()),
        _ => prepare(file.parent().unwrap_or(Path::new(""))),
    }
}

/// Writes bytes to a [`WholeFile`].
///
/// # Errors
/// The file cannot be made, written or renamed.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let written = || -> io::Result<()> {
        let mut file = WholeFile::create(path)?;
        file.write_all(bytes)?;
        file.close()
    };
    written().map_err(|error| WriteError::File { path: path.to_path_buf(), error })
}

/// A file that gets its name when it is closed, so that it is never seen half written. What is no regular file (a
/// device, a pipe) has no name to get: it is written as it stands.
pub(crate) struct WholeFile {
    file: File,
    /// The temporary file and the name it will have.
    named: Option<(TempPath, PathBuf)>,
}

impl WholeFile {
    /// A symbolic link is followed. The file may be read by others as far as the umask lets them.
    ///
    /// # Errors
    /// The path is a folder; its folder is not there or not writable.
    pub(crate) fn create(path: &Path) -> io::Result<WholeFile> {
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        match fs::metadata(&path) {
            Ok(there) if there.is_dir() => return Err(io::Error::new(io::ErrorKind::IsADirectory, "is a directory")),
            Ok(there) if !there.is_file() => {
                return Ok(WholeFile { file: OpenOptions::new().write(true).open(&path)?, named: None });
            }
            Ok(_) | Err(_) => {}
        }
        let mut builder = tempfile::Builder::new();
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let (file, temporary) = builder.tempfile_in(folder)?.into_parts();
        Ok(WholeFile { file, named: Some((temporary, path)) })
    }

    /// # Errors
    /// The file cannot be renamed.
    pub(crate) fn close(self) -> io::Result<()> {
        match self.named {
            Some((temporary, path)) => temporary.persist(path).map_err(|e| e.error),
            None => Ok(()),
        }
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}
