//! The guide to guarantees shows what the command prints: every block that begins with `$ anamorph check`.
//!
//! With `BLESS=1` in the environment the page is written anew instead.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::repository;
use std::process::Command;

const PAGE: &str = "docs/guarantees.md";

#[test]
fn the_examples_of_the_guide_are_what_is_printed() {
    let page = std::fs::read_to_string(repository(PAGE)).unwrap();
    let (mut written, mut examples) = (String::new(), 0);
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        written.push_str(line);
        written.push('\n');
        let Some(command) = line.strip_prefix("$ anamorph ") else {
            continue;
        };
        examples += 1;
        let output = Command::new(env!("CARGO_BIN_EXE_anamorph"))
            .args(command.split_whitespace())
            .current_dir(repository("."))
            .output()
            .unwrap();
        assert!(output.status.success(), "{command}: {output:?}");
        written.push_str(&String::from_utf8(output.stdout).unwrap());
        // What stood there before.
        let end = lines.by_ref().find(|line| *line == "```").unwrap();
        written.push_str(end);
        written.push('\n');
    }
    assert!(examples >= 3);
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(repository(PAGE), written).unwrap();
        return;
    }
    assert!(
        page == written,
        "{PAGE} is not what is printed; write it anew with BLESS=1:\n{written}"
    );
}
