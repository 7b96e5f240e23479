//! Files in and out: read whole, written to a temporary file and renamed.

use crate::error::{Failure, output};
use anamorph_core::Fingerprint;
use std::io::{ErrorKind, Read, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Temporary files that a signal must not leave behind. Who makes one, or puts several in their places, holds this so long.
static TEMPORARY: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn temporary() -> MutexGuard<'static, Vec<PathBuf>> {
    TEMPORARY.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends the process on Ctrl-C and its like, with the exit code 130 and without temporary files. Signals that the process was told to
/// ignore, as by `nohup`, stay ignored.
pub(crate) fn end_on_signals() {
    // Where this cannot be, a signal ends the process as ever.
    let _ = ctrlc::try_set_handler(|| {
        let files = temporary();
        for path in files.iter() {
            let _ = std::fs::remove_file(path);
        }
        #[allow(
            clippy::exit,
            reason = "a signal ends the process, and no result may appear meanwhile"
        )]
        std::process::exit(130);
    });
}

/// The fingerprint of bytes: FNV-1a.
///
/// *Source*: G. Fowler, L. C. Noll, K.-P. Vo, the FNV non-cryptographic hash.
pub(crate) fn fingerprint(bytes: &[u8]) -> Fingerprint {
    let step = |hash: u64, &byte: &u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    Fingerprint(bytes.iter().fold(0xcbf2_9ce4_8422_2325, step))
}

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

/// A destination as messages show it.
pub(crate) fn shown_output(path: &Path) -> String {
    if is_stream(path) {
        "standard output".to_owned()
    } else {
        path.display().to_string()
    }
}

/// What may be done about a failure of the operating system, to be put behind it; empty where nothing helps.
pub(crate) fn mend(kind: ErrorKind) -> &'static str {
    match kind {
        ErrorKind::NotFound => "; check the path",
        ErrorKind::IsADirectory => "; name a file in it",
        ErrorKind::PermissionDenied => "; check the permissions of the file and of its folder",
        ErrorKind::ReadOnlyFilesystem => "; choose another place",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "; make room, or choose another place",
        ErrorKind::AlreadyExists => "; choose another name, or add --force to replace it",
        ErrorKind::NotADirectory => "; a part of the path is a file, not a folder",
        _ => "",
    }
}

/// The whole of a file, or of standard input for `-`.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let fail = |error: std::io::Error| {
        let mend = mend(error.kind());
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

/// Refuses more than one `-` among the inputs.
pub(crate) fn at_most_one_stream<'a>(
    inputs: impl IntoIterator<Item = &'a PathBuf>,
) -> Result<(), Failure> {
    if inputs.into_iter().filter(|path| is_stream(path)).count() > 1 {
        return Err(Failure::usage(
            "standard input can be read only once; name files for the others",
        ));
    }
    Ok(())
}

/// Whether something is there that is neither file nor folder: a device such as `/dev/null`, a pipe. It is written to, not
/// replaced.
fn is_special(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

/// Whether writing to a destination shows at once, so that it must come last: standard output, devices, pipes.
pub(crate) fn is_immediate(path: &Path) -> bool {
    is_stream(path) || is_special(path)
}

/// Refuses a destination that exists, unless it may be replaced.
pub(crate) fn refuse_existing(path: &Path, force: bool) -> Result<(), Failure> {
    if is_immediate(path) {
        return Ok(());
    }
    if path.is_dir() {
        return Err(Failure::new(format!(
            "{}: is a folder; name a file in it",
            path.display()
        )));
    }
    if !force && path.symlink_metadata().is_ok() {
        return Err(exists(path));
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

fn exists(path: &Path) -> Failure {
    let mend = mend(ErrorKind::AlreadyExists);
    Failure::new(format!("{}: exists already{mend}", path.display()))
}

/// The folder in which a path is.
pub(crate) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// The path of a file that another file names, relative to `folder`. One that leads out of the folder (an absolute path,
/// `..`, a link) is refused unless it is allowed.
pub(crate) fn inside_folder(
    folder: &Path,
    name: &str,
    allow_outside: bool,
) -> Result<PathBuf, String> {
    let path = folder.join(name);
    if name.is_empty() {
        return Err("a file has an empty name; write its name".to_owned());
    }
    if allow_outside {
        return Ok(path);
    }
    let outside = |why: &str| {
        Err(format!(
            "{name} {why} {}; put the file there, or add --allow-outside",
            folder.display()
        ))
    };
    let mut depth = 0_usize;
    for component in Path::new(name).components() {
        match component {
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
            Component::ParentDir if depth > 0 => depth -= 1,
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => {
                return outside("is outside of");
            }
        }
    }
    if let (Ok(real), Ok(folder)) = (std::fs::canonicalize(&path), std::fs::canonicalize(folder))
        && !real.starts_with(&folder)
    {
        return outside("is a link that leads out of");
    }
    Ok(path)
}

/// A path by which the same file is known, however it is written; it need not exist.
pub(crate) fn identity(path: &Path) -> PathBuf {
    let whole = std::fs::canonicalize(path).ok();
    whole.unwrap_or_else(|| match path.file_name() {
        Some(name) => identity(folder_of(path)).join(name),
        None => path.to_owned(),
    })
}

/// Makes a folder and those above it; says which are new, outermost first.
pub(crate) fn make_folder(path: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut missing: Vec<PathBuf> = path
        .ancestors()
        .take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists())
        .map(Path::to_owned)
        .collect();
    missing.reverse();
    for (made, folder) in missing.iter().enumerate() {
        if let Err(error) = std::fs::create_dir(folder) {
            remove_empty(&missing[..made]);
            let mend = match error.kind() {
                ErrorKind::AlreadyExists => "; a file of this name is in the way",
                kind => mend(kind),
            };
            return Err(Failure::new(format!(
                "{}: cannot make the folder: {error}{mend}",
                folder.display()
            )));
        }
    }
    if path.is_dir() {
        Ok(missing)
    } else {
        Err(Failure::new(format!(
            "{}: cannot make the folder, because a file of this name is in the way; choose another name",
            path.display()
        )))
    }
}

/// Removes those of the folders, outermost first, in which nothing is.
pub(crate) fn remove_empty(folders: &[PathBuf]) {
    for folder in folders.iter().rev() {
        // What is not empty stays, and that is as it should be.
        let _ = std::fs::remove_dir(folder);
    }
}

/// A file that is being written beside its destination and appears there only when [`keep_all`] is called.
pub(crate) struct Pending {
    /// As messages show it.
    named: PathBuf,
    /// The file itself, behind any symbolic links.
    destination: PathBuf,
    /// `None` for what cannot be replaced, only written to: standard output, devices, pipes.
    file: Option<tempfile::NamedTempFile>,
    replace: bool,
}

impl Pending {
    /// Begins a file beside `named`. That it can be written is known then; nothing is to be seen there yet.
    pub(crate) fn create(named: &Path, replace: bool) -> Result<Self, Failure> {
        if is_immediate(named) {
            return Ok(Self {
                named: named.to_owned(),
                destination: named.to_owned(),
                file: None,
                replace,
            });
        }
        // A link stays a link: what it leads to is replaced.
        let destination = std::fs::canonicalize(named).unwrap_or_else(|_| named.to_owned());
        let mut known = temporary();
        let file = tempfile::Builder::new()
            .prefix(".anamorph-")
            .suffix(".part")
            .tempfile_in(folder_of(&destination))
            .map_err(|error| cannot_write(named, &error))?;
        known.push(file.path().to_owned());
        drop(known);
        Ok(Self {
            named: named.to_owned(),
            destination,
            file: Some(file),
            replace,
        })
    }

    /// Writes the content by `fill`; what goes to standard output, a device or a pipe is out then.
    pub(crate) fn fill(
        &mut self,
        fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
    ) -> Result<(), Failure> {
        const BUFFER: usize = 1 << 20;
        let fill = |out: &mut dyn Write| {
            let mut out = std::io::BufWriter::with_capacity(BUFFER, out);
            fill(&mut out)?;
            out.flush()
        };
        if is_stream(&self.named) {
            return fill(&mut std::io::stdout().lock()).map_err(|error| output(&error));
        }
        let done = match &mut self.file {
            Some(file) => {
                fill(file.as_file_mut()).and_then(|()| set_permissions(file, &self.destination))
            }
            None => std::fs::OpenOptions::new()
                .write(true)
                .open(&self.destination)
                .and_then(|mut out| fill(&mut out)),
        };
        done.map_err(|error| match error.kind() {
            ErrorKind::BrokenPipe if self.file.is_none() => Failure::ClosedPipe,
            _ => cannot_write(&self.named, &error),
        })
    }

    /// Puts the file in its place; says whether a new file appeared.
    fn keep(self) -> Result<Option<PathBuf>, Failure> {
        let Some(file) = self.file else {
            return Ok(None);
        };
        let new = self.destination.symlink_metadata().is_err();
        let result = if self.replace {
            file.persist(&self.destination)
        } else {
            // Something may have appeared there since we looked.
            file.persist_noclobber(&self.destination)
        };
        match result {
            Ok(_) => Ok(new.then_some(self.destination)),
            Err(error) if error.error.kind() == ErrorKind::AlreadyExists => {
                Err(exists(&self.named))
            }
            Err(error) => Err(cannot_write(&self.named, &error.error)),
        }
    }
}

/// Puts all files in their places. If one cannot be, those that are new are taken away again.
pub(crate) fn keep_all(files: impl IntoIterator<Item = Pending>) -> Result<(), Failure> {
    let mut known = temporary();
    let mut new = Vec::new();
    for file in files {
        let own = file.file.as_ref().map(|file| file.path().to_owned());
        let kept = file.keep();
        known.retain(|path| Some(path) != own.as_ref());
        match kept {
            Ok(path) => new.extend(path),
            Err(failure) => {
                for path in new {
                    let _ = std::fs::remove_file(path);
                }
                return Err(failure);
            }
        }
    }
    Ok(())
}

fn cannot_write(path: &Path, error: &std::io::Error) -> Failure {
    let mend = mend(error.kind());
    Failure::new(format!("{}: cannot write: {error}{mend}", path.display()))
}

/// Temporary files are private; a result gets the permissions of the file it replaces, or those any new file has.
#[cfg(unix)]
fn set_permissions(file: &tempfile::NamedTempFile, replaced: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    if let Ok(replaced) = std::fs::metadata(replaced) {
        return file.as_file().set_permissions(replaced.permissions());
    }
    // What the process's mask leaves of 0666 cannot be asked for without changing it; another new file tells.
    let _known = temporary();
    let probe = tempfile::Builder::new()
        .prefix(".anamorph-")
        .permissions(std::fs::Permissions::from_mode(0o666))
        .tempfile_in(folder_of(file.path()))?;
    let permissions = probe.as_file().metadata()?.permissions();
    file.as_file().set_permissions(permissions)
}

#[cfg(not(unix))]
fn set_permissions(_: &tempfile::NamedTempFile, _: &Path) -> std::io::Result<()> {
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
