//! Images: warps and morphs of pixels that come with the program, as strips of pictures.
//!
//! *Source*: Figs. 11 and 15 of Milliron et al. 2002 show feature lines on images and what becomes of crossing ones; the images are others.

use super::page::{escape, highlighted};
use crate::arguments::GalleryOptions;
use crate::commands::morph::{Places, frames, overlay};
use crate::error::Failure;
use crate::files::Pending;
use crate::meshes::RecipeFiles;
use crate::model::ModelSpace;
use anamorph_catalog::Context;
use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::{Bounds, Inverse, Mark, Plane, Role, Shape};
use anamorph_io::images::{ImageFile, ImageLimits};
use anamorph_preview::Picture;
use anamorph_raster::colour::Srgb8;
use anamorph_raster::{Edge, Filter, Hierarchy, Raster, Window, hierarchical_map, resample};
use anamorph_recipe::Recipe;
use std::fmt::Write;

macro_rules! file {
    ($name:literal) => {
        (
            $name,
            include_bytes!(concat!("../../../../tests/fixtures/valid/", $name)),
        )
    };
}

/// Name and bytes.
type File = (&'static str, &'static [u8]);

/// What is made of images.
enum Work {
    /// The image with the sources of the first recipe, then warped by each with its targets.
    Warps(File, &'static [&'static str]),
    /// Frames from the first image to the second, and once more with the features.
    Morph([File; 2], &'static [File], &'static str),
    /// The image and the image warped, each as bright as it is and with a sixteenth of its light.
    Exposures(File, &'static str),
}

/// A strip and what is said of it.
pub(super) struct Scene {
    /// Name of the picture.
    name: &'static str,
    title: &'static str,
    about: &'static str,
    credit: &'static str,
    work: Work,
}

/// What the section says of itself.
pub(super) const ABOUT: &str = "Any warp of the plane draws images, and features turn one image into another. All is mixed in linear light.";

const CATS: &str = "version = 1\n\n[[warp]]\nkind = \"thin-plate\"\nsource = \"cat.landmarks.json\"\ntarget = \"raccoon.landmarks.json\"\n\
    point = [ # the border stays\n  { from = [\"0%\", \"0%\"] }, { from = [\"50%\", \"0%\"] }, { from = [\"100%\", \"0%\"] },\n  \
    { from = [\"0%\", \"50%\"] }, { from = [\"100%\", \"50%\"] },\n  \
    { from = [\"0%\", \"100%\"] }, { from = [\"50%\", \"100%\"] }, { from = [\"100%\", \"100%\"] },\n]\n";
const FACES: &str = "version = 1\n\n[time]\ndissolve = { start = 0.2, end = 0.8, ease = \"cubic\" }\n\n[[warp]]\nkind = \"lines\"\n\
    p = 0.25\nsource = \"mona-lisa.landmarks.json\"\ntarget = \"girl-with-a-pearl-earring.landmarks.json\"\n";
const HEAD: &str = "version = 1\n\n[[warp]]\nkind = \"lines\"\na = 4\np = 0.5\nline = [\n  \
    { source = [[70, 45], [126, 50]], target = [[73, 36], [123, 58]] }, # the eyes tilt\n  \
    { source = [[103, 72], [103, 105]], target = [[98, 72], [93, 104]] },\n  \
    { source = [[2, 2], [178, 2]] },\n  { source = [[2, 118], [178, 118]] },\n]\n";
/// Two crossing lines, one of them turned by 60 degrees.
const CROSSED: [&str; 2] = [
    "version = 1\n\n[[warp]]\nkind = \"lines\"\na = 1.2\nline = [\n  { source = [[50, 60], [130, 60]] },\n  \
     { source = [[90, 20], [90, 100]], target = [[124.6, 40], [55.4, 80]] },\n]\n",
    "version = 1\n\n[[warp]]\nkind = \"global-lines\"\na = 1.2\nline = [\n  { source = [[50, 60], [130, 60]] },\n  \
     { source = [[90, 20], [90, 100]], target = [[124.6, 40], [55.4, 80]] },\n]\n",
];
const RINGS: &str = "version = 1\n\n[[warp]]\nkind = \"vortex\"\ncentre = [\"50%\", \"50%\"]\nradius = \"60%\"\nangle = \"160deg\"\n";

/// All of them.
pub(super) static SCENES: &[Scene] = &[
    Scene {
        name: "image-lines",
        title: "Feature lines on an image (§4.2, Fig. 11)",
        about: "The lines in orange are carried to those in blue, and the cat with them; the outer lines hold the border.",
        credit: "Chelsea by Stefan van der Walt, CC0 1.0",
        work: Work::Warps(file!("cat.png"), &[HEAD]),
    },
    Scene {
        name: "image-global-lines",
        title: "Crossing lines, local and global (§5.2, Fig. 15)",
        about: "The upright line is turned by 60 degrees, the level one stays. Feature lines, each by itself, fold the image where they \
                cross (middle); global feature lines shear it without a fold (right).",
        credit: "Chelsea by Stefan van der Walt, CC0 1.0",
        work: Work::Warps(file!("cat.png"), &CROSSED),
    },
    Scene {
        name: "image-animals",
        title: "A cat becomes a raccoon",
        about: "23 landmarks, a thin plate between them; below, with the landmarks on their way.",
        credit: "Chelsea by Stefan van der Walt, CC0 1.0; raccoon by Judy Weggelaar, public domain",
        work: Work::Morph(
            [file!("cat.png"), file!("raccoon.png")],
            &[file!("cat.landmarks.json"), file!("raccoon.landmarks.json")],
            CATS,
        ),
    },
    Scene {
        name: "image-faces",
        title: "One portrait becomes another",
        about: "68 landmarks, joined to feature lines; the colours go over later than the shape begins to.",
        credit: "Leonardo da Vinci, Mona Lisa; Johannes Vermeer, Girl with a Pearl Earring; public domain",
        work: Work::Morph(
            [
                file!("mona-lisa.png"),
                file!("girl-with-a-pearl-earring.png"),
            ],
            &[
                file!("mona-lisa.landmarks.json"),
                file!("girl-with-a-pearl-earring.landmarks.json"),
            ],
            FACES,
        ),
    },
    Scene {
        name: "image-rings",
        title: "OpenEXR: light beyond white",
        about: "Before and after, as it is and with a sixteenth of its light: the warp has mixed and kept what is far brighter than white.",
        credit: "Bright Rings, Industrial Light & Magic, BSD 3-clause, scaled down",
        work: Work::Exposures(file!("bright-rings.exr"), RINGS),
    },
];

/// A strip that has been drawn.
pub(super) struct Shown {
    scene: &'static Scene,
    picture: String,
    size: [usize; 2],
    recipe: &'static str,
}

/// Pixels between the pictures of a strip.
const GAP: usize = 6;
/// Strips of small images are shown larger, by whole pixels.
const WIDTH: usize = 1100;
/// Frames of a morph.
const FRAMES: usize = 6;
/// Features before and after a warp, in linear light.
const INKS: [[f32; 3]; 2] = [[1.0, 0.35, 0.03], [0.03, 0.25, 1.0]];

fn read(file: File) -> Result<ImageFile, Failure> {
    let failed =
        |error: &dyn core::fmt::Display| Failure::new(format!("gallery: {}: {error}", file.0));
    ImageFile::read(file.1, ImageLimits::of_file(file.1.len())).map_err(|error| failed(&error))
}

/// Colours of an image without coverage.
fn colours(image: &ImageFile) -> Result<Raster, Failure> {
    Ok(image.colours().map_err(Failure::new)?.into_owned())
}

/// An image warped by a recipe, with the features before and after.
fn warped(image: &Raster, recipe: &str, name: &str) -> Result<(Raster, [Places; 2]), Failure> {
    let window = image.window();
    let size = dvec2(window.width() as f64, window.height() as f64);
    let recipe = Recipe::from_toml(recipe, name).map_err(Failure::new)?;
    let context = Context::of_bounds(Bounds::new(window.corner(), window.corner() + size));
    let built = recipe
        .build(&Plane::registry(), &context, &mut |_| None)
        .map_err(Failure::new)?;
    let back = Inverse::new(built.stack(), size.length());
    let (map, _) = hierarchical_map(&back, window, &Hierarchy::default()).map_err(Failure::new)?;
    let drawn = resample(image, &map, Filter::ANISOTROPIC, Edge::Clamp).map_err(Failure::new)?;
    let of = |role: Role| {
        let marks = built.parts.iter().flat_map(|part| &part.marks);
        let own = marks.filter(|mark| mark.role == role);
        own.map(|mark: &Mark<Plane>| match &mark.shape {
            Shape::Point(point) => vec![*point],
            Shape::Polyline(points) => points.clone(),
            Shape::Arrow(from, to) => vec![*from, *to],
        })
        .collect()
    };
    Ok((drawn, [of(Role::Source), of(Role::Target)]))
}

/// The pictures of a scene, row by row.
fn rows(scene: &Scene) -> Result<Vec<Vec<Raster>>, Failure> {
    match &scene.work {
        Work::Warps(file, recipes) => {
            let image = colours(&read(*file)?)?;
            let mut row = Vec::new();
            for recipe in *recipes {
                let (mut after, [sources, targets]) = warped(&image, recipe, scene.name)?;
                if row.is_empty() {
                    let mut before = image.clone();
                    overlay::draw(&mut before, &sources, INKS[0]);
                    row.push(before);
                }
                overlay::draw(&mut after, &targets, INKS[1]);
                row.push(after);
            }
            Ok(vec![row])
        }
        Work::Morph(files, beside, recipe) => {
            let images = [read(files[0])?, read(files[1])?];
            let recipe = Recipe::from_toml(recipe, scene.name).map_err(Failure::new)?;
            let embedded = RecipeFiles::embedded(beside);
            let times: Vec<f64> = (0..FRAMES)
                .map(|i| i as f64 / (FRAMES - 1) as f64)
                .collect();
            let drawn = frames([&images[0], &images[1]], recipe, embedded, &times)?;
            let (mut plain, mut marked) = (Vec::new(), Vec::new());
            for (frame, places) in drawn {
                let mut with = frame.clone();
                overlay::draw(&mut with, &places, INKS[0]);
                plain.push(frame);
                marked.push(with);
            }
            Ok(vec![plain, marked])
        }
        Work::Exposures(file, recipe) => {
            let image = colours(&read(*file)?)?;
            let (after, _) = warped(&image, recipe, scene.name)?;
            let dim = |image: &Raster| {
                let mut image = image.clone();
                image
                    .samples_mut()
                    .iter_mut()
                    .for_each(|light| *light /= 16.0);
                image
            };
            let (before_dim, after_dim) = (dim(&image), dim(&after));
            Ok(vec![vec![image, after, before_dim, after_dim]])
        }
    }
}

/// All pictures of a strip in one, whole pixels enlarged.
fn strip(rows: &[Vec<Raster>]) -> Result<(Picture, [usize; 2]), Failure> {
    let first = rows.iter().flatten().next().map(Raster::window);
    let Some(first) = first else {
        return Err(Failure::new("gallery: a strip without pictures"));
    };
    let count = rows.iter().map(Vec::len).max().unwrap_or(1);
    let own = [first.width(), first.height()];
    let times = (WIDTH / (count * (own[0] + GAP))).clamp(1, 4);
    let size = [
        count * own[0] * times + (count - 1) * GAP,
        rows.len() * own[1] * times + (rows.len() - 1) * GAP,
    ];
    let table = Srgb8::new();
    let mut pixels = vec![0x80; 3 * size[0] * size[1]];
    for (number, row) in rows.iter().enumerate() {
        for (place, raster) in row.iter().enumerate() {
            let corner = [
                place * (own[0] * times + GAP),
                number * (own[1] * times + GAP),
            ];
            let large = enlarged(raster, times)?;
            for y in 0..large.height() {
                for x in 0..large.width() {
                    let light = large.pixel(x, y);
                    let at = 3 * ((corner[1] + y) * size[0] + corner[0] + x);
                    for (i, code) in pixels[at..at + 3].iter_mut().enumerate() {
                        let channel = if light.len() < 3 { 0 } else { i };
                        *code = table.encode(light[channel]);
                    }
                }
            }
        }
    }
    let side = |length: usize| u32::try_from(length).map_err(Failure::new);
    let picture = Picture::from_rgb(&pixels, side(size[0])?, side(size[1])?);
    Ok((picture.map_err(Failure::new)?, size))
}

/// A picture larger by a whole factor, without steps.
fn enlarged(raster: &Raster, times: usize) -> Result<Raster, Failure> {
    if times == 1 {
        return Ok(raster.clone());
    }
    let from = raster.window();
    let window = Window::new(0, 0, from.width() * times, from.height() * times);
    let window = window.map_err(Failure::new)?;
    let back = anamorph_core::Affine::<Plane> {
        linear: anamorph_core::glam::DMat2::from_diagonal(DVec2::splat(1.0 / times as f64)),
        translation: from.corner(),
    };
    anamorph_raster::resample_through(raster, &back, Filter::CATMULL_ROM, Edge::Clamp, window)
        .map_err(Failure::new)
}

/// Draws a scene, and begins the file of its picture.
pub(super) fn show(
    scene: &'static Scene,
    options: &GalleryOptions,
    files: &mut Vec<Pending>,
) -> Result<Shown, Failure> {
    let (picture, size) = strip(&rows(scene)?)?;
    let name = format!("images/{}.png", scene.name);
    let png = picture.png().map_err(Failure::new)?;
    let mut file = Pending::create(&options.out.join(&name), options.force)?;
    file.fill(|out| out.write_all(&png))?;
    files.push(file);
    let recipe = match &scene.work {
        Work::Warps(_, recipes) => recipes.last().copied().unwrap_or_default(),
        Work::Morph(_, _, recipe) | Work::Exposures(_, recipe) => recipe,
    };
    Ok(Shown {
        scene,
        picture: name,
        size,
        recipe,
    })
}

/// The section of the page.
pub(super) fn html(all: &[Shown]) -> String {
    let mut html = String::new();
    for shown in all {
        let scene = shown.scene;
        let [width, height] = shown.size;
        let _ = writeln!(
            html,
            "<article id=\"{name}\"><div class=\"head\"><h3><a href=\"#{name}\">{}</a></h3></div>\
             <div class=\"text\"><p>{}</p></div><figure class=\"picture\"><img src=\"{}\" width=\"{width}\" height=\"{height}\" \
             loading=\"lazy\" alt=\"{}\"></figure><div class=\"recipe\"><div class=\"bar\"><span>recipe</span>\
             <button type=\"button\">Copy</button></div><pre><code>{}</code></pre></div><p class=\"note\">{}</p></article>",
            escape(scene.title),
            escape(scene.about),
            shown.picture,
            escape(scene.title),
            highlighted(shown.recipe),
            escape(scene.credit),
            name = scene.name,
        );
    }
    html
}

/// The section of the documentation's page.
pub(super) fn markdown(all: &[Shown]) -> String {
    let mut text =
        format!("\n## Images\n\n{ABOUT} More: [images](images.md), [morphs](morphs.md).\n");
    for shown in all {
        let scene = shown.scene;
        let _ = write!(
            text,
            "\n### {}\n\n{}\n\n![{}]({})\n\nImages: {}.\n",
            scene.title, scene.about, scene.title, shown.picture, scene.credit
        );
    }
    text
}
