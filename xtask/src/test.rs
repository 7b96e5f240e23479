//! `cargo xtask test`: everything that decides whether a change is good.
//!
//! The steps run in the order of [`plan`], the cheap ones that fail most often first; the first that fails ends the run
//! and the last line says which it was and how to run it alone. `wasm32-unknown-unknown` is checked where that target
//! is installed and said to be skipped elsewhere, so that a plain toolchain is enough.

use crate::document::Table;
use crate::tidy::{self, Tree};
use crate::{Chore, Failure};
use std::io;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// The chore.
pub const CHORE: Chore = Chore {
    name: "test",
    arguments: "",
    what: "what decides whether a change is good: format, clippy, tests, documentation, features, tidy",
    run,
};

const WASM: &str = "wasm32-unknown-unknown";

/// One call of cargo.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Call {
    /// The arguments, without `cargo`.
    pub arguments: Vec<String>,
    /// An environment variable to set for it.
    pub environment: Option<(&'static str, &'static str)>,
}

impl Call {
    fn new(arguments: &str) -> Self {
        Self {
            arguments: arguments.split_whitespace().map(str::to_owned).collect(),
            environment: None,
        }
    }

    /// The call as one would type it.
    #[must_use]
    pub fn typed(&self) -> String {
        let environment = self
            .environment
            .map(|(key, value)| format!("{key}=\"{value}\" "))
            .unwrap_or_default();
        format!("{environment}cargo {}", self.arguments.join(" "))
    }
}

/// What a step does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Work {
    /// Calls of cargo, one after another.
    Cargo(Vec<Call>),
    /// The rules of [`mod@tidy`].
    Tidy,
    /// Nothing, for the reason given.
    Skipped(String),
}

/// One step of the chore.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Step {
    /// Its name.
    pub name: &'static str,
    /// What it does.
    pub work: Work,
}

/// A library crate, as its manifest describes it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Library {
    /// The package's name.
    pub package: String,
    /// The features it declares, `default` aside.
    pub features: Vec<String>,
}

/// The crates under `crates/` that have a library, in the order of their folders.
#[must_use]
pub fn libraries(tree: &Tree) -> Vec<Library> {
    let manifests = tree.matching("crates/*/Cargo.toml");
    manifests
        .filter(|path| tree.has(&path.replace("Cargo.toml", "src/lib.rs")))
        .filter_map(|path| {
            let manifest = Table::parse(&tree.text(path)?).ok()?;
            let package = manifest
                .at(&["package", "name"])?
                .value
                .as_text()?
                .to_owned();
            let declared = manifest
                .get("features")
                .and_then(|f| f.value.as_table())
                .cloned()
                .unwrap_or_default();
            let features = declared
                .entries
                .into_iter()
                .map(|e| e.key)
                .filter(|key| key != "default")
                .collect();
            Some(Library { package, features })
        })
        .collect()
}

/// The steps, for these library crates.
///
/// Every library is checked alone without its features; the engine, which is most often used alone, with each of its
/// features as well. The command line, if it has a library part, is not meant for `wasm32`.
#[must_use]
pub fn plan(libraries: &[Library], wasm_installed: bool) -> Vec<Step> {
    let mut features = Vec::new();
    for Library {
        package,
        features: declared,
    } in libraries
    {
        features.push(Call::new(&format!(
            "check -p {package} --no-default-features"
        )));
        if package == "anamorph-core" {
            features.extend(declared.iter().map(|f| {
                Call::new(&format!(
                    "check -p {package} --no-default-features --features {f}"
                ))
            }));
        }
    }
    let portable: Vec<String> = libraries
        .iter()
        .filter(|l| l.package != "anamorph-cli")
        .map(|l| format!("-p {}", l.package))
        .collect();
    let wasm = if wasm_installed {
        Work::Cargo(vec![Call::new(&format!(
            "check --target {WASM} {}",
            portable.join(" ")
        ))])
    } else {
        Work::Skipped(format!(
            "the target {WASM} is not installed; `rustup target add {WASM}` adds it"
        ))
    };
    let documentation = Call {
        environment: Some(("RUSTDOCFLAGS", "-D warnings")),
        ..Call::new("doc --workspace --no-deps --all-features")
    };
    let cargo = |arguments| Work::Cargo(vec![Call::new(arguments)]);
    vec![
        Step {
            name: "format",
            work: cargo("fmt --all --check"),
        },
        Step {
            name: "clippy",
            work: cargo("clippy --workspace --all-targets --all-features -- -D warnings"),
        },
        Step {
            name: "tests",
            work: cargo("test --workspace --all-features"),
        },
        Step {
            name: "documentation",
            work: Work::Cargo(vec![documentation]),
        },
        Step {
            name: "features",
            work: Work::Cargo(features),
        },
        Step {
            name: "wasm32",
            work: wasm,
        },
        Step {
            name: "tidy",
            work: Work::Tidy,
        },
    ]
}

/// Whether rustc has the standard library for the target: asked of rustc itself, as not every toolchain has rustup.
fn wasm_installed() -> bool {
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    Command::new(rustc)
        .args(["--print", "target-libdir", "--target", WASM])
        .output()
        .is_ok_and(|output| Path::new(String::from_utf8_lossy(&output.stdout).trim()).is_dir())
}

fn run(root: &Path, arguments: &[String]) -> Result<(), Failure> {
    crate::no_arguments("test", arguments)?;
    let tree = Tree::open(root).map_err(|e| Failure::file(root, &e))?;
    let steps = plan(&libraries(&tree), wasm_installed());
    let start = Instant::now();
    let mut passed: Vec<(&str, Duration)> = Vec::new();
    let mut skipped = Vec::new();
    for (number, step) in steps.iter().enumerate() {
        println!("\n==> {} of {}: {}", number + 1, steps.len(), step.name);
        if let Work::Skipped(reason) = &step.work {
            println!("    skipped: {reason}");
            skipped.push(step.name);
            continue;
        }
        let step_start = Instant::now();
        let result = perform(root, &step.work);
        let time = step_start.elapsed();
        if let Err(rerun) = result {
            println!("    {} FAILED after {:.1} s", step.name, time.as_secs_f64());
            return Err(Failure::Failed(format!(
                "test: step `{}` failed; rerun it with: {rerun}",
                step.name
            )));
        }
        println!("    {} passed in {:.1} s", step.name, time.as_secs_f64());
        passed.push((step.name, time));
    }
    println!("\n{}", summary(&passed, &skipped, start.elapsed()));
    Ok(())
}

/// Does a step's work; the error is the command that does the failed part again.
fn perform(root: &Path, work: &Work) -> Result<(), String> {
    match work {
        Work::Skipped(_) => Ok(()),
        Work::Tidy => tidy::report(root).map_err(|failure| {
            if let Failure::Failed(message) = failure {
                println!("{message}");
            }
            "cargo xtask tidy".to_owned()
        }),
        Work::Cargo(calls) => call_each(calls, |call| {
            println!("    {}", call.typed());
            let mut command = Command::new(crate::cargo());
            command
                .args(&call.arguments)
                .current_dir(root)
                .envs(call.environment);
            command.status().map(|status| status.success())
        }),
    }
}

/// Makes the calls up to the first that fails; the error is that call as one would type it.
fn call_each(
    calls: &[Call],
    mut succeeds: impl FnMut(&Call) -> io::Result<bool>,
) -> Result<(), String> {
    calls.iter().try_for_each(|call| match succeeds(call) {
        Ok(true) => Ok(()),
        Ok(false) => Err(call.typed()),
        Err(error) => Err(format!(
            "{} (cargo could not be started: {error})",
            call.typed()
        )),
    })
}

/// The lines that end a run in which every step passed.
fn summary(passed: &[(&str, Duration)], skipped: &[&str], whole: Duration) -> String {
    let mut text = String::new();
    for (name, time) in passed {
        text.push_str(&format!("{name:>14}  {:7.1} s\n", time.as_secs_f64()));
    }
    for name in skipped {
        text.push_str(&format!("{name:>14}  skipped\n"));
    }
    text.push_str(&format!(
        "test: all {} steps passed in {:.1} s",
        passed.len(),
        whole.as_secs_f64()
    ));
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tidy::testing::Sketch;

    fn two_libraries() -> Vec<Library> {
        let tree = Sketch::new()
            .file(
                "crates/cli/Cargo.toml",
                "[package]\nname = \"anamorph-cli\"\n",
            )
            .file("crates/cli/src/main.rs", "")
            .file(
                "crates/core/Cargo.toml",
                "[package]\nname = \"anamorph-core\"\n[features]\ndefault = []\nserde = []\n",
            )
            .file("crates/core/src/lib.rs", "")
            .file(
                "crates/io/Cargo.toml",
                "[package]\nname = \"anamorph-io\"\n[features]\nfast = []\n",
            )
            .file("crates/io/src/lib.rs", "");
        libraries(&tree.tree())
    }

    fn typed(steps: &[Step], name: &str) -> Vec<String> {
        match &steps
            .iter()
            .find(|s| s.name == name)
            .expect("the step")
            .work
        {
            Work::Cargo(calls) => calls.iter().map(Call::typed).collect(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn libraries_are_found_and_programs_are_not() {
        let core = Library {
            package: "anamorph-core".into(),
            features: vec!["serde".into()],
        };
        let io = Library {
            package: "anamorph-io".into(),
            features: vec!["fast".into()],
        };
        assert_eq!(two_libraries(), [core, io]);
    }

    #[test]
    fn the_feature_matrix_takes_each_library_alone() {
        let steps = plan(&two_libraries(), false);
        assert_eq!(
            typed(&steps, "features"),
            [
                "cargo check -p anamorph-core --no-default-features",
                "cargo check -p anamorph-core --no-default-features --features serde",
                "cargo check -p anamorph-io --no-default-features",
            ]
        );
    }

    #[test]
    fn wasm_is_checked_only_where_it_is_installed() {
        let steps = plan(&two_libraries(), true);
        assert_eq!(
            typed(&steps, "wasm32"),
            ["cargo check --target wasm32-unknown-unknown -p anamorph-core -p anamorph-io"]
        );
        let steps = plan(&two_libraries(), false);
        assert!(
            steps
                .iter()
                .any(|s| s.name == "wasm32" && matches!(s.work, Work::Skipped(_)))
        );
    }

    #[test]
    fn the_order_is_fixed_and_warnings_are_errors() {
        let steps = plan(&two_libraries(), false);
        let names: Vec<&str> = steps.iter().map(|s| s.name).collect();
        assert_eq!(
            names,
            [
                "format",
                "clippy",
                "tests",
                "documentation",
                "features",
                "wasm32",
                "tidy"
            ]
        );
        assert!(typed(&steps, "clippy")[0].ends_with("-- -D warnings"));
        assert_eq!(
            typed(&steps, "documentation"),
            ["RUSTDOCFLAGS=\"-D warnings\" cargo doc --workspace --no-deps --all-features"]
        );
    }

    #[test]
    fn a_failed_call_is_named_as_it_would_be_typed_and_ends_the_step() {
        let calls = ["check -p a", "check -p b", "check -p c"].map(Call::new);
        let mut made = Vec::new();
        let result = call_each(&calls, |call| {
            made.push(call.typed());
            Ok(!call.typed().ends_with('b'))
        });
        assert_eq!(result, Err("cargo check -p b".to_owned()));
        assert_eq!(made, ["cargo check -p a", "cargo check -p b"]);
        assert_eq!(call_each(&calls, |_| Ok(true)), Ok(()));
        let absent = call_each(&calls, |_| Err(io::ErrorKind::NotFound.into()));
        assert!(
            absent.is_err_and(|m| m.starts_with("cargo check -p a (cargo could not be started"))
        );
    }

    #[test]
    fn an_untidy_tree_fails_its_step() {
        let sketch = Sketch::new().file("stray.txt", "");
        assert_eq!(
            perform(sketch.path(), &Work::Tidy),
            Err("cargo xtask tidy".to_owned())
        );
        let sketch = Sketch::new().file("README.md", "");
        assert_eq!(perform(sketch.path(), &Work::Tidy), Ok(()));
    }

    #[test]
    fn the_last_line_counts_the_steps_that_ran() {
        let seconds = Duration::from_secs;
        let text = summary(
            &[("format", seconds(1)), ("tests", seconds(61))],
            &["wasm32"],
            seconds(63),
        );
        assert_eq!(
            text.lines().last(),
            Some("test: all 2 steps passed in 63.0 s")
        );
        assert!(
            text.contains("wasm32  skipped") && text.contains("61.0 s"),
            "{text}"
        );
    }
}
