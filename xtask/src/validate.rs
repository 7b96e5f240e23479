//! `cargo xtask validate`: what the Khronos glTF validator says of models before and after a warp.
//!
//! The validator is the npm package `gltf-validator`, which is installed into `target/validate` on the first run; `node` and
//! `npm` have to be there for that. Each model is validated as it is, twisted by the command, and validated again: an error
//! that the twisted model has more often than the model itself fails the chore. Without arguments the motions of the documentation
//! and warps of some fixtures over time are written as animations, too; those must have no error at all.

use crate::{Chore, Failure, cargo};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The chore.
pub const CHORE: Chore = Chore {
    name: "validate",
    arguments: "[FILE…]",
    what: "runs the Khronos validator on glTF models (the fixtures) before and after a twist, and on the motions of the documentation; needs node and npm",
    run,
};

/// The version of the validator.
const VALIDATOR: &str = "gltf-validator@2.0.0-dev.3.10";

/// Where the fixtures are.
const FIXTURES: &str = "tests/fixtures/valid";

/// Reads the files named behind it and prints, for each, a line with its name and the codes of its errors as JSON.
const SCRIPT: &str = r#"
const fs = require("fs"), path = require("path"), validator = require("gltf-validator");
(async () => {
  for (const file of process.argv.slice(2)) {
    const beside = uri => fs.promises.readFile(path.join(path.dirname(file), decodeURIComponent(uri))).then(b => new Uint8Array(b));
    let codes;
    try {
      const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 0, externalResourceFunction: beside });
      codes = report.issues.messages.filter(m => m.severity === 0).map(m => m.code);
    } catch (error) {
      codes = ["UNREADABLE: " + error];
    }
    console.log(JSON.stringify([file, codes]));
  }
})();
"#;

/// Where the recipes of the documentation are.
const RECIPES: &str = "docs/recipes";

/// Fixtures without errors, which are warped over time.
const MORPHED: [&str; 4] = [
    "spot.obj",
    "gltf-interleaved.glb",
    "gltf-quantized.glb",
    "gltf-sparse.gltf",
];

/// How often each error occurs.
type Errors = BTreeMap<String, usize>;

/// The errors of `after` that are not among those of `before`, with how many there are more.
fn new_errors(before: &Errors, after: &Errors) -> Errors {
    after
        .iter()
        .filter_map(|(code, count)| {
            let more = count.saturating_sub(before.get(code).copied().unwrap_or(0));
            (more > 0).then(|| (code.clone(), more))
        })
        .collect()
}

/// What the script printed for one file.
fn parsed(line: &str) -> Option<(PathBuf, Errors)> {
    let value: Value = serde_json::from_str(line).ok()?;
    let mut errors = Errors::new();
    for code in value.get(1)?.as_array()? {
        *errors.entry(code.as_str()?.to_owned()).or_default() += 1;
    }
    Some((PathBuf::from(value.get(0)?.as_str()?), errors))
}

/// Runs a program and gives back its standard output.
fn output(command: &mut Command, missing: &str) -> Result<String, Failure> {
    let program = command.get_program().to_string_lossy().into_owned();
    let output = command
        .output()
        .map_err(|error| Failure::Failed(format!("{program} cannot be run: {error}; {missing}")))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        let said = String::from_utf8_lossy(&output.stderr);
        Err(Failure::Failed(format!("{program} failed:\n{said}")))
    }
}

/// Makes the folder with the validator in it, once.
fn install(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::file(folder, &error))?;
    let script = folder.join("validate.js");
    std::fs::write(&script, SCRIPT).map_err(|error| Failure::file(&script, &error))?;
    if folder.join("node_modules/gltf-validator").is_dir() {
        return Ok(());
    }
    println!("installing {VALIDATOR} into {}", folder.display());
    let npm = if cfg!(windows) { "npm.cmd" } else { "npm" };
    let mut command = Command::new(npm);
    command
        .args([
            "install",
            "--no-save",
            "--no-audit",
            "--no-fund",
            "--prefix",
        ])
        .arg(folder)
        .arg(VALIDATOR);
    output(&mut command, "install Node.js, which has it").map(drop)
}

/// What the validator says of files.
fn validated(folder: &Path, files: &[PathBuf]) -> Result<Vec<Errors>, Failure> {
    let mut command = Command::new("node");
    command.arg(folder.join("validate.js")).args(files);
    let printed = output(&mut command, "install Node.js")?;
    let found: Vec<(PathBuf, Errors)> = printed.lines().filter_map(parsed).collect();
    let same = found.len() == files.len() && found.iter().zip(files).all(|(f, file)| f.0 == *file);
    if same {
        Ok(found.into_iter().map(|(_, errors)| errors).collect())
    } else {
        Err(Failure::Failed(format!(
            "the validator stopped early:\n{printed}"
        )))
    }
}

/// The glTF fixtures.
fn fixtures(root: &Path) -> Result<Vec<PathBuf>, Failure> {
    let folder = root.join(FIXTURES);
    let entries = std::fs::read_dir(&folder).map_err(|error| Failure::file(&folder, &error))?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "glb" || e == "gltf"))
        .collect();
    files.sort();
    Ok(files)
}

fn run(root: &Path, arguments: &[String]) -> Result<(), Failure> {
    let models: Vec<PathBuf> = if arguments.is_empty() {
        fixtures(root)?
    } else {
        arguments.iter().map(PathBuf::from).collect()
    };
    let folder = root.join("target/validate");
    install(&folder)?;
    let recipe = folder.join("twist.toml");
    let text = "version = 1\n[[warp]]\nkind = \"twist\"\naxis = \"y\"\nangle = \"120deg\"\n";
    std::fs::write(&recipe, text).map_err(|error| Failure::file(&recipe, &error))?;

    let mut twisted = Vec::new();
    for (number, model) in models.iter().enumerate() {
        // A folder each, for models of the same name and for the files beside them.
        let out = folder.join(format!("twisted/{number}"));
        std::fs::create_dir_all(&out).map_err(|error| Failure::file(&out, &error))?;
        let name = model.file_name().unwrap_or_default();
        let target = out.join(name);
        let mut command = Command::new(cargo());
        command
            .current_dir(root)
            .args(["run", "--quiet", "-p", "anamorph-cli", "--", "warp"])
            .arg(std::path::absolute(model).unwrap_or_else(|_| model.clone()))
            .arg("--recipe")
            .arg(&recipe)
            .arg("-o")
            .arg(&target)
            .args(["--force", "--quiet"]);
        output(&mut command, "install a Rust toolchain")?;
        twisted.push(target);
    }

    let before = validated(&folder, &models)?;
    let after = validated(&folder, &twisted)?;
    let mut worse = Vec::new();
    for ((model, before), after) in models.iter().zip(&before).zip(&after) {
        let new = new_errors(before, after);
        println!(
            "{}: {} errors, {} after the twist",
            model.display(),
            before.values().sum::<usize>(),
            after.values().sum::<usize>()
        );
        for (code, count) in new {
            worse.push(format!(
                "{}: {code}, {count} more than before",
                model.display()
            ));
        }
    }
    if arguments.is_empty() {
        let animations = animations(root, &folder)?;
        for (file, errors) in animations.iter().zip(validated(&folder, &animations)?) {
            let count = errors.values().sum::<usize>();
            println!("{}: {count} errors", file.display());
            for (code, count) in errors {
                worse.push(format!("{}: {code}, {count} times", file.display()));
            }
        }
    }
    if worse.is_empty() {
        Ok(())
    } else {
        Err(Failure::Failed(format!(
            "what the command wrote has errors:\n{}",
            worse.join("\n")
        )))
    }
}

/// The motions of the documentation, and warps of some fixtures over time, as animations.
fn animations(root: &Path, folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let recipes = root.join(RECIPES);
    let entries = std::fs::read_dir(&recipes).map_err(|error| Failure::file(&recipes, &error))?;
    let mut written = Vec::new();
    for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        if path.extension().is_none_or(|e| e != "toml") || !text.contains("\n[motion]\n") {
            continue;
        }
        let mut target = folder.join(path.file_name().unwrap_or_default());
        target.set_extension("glb");
        let mut command = Command::new(cargo());
        command
            .current_dir(root)
            .args(["run", "--quiet", "-p", "anamorph-cli", "--", "motion"])
            .arg(&path)
            .arg("-o")
            .arg(&target)
            .args(["--force", "--quiet"]);
        output(&mut command, "install a Rust toolchain")?;
        written.push(target);
    }
    written.sort();
    let recipe = folder.join("twist.toml");
    for model in MORPHED {
        let name = Path::new(model).with_extension("film.glb");
        let target = folder.join(name);
        let mut command = Command::new(cargo());
        command
            .current_dir(root)
            .args(["run", "--quiet", "-p", "anamorph-cli", "--", "warp"])
            .arg(root.join(FIXTURES).join(model))
            .arg("--recipe")
            .arg(&recipe)
            .args(["--frames", "5", "--force", "--quiet", "-o"])
            .arg(&target);
        output(&mut command, "install a Rust toolchain")?;
        written.push(target);
    }
    Ok(written)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_errors_that_are_new_count() {
        let errors = |list: &[(&str, usize)]| -> Errors {
            list.iter()
                .map(|(code, n)| ((*code).to_owned(), *n))
                .collect()
        };
        let before = errors(&[("A", 2), ("B", 1)]);
        assert!(new_errors(&before, &errors(&[("A", 2)])).is_empty());
        assert_eq!(
            new_errors(&before, &errors(&[("A", 3), ("C", 1)])),
            errors(&[("A", 1), ("C", 1)])
        );
        let (file, found) = parsed("[\"a.glb\",[\"A\",\"A\",\"B\"]]").expect("a line");
        assert_eq!((file, found), (PathBuf::from("a.glb"), before));
        assert!(parsed("npm notice").is_none());
    }
}
