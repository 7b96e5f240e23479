//! The preview of a warp: the model before and after, with the features of the warps.

use crate::arguments::{Side, ThemeName, UpAxis, ViewOptions};
use crate::model::ModelSpace;
use anamorph_core::{Deformation, Domain, Mark, Role, Shape, Site};
use anamorph_io::Document;
use anamorph_preview::{Camera, Model, Options, Panel, PreviewError, Theme, Up, before_after};
use anamorph_recipe::BuiltRecipe;
use std::f64::consts::{FRAC_PI_2, PI};

/// Options of the preview crate from those of the command line.
fn options(view: &ViewOptions) -> Options {
    let camera = Camera::default().with_up(match view.up {
        UpAxis::X => Up::X,
        UpAxis::Y => Up::Y,
        UpAxis::Z => Up::Z,
    });
    let camera = match view.view {
        Side::ThreeQuarter => camera,
        Side::BackQuarter => camera.from_behind(),
        Side::Front => camera.at(0.0, 0.0),
        Side::Back => camera.at(PI, 0.0),
        Side::Left => camera.at(-FRAC_PI_2, 0.0),
        Side::Right => camera.at(FRAC_PI_2, 0.0),
        Side::Top => camera.at(0.0, FRAC_PI_2),
    };
    let theme = match view.theme {
        ThemeName::Light => Theme::Light,
        ThemeName::Dark => Theme::Dark,
    };
    Options {
        width: view.size.0,
        height: view.size.1,
        theme,
        camera,
        ..Options::default()
    }
}

/// Refuses a preview that could not be drawn whatever the model.
pub(crate) fn check(view: &ViewOptions) -> Result<(), PreviewError> {
    options(view).check()
}

/// The marks of a recipe: sources as the first warp sees them, targets carried on by the later warps.
fn marks<S: ModelSpace>(built: &BuiltRecipe<S>) -> (Vec<Mark<S>>, Vec<Mark<S>>) {
    let (mut before, mut after) = (Vec::new(), Vec::new());
    for (number, part) in built.parts.iter().enumerate() {
        let later = &built.parts[number + 1..];
        let carry = |point: S| {
            later
                .iter()
                .filter(|part| part.deformation.domain() == Domain::Space)
                .fold(point, |point, part| {
                    part.deformation.map(&Site::anywhere(point))
                })
        };
        for mark in &part.marks {
            match mark.role {
                // Sources of later warps stand in a space that the picture of the original does not show.
                Role::Source | Role::SourceGuide if number == 0 => before.push(mark.clone()),
                Role::Source | Role::SourceGuide => {}
                Role::Target | Role::TargetGuide => {
                    let shape = match &mark.shape {
                        Shape::Point(point) => Shape::Point(carry(*point)),
                        Shape::Polyline(line) => {
                            Shape::Polyline(line.iter().map(|&p| carry(p)).collect())
                        }
                        Shape::Arrow(from, to) => Shape::Arrow(carry(*from), carry(*to)),
                    };
                    after.push(Mark::new(mark.role, shape));
                }
            }
        }
    }
    (before, after)
}

/// Vertex colours, if the file has them.
fn colours(document: &dyn Document) -> Option<Vec<[f32; 3]>> {
    let [red, green, blue] = ["red", "green", "blue"].map(|name| document.attribute(name));
    let (red, green, blue) = (red?, green?, blue?);
    // The edge of the picture: eight bits follow.
    #[allow(clippy::cast_possible_truncation)]
    Some(
        red.iter()
            .zip(&green)
            .zip(&blue)
            .map(|((&r, &g), &b)| [r as f32, g as f32, b as f32])
            .collect(),
    )
}

/// The preview as the bytes of a PNG file.
pub(crate) fn preview<S: ModelSpace>(
    document: &dyn Document,
    before: &[S],
    after: &[S],
    built: &BuiltRecipe<S>,
    view: &ViewOptions,
) -> Result<Vec<u8>, PreviewError> {
    let mesh = document.mesh().unwrap_or_default();
    let colours = colours(document);
    let (sources, targets) = marks(built);
    let model = |points| {
        let model = Model {
            points,
            triangles: &mesh.triangles,
            lines: &mesh.lines,
            colours: None,
        };
        match &colours {
            Some(colours) => model.with_colours(colours),
            None => model,
        }
    };
    let before = Panel::new(model(before)).with_marks(&sources);
    let after = Panel::new(model(after)).with_marks(&targets);
    before_after(&before, &after, &options(view))?.png()
}
