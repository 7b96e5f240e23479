//! Rule: a crate uses only the crates that its row of the house names, all of them on its floor's lower neighbours.
//!
//! Normal and build dependencies are held to it, also those of one platform; dev-dependencies are free, and so are the
//! workspace members outside `crates/`. The rows are in [`HOUSE`]; the text of the rule is `docs/architecture.md`.

use super::manifests::{self, Dependency, Kind, Manifest};
use super::{Finding, Tree};
use crate::document::Table;

/// How a crate may use another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Use {
    /// In any way.
    Free(&'static str),
    /// Only as an optional dependency, behind a feature.
    Optional(&'static str),
}

use Use::{Free, Optional};

impl Use {
    fn target(self) -> &'static str {
        match self {
            Free(target) | Optional(target) => target,
        }
    }
}

/// One crate's place in the house.
pub struct Row {
    /// Its folder under `crates/`.
    pub folder: &'static str,
    /// Its floor.
    pub floor: u8,
    /// The crates of the house it may use, by folder.
    pub may_use: &'static [Use],
    /// The packages from elsewhere it may use; nothing stands for any.
    pub outside: Option<&'static [Use]>,
}

const fn row(folder: &'static str, floor: u8, may_use: &'static [Use]) -> Row {
    Row {
        folder,
        floor,
        may_use,
        outside: None,
    }
}

/// The house, from the ground up: a crate uses only rows above its own in this list.
pub const HOUSE: &[Row] = &[
    Row {
        folder: "core",
        floor: 0,
        may_use: &[],
        // Whoever wants one small component compiles this and no more.
        outside: Some(&[
            Free("glam"),
            Free("libm"),
            Optional("bytemuck"),
            Optional("fearless_simd"),
            Optional("rayon"),
            Optional("serde"),
        ]),
    },
    row("catalog", 0, &[Free("core")]),
    row("features", 1, &[Free("core"), Optional("catalog")]),
    row("fields", 1, &[Free("core"), Optional("catalog")]),
    row("transforms", 1, &[Free("core"), Optional("catalog")]),
    row("curves", 1, &[Free("core")]),
    row("solvers", 0, &[]),
    row("meshing", 1, &[Free("core")]),
    row("raster", 1, &[Free("core")]),
    row(
        "warps",
        2,
        &[
            Free("core"),
            Free("catalog"),
            Free("features"),
            Free("fields"),
            Free("transforms"),
            Optional("curves"),
            Optional("solvers"),
        ],
    ),
    row(
        "morph",
        2,
        &[
            Free("core"),
            Free("meshing"),
            Free("raster"),
            Free("curves"),
            Free("transforms"),
            Free("solvers"),
        ],
    ),
    row("io", 3, &[Free("core"), Free("raster")]),
    row("preview", 3, &[Free("core")]),
    row(
        "recipe",
        3,
        &[
            Free("core"),
            Free("catalog"),
            Free("features"),
            Free("fields"),
            Free("transforms"),
            Free("curves"),
            Free("meshing"),
            Free("raster"),
            Free("warps"),
            Free("morph"),
        ],
    ),
    row("anamorph", 4, EVERY_PART),
    row("cli", 4, EVERYTHING),
];

const EVERYTHING: &[Use] = &[
    Free("core"),
    Free("catalog"),
    Free("features"),
    Free("fields"),
    Free("solvers"),
    Free("transforms"),
    Free("curves"),
    Free("meshing"),
    Free("raster"),
    Free("warps"),
    Free("morph"),
    Free("io"),
    Free("preview"),
    Free("recipe"),
    Free("anamorph"),
];

/// All but the façade, which is the last.
const EVERY_PART: &[Use] = match EVERYTHING.split_last() {
    Some((_, parts)) => parts,
    None => &[],
};

const THIS_FILE: &str = "xtask/src/tidy/floors.rs";

/// The row of the crate in that folder under `crates/`.
#[must_use]
pub fn row_of(folder: &str) -> Option<&'static Row> {
    HOUSE.iter().find(|row| row.folder == folder)
}

/// The package that a folder under `crates/` holds.
#[must_use]
pub fn package(folder: &str) -> String {
    if folder == "anamorph" {
        folder.to_owned()
    } else {
        format!("anamorph-{folder}")
    }
}

/// Dependencies that the house does not allow.
#[must_use]
pub fn findings(tree: &Tree) -> Vec<Finding> {
    // A manifest that is no TOML is a finding of the rule on manifests.
    let (manifests, _) = manifests::read(tree);
    let workspace = tree
        .text("Cargo.toml")
        .and_then(|text| Table::parse(&text).ok())
        .unwrap_or_default();
    manifests
        .iter()
        .flat_map(|manifest| of_crate(manifest, &workspace))
        .collect()
}

fn of_crate(manifest: &Manifest, workspace: &Table) -> Vec<Finding> {
    let (path, folder) = (&manifest.path, &manifest.folder);
    let (name, name_line) = manifest.name().unwrap_or(("", 1));
    let Some(row) = row_of(folder) else {
        let what = format!("the crate `{folder}` has no floor");
        return vec![Finding::new(
            path,
            name_line,
            what,
            format!("give it a floor in {THIS_FILE}"),
        )];
    };
    let mut findings = Vec::new();
    if name != package(folder) {
        let what = format!("the package in crates/{folder} is called `{name}`");
        findings.push(Finding::new(
            path,
            name_line,
            what,
            format!("call it `{}`", package(folder)),
        ));
    }
    for dependency in manifest
        .dependencies(workspace)
        .iter()
        .filter(|d| d.kind != Kind::Dev)
    {
        if let Some((what, mend)) = objection(row, dependency) {
            findings.push(Finding::new(path, dependency.line, what, mend));
        }
    }
    findings
}

/// What is wrong with a dependency of the crate in that row, and how to mend it.
fn objection(row: &Row, dependency: &Dependency) -> Option<(String, String)> {
    let of_house = dependency.package == "anamorph" || dependency.package.starts_with("anamorph-");
    let (allowed, found) = if of_house {
        (
            row.may_use,
            row.may_use
                .iter()
                .find(|u| package(u.target()) == dependency.package),
        )
    } else {
        let outside = row.outside?;
        (
            outside,
            outside.iter().find(|u| u.target() == dependency.package),
        )
    };
    match found {
        Some(Free(_)) => None,
        Some(Optional(_)) if dependency.optional => None,
        Some(Optional(_)) => {
            let what = format!(
                "`{}` may use `{}` only behind a feature",
                row.folder, dependency.package
            );
            Some((what, "make the dependency `optional = true`".to_owned()))
        }
        None => {
            let list: Vec<&str> = allowed.iter().map(|u| u.target()).collect();
            let list = if list.is_empty() {
                "none".to_owned()
            } else {
                list.join(", ")
            };
            let kind = if of_house {
                "crates of the house"
            } else {
                "packages from elsewhere"
            };
            let what = format!(
                "`{}` (floor {}) may not use `{}`",
                row.folder, row.floor, dependency.package
            );
            let mend = format!("use only ({kind}: {list}), or move the code to a crate that may");
            Some((what, mend))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Sketch, assert_found};
    use super::*;

    fn house(folder: &str, dependencies: &str) -> Vec<String> {
        let manifest = format!("[package]\nname = \"{}\"\n{dependencies}", package(folder));
        Sketch::new()
            .file(&format!("crates/{folder}/Cargo.toml"), manifest)
            .findings(findings)
    }

    #[test]
    fn the_house_stands_from_the_ground_up() {
        for (place, row) in HOUSE.iter().enumerate() {
            for used in row.may_use {
                let below = HOUSE
                    .iter()
                    .position(|r| r.folder == used.target())
                    .expect("a row for what is used");
                assert!(below < place, "{} uses {}", row.folder, used.target());
                let lower = HOUSE[below].floor < row.floor;
                let same_by_design = [("catalog", "core"), ("cli", "anamorph")]
                    .contains(&(row.folder, used.target()));
                assert!(
                    lower || same_by_design,
                    "{} uses {}",
                    row.folder,
                    used.target()
                );
            }
        }
        assert_eq!(
            row_of("anamorph").map(|r| r.may_use.len()),
            Some(HOUSE.len() - 2)
        );
        assert_eq!(
            row_of("cli").map(|r| r.may_use.len()),
            Some(HOUSE.len() - 1)
        );
    }

    #[test]
    fn allowed_edges_are_clean() {
        let warps = "[dependencies]\nanamorph-core.workspace = true\nanamorph-fields.workspace = true\nrayon = \"1\"\n";
        assert_found(&house("warps", warps), &[]);
        let fields = "[dependencies]\nanamorph-catalog = { workspace = true, optional = true }\n";
        assert_found(&house("fields", fields), &[]);
        assert_found(
            &house(
                "cli",
                "[dependencies]\nanamorph = \"0.1\"\nanamorph-io = \"0.1\"\n",
            ),
            &[],
        );
        let core = "[dependencies]\nglam = \"1\"\nlibm = \"1\"\nrayon = { workspace = true, optional = true }\n";
        assert_found(&house("core", core), &[]);
    }

    #[test]
    fn an_edge_upwards_or_sideways_is_found() {
        let text = "[dependencies]\nanamorph-core = \"0.1\"\nanamorph-warps = \"0.1\"\nanamorph-transforms = \"0.1\"\n";
        assert_found(
            &house("fields", text),
            &[
                "crates/fields/Cargo.toml:5: `fields` (floor 1) may not use `anamorph-warps`",
                "crates/fields/Cargo.toml:6: `fields` (floor 1) may not use `anamorph-transforms`",
            ],
        );
        assert_found(
            &house("anamorph", "[dependencies]\nanamorph-cli = \"0.1\"\n"),
            &["may not use `anamorph-cli`"],
        );
        assert_found(
            &house("core", "[dependencies]\nanamorph-catalog = \"0.1\"\n"),
            &["crates of the house: none"],
        );
    }

    #[test]
    fn build_platform_and_renamed_dependencies_do_not_hide_an_edge() {
        assert_found(
            &house("core", "[build-dependencies]\nanamorph-io = \"0.1\"\n"),
            &["may not use `anamorph-io`"],
        );
        let platform = "[target.'cfg(unix)'.dependencies]\nanamorph-io = \"0.1\"\n";
        assert_found(&house("core", platform), &["may not use `anamorph-io`"]);
        let renamed = "[dependencies]\nreader = { package = \"anamorph-io\", path = \"../io\" }\n";
        assert_found(&house("core", renamed), &["may not use `anamorph-io`"]);
    }

    #[test]
    fn dev_dependencies_are_free() {
        assert_found(
            &house(
                "core",
                "[dev-dependencies]\nanamorph-warps = \"0.1\"\nproptest = \"1\"\n",
            ),
            &[],
        );
    }

    #[test]
    fn the_catalog_must_stay_optional_on_the_first_floor() {
        let text = "[dependencies]\nanamorph-catalog.workspace = true\n";
        assert_found(
            &house("transforms", text),
            &["only behind a feature; make the dependency `optional = true`"],
        );
        assert_found(&house("warps", text), &[]);
    }

    #[test]
    fn the_engine_stays_light() {
        let text = "[dependencies]\nnalgebra = \"1\"\nserde = \"1\"\n";
        assert_found(
            &house("core", text),
            &[
                "may not use `nalgebra`; use only (packages from elsewhere: glam, libm",
                "`serde` only behind a feature",
            ],
        );
    }

    #[test]
    fn a_crate_without_a_floor_and_a_wrong_name_are_found() {
        assert_found(
            &house("toys", ""),
            &["crates/toys/Cargo.toml:2: the crate `toys` has no floor; give it a floor"],
        );
        let sketch = Sketch::new().file("crates/io/Cargo.toml", "[package]\nname = \"io\"\n");
        assert_found(
            &sketch.findings(findings),
            &["is called `io`; call it `anamorph-io`"],
        );
    }
}
