//! Rule: every crate takes its version, edition, toolchain, licence and lints from the workspace.
//!
//! Also here: what a crate's manifest says, for the rules that ask.

use super::{Finding, Tree};
use crate::document::{Entry, Table, Value};

/// The keys of `[package]` that come from the workspace.
const INHERITED: &[&str] = &["version", "edition", "rust-version", "license", "publish"];

/// The manifest of a crate under `crates/`.
pub struct Manifest {
    /// Its path from the root.
    pub path: String,
    /// The folder under `crates/`.
    pub folder: String,
    /// What it says.
    pub table: Table,
}

/// When a dependency is compiled in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// With the library or program.
    Normal,
    /// With its build script.
    Build,
    /// With its tests and benchmarks only.
    Dev,
}

/// One dependency of a crate.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Dependency {
    /// The package's own name, whatever the crate calls it.
    pub package: String,
    /// When it is compiled in.
    pub kind: Kind,
    /// Whether a feature turns it on.
    pub optional: bool,
    /// The line that names it.
    pub line: usize,
}

/// The manifests of the crates, in the order of their folders; those that are no TOML are findings.
#[must_use]
pub fn read(tree: &Tree) -> (Vec<Manifest>, Vec<Finding>) {
    let mut manifests = Vec::new();
    let mut findings = Vec::new();
    for path in tree.matching("crates/*/Cargo.toml") {
        match Table::parse(&tree.text(path).unwrap_or_default()) {
            Ok(table) => {
                let folder = path.split('/').nth(1).unwrap_or_default().to_owned();
                manifests.push(Manifest {
                    path: path.to_owned(),
                    folder,
                    table,
                });
            }
            Err(error) => findings.push(Finding::new(
                path,
                error.line,
                error.message,
                "write it as TOML",
            )),
        }
    }
    (manifests, findings)
}

impl Manifest {
    /// The dependencies, with those for one platform; `workspace` is the root's manifest, which may rename packages.
    #[must_use]
    pub fn dependencies(&self, workspace: &Table) -> Vec<Dependency> {
        let mut found = Vec::new();
        let platforms = self
            .table
            .get("target")
            .and_then(|t| t.value.as_table())
            .into_iter();
        let platforms = platforms
            .flat_map(|t| &t.entries)
            .filter_map(|e| e.value.as_table());
        for table in std::iter::once(&self.table).chain(platforms) {
            for (key, kind) in [
                ("dependencies", Kind::Normal),
                ("build-dependencies", Kind::Build),
                ("dev-dependencies", Kind::Dev),
            ] {
                let listed = table
                    .get(key)
                    .and_then(|e| e.value.as_table())
                    .into_iter()
                    .flat_map(|t| &t.entries);
                found.extend(listed.map(|entry| dependency(entry, kind, workspace)));
            }
        }
        found
    }

    /// The package's name and its line.
    #[must_use]
    pub fn name(&self) -> Option<(&str, usize)> {
        let entry = self.table.at(&["package", "name"])?;
        Some((entry.value.as_text()?, entry.line))
    }
}

fn dependency(entry: &Entry, kind: Kind, workspace: &Table) -> Dependency {
    let details = entry.value.as_table();
    let shared = workspace
        .at(&["workspace", "dependencies", &entry.key])
        .and_then(|e| e.value.as_table());
    let renamed = details.and_then(|d| d.text("package"));
    let renamed = renamed.or_else(|| {
        let inherits = is_true(details.and_then(|d| d.get("workspace")));
        shared.filter(|_| inherits).and_then(|s| s.text("package"))
    });
    Dependency {
        package: renamed.unwrap_or(&entry.key).to_owned(),
        kind,
        optional: is_true(details.and_then(|d| d.get("optional"))),
        line: entry.line,
    }
}

fn is_true(entry: Option<&Entry>) -> bool {
    entry.is_some_and(|e| e.value == Value::Flag(true))
}

/// Manifests that do not take what is shared from the workspace.
#[must_use]
pub fn findings(tree: &Tree) -> Vec<Finding> {
    let (manifests, mut findings) = read(tree);
    for manifest in manifests {
        let table = &manifest.table;
        let mut check = |keys: &[&str], name: &str, mend: &str| {
            if !is_true(table.at(keys)) {
                let deepest = (1..keys.len()).rev().find_map(|n| table.at(&keys[..n]));
                let what = format!("{name} is not taken from the workspace");
                findings.push(Finding::new(
                    &manifest.path,
                    deepest.map_or(1, |e| e.line),
                    what,
                    mend,
                ));
            }
        };
        for key in INHERITED {
            check(
                &["package", key, "workspace"],
                key,
                &format!("write `{key}.workspace = true` under [package]"),
            );
        }
        check(
            &["lints", "workspace"],
            "lints",
            "write `workspace = true` under [lints]",
        );
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Sketch, assert_found};
    use super::*;

    const GOOD: &str = "[package]\nname = \"anamorph-io\"\nversion.workspace = true\nedition = { workspace = true }\n\
        rust-version.workspace = true\nlicense.workspace = true\npublish.workspace = true\n\n[lints]\nworkspace = true\n";

    #[test]
    fn a_manifest_that_inherits_is_clean() {
        assert_found(
            &Sketch::new()
                .file("crates/io/Cargo.toml", GOOD)
                .findings(findings),
            &[],
        );
    }

    #[test]
    fn own_values_and_missing_lints_are_found() {
        let bad = GOOD
            .replace("edition = { workspace = true }", "edition = \"2021\"")
            .replace("[lints]\nworkspace", "#");
        assert_found(
            &Sketch::new()
                .file("crates/io/Cargo.toml", bad)
                .findings(findings),
            &[
                "crates/io/Cargo.toml:4: edition is not taken",
                "crates/io/Cargo.toml:1: lints is not taken",
            ],
        );
        let absent = GOOD.replace("publish.workspace = true\n", "");
        assert_found(
            &Sketch::new()
                .file("crates/io/Cargo.toml", absent)
                .findings(findings),
            &[
                "crates/io/Cargo.toml:1: publish is not taken from the workspace; write `publish.workspace = true`",
            ],
        );
    }

    #[test]
    fn what_is_no_toml_is_found_on_its_line() {
        let sketch = Sketch::new().file("crates/io/Cargo.toml", "[package]\nname = = 3\n");
        assert_found(&sketch.findings(findings), &["crates/io/Cargo.toml:2: "]);
    }

    #[test]
    fn dependencies_of_every_kind_platform_and_spelling_are_seen() {
        let text = "[dependencies]\na = \"1\"\nb = { package = \"real-b\", path = \"x\", optional = true }\nc.workspace = true\n\
            [build-dependencies]\nd = \"1\"\n[target.'cfg(unix)'.dependencies.e]\nversion = \"1\"\n\
            [dev-dependencies]\nf = \"1\"\n";
        let table = Table::parse(text).expect("TOML");
        let manifest = Manifest {
            path: String::new(),
            folder: String::new(),
            table,
        };
        let workspace = Table::parse(
            "[workspace.dependencies]\na = { package = \"no\" }\nc = { package = \"real-c\" }",
        )
        .expect("TOML");
        let seen: Vec<_> = manifest.dependencies(&workspace);
        let seen: Vec<_> = seen
            .iter()
            .map(|d| (d.package.as_str(), d.kind, d.optional, d.line))
            .collect();
        assert_eq!(
            seen,
            [
                ("a", Kind::Normal, false, 2),
                ("real-b", Kind::Normal, true, 3),
                ("real-c", Kind::Normal, false, 4),
                ("d", Kind::Build, false, 6),
                ("f", Kind::Dev, false, 10),
                ("e", Kind::Normal, false, 7),
            ]
        );
    }
}
