//! The command line of anamorph, as a library so that tests can run it in place.
//!
//! This is the only crate that opens files, prints, shows progress and decides exit codes: 0 done, 1 failed, 2 wrong
//! usage. Nothing is written before everything that could fail has been computed; files appear whole or not at all.

// Printing is what this crate is for.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod arguments;
mod commands;
mod companions;
mod error;
mod files;
mod gallery;
mod meshes;
mod model;
mod motion;
mod painted;
mod picture;
mod progress;
mod shape_arguments;

use arguments::{Arguments, Command};
use clap::Parser;
use std::ffi::OsString;
use std::process::ExitCode;

/// Lets signals such as Ctrl-C end the process with the exit code 130, and without the temporary files of results.
pub fn end_on_signals() {
    files::end_on_signals();
}

/// Runs the command with the given arguments (the first is the program's name) and says how it ended.
pub fn run<I, T>(arguments: I) -> ExitCode
where
    I: IntoIterator<Item = T>,
    T: Into<OsString> + Clone,
{
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version are no errors; clap knows which stream each belongs to.
            let usage = error.use_stderr();
            let _ = error.print();
            return if usage {
                ExitCode::from(2)
            } else {
                ExitCode::SUCCESS
            };
        }
    };
    let result = match arguments.command {
        Command::Warp(options) => commands::warp::run(&options),
        Command::Morph(options) => commands::morph::run(&options),
        Command::Mesh(options) => commands::shapes::mesh::run(&options),
        Command::Bind(options) => commands::bind::run(&options),
        Command::Motion(options) => commands::motion::run(&options),
        Command::Cage(options) => commands::cage::run(&options),
        Command::Inspect(options) => commands::inspect::run(&options),
        Command::Snake(options) => commands::snake::run(&options),
        Command::Check(options) => commands::check::run(&options),
        Command::List(options) => commands::list::run(&options),
        Command::Gallery(options) => gallery::run(&options),
        Command::Schema => commands::schema::run(),
        Command::Completions { shell } => commands::shell::completions(shell),
        Command::Man => commands::shell::man(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.print();
            failure.exit_code()
        }
    }
}
