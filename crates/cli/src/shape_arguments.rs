//! Values of the options of morphs of shapes.
//!
//! Each says what may be written where it is refused. They are beside `arguments.rs` because that is long enough.

use crate::arguments::parse_threads;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// How shapes are read and matched.
#[derive(Debug, Args)]
#[command(next_help_heading = "Shapes")]
pub(crate) struct ShapeOptions {
    /// Places of the outlines that must become each other, a TOML file of [[anchor]] tables for each step
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub anchors: Vec<PathBuf>,
    /// What becomes of parts of a drawing that have no partner: they split off or merge into the nearest if left out
    #[arg(long, value_name = "HOW")]
    pub pieces: Option<PiecesName>,
    /// The text of each font among the inputs
    #[arg(long, value_name = "TEXT", num_args = 1..)]
    pub text: Vec<String>,
    /// A place on an axis of variable fonts, for all fonts or one for each, as in wght=700 or wght=100,900; may be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_axis)]
    pub axis: Vec<Axis>,
    /// Take the outlines of images: of what is opaque, or dark in images without alpha
    #[arg(long)]
    pub silhouette: bool,
    /// How far curves may be from the polygons that stand for them, in units of the drawing; a two-thousandth of its longer side if
    /// left out
    #[arg(long, value_name = "UNITS", value_parser = parse_positive)]
    pub tolerance: Option<f64>,
    /// Pixels of the longer side of pictures of shapes; 512 if left out
    #[arg(long, value_name = "PIXELS", value_parser = parse_side)]
    pub size: Option<f64>,
}

impl ShapeOptions {
    /// The first of them that is given.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let all = [
            (!self.anchors.is_empty(), "--anchors"),
            (self.pieces.is_some(), "--pieces"),
            (!self.text.is_empty(), "--text"),
            (!self.axis.is_empty(), "--axis"),
            (self.tolerance.is_some(), "--tolerance"),
            (self.size.is_some(), "--size"),
        ];
        all.iter().find(|(given, _)| *given).map(|(_, name)| *name)
    }
}

/// What is drawn and measured between shapes.
#[derive(Debug, Args)]
#[command(next_help_heading = "Shapes")]
pub(crate) struct BetweenOptions {
    /// How shapes go over: indifferent, linear, modified, log, vertex-linear or as-rigid-as-possible; indifferent if left out
    #[arg(long, value_name = "NAME")]
    pub scheme: Option<String>,
    /// An image for each shape, laid over its canvas: in-betweens show both, one dissolving into the other. The result is pictures
    #[arg(long, value_name = "IMAGE", num_args = 1..)]
    pub texture: Vec<PathBuf>,
    /// Write how good a morph of shapes is, beside other methods over the same meshes, as JSON, and print a table
    #[arg(long, value_name = "FILE.json")]
    pub metrics: Option<PathBuf>,
    /// Draw which places of shapes become each other, as .png or .svg
    #[arg(long, value_name = "FILE")]
    pub matching: Option<PathBuf>,
    /// Plot strain against time, beside vertices that go straight: .svg or .png, or .csv for the numbers
    #[arg(long, value_name = "FILE")]
    pub strain_plot: Option<PathBuf>,
    /// Triangles to plot the strain of, counted from 0 as in a pair of meshes; the mean of all if left out
    #[arg(
        long,
        value_name = "N,N,…",
        value_delimiter = ',',
        requires = "strain_plot"
    )]
    pub triangles: Vec<usize>,
}

impl BetweenOptions {
    /// The first of them that is given.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let all = [
            (self.scheme.is_some(), "--scheme"),
            (!self.texture.is_empty(), "--texture"),
            (self.metrics.is_some(), "--metrics"),
            (self.matching.is_some(), "--matching"),
            (self.strain_plot.is_some(), "--strain-plot"),
        ];
        all.iter().find(|(given, _)| *given).map(|(_, name)| *name)
    }
}

/// Make one triangulation of two shapes.
///
/// The same triangles lie in both, none turned over: to morph them elsewhere, or by hand.
#[derive(Debug, Args)]
pub(crate) struct MeshOptions {
    /// Two shapes (SVG, polygons, fonts, images with --silhouette), or a pair of meshes to look at
    #[arg(required = true, num_args = 1..=2, value_name = "INPUT")]
    pub inputs: Vec<PathBuf>,
    /// Where the result goes: the pair of meshes (.json), or a picture of both (.svg, .png); `-` is the pair on standard output
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    #[command(flatten)]
    pub shapes: ShapeOptions,
    /// Print what the meshes are like as JSON on standard output
    #[arg(long)]
    pub json: bool,
    /// Threads to use, 1 to 1024; as many as the machine has if left out. Results do not depend on it
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub threads: Option<usize>,
    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
    /// Replace files that exist
    #[arg(short, long)]
    pub force: bool,
}

/// What becomes of parts of a drawing without a partner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum PiecesName {
    /// Further parts of the target split off the source's nearest, further parts of the source merge into the target's
    SplitAndMerge,
    /// Further parts of the target split off; those of the source shrink to points
    Split,
    /// Further parts of the source merge; those of the target grow from points
    Merge,
    /// All grow from points, or shrink to points
    Grow,
}

impl From<PiecesName> for anamorph_morph::shapes::Pieces {
    fn from(name: PiecesName) -> Self {
        match name {
            PiecesName::SplitAndMerge => Self::SplitAndMerge,
            PiecesName::Split => Self::Split,
            PiecesName::Merge => Self::Merge,
            PiecesName::Grow => Self::Grow,
        }
    }
}

/// Places on an axis of variable fonts.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Axis {
    pub name: String,
    /// One for all fonts, or one for each.
    pub values: Vec<f64>,
}

fn parse_axis(text: &str) -> Result<Axis, String> {
    let wrong = || {
        "write the name of an axis and a number, as in wght=700, or numbers for each font, as in wght=100,900".to_owned()
    };
    let (name, values) = text.split_once('=').ok_or_else(wrong)?;
    let number = |text: &str| {
        let number = text.trim().parse().ok();
        number.filter(|number: &f64| number.is_finite())
    };
    let values: Option<Vec<f64>> = values.split(',').map(number).collect();
    let name = name.trim().to_owned();
    match values {
        Some(values) if !name.is_empty() => Ok(Axis { name, values }),
        _ => Err(wrong()),
    }
}

pub(crate) fn parse_positive(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok();
    number
        .filter(|n: &f64| *n > 0.0 && n.is_finite())
        .ok_or_else(|| "write a positive number, such as 0.1".to_owned())
}

pub(crate) fn parse_side(text: &str) -> Result<f64, String> {
    let number = text.trim().trim_end_matches("px").trim().parse().ok();
    number
        .filter(|n: &f64| (1.0..=16_384.0).contains(n))
        .ok_or_else(|| "write a number of pixels from 1 to 16384".to_owned())
}
