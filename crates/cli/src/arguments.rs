//! What the command line understands.

use crate::shape_arguments::{BetweenOptions, MeshOptions, ShapeOptions};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::{Path, PathBuf};

/// Warps models by recipes, draws what it did, and reports what it promises.
#[derive(Debug, Parser)]
#[command(
    name = "anamorph",
    version,
    propagate_version = true,
    max_term_width = 100
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Warp models by a recipe
    Warp(Box<WarpOptions>),
    /// Turn images or shapes into one another, or draw what is between
    Morph(Box<MorphOptions>),
    /// Make one triangulation of two shapes
    Mesh(Box<MeshOptions>),
    /// Evaluate the fields of a recipe on a model once and keep them
    Bind(BindOptions),
    /// Write the motion of a recipe as a table, an animation or a picture
    Motion(MotionOptions),
    /// Write control points, frames or points of a model to edit in a modeller
    Cage(CageOptions),
    /// Let a curve settle on the edges of an image, to be a feature of a warp
    Snake(crate::commands::snake::SnakeOptions),
    /// Say what a model file or an image holds, and what is odd about it
    Inspect(InspectOptions),
    /// Say what the warps of a recipe promise
    Check(CheckOptions),
    /// List what can be named: warps, fields, falloffs, formats, curves, eases, orientations
    List(ListOptions),
    /// Draw a page of every warp: before and after, recipe, promises
    Gallery(GalleryOptions),
    /// Print the JSON Schema of recipes, for editors
    Schema,
    /// Print completions for a shell
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page
    Man,
}

/// Warp models by a recipe.
///
/// Only what moves is rewritten: every other byte of the file stays.
#[derive(Debug, Args)]
pub(crate) struct WarpOptions {
    /// Model files (`anamorph list formats` names what can be read); `-` is standard input
    #[arg(required = true, value_name = "MODEL")]
    pub models: Vec<PathBuf>,
    /// The recipe, TOML or JSON; `-` is standard input
    #[arg(
        short,
        long,
        value_name = "FILE",
        required_unless_present = "from_stmap"
    )]
    pub recipe: Option<PathBuf>,
    /// Where the warped model goes: a file, or a folder (ending in `/`) for several models; `-` is standard output
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Change a value of the recipe, such as `warp.0.angle=30deg`
    #[arg(long, value_name = "PATH=VALUE")]
    pub set: Vec<String>,
    /// Write a report as JSON: what moved, what the warps promise
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<PathBuf>,
    /// Draw the model before and after, with the warp's features (a folder for several models)
    #[arg(long, value_name = "PICTURE")]
    pub preview: Option<PathBuf>,
    /// Make the preview a film of that many pictures, in which the camera goes once round the model; GIF or APNG by its
    /// extension (.gif, .apng, .png)
    #[arg(long, value_name = "PICTURES", requires = "preview", value_parser = parse_pictures, help_heading = "Preview")]
    pub turntable: Option<usize>,
    /// Paint a number on the model in the preview: what becomes of volumes (or areas, in the plane), how strongly and with what
    /// weight features pull, or how far points move
    #[arg(
        long,
        value_name = "FIELD",
        requires = "preview",
        help_heading = "Preview"
    )]
    pub preview_field: Option<PreviewField>,
    #[command(flatten)]
    pub view: ViewOptions,
    /// Threads to use, 1 to 1024; as many as the machine has if left out. Results do not depend on it
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub threads: Option<usize>,
    /// Use the influences that `anamorph bind` kept for this model, with the recipe's present targets and strengths
    #[arg(long, value_name = "FILE")]
    pub binding: Option<PathBuf>,
    /// Undo the recipe: each point goes to the place that the recipe moves onto it (of a recipe with `mapping = "inverse"`, the
    /// warps as they are)
    #[arg(long, conflicts_with = "binding")]
    pub invert: bool,
    /// The model as it was before the recipe warped it: what is relative to the model's bounds refers to this one
    #[arg(long, value_name = "MODEL", conflicts_with = "frames")]
    pub rest: Option<PathBuf>,
    /// Write the recipe over time, from the model as it is to the full warp, as that many numbered files: OUT (and a preview or
    /// report) says where the number goes, as in out.%04d.obj or out.####.obj. Frames that exist are kept. An OUT that ends in
    /// .glb, without such a place, becomes one file with an animation of morph targets; of an image .gif, .apng, .y4m and `-` (y4m)
    /// become a film
    #[arg(
        long,
        value_name = "N",
        help_heading = "Time",
        conflicts_with = "binding"
    )]
    pub frames: Option<usize>,
    /// The number of the first frame
    #[arg(
        long,
        value_name = "NUMBER",
        requires = "frames",
        default_value = "1",
        help_heading = "Time",
        allow_hyphen_values = true
    )]
    pub start: i64,
    /// Write only these frames, by their numbers
    #[arg(long, value_name = "A-B", requires = "frames", value_parser = parse_range, allow_hyphen_values = true, help_heading = "Time")]
    pub range: Option<(i64, i64)>,
    /// Frames a second of an animation; 24 if left out. Numbered files are the same at any rate
    #[arg(long, value_name = "N", requires = "frames", value_parser = parse_rate, allow_hyphen_values = true, help_heading = "Time")]
    pub fps: Option<f64>,
    /// Leave the normals stored in the file as they are
    #[arg(long)]
    pub keep_normals: bool,
    /// Pass points that are not finite through untouched, instead of refusing the file
    #[arg(long)]
    pub allow_nonfinite: bool,
    /// Read files that lie outside of the folder of the file that names them
    #[arg(long)]
    pub allow_outside: bool,
    #[command(flatten)]
    pub image: ImageOptions,
    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
    /// Replace files that exist
    #[arg(short, long)]
    pub force: bool,
}

/// How pixels are read, and how they are kept.
#[derive(Debug, Args)]
#[command(next_help_heading = "Images")]
pub(crate) struct PixelOptions {
    /// How pixels are read between their centres: nearest, bilinear, catmull-rom, mitchell, lanczos or anisotropic, which is the
    /// default and does not alias where the image shrinks
    #[arg(long, value_name = "FILTER")]
    pub filter: Option<String>,
    /// What stands beyond the pixels: clamp, wrap, mirror or transparent. Transparent if left out and the image has alpha, a
    /// data window of its own, or grows; else clamp
    #[arg(long, value_name = "EDGE")]
    pub edge: Option<String>,
    /// How far the place that a pixel is read from may be off, in pixels; 0 evaluates the warp at every pixel. 0.05 if left out
    #[arg(long, value_name = "PIXELS", value_parser = parse_pixels, allow_hyphen_values = true)]
    pub max_error: Option<f64>,
    /// Quality of JPEG files, 1 to 100; 95 if left out
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=100))]
    pub quality: Option<u8>,
    /// Read images that have far more pixels than the size of their file accounts for
    #[arg(long)]
    pub allow_large: bool,
}

/// How images are drawn.
#[derive(Debug, Args)]
#[command(next_help_heading = "Images")]
pub(crate) struct ImageOptions {
    #[command(flatten)]
    pub pixels: PixelOptions,
    /// Look up where each pixel of the result comes from, or move the pixels of the image
    #[arg(long, value_name = "WAY")]
    pub mapping: Option<MappingName>,
    /// Let the picture grow to hold all of the result (in OpenEXR the data window, else the picture itself)
    #[arg(long)]
    pub grow: bool,
    /// Write where each pixel comes from as an ST map: 32-bit OpenEXR, u and v from 0 to 1, v up
    #[arg(long, value_name = "FILE.exr")]
    pub stmap: Option<PathBuf>,
    /// Warp by an ST map, as --stmap and compositors write it, instead of a recipe; the result has the map's pixels
    #[arg(long, value_name = "FILE.exr",
        conflicts_with_all = ["recipe", "set", "invert", "mapping", "grow", "max_error", "stmap", "motion_vectors", "frames"])]
    pub from_stmap: Option<PathBuf>,
    /// Write how far each pixel of the image moves: 32-bit OpenEXR, forward.u and forward.v in pixels, v up
    #[arg(long, value_name = "FILE.exr")]
    pub motion_vectors: Option<PathBuf>,
}

/// Turn images or shapes into one another, or draw what is between.
///
/// Features stand on each image: those of a recipe (sources on the first image, targets on the second), or landmarks. Both images are
/// drawn with the features half way, or however far, and one dissolves into the other.
#[derive(Debug, Args)]
pub(crate) struct MorphOptions {
    /// Two images or more, or series of them such as clip.%04d.png; or two shapes or more: SVG, polygons, fonts. A chain goes
    /// from each to the next. Or a pair of meshes, as `anamorph mesh` writes it
    #[arg(required_unless_present = "batch", value_name = "INPUT")]
    pub images: Vec<PathBuf>,
    /// Morph all that a list names: a TOML file of [[morph]] tables with `inputs`, `output` and options by their names. Goes on after a
    /// failure
    #[arg(long, value_name = "LIST.toml", conflicts_with_all = ["images", "output", "recipe", "landmarks", "method", "frames", "at", "start",
        "range", "fps", "ease", "dissolve", "fit", "set", "draw_features", "report", "ShapeOptions", "BetweenOptions", "PixelOptions"])]
    pub batch: Option<PathBuf>,
    /// The recipe of one warp between features, TOML or JSON; for a chain one for each step (-r AB -r BC)
    #[arg(short, long, value_name = "FILE", conflicts_with = "landmarks")]
    pub recipe: Vec<PathBuf>,
    /// Landmarks instead of a recipe: one file for each image, JSON, .pts or .csv
    #[arg(
        short,
        long,
        value_name = "FILE",
        num_args = 2..
    )]
    pub landmarks: Vec<PathBuf>,
    /// The warp between landmarks: thin-plate, lines, points, radial or multilevel; thin-plate if left out
    #[arg(long, value_name = "KIND", requires = "landmarks")]
    pub method: Option<String>,
    /// Where the result goes: numbered images (out.%04d.png, out.####.exr), a film (.gif, .apng, .y4m), with --at one image; `-` is a
    /// y4m film on standard output, for an encoder. Shapes also become an animated .svg, Lottie (.json) or .glb, or numbered .svg, .json
    /// and .obj
    #[arg(
        short,
        long,
        value_name = "OUT",
        required_unless_present = "batch",
        default_value = ".",
        hide_default_value = true
    )]
    pub output: PathBuf,
    /// Frames of the whole; as many as the longest series has if left out, or 25 for each step
    #[arg(long, value_name = "N", help_heading = "Time")]
    pub frames: Option<usize>,
    /// One image of what is between, at a time from 0 (the first image) to 1 (the last)
    #[arg(long, value_name = "TIME", conflicts_with_all = ["frames", "range", "start", "fps"], value_parser = parse_time, help_heading = "Time")]
    pub at: Option<f64>,
    /// The number of the first frame
    #[arg(
        long,
        value_name = "NUMBER",
        default_value = "1",
        help_heading = "Time",
        allow_hyphen_values = true
    )]
    pub start: i64,
    /// Write only these frames, by their numbers
    #[arg(long, value_name = "A-B", value_parser = parse_range, allow_hyphen_values = true, help_heading = "Time")]
    pub range: Option<(i64, i64)>,
    /// Frames a second of a film; 24 if left out
    #[arg(long, value_name = "N", value_parser = parse_rate, allow_hyphen_values = true, help_heading = "Time")]
    pub fps: Option<f64>,
    /// How the shape goes over: an ease (`anamorph list eases`) for features without a schedule of their own
    #[arg(long, value_name = "EASE", help_heading = "Time")]
    pub ease: Option<String>,
    /// How the colours go over: an ease; with the shape if left out
    #[arg(long, value_name = "EASE", help_heading = "Time")]
    pub dissolve: Option<String>,
    /// How images of another size than the first come to lie on it, with their features
    #[arg(long, value_name = "HOW")]
    pub fit: Option<FitName>,
    /// Change a value of the recipes, such as `warp.0.p=0.5`
    #[arg(long, value_name = "PATH=VALUE")]
    pub set: Vec<String>,
    /// Draw the features on the frames
    #[arg(long)]
    pub draw_features: bool,
    /// Write a report as JSON: frames, features, how good the maps are
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    pub shapes: ShapeOptions,
    #[command(flatten)]
    pub between: BetweenOptions,
    #[command(flatten)]
    pub pixels: PixelOptions,
    /// Threads to use, 1 to 1024; as many as the machine has if left out. Results do not depend on it
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub threads: Option<usize>,
    /// Read files that lie outside of the folder of the file that names them
    #[arg(long)]
    pub allow_outside: bool,
    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
    /// Replace files that exist
    #[arg(short, long)]
    pub force: bool,
}

/// How an image comes to lie on one of another size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FitName {
    /// Its width and height each
    Stretch,
    /// As large as it can be without being cut
    Contain,
    /// As small as it can be without a border
    Cover,
}

impl WarpOptions {
    /// The recipe's file; an empty path where there is none.
    pub(crate) fn recipe_path(&self) -> &Path {
        self.recipe.as_deref().unwrap_or(Path::new(""))
    }
}

impl ImageOptions {
    /// The first of them that is given.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let all = [
            (self.pixels.filter.is_some(), "--filter"),
            (self.pixels.edge.is_some(), "--edge"),
            (self.pixels.max_error.is_some(), "--max-error"),
            (self.mapping.is_some(), "--mapping"),
            (self.grow, "--grow"),
            (self.stmap.is_some(), "--stmap"),
            (self.from_stmap.is_some(), "--from-stmap"),
            (self.motion_vectors.is_some(), "--motion-vectors"),
            (self.pixels.quality.is_some(), "--quality"),
            (self.pixels.allow_large, "--allow-large"),
        ];
        all.into_iter()
            .find_map(|(given, name)| given.then_some(name))
    }
}

/// Which pixels the work goes over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MappingName {
    /// Those of the result: each is looked up in the image
    Inverse,
    /// Those of the image: each is moved, and what lies between is filled
    Forward,
}

fn parse_pixels(text: &str) -> Result<f64, String> {
    let number = text.trim().trim_end_matches("px").trim().parse().ok();
    number
        .filter(|n: &f64| (0.0..=1e3).contains(n))
        .ok_or_else(|| "write a number of pixels from 0 to 1000, such as 0.05px".to_owned())
}

/// Evaluate the fields of a recipe on a model once and keep them.
///
/// `anamorph warp --binding` then moves the model by new targets and strengths, much faster where features are many or intricate.
#[derive(Debug, Args)]
pub(crate) struct BindOptions {
    /// The model; `-` is standard input
    #[arg(value_name = "MODEL")]
    pub model: PathBuf,
    /// The recipe, TOML or JSON
    #[arg(short, long, value_name = "FILE")]
    pub recipe: PathBuf,
    /// Where the binding goes
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Change a value of the recipe, such as `warp.0.angle=30deg`
    #[arg(long, value_name = "PATH=VALUE")]
    pub set: Vec<String>,
    /// Drop influences that have less than this share of a point's weight; the error that makes is measured and kept
    #[arg(long, value_name = "SHARE", value_parser = parse_share, default_value = "0")]
    pub drop_below: f64,
    /// Read files that lie outside of the folder of the file that names them
    #[arg(long)]
    pub allow_outside: bool,
    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
    /// Replace a file that exists
    #[arg(short, long)]
    pub force: bool,
}

fn parse_range(text: &str) -> Result<(i64, i64), String> {
    let wrong = || "write two numbers of frames, such as 10-20".to_owned();
    // A dash may also be the sign of the first number.
    let dash = text.trim().get(1..).and_then(|rest| rest.find('-'));
    let (first, last) = match dash {
        Some(dash) => (&text.trim()[..=dash], &text.trim()[dash + 2..]),
        None => (text, text),
    };
    let number = |text: &str| text.trim().parse().map_err(|_| wrong());
    Ok((number(first)?, number(last)?))
}

fn parse_share(text: &str) -> Result<f64, String> {
    let share = text.trim().parse().ok();
    share
        .filter(|share: &f64| (0.0..1.0).contains(share))
        .ok_or_else(|| "write a share from 0 to less than 1, such as 0.0001".to_owned())
}

/// Write the motion of a recipe as a table, an animation or a picture.
///
/// What an animator would want to know (backing up, stalls, abrupt starts) is printed as warnings.
#[derive(Debug, Args)]
pub(crate) struct MotionOptions {
    /// The recipe, TOML or JSON, with a table `[motion]`; `-` is standard input
    #[arg(value_name = "RECIPE")]
    pub recipe: PathBuf,
    /// What is written, by its extension: .csv (time, position, quaternion, distance, speed), .glb (an animated node),
    /// .svg or .png (a picture of path, distance and speed); `-` is a table on standard output
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Frames a second
    #[arg(long, value_name = "N", default_value = "24", value_parser = parse_rate, allow_hyphen_values = true)]
    pub fps: f64,
    /// Seconds the motion lasts, instead of those of the recipe
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_hyphen_values = true)]
    pub duration: Option<f64>,
    /// Change a value of the recipe, such as `motion.path.closed=true`
    #[arg(long, value_name = "PATH=VALUE")]
    pub set: Vec<String>,
    /// Write a report as JSON: length, frames, findings, errors of an animation
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<PathBuf>,
    /// Size of a picture in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1600x900", value_parser = parse_size)]
    pub size: (u32, u32),
    /// Colours of a picture
    #[arg(long, value_name = "THEME", default_value = "light")]
    pub theme: ThemeName,
    /// Read files that lie outside of the folder of the recipe
    #[arg(long)]
    pub allow_outside: bool,
    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
    /// Replace files that exist
    #[arg(short, long)]
    pub force: bool,
}

fn parse_rate(text: &str) -> Result<f64, String> {
    let rate = text.trim().parse().ok();
    rate.filter(|rate: &f64| *rate >= 1e-3 && *rate <= 1e6)
        .ok_or_else(|| "write a number of frames a second from 0.001 to 1000000".to_owned())
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    let seconds = text.trim().parse().ok();
    seconds
        .filter(|seconds: &f64| *seconds >= 1e-6 && *seconds <= 1e9)
        .ok_or_else(|| "write a number of seconds from 0.000001 to 1000000000".to_owned())
}

/// Write control points, frames, points or a coarse mesh of a model to edit in a modeller.
///
/// A recipe reads them back: `source` names the file as written here, `target` the edited one.
#[derive(Debug, Args)]
pub(crate) struct CageOptions {
    /// The model; `-` is standard input
    #[arg(value_name = "MODEL")]
    pub model: PathBuf,
    #[command(flatten)]
    pub content: CageContent,
    /// Where the cage goes: an OBJ file, or a table of points if it ends in `.csv`; a coarse mesh as any format of meshes, by
    /// its extension; `-` is standard output
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// The warp that a lattice is for
    #[arg(long, value_name = "KIND", requires = "lattice")]
    pub kind: Option<LatticeKind>,
    /// Degree of a spline lattice, 1 to 5; 3 if left out
    #[arg(long, value_name = "N", requires = "lattice")]
    pub degree: Option<usize>,
    /// How the knots of a spline lattice are spread; uniform if left out
    #[arg(long, value_name = "SPREAD", requires = "lattice")]
    pub knots: Option<KnotsName>,
    /// How far the box reaches beyond the model: scene units, or a share of the diagonal of its bounds such as `2%`
    #[arg(
        long,
        value_name = "LENGTH",
        conflicts_with_all = ["points", "mesh"],
        allow_hyphen_values = true
    )]
    pub margin: Option<String>,
    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
    /// Replace a file that exists
    #[arg(short, long)]
    pub force: bool,
    /// Let the model refer to files outside of its folder
    #[arg(long)]
    pub allow_outside: bool,
}

/// What a cage is made of.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
pub(crate) struct CageContent {
    /// Control points of a lattice: how many along each axis, such as 4,4,4
    #[arg(long, value_name = "N,N,N", value_parser = parse_counts)]
    pub lattice: Option<Counts>,
    /// Control frames, each an origin and the tips of its arrows: how many along each axis
    #[arg(long, value_name = "N,N,N", value_parser = parse_counts)]
    pub frames: Option<Counts>,
    /// This many points of the model, spread well over it
    #[arg(long, value_name = "COUNT", value_parser = parse_points)]
    pub points: Option<usize>,
    /// A coarse mesh of this many vertices in the shape of the model, for `mesh`: at least 4. Holes, handles and pieces
    /// stay, which may take more
    #[arg(long, value_name = "COUNT", value_parser = parse_vertices)]
    pub mesh: Option<usize>,
}

/// Numbers along each axis.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Counts(pub Vec<usize>);

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum LatticeKind {
    /// Every control point moves the whole model
    Lattice,
    /// Every control point moves what is near
    SplineLattice,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum KnotsName {
    /// The outer control points lie outside of the box
    Uniform,
    /// The outer control points lie on the box
    Clamped,
}

/// Beyond it nobody moves points by hand, and choosing them takes its time.
const MOST_POINTS: usize = 10_000;

fn parse_points(text: &str) -> Result<usize, String> {
    let count = text.trim().parse().ok();
    count
        .filter(|count| (1..=MOST_POINTS).contains(count))
        .ok_or_else(|| format!("write a whole number from 1 to {MOST_POINTS}"))
}

/// The least that encloses anything is a tetrahedron.
fn parse_vertices(text: &str) -> Result<usize, String> {
    let count = text.trim().parse().ok();
    count
        .filter(|&count| count >= 4)
        .ok_or_else(|| "write a whole number of vertices, at least 4".to_owned())
}

fn parse_counts(text: &str) -> Result<Counts, String> {
    let counts: Option<Vec<usize>> = text
        .split([',', 'x', 'X'])
        .map(|count| count.trim().parse().ok())
        .collect();
    counts
        .filter(|counts| counts.len() <= 3 && counts.iter().all(|&count| count >= 2))
        .map(Counts)
        .ok_or_else(|| "write a whole number, at least 2, for each axis, such as 4,4,4".to_owned())
}

/// What is painted on a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum PreviewField {
    /// The determinant of the Jacobian: the factor of volumes; 0 or less is a fold
    Det,
    /// The averaged strength within the mask, the greatest of a stack's
    Strength,
    /// The sum of the weights before they are normalized, the greatest of a stack's
    Weight,
    /// How far points move
    Displacement,
}

fn parse_time(text: &str) -> Result<f64, String> {
    let time = text.parse().ok().filter(|t| (0.0..=1.0).contains(t));
    time.ok_or_else(|| "write a number from 0 (nothing has happened) to 1 (all has)".to_owned())
}

/// How a preview is taken.
#[derive(Debug, Args)]
pub(crate) struct ViewOptions {
    /// From where the preview is taken
    #[arg(
        long,
        value_name = "SIDE",
        default_value = "three-quarter",
        requires = "preview",
        help_heading = "Preview"
    )]
    pub view: Side,
    /// The axis that points up in the preview
    #[arg(
        long,
        value_name = "AXIS",
        default_value = "y",
        requires = "preview",
        help_heading = "Preview"
    )]
    pub up: UpAxis,
    /// Size of the preview in pixels; 1600x900 if left out, 960x540 for a turntable
    #[arg(long, value_name = "WIDTHxHEIGHT", requires = "preview", value_parser = parse_size, help_heading = "Preview")]
    pub size: Option<(u32, u32)>,
    /// Colours of the preview
    #[arg(
        long,
        value_name = "THEME",
        default_value = "light",
        requires = "preview",
        help_heading = "Preview"
    )]
    pub theme: ThemeName,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Side {
    /// From the front right, a little above
    ThreeQuarter,
    /// From the back left, a little above
    BackQuarter,
    Front,
    Back,
    Left,
    Right,
    Top,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum UpAxis {
    X,
    Y,
    Z,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ThemeName {
    Light,
    Dark,
}

/// More threads than this only fill memory with their stacks.
const MOST_THREADS: usize = 1024;

pub(crate) fn parse_threads(text: &str) -> Result<usize, String> {
    text.trim()
        .parse()
        .ok()
        .filter(|threads| (1..=MOST_THREADS).contains(threads))
        .ok_or_else(|| format!("write a whole number from 1 to {MOST_THREADS}"))
}

/// More pictures than this and a full turn is finer than any screen shows.
const MOST_PICTURES: usize = 720;

fn parse_pictures(text: &str) -> Result<usize, String> {
    text.trim()
        .parse()
        .ok()
        .filter(|pictures| (2..=MOST_PICTURES).contains(pictures))
        .ok_or_else(|| format!("write a whole number from 2 to {MOST_PICTURES}"))
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let wrong = || "write the size as WIDTHxHEIGHT in pixels, such as 1600x900".to_owned();
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    Ok((
        width.trim().parse().map_err(|_| wrong())?,
        height.trim().parse().map_err(|_| wrong())?,
    ))
}

/// Say what a model file holds, and what is odd about it.
#[derive(Debug, Args)]
pub(crate) struct InspectOptions {
    /// Model files; `-` is standard input
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Let a model refer to files outside of its folder
    #[arg(long)]
    pub allow_outside: bool,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

/// Say what the warps of a recipe promise.
///
/// Each promise is proved, refuted (with a place that shows it) or unknown.
#[derive(Debug, Args)]
pub(crate) struct CheckOptions {
    /// Recipes, TOML or JSON
    #[arg(required = true, value_name = "RECIPE")]
    pub recipes: Vec<PathBuf>,
    /// The model the recipe is for; a cube (or square) from -1 to 1 stands in if left out
    #[arg(long, value_name = "MODEL")]
    pub model: Option<PathBuf>,
    /// Without a model: check in the plane instead of in space
    #[arg(long, conflicts_with = "model")]
    pub plane: bool,
    /// The moment to look at, from 0 to 1: tracks have set their values then, and schedules are in force
    #[arg(long, value_name = "T", value_parser = parse_time)]
    pub time: Option<f64>,
    /// Change a value of the recipe, such as `warp.0.angle=30deg`
    #[arg(long, value_name = "PATH=VALUE")]
    pub set: Vec<String>,
    /// Read files that lie outside of the folder of the file that names them
    #[arg(long)]
    pub allow_outside: bool,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

/// Draw a page of every warp: before and after, recipe, promises.
///
/// The page is a folder of plain files that needs no network: open `index.html` in a browser.
#[derive(Debug, Args)]
pub(crate) struct GalleryOptions {
    /// The folder for the page; it is made if it does not exist
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,
    /// Size of the pictures in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1280x600", value_parser = parse_size)]
    pub size: (u32, u32),
    /// Write the documentation's page, too
    #[arg(long, hide = true)]
    pub markdown: bool,
    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
    /// Replace files that exist
    #[arg(short, long)]
    pub force: bool,
}

/// List what can be named in recipes and on the command line.
#[derive(Debug, Args)]
pub(crate) struct ListOptions {
    /// What to list
    #[arg(value_name = "KIND")]
    pub kind: ListKind,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ListKind {
    /// Warps that a recipe can name
    Warps,
    /// Fields for `strength`, `weight` and `mask`
    Fields,
    /// How influence falls off with distance
    Falloffs,
    /// File formats
    Formats,
    /// Families of curves for the path of a motion
    Curves,
    /// Eases for the speed of a motion
    Eases,
    /// Orientations for a motion
    Orientations,
}
