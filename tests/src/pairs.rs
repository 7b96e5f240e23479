//! Morphs of pairs of shapes, measured: what `cargo xtask pairs` prints, and what a fixed list of pairs is tested by.
//!
//! Both shapes are read, matched, meshed alike and morphed with nothing set but the defaults. The meshes are checked by
//! [`CompatiblePair::check`], which knows nothing of how they were made, and frames are measured for the first method
//! of [`METHODS`], the linear one and as-rigid-as-possible.
//!
//! [`CompatiblePair::check`]: anamorph_meshing::compatible::CompatiblePair::check
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing Based on Strain Field Interpolation*, 2004, for what is measured; the
//! project's own design for the table.

use anamorph_core::glam::DVec2;
use anamorph_io::outlines::{self, FontOptions, Rule};
use anamorph_morph::figures::{Figure, FigureOptions};
use anamorph_morph::shapes::{FillRule, Part, Ring, Shape};
use anamorph_morph::strain::{METHODS, Settings, method, metrics};

/// In-betweens that are measured.
const TIMES: usize = 10;
/// Flattening tolerance as a share of the longer side of what is seen.
const TOLERANCE: f64 = 1.0 / 2000.0;

/// The parts of a drawing in a file; of a font, those of a text.
///
/// # Errors
/// What is wrong with the file, in words.
pub fn load(bytes: &[u8], text: Option<&str>) -> Result<Vec<Part>, String> {
    let drawing = match text {
        Some(text) => outlines::read_text(bytes, text, &FontOptions::default()),
        None => outlines::read(bytes),
    };
    let drawing = drawing.map_err(|error| error.to_string())?.turned(true);
    let view = drawing.view();
    let tolerance = TOLERANCE * view[2].max(view[3]);
    let mut parts = Vec::new();
    for part in &drawing.parts {
        let rings = part.contours.iter().map(|contour| Ring {
            points: contour.flatten(tolerance),
            hole: false,
        });
        let fill = match part.rule {
            Rule::NonZero => FillRule::NonZero,
            Rule::EvenOdd => FillRule::EvenOdd,
        };
        let shape = Shape {
            rings: rings.collect(),
            fill,
        };
        // Parts without area are left out, as the command does.
        if let Ok((regions, _)) = shape.regions() {
            parts.extend(regions.into_iter().map(|region| Part {
                id: part.id.clone(),
                colour: None,
                region,
            }));
        }
    }
    if parts.is_empty() {
        return Err("nothing in it is filled".to_owned());
    }
    Ok(parts)
}

/// What one method makes of a pair, over all parts and frames.
#[derive(Debug, Clone, Default)]
pub struct Row {
    /// The method.
    pub method: &'static str,
    /// Triangles turned over.
    pub flips: usize,
    /// The smallest determinant.
    pub smallest: f64,
    /// How far the area leaves what lies between both ends, at most, in shares of it.
    pub area_overshoot: f64,
    /// The largest mean symmetric Dirichlet energy of a frame.
    pub dirichlet: f64,
    /// Crossings of outlines.
    pub crossings: usize,
    /// The median of Newton's steps.
    pub steps: usize,
    /// Frames whose search came to no end.
    pub unfinished: usize,
    /// Why there are no frames.
    pub fault: Option<String>,
}

/// What became of a pair.
#[derive(Debug, Clone, Default)]
pub struct Measured {
    /// Parts that were paired.
    pub couples: usize,
    /// Triangles of all parts.
    pub triangles: usize,
    /// As many as there were when both triangulations lay over each other.
    pub overlaid: usize,
    /// The smallest angle in degrees.
    pub angle: f64,
    /// What the checker of meshes found.
    pub faults: Vec<String>,
    /// By method.
    pub rows: Vec<Row>,
}

impl Measured {
    /// Whether meshes are valid, and the first method has all frames without anything turned over.
    pub fn is_good(&self) -> bool {
        let sound = |row: &Row| row.flips == 0 && row.fault.is_none() && row.smallest > 0.0;
        self.faults.is_empty() && self.rows.first().is_some_and(sound)
    }
}

/// Morphs a pair and measures it.
///
/// # Errors
/// Why there is no morph, in words.
pub fn measure(source: &[Part], target: &[Part], methods: usize) -> Result<Measured, String> {
    let chosen = method(METHODS[0].name).map_err(|error| error.to_string())?;
    let figure = Figure::new(source, target, &chosen, &FigureOptions::default());
    let figure = figure.map_err(|error| error.to_string())?;
    let mut found = Measured {
        couples: figure.couples().len(),
        angle: f64::INFINITY,
        ..Measured::default()
    };
    let times: Vec<f64> = (0..=TIMES).map(|i| i as f64 / TIMES as f64).collect();
    for couple in figure.couples() {
        match couple.mesh.check() {
            Ok(quality) => {
                let [a, b] = quality.smallest_angle;
                found.angle = found.angle.min(a).min(b);
            }
            Err(fault) => found.faults.push(fault.to_string()),
        }
        found.triangles += couple.mesh.triangles.len();
        found.overlaid += couple.mesh.overlaid;
    }
    let names = METHODS[0..1].iter().chain(
        METHODS
            .iter()
            .filter(|m| ["vertex-linear", "as-rigid-as-possible"].contains(&m.name)),
    );
    for chosen in names.take(methods) {
        let mut row = Row {
            method: chosen.name,
            smallest: f64::INFINITY,
            ..Row::default()
        };
        for couple in figure.couples() {
            // What is turned over is counted, not refused, but by the method that promises that nothing is.
            let settings = Settings {
                allow_flips: chosen.name != METHODS[0].name,
                ..Settings::default()
            };
            let measured = chosen
                .prepare(couple.pair(), &settings)
                .map_err(|error| error.to_string())
                .and_then(|between| {
                    let all = metrics::measure(couple.pair(), &*between, &times);
                    all.map_err(|error| error.to_string())
                });
            match measured {
                Ok(all) => {
                    row.flips += all.flips();
                    row.smallest = row.smallest.min(all.smallest_determinant());
                    row.area_overshoot = row.area_overshoot.max(all.area_overshoot);
                    row.crossings += all.crossings();
                    row.steps = row.steps.max(all.median_steps());
                    for frame in &all.frames {
                        row.dirichlet = row.dirichlet.max(frame.symmetric_dirichlet.mean);
                        row.unfinished += frame.unfinished;
                    }
                }
                Err(error) => row.fault = Some(error),
            }
        }
        found.rows.push(row);
    }
    Ok(found)
}

/// The largest jump of a point from frame to frame, in shares of the drawing's size, over evenly spaced frames: what shakes shows here.
///
/// # Errors
/// Why there is no morph, in words.
pub fn largest_jump(source: &[Part], target: &[Part], frames: usize) -> Result<f64, String> {
    let chosen = method(METHODS[0].name).map_err(|error| error.to_string())?;
    let figure = Figure::new(source, target, &chosen, &FigureOptions::default());
    let figure = figure.map_err(|error| error.to_string())?;
    let mut worst: f64 = 0.0;
    for couple in figure.couples() {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for p in couple.mesh.source.iter().chain(&couple.mesh.target) {
            (low, high) = (low.min(*p), high.max(*p));
        }
        let mut last = couple.mesh.source.clone();
        for frame in 1..=frames {
            let places = couple.places(frame as f64 / frames as f64);
            let places = places.map_err(|error| error.to_string())?;
            let jumps = places.iter().zip(&last).map(|(a, b)| a.distance(*b));
            worst = worst.max(jumps.fold(0.0, f64::max) / (high - low).max_element());
            last = places;
        }
    }
    Ok(worst)
}
