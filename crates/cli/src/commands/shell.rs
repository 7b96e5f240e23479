//! `anamorph completions` and `anamorph man`.

use crate::arguments::Arguments;
use crate::error::{Failure, output};
use clap::CommandFactory;
use std::io::Write;

pub(crate) fn completions(shell: clap_complete::Shell) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "anamorph", &mut text);
    std::io::stdout()
        .lock()
        .write_all(&text)
        .map_err(|error| output(&error))
}

/// One page for the command and one section a subcommand, in one document.
pub(crate) fn man() -> Result<(), Failure> {
    let mut text = Vec::new();
    let mut command = Arguments::command();
    // Gives subcommands their full names.
    command.build();
    clap_mangen::Man::new(command.clone())
        .render(&mut text)
        .map_err(Failure::new)?;
    for sub in command
        .get_subcommands()
        .filter(|sub| sub.get_name() != "help")
    {
        let page = clap_mangen::Man::new(sub.clone()).title(format!("anamorph-{}", sub.get_name()));
        page.render(&mut text).map_err(Failure::new)?;
    }
    std::io::stdout()
        .lock()
        .write_all(&text)
        .map_err(|error| output(&error))
}
