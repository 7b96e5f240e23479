//! Motions: the recipes of the documentation that have a table `[motion]`, drawn.

use super::page::{escape, highlighted};
use crate::arguments::GalleryOptions;
use crate::commands::motion::warnings;
use crate::error::Failure;
use crate::files::Pending;
use crate::motion::drawing::{Palette, figure, label};
use anamorph_recipe::Recipe;
use std::fmt::Write;

/// A motion of the documentation.
pub(super) struct Scene {
    /// Name of the recipe, without extension; also that of its picture.
    pub(super) name: &'static str,
    /// The recipe.
    pub(super) recipe: &'static str,
}

macro_rules! scene {
    ($name:literal) => {
        Scene {
            name: $name,
            recipe: include_str!(concat!("../../../../docs/recipes/", $name, ".toml")),
        }
    };
}

/// All of them.
pub(super) static SCENES: &[Scene] = &[
    scene!("figure-eight"),
    scene!("helix-camera"),
    scene!("tumble"),
];

/// What the section says of itself.
pub(super) const ABOUT: &str = "Motions along paths: ticks at equal times, frames at every second one; beside it the distance covered \
    and the speed, with faults marked in red.";

/// A motion with all that the page says of it.
pub(super) struct Shown {
    scene: &'static Scene,
    /// What the recipe's first line says.
    summary: String,
    label: String,
    notes: Vec<String>,
    /// Names of its pictures in the light and in the dark.
    pictures: [String; 2],
}

/// The size of the pictures.
const SIZE: [f64; 2] = [1280.0, 720.0];

/// Draws a scene, and begins the files of its pictures.
pub(super) fn show(
    scene: &'static Scene,
    options: &GalleryOptions,
    files: &mut Vec<Pending>,
) -> Result<Shown, Failure> {
    let recipe = Recipe::from_toml(scene.recipe, scene.name).map_err(Failure::new)?;
    let built = recipe.build_motion(None).map_err(Failure::new)?;
    let mut pictures = [String::new(), String::new()];
    let themes = [("", Palette::LIGHT), ("-dark", Palette::DARK)];
    for (name, (suffix, palette)) in pictures.iter_mut().zip(themes) {
        *name = format!("images/{}{suffix}.svg", scene.name);
        let svg = figure(&built, SIZE, &palette).svg(&label(&built));
        let mut file = Pending::create(&options.out.join(&name), options.force)?;
        file.fill(|out| out.write_all(svg.as_bytes()))?;
        files.push(file);
    }
    let first = scene.recipe.lines().next().unwrap_or_default();
    Ok(Shown {
        scene,
        summary: first.trim_start_matches("# ").to_owned(),
        label: label(&built),
        notes: warnings(&built),
        pictures,
    })
}

/// The section of the page.
pub(super) fn html(all: &[Shown]) -> String {
    let mut html = String::new();
    let [width, height] = SIZE;
    for shown in all {
        let [light, dark] = &shown.pictures;
        let name = shown.scene.name;
        let picture = |class: &str, file: &str| {
            format!(
                "<img class=\"{class}\" src=\"{file}\" width=\"{width}\" height=\"{height}\" loading=\"lazy\" alt=\"{}\">",
                escape(&shown.label)
            )
        };
        let notes = if shown.notes.is_empty() {
            "<p class=\"note\">No faults.</p>".to_owned()
        } else {
            let each = shown.notes.iter();
            each.map(|note| format!("<p class=\"note\">{}</p>", escape(note)))
                .collect()
        };
        let _ = writeln!(
            html,
            "<article id=\"{name}\"><div class=\"head\"><h3><a href=\"#{name}\">{name}</a></h3></div>\
             <div class=\"text\"><p>{}</p></div><figure class=\"picture\">{}{}</figure>\
             <div class=\"two\"><div class=\"recipe\"><div class=\"bar\"><span>{name}.toml</span>\
             <button type=\"button\">Copy</button></div><pre><code>{}</code></pre></div>\
             <div class=\"promises\">{notes}</div></div></article>",
            escape(&shown.summary),
            picture("light", light),
            picture("dark", dark),
            highlighted(shown.scene.recipe),
        );
    }
    html
}

/// The section of the documentation's page.
pub(super) fn markdown(all: &[Shown]) -> String {
    let mut text = format!("\n## Motions\n\n{ABOUT}\n");
    for shown in all {
        let name = shown.scene.name;
        let _ = write!(
            text,
            "\n### `{name}`\n\n{}\n\n![{}]({})\n\nRecipe: [{name}.toml](recipes/{name}.toml).\n",
            shown.summary, shown.label, shown.pictures[0],
        );
    }
    text
}
