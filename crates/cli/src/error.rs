//! How a command fails.

use std::process::ExitCode;

/// Prints a line on standard error. Unlike `eprintln!` it does not panic where nobody can read it.
macro_rules! say {
    ($($argument:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr().lock(), $($argument)*);
    }};
}
pub(crate) use say;

/// Why a command stopped.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Something went wrong; the text says what, where and how to mend it.
    Message(String),
    /// The arguments do not fit together.
    Usage(String),
    /// The reasons have been printed already, one a file.
    Reported,
    /// Nobody reads the output any more.
    ClosedPipe,
}

impl Failure {
    pub(crate) fn new(message: impl std::fmt::Display) -> Self {
        Self::Message(message.to_string())
    }

    pub(crate) fn usage(message: impl std::fmt::Display) -> Self {
        Self::Usage(message.to_string())
    }

    /// A failure of writing to a file or to standard output while it grows.
    pub(crate) fn written(path: &std::path::Path, error: &std::io::Error) -> Self {
        if crate::files::is_stream(path) {
            return output(error);
        }
        let mend = crate::files::mend(error.kind());
        Self::new(format!("{}: cannot write: {error}{mend}", path.display()))
    }

    /// Says why on standard error.
    pub(crate) fn print(&self) {
        match self {
            Self::Message(text) => {
                for line in text.lines() {
                    say!("error: {line}");
                }
            }
            Self::Usage(text) => {
                say!("error: {text}");
                say!("see `anamorph --help`");
            }
            Self::Reported | Self::ClosedPipe => {}
        }
    }

    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::Message(_) | Self::Reported => ExitCode::from(1),
            Self::Usage(_) => ExitCode::from(2),
            Self::ClosedPipe => ExitCode::SUCCESS,
        }
    }
}

/// A failure of writing to standard output.
pub(crate) fn output(error: &std::io::Error) -> Failure {
    if error.kind() == std::io::ErrorKind::BrokenPipe {
        Failure::ClosedPipe
    } else {
        Failure::new(format!("cannot write to standard output: {error}"))
    }
}
