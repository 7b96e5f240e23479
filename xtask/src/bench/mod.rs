//! `cargo xtask bench [--quick] [FILTER…]`: measures, and writes `docs/benchmarks.md`.
//!
//! The benchmarks are the criterion benches of the package `anamorph-tests`. This chore runs them, reads what criterion
//! left ([`measured`]), and writes a table for each group ([`page`]): time and rate per element, and *ratios inside the
//! run*. Within a group, the row whose function starts with `baseline` is what the others are compared with; a ratio is
//! the baseline's time divided by the row's, so more is faster. `tests/benches/bars.toml` says which ratios are asked
//! for ([`bars`]). A ratio below its bar is printed as `MISSED`; it fails nothing, since the machine has its share in it.
//!
//! A run without a filter starts from nothing. With filters (regular expressions on `group/row`; any may match), groups
//! that were measured show this run's rows only, and other groups what the last run left, so that every ratio compares
//! times of one run.

pub mod bars;
pub mod measured;
pub mod page;

use crate::{Chore, Failure};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

/// The chore.
pub const CHORE: Chore = Chore {
    name: "bench",
    arguments: "[--quick] [FILTER…]",
    what: "measures, and writes docs/benchmarks.md with ratios inside the run",
    run,
};

const PAGE: &str = "docs/benchmarks.md";
const BARS: &str = "tests/benches/bars.toml";

/// What the arguments ask for.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
struct Options {
    quick: bool,
    filters: Vec<String>,
}

impl Options {
    fn read(arguments: &[String]) -> Result<Self, Failure> {
        let mut options = Self::default();
        for argument in arguments {
            match argument.as_str() {
                "--quick" => options.quick = true,
                flag if flag.starts_with('-') => {
                    return Err(Failure::Usage(format!(
                        "`bench` has no option `{flag}`; it has `--quick`"
                    )));
                }
                filter => options.filters.push(filter.to_owned()),
            }
        }
        Ok(options)
    }

    /// The arguments of cargo. `--bench *` leaves out the unit tests of the package, which know no criterion options.
    fn cargo_arguments(&self) -> Vec<String> {
        let mut arguments: Vec<String> = ["bench", "-p", "anamorph-tests", "--bench", "*", "--"]
            .map(str::to_owned)
            .to_vec();
        if self.quick {
            arguments.push("--quick".to_owned());
        }
        match &self.filters[..] {
            [] => {}
            [one] => arguments.push(one.clone()),
            // Criterion takes one regular expression.
            many => arguments.push(
                many.iter()
                    .map(|f| format!("({f})"))
                    .collect::<Vec<_>>()
                    .join("|"),
            ),
        }
        arguments
    }
}

fn run(root: &Path, arguments: &[String]) -> Result<(), Failure> {
    let options = Options::read(arguments)?;
    // What is written by hand is read first: a mistake there should not cost a run.
    let bars_path = root.join(BARS);
    let bars = match read_if_present(&bars_path)? {
        Some(text) => bars::read(&text)
            .map_err(|e| Failure::Failed(format!("{BARS}:{}: {}", e.line, e.message)))?,
        None => Vec::new(),
    };
    let page_path = root.join(PAGE);
    let notes = match read_if_present(&page_path)? {
        Some(text) => page::notes(&text).map_err(|e| Failure::Failed(format!("{PAGE}: {e}")))?,
        None => None,
    };

    let results = target_folder(root)?.join("criterion");
    if options.filters.is_empty() && results.exists() {
        std::fs::remove_dir_all(&results).map_err(|e| Failure::file(&results, &e))?;
    }
    let start = SystemTime::now();
    let status = Command::new(crate::cargo())
        .args(options.cargo_arguments())
        .current_dir(root)
        .env("CRITERION_HOME", &results)
        .status()
        .map_err(|e| Failure::Failed(format!("cargo could not be started: {e}")))?;
    if !status.success() {
        return Err(Failure::Failed(format!(
            "bench: `cargo {}` failed",
            options.cargo_arguments().join(" ")
        )));
    }

    let rows = measured::read(&results, start).map_err(Failure::Failed)?;
    if !rows.iter().any(|row| row.fresh) {
        return Err(Failure::Failed(
            "bench: nothing was measured; does a filter match nothing?".to_owned(),
        ));
    }
    let groups = measured::groups(rows);
    let machine = page::Machine::this();
    let text = page::write(&groups, &bars, &machine, options.quick, notes.as_deref());
    println!("\n{}", page::tables(&groups, &bars));
    if let Some(folder) = page_path.parent() {
        std::fs::create_dir_all(folder).map_err(|e| Failure::file(folder, &e))?;
    }
    std::fs::write(&page_path, text).map_err(|e| Failure::file(&page_path, &e))?;
    println!("bench: wrote {PAGE}");
    Ok(())
}

fn read_if_present(path: &Path) -> Result<Option<String>, Failure> {
    match std::fs::read_to_string(path) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(Failure::file(path, &error)),
    }
}

/// Where cargo builds, wherever the configuration puts it.
pub(crate) fn target_folder(root: &Path) -> Result<PathBuf, Failure> {
    let output = Command::new(crate::cargo())
        .args(["metadata", "--no-deps", "--format-version", "1"])
        .current_dir(root)
        .output()
        .map_err(|e| Failure::Failed(format!("cargo could not be started: {e}")))?;
    let metadata: Option<serde_json::Value> = serde_json::from_slice(&output.stdout).ok();
    let folder = metadata
        .as_ref()
        .and_then(|m| m.get("target_directory")?.as_str())
        .map(PathBuf::from);
    folder.ok_or_else(|| {
        Failure::Failed(format!(
            "`cargo metadata` failed: {}",
            String::from_utf8_lossy(&output.stderr).trim()
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(arguments: &[&str]) -> Result<Options, Failure> {
        Options::read(
            &arguments
                .iter()
                .map(|a| (*a).to_owned())
                .collect::<Vec<_>>(),
        )
    }

    #[test]
    fn filters_become_one_regular_expression() {
        let tail = |arguments: &[&str]| {
            options(arguments)
                .expect("options")
                .cargo_arguments()
                .split_off(6)
        };
        assert_eq!(tail(&[]), Vec::<String>::new());
        assert_eq!(tail(&["lattice", "--quick"]), ["--quick", "lattice"]);
        assert_eq!(tail(&["lattice|x", "bend"]), ["(lattice|x)|(bend)"]);
    }

    #[test]
    fn an_unknown_option_is_an_error_of_usage() {
        let Err(Failure::Usage(message)) = options(&["--fast"]) else {
            panic!("accepted")
        };
        assert!(message.contains("--fast") && message.contains("--quick"));
    }

    #[test]
    fn the_target_folder_is_the_one_cargo_uses() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        assert!(target_folder(&root).expect("a folder").is_absolute());
        let nothing = tempfile::tempdir().expect("a folder");
        assert!(
            matches!(target_folder(nothing.path()), Err(Failure::Failed(m)) if m.contains("Cargo.toml"))
        );
    }
}
