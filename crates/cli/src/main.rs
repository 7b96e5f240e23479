//! The `anamorph` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    anamorph_cli::end_on_signals();
    anamorph_cli::run(std::env::args_os())
}
