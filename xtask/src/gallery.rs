//! `cargo xtask gallery`: draws the gallery and refreshes its pictures in the documentation.
//!
//! Runs `anamorph gallery` into the target folder, then takes over what it made: the light pictures to
//! `docs/images/gallery/` (those of scenes that are gone are removed) and the text to `docs/gallery.md`; the page
//! `docs/curves.md` and its plot, too. No picture of the documentation is drawn by hand.

use crate::{Chore, Failure, no_arguments};
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// The chore.
pub const CHORE: Chore = Chore {
    name: "gallery",
    arguments: "",
    what: "draws every warp, and refreshes docs/gallery.md, docs/curves.md and their pictures",
    run,
};

/// Where the pictures of the documentation lie, from the root and from `docs`.
const IMAGES: [&str; 2] = ["docs/images/gallery", "images/gallery"];
/// The page of the documentation.
const PAGE: &str = "docs/gallery.md";
/// What is taken over as it is: where it is made, and where it goes.
const MEASURED: [[&str; 2]; 2] = [
    ["curves.md", "docs/curves.md"],
    ["images/arc-length.svg", "docs/images/arc-length.svg"],
];

fn run(root: &Path, arguments: &[String]) -> Result<(), Failure> {
    no_arguments(CHORE.name, arguments)?;
    let made = crate::bench::target_folder(root)?.join("gallery");
    let status = Command::new(crate::cargo())
        .args([
            "run",
            "--release",
            "--bin",
            "anamorph",
            "--",
            "gallery",
            "--markdown",
            "--force",
            "--out",
        ])
        .arg(&made)
        .current_dir(root)
        .status()
        .map_err(|e| Failure::Failed(format!("cargo could not be started: {e}")))?;
    if !status.success() {
        return Err(Failure::Failed("gallery: the command failed".to_owned()));
    }
    let text = std::fs::read_to_string(made.join("gallery.md"))
        .map_err(|e| Failure::file(&made.join("gallery.md"), &e))?;
    let (text, pictures) = moved(&text);
    let images = root.join(IMAGES[0]);
    std::fs::create_dir_all(&images).map_err(|e| Failure::file(&images, &e))?;
    for picture in &pictures {
        let (from, to) = (made.join("images").join(picture), images.join(picture));
        std::fs::copy(&from, &to).map_err(|e| Failure::file(&from, &e))?;
    }
    let gone = std::fs::read_dir(&images).map_err(|e| Failure::file(&images, &e))?;
    for entry in gone.flatten() {
        if !pictures.contains(&*entry.file_name().to_string_lossy()) {
            std::fs::remove_file(entry.path()).map_err(|e| Failure::file(&entry.path(), &e))?;
        }
    }
    for [from, to] in MEASURED {
        let (from, to) = (made.join(from), root.join(to));
        std::fs::copy(&from, &to).map_err(|e| Failure::file(&from, &e))?;
    }
    let page = root.join(PAGE);
    std::fs::write(&page, text).map_err(|e| Failure::file(&page, &e))?;
    println!("gallery: wrote {PAGE} and {} pictures", pictures.len());
    Ok(())
}

/// The text with its pictures where the documentation keeps them, and their names.
fn moved(text: &str) -> (String, BTreeSet<String>) {
    let pictures = text
        .split("](images/")
        .skip(1)
        .filter_map(|rest| rest.split_once(')'))
        .map(|(name, _)| name.to_owned())
        .collect();
    let text = text.replace("](images/", &format!("]({}/", IMAGES[1]));
    (text, pictures)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_found_and_moved() {
        let (text, pictures) =
            moved("a ![b (c)](images/d.png) ![e](images/f-g.png)\n[h](recipes/i.toml)");
        assert_eq!(
            text,
            "a ![b (c)](images/gallery/d.png) ![e](images/gallery/f-g.png)\n[h](recipes/i.toml)"
        );
        let names: Vec<&str> = pictures.iter().map(String::as_str).collect();
        assert_eq!(names, ["d.png", "f-g.png"]);
    }
}
