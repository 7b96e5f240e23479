//! The preview of a warp: the model before and after, with the features of the warps.

use crate::arguments::{Side, ThemeName, UpAxis, ViewOptions};
use crate::error::Failure;
use crate::model::ModelSpace;
use crate::painted::Painted;
use anamorph_core::{Deformation, Domain, Mark, Role, Shape, Site, Solid};
use anamorph_io::{Document, Mesh};
use anamorph_preview::{
    Animation, AnimationFormat, Camera, Model, Options, Panel, Picture, PreviewError, Theme, Up,
    before_after,
};
use anamorph_recipe::BuiltRecipe;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::io::Write;
use std::path::Path;

/// The camera that looks from a side.
pub(crate) fn camera(side: Side) -> Camera {
    from_side(Camera::default(), side)
}

fn from_side(camera: Camera, side: Side) -> Camera {
    match side {
        Side::ThreeQuarter => camera,
        Side::BackQuarter => camera.from_behind(),
        Side::Front => camera.at(0.0, 0.0),
        Side::Back => camera.at(PI, 0.0),
        Side::Left => camera.at(-FRAC_PI_2, 0.0),
        Side::Right => camera.at(FRAC_PI_2, 0.0),
        Side::Top => camera.at(0.0, FRAC_PI_2),
    }
}

/// Options of the preview crate from those of the command line.
fn options(view: &ViewOptions, turning: bool) -> Options {
    let camera = Camera::default().with_up(match view.up {
        UpAxis::X => Up::X,
        UpAxis::Y => Up::Y,
        UpAxis::Z => Up::Z,
    });
    let camera = from_side(camera, view.view);
    let theme = match view.theme {
        ThemeName::Light => Theme::Light,
        ThemeName::Dark => Theme::Dark,
    };
    let usual = if turning { (960, 540) } else { (1600, 900) };
    let (width, height) = view.size.unwrap_or(usual);
    Options {
        width,
        height,
        theme,
        camera,
        turning,
        ..Options::default()
    }
}

/// What kind of picture is asked for.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Kind {
    /// One picture, PNG.
    Still,
    /// Pictures of a camera that goes round.
    Turntable(usize, AnimationFormat),
}

impl Kind {
    /// From the name of the file and the number of pictures.
    pub(crate) fn of(path: &Path, turntable: Option<usize>) -> Result<Self, Failure> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let extension = extension.as_deref().unwrap_or_default();
        match (turntable, extension) {
            (Some(count), "gif") => Ok(Self::Turntable(count, AnimationFormat::Gif)),
            (Some(count), "apng" | "png") => Ok(Self::Turntable(count, AnimationFormat::Apng)),
            (Some(_), _) => Err(Failure::usage(format!(
                "{}: a turntable is a GIF or an APNG; name the preview .gif, .apng or .png",
                path.display()
            ))),
            (None, "gif" | "apng") => Err(Failure::usage(format!(
                "{}: a still preview is a PNG; name it .png, or ask for a film with --turntable 48",
                path.display()
            ))),
            (None, "jpg" | "jpeg" | "webp" | "bmp" | "tif" | "tiff" | "svg" | "pdf" | "exr") => {
                Err(Failure::usage(format!(
                    "{}: a preview is a PNG; name it .png",
                    path.display()
                )))
            }
            (None, _) => Ok(Self::Still),
        }
    }
}

/// Pictures of a turntable a second.
const RATE: f64 = 16.0;

/// Refuses a preview that could not be drawn whatever the model.
pub(crate) fn check(view: &ViewOptions, turning: bool) -> Result<(), PreviewError> {
    options(view, turning).check()
}

/// The marks of a recipe: sources as the first warp sees them, targets carried on by the later warps.
pub(crate) fn marks<S: ModelSpace>(built: &BuiltRecipe<S>) -> (Vec<Mark<S>>, Vec<Mark<S>>) {
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

/// A model before and after, ready to be drawn.
pub(crate) struct Subject<'a, S: ModelSpace> {
    mesh: Mesh,
    colours: Option<Vec<[f32; 3]>>,
    painted: Option<&'a Painted>,
    around: Option<[Solid; 2]>,
    sources: Vec<Mark<S>>,
    targets: Vec<Mark<S>>,
    before: &'a [S],
    after: &'a [S],
}

impl<'a, S: ModelSpace> Subject<'a, S> {
    /// The visible points of `document` before and after, and the features of the recipe.
    pub(crate) fn new(
        document: &dyn Document,
        before: &'a [S],
        after: &'a [S],
        built: &BuiltRecipe<S>,
    ) -> Self {
        let (sources, targets) = marks(built);
        Self {
            mesh: document.mesh().unwrap_or_default(),
            colours: colours(document),
            painted: None,
            around: None,
            sources,
            targets,
            before,
            after,
        }
    }

    /// The same with numbers painted on it.
    pub(crate) fn painted(self, painted: Option<&'a Painted>) -> Self {
        Self { painted, ..self }
    }

    /// The same with room for a box given by two corners.
    pub(crate) fn within(self, around: Option<[Solid; 2]>) -> Self {
        Self { around, ..self }
    }

    /// Of what undoes the recipe, if it does: then sources and targets change places.
    pub(crate) fn undoing(mut self, undoes: bool) -> Self {
        if undoes {
            std::mem::swap(&mut self.sources, &mut self.targets);
        }
        self
    }

    /// The two panels.
    pub(crate) fn draw(&self, options: &Options) -> Result<Picture, PreviewError> {
        let model = |points| {
            let model = Model {
                points,
                triangles: &self.mesh.triangles,
                lines: &self.mesh.lines,
                colours: None,
            };
            match (self.painted, &self.colours) {
                (Some(painted), _) => model.with_colours(&painted.colours),
                (None, Some(colours)) => model.with_colours(colours),
                (None, None) => model,
            }
        };
        let before = Panel::new(model(self.before)).with_marks(&self.sources);
        let after = Panel::new(model(self.after)).with_marks(&self.targets);
        let options = Options {
            around: self.around,
            ..*options
        };
        before_after(&before, &after, &options)
    }

    /// Writes the preview that `view` and `kind` ask for.
    pub(crate) fn write(
        &self,
        view: &ViewOptions,
        kind: Kind,
        out: &mut dyn Write,
    ) -> Result<(), PreviewError> {
        let draw = |options: &Options| {
            let picture = self.draw(options)?;
            match self.painted {
                Some(painted) => painted.with_scale(&picture, view.theme),
                None => Ok(picture),
            }
        };
        match kind {
            Kind::Still => {
                let png = draw(&options(view, false))?.png()?;
                out.write_all(&png).map_err(|error| PreviewError::Encoding {
                    reason: error.to_string(),
                })
            }
            Kind::Turntable(count, format) => {
                let options = options(view, true);
                let mut animation = Animation::new(out, format, count, RATE)?;
                for step in 0..count {
                    #[allow(clippy::cast_precision_loss)]
                    let angle = step as f64 / count as f64 * TAU;
                    let camera = options.camera.turned(angle);
                    animation.push(&draw(&Options { camera, ..options })?)?;
                }
                animation.finish()
            }
        }
    }
}
