//! The `anamorph` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    anamorph_cli::run(std::env::args_os())
}
