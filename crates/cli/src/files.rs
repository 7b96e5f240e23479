//! Files in and out: read whole, written to a temporary file and renamed.

use crate::error::{Failure, output};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// Whether a path stands for a standard stream.
pub(crate) fn is_stream(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// A path as messages show it.
pub(crate) fn shown(path: &Path) -> String {
    if is_stream(path) {
        "standard input".to_owned()
    } else {
        path.display().to_string()
    }
}

/// The whole of a file, or of standard input for `-`.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let fail = |error: std::io::Error| {
        let mend = match error.kind() {
            std::io::ErrorKind::NotFound => "; check the path",
            std::io::ErrorKind::IsADirectory => "; name a file in it",
            _ => "",
        };
        Failure::new(format!("{}: cannot read: {error}{mend}", shown(path)))
    };
    if is_stream(path) {
        let mut bytes = Vec::new();
        std::io::stdin()
            .lock()
            .read_to_end(&mut bytes)
            .map_err(fail)?;
        return Ok(bytes);
    }
    if path.is_dir() {
        return Err(Failure::new(format!(
            "{}: is a folder; name a file in it",
            shown(path)
        )));
    }
    std::fs::read(path).map_err(fail)
}

/// A file that is being written beside its destination and appears there only when [`Pending::keep`] is called.
pub(crate) struct Pending {
    destination: PathBuf,
    file: Option<tempfile::NamedTempFile>,
}

/// Refuses a destination that exists, unless it may be replaced.
pub(crate) fn refuse_existing(path: &Path, force: bool) -> Result<(), Failure> {
    if is_stream(path) {
        return Ok(());
    }
    if path.is_dir() {
        return Err(Failure::new(format!(
            "{}: is a folder; name a file in it",
            path.display()
        )));
    }
    if !force && path.exists() {
        return Err(Failure::new(format!(
            "{}: exists already; choose another name, or add --force to replace it",
            path.display()
        )));
    }
    let folder = folder_of(path);
    if !folder.is_dir() {
        return Err(Failure::new(format!(
            "{}: its folder does not exist; make it first",
            path.display()
        )));
    }
    Ok(())
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

impl Pending {
    /// Writes a file beside `destination` by `fill`; for `-` straight to standard output.
    pub(crate) fn write(
        destination: &Path,
        fill: impl FnOnce(&mut dyn Write) -> Result<(), Failure>,
    ) -> Result<Self, Failure> {
        if is_stream(destination) {
            let mut out = std::io::BufWriter::with_capacity(1 << 20, std::io::stdout().lock());
            fill(&mut out)?;
            out.flush().map_err(|error| output(&error))?;
            return Ok(Self {
                destination: destination.to_owned(),
                file: None,
            });
        }
        let fail = |error: std::io::Error| {
            Failure::new(format!("{}: cannot write: {error}", destination.display()))
        };
        let mut file = tempfile::Builder::new()
            .prefix(".anamorph-")
            .suffix(".part")
            .tempfile_in(folder_of(destination))
            .map_err(fail)?;
        {
            let mut out = std::io::BufWriter::with_capacity(1 << 20, file.as_file_mut());
            fill(&mut out)?;
            out.flush().map_err(fail)?;
        }
        set_usual_permissions(&file).map_err(fail)?;
        Ok(Self {
            destination: destination.to_owned(),
            file: Some(file),
        })
    }

    /// Puts the file in its place.
    pub(crate) fn keep(self) -> Result<(), Failure> {
        let Some(file) = self.file else { return Ok(()) };
        match file.persist(&self.destination) {
            Ok(_) => Ok(()),
            Err(error) => Err(Failure::new(format!(
                "{}: cannot write: {}",
                self.destination.display(),
                error.error
            ))),
        }
    }
}

/// Temporary files are private; a result gets the permissions any new file has.
#[cfg(unix)]
fn set_usual_permissions(file: &tempfile::NamedTempFile) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    // What the process's mask leaves of 0666 cannot be asked for without changing it; another new file tells.
    let probe = tempfile::Builder::new()
        .prefix(".anamorph-")
        .permissions(std::fs::Permissions::from_mode(0o666))
        .tempfile_in(file.path().parent().unwrap_or(Path::new(".")))?;
    let permissions = probe.as_file().metadata()?.permissions();
    file.as_file().set_permissions(permissions)
}

#[cfg(not(unix))]
fn set_usual_permissions(_: &tempfile::NamedTempFile) -> std::io::Result<()> {
    Ok(())
}

/// A number for people: six significant digits, no trailing zeros.
pub(crate) fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e9).contains(&value.abs()) {
        return format!("{value:.5e}");
    }
    #[allow(clippy::cast_possible_truncation)]
    let before_point = value.abs().log10().floor() as i32 + 1;
    let decimals = usize::try_from(6 - before_point).unwrap_or(0);
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}
