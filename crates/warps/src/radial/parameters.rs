//! How recipes describe radial basis functions and thin plates.
//!
//! *Source*: Arad et al. 1994; Litwinowicz and Williams 1994; the notation is that of the warp `points` (Milliron et al. 2002,
//! §3.2).

use super::{Kernel, RadialError, RadialWarp};
use crate::features::parameters::{Files, target};
use anamorph_catalog::schemars::JsonSchema;
use anamorph_catalog::{
    Built, ConstructError, Context, Length, Offset, Place, Value, WarpEntry, parse, schemars,
};
use anamorph_core::Space;
use anamorph_features::PointPair;
use serde::Deserialize;

/// One source point and where it goes.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LandmarkParameters {
    /// The source point.
    from: Place,
    /// The target point.
    to: Option<Place>,
    /// The offset from source to target, instead of `to`. With neither the point is pinned.
    by: Option<Offset>,
}

/// The names of kernels.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum KernelName {
    /// The distance `r`.
    Linear,
    /// `r³`.
    Cubic,
    /// `r² log r` in the plane, `r` in space.
    ThinPlate,
    /// `r² log r` in the plane and in space.
    Logarithmic,
    /// `exp(−(r/width)²)`.
    Gaussian,
    /// `√(r² + width²)`.
    Multiquadric,
    /// `1/√(r² + width²)`.
    InverseMultiquadric,
    /// A polynomial that ends at the radius.
    Wendland,
}

/// Source points are carried to their targets by radial basis functions.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct RadialParameters {
    /// The points; those of the files come before them.
    #[serde(default)]
    point: Vec<LandmarkParameters>,
    /// A file with source points, such as from `anamorph cage --points`.
    source: Option<String>,
    /// A file with their targets, one for each in the same order.
    target: Option<String>,
    /// The kernel, "thin-plate" if left out.
    kernel: Option<KernelName>,
    /// Width of the kernels that have one: "gaussian", "multiquadric", "inverse-multiquadric".
    width: Option<Length>,
    /// Radius of the kernel "wendland": what is farther from all points stays.
    radius: Option<Length>,
    /// Whether an affine map is part of the warp; `true` if left out, but for "wendland".
    affine: Option<bool>,
    /// How much the targets may be missed for a smoother warp, 0 if left out: then they are met.
    smoothing: Option<f64>,
}

/// A thin plate is bent so that source points come to their targets.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PlateParameters {
    /// The points; those of the files come before them.
    #[serde(default)]
    point: Vec<LandmarkParameters>,
    /// A file with source points, such as from `anamorph cage --points`.
    source: Option<String>,
    /// A file with their targets, one for each in the same order.
    target: Option<String>,
    /// How much the targets may be missed for a smoother warp, 0 if left out: then they are met.
    smoothing: Option<f64>,
}

/// The pairs of the files and of the list, and how many are of the files.
pub(crate) fn landmarks<S: Space>(
    files: (Option<&String>, Option<&String>),
    list: &[LandmarkParameters],
    context: &Context<'_, S>,
) -> Result<(Vec<PointPair<S>>, usize), ConstructError> {
    let files = Files::load(files.0, files.1, context)?;
    let mut pairs = Vec::new();
    if let Some((sources, targets)) = files.points("points")? {
        let both = sources.into_iter().zip(targets);
        pairs.extend(both.map(|(source, target)| PointPair { source, target }));
    }
    let from_files = pairs.len();
    for (i, point) in list.iter().enumerate() {
        let path = format!("point.{i}");
        let source: S = point.from.resolve(&format!("{path}.from"), context)?;
        let target = target(&path, source, point.to.as_ref(), point.by.as_ref(), context)?;
        pairs.push(PointPair { source, target });
    }
    Ok((pairs, from_files))
}

/// An error of a point of the list, before which come `from_files` points of files.
fn located(from_files: usize, error: &RadialError) -> ConstructError {
    let path = match error {
        RadialError::NotFinite { point }
        | RadialError::Coincident { second: point, .. }
        | RadialError::IllConditioned { second: point, .. } => {
            match point.checked_sub(from_files) {
                Some(number) => format!("point.{number}"),
                None => "source".to_owned(),
            }
        }
        RadialError::NoPoint | RadialError::TooMany { .. } | RadialError::Dependent(_) => {
            "point".to_owned()
        }
        RadialError::Length { what, .. } => (*what).to_owned(),
        RadialError::TooDense { .. } => "radius".to_owned(),
        RadialError::Smoothing { .. } => "smoothing".to_owned(),
        RadialError::NeedsAffine { .. } => "affine".to_owned(),
    };
    let hint = match error {
        RadialError::NoPoint => {
            "add a table `[[warp.point]]` with `from` and `to`, or name files as `source` and `target`"
        }
        RadialError::NeedsAffine { .. } => "remove `affine`, or take another kernel",
        RadialError::TooMany { .. } => "of all kernels, \"wendland\" serves the most points",
        _ => "",
    };
    ConstructError::new(path, error.to_string()).with_hint(hint)
}

/// The kernel of its name, width and radius.
fn kernel<S: Space>(
    p: &RadialParameters,
    context: &Context<'_, S>,
) -> Result<Kernel, ConstructError> {
    let name = p.kernel.unwrap_or(KernelName::ThinPlate);
    let length = |length: Option<Length>, what: &str| match length {
        Some(length) => length.resolve_positive(what, context),
        None => Err(ConstructError::new(
            "kernel",
            format!("this kernel has a {what}, and none is given"),
        )
        .with_hint(format!("write `{what}`, for example \"30%\""))),
    };
    let kernel = match name {
        KernelName::Linear => Kernel::Linear,
        KernelName::Cubic => Kernel::Cubic,
        KernelName::ThinPlate => Kernel::ThinPlate,
        KernelName::Logarithmic => Kernel::Logarithmic,
        KernelName::Gaussian => Kernel::Gaussian {
            width: length(p.width, "width")?,
        },
        KernelName::Multiquadric => Kernel::Multiquadric {
            width: length(p.width, "width")?,
        },
        KernelName::InverseMultiquadric => Kernel::InverseMultiquadric {
            width: length(p.width, "width")?,
        },
        KernelName::Wendland => Kernel::Wendland {
            radius: length(p.radius, "radius")?,
        },
    };
    let has = |what: &str| match kernel {
        Kernel::Wendland { .. } => what == "radius",
        _ => what == "width" && kernel.length().is_some(),
    };
    for (given, what) in [(p.width.is_some(), "width"), (p.radius.is_some(), "radius")] {
        if given && !has(what) {
            let message = format!("the kernel \"{}\" has no {what}", kernel.name());
            return Err(ConstructError::new(what, message)
                .with_hint(format!("remove `{what}`, or take a kernel that has one")));
        }
    }
    Ok(kernel)
}

fn built<S: Space>(
    (pairs, from_files): (Vec<PointPair<S>>, usize),
    kernel: Kernel,
    affine: bool,
    smoothing: Option<f64>,
) -> Result<Built<S>, ConstructError> {
    let warp = RadialWarp::construct(pairs, kernel, affine, smoothing.unwrap_or(0.0))
        .map_err(|error| located(from_files, &error))?;
    Ok(Built::new(warp.marks(), Box::new(warp)))
}

/// The registry entry of radial basis functions.
pub(crate) fn radial<S: Space>() -> WarpEntry<S> {
    fn construct<S: Space>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: RadialParameters = parse(value)?;
        let kernel = kernel(&p, context)?;
        let affine = p
            .affine
            .unwrap_or(!matches!(kernel, Kernel::Wendland { .. }));
        let pairs = landmarks((p.source.as_ref(), p.target.as_ref()), &p.point, context)?;
        built(pairs, kernel, affine, p.smoothing)
    }
    WarpEntry {
        kind: "radial",
        system: "B19",
        figure: "",
        summary: "carries points to their targets by radial basis functions, of all space or within a radius",
        reference: "N. Arad, N. Dyn, D. Reisfeld and Y. Yeshurun, Image Warping by Radial Basis Functions, CVGIP 56(2), 1994",
        example: "kernel = \"wendland\"\nradius = \"60%\"\n\
                  point = [{ from = \"30%\", by = \"12%\" }, { from = \"75%\" }]\n",
        schema: RadialParameters::json_schema,
        construct: construct::<S>,
    }
}

/// The registry entry of thin plates.
pub(crate) fn thin_plate<S: Space>() -> WarpEntry<S> {
    fn construct<S: Space>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: PlateParameters = parse(value)?;
        let pairs = landmarks((p.source.as_ref(), p.target.as_ref()), &p.point, context)?;
        built(pairs, Kernel::ThinPlate, true, p.smoothing)
    }
    WarpEntry {
        kind: "thin-plate",
        system: "B19",
        figure: "",
        summary: "bends space like a thin plate, as little as points and their targets allow",
        reference: "P. Litwinowicz and L. Williams, Animating Images with Drawings, SIGGRAPH 1994",
        example: if S::DIM == 2 {
            "point = [{ from = [\"0%\", \"0%\"] }, { from = [\"100%\", \"0%\"] }, { from = [\"0%\", \"100%\"] }, \
             { from = [\"100%\", \"100%\"] }, { from = \"50%\", by = [\"20%\", \"10%\"] }]\n"
        } else {
            "point = [{ from = [\"0%\", \"0%\", \"0%\"] }, { from = [\"100%\", \"0%\", \"0%\"] }, \
             { from = [\"0%\", \"100%\", \"0%\"] }, { from = [\"0%\", \"0%\", \"100%\"] }, { from = \"100%\" }, \
             { from = \"50%\", by = [\"20%\", \"10%\", 0] }]\n"
        },
        schema: PlateParameters::json_schema,
        construct: construct::<S>,
    }
}
