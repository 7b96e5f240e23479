//! Numbers painted on a model: what a warp does at each vertex, as colours with a scale beside them.
//!
//! *Source*: Milliron et al. 2002, §7.4 for what the determinant tells, eq. (3) for strengths and weights; the colours are a decision.

use crate::arguments::{PreviewField, ThemeName};
use crate::error::Failure;
use crate::model::ModelSpace;
use anamorph_core::{Deformation, Domain, Linear, Site, in_force};
use anamorph_preview::{Anchor, Figure, Ink, Picture, PreviewError};
use anamorph_recipe::BuiltRecipe;

type Colour = [f32; 3];

/// From nothing to much.
const RISING: [Colour; 5] = [
    [0.91, 0.91, 0.90],
    [0.98, 0.83, 0.47],
    [0.95, 0.53, 0.23],
    [0.78, 0.19, 0.24],
    [0.36, 0.04, 0.29],
];
/// From pressed together over as it was to drawn apart.
const AROUND: [Colour; 5] = [
    [0.09, 0.25, 0.58],
    [0.42, 0.66, 0.86],
    [0.92, 0.92, 0.91],
    [0.96, 0.66, 0.36],
    [0.72, 0.20, 0.09],
];
/// Turned inside out.
const FOLDED: Colour = [0.85, 0.05, 0.78];
/// Volumes that differ by less are not told apart, for a scale that shows something: powers of 2.
const LEAST_OCTAVES: f64 = 0.1;
/// Volumes that differ by more are as one.
const MOST_OCTAVES: f64 = 6.0;

/// Colours of a model's vertices, and what they mean.
pub(crate) struct Painted {
    pub(crate) colours: Vec<Colour>,
    what: &'static str,
    ramp: [Colour; 5],
    /// Numbers at even steps of the ramp.
    ticks: Vec<String>,
    /// Vertices turned inside out.
    folded: usize,
}

fn colour(ramp: &[Colour; 5], share: f64) -> Colour {
    let place = share.clamp(0.0, 1.0) * 4.0;
    // Between 0 and 4.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let below = (place.floor() as usize).min(3);
    #[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss)]
    let rest = (place - below as f64) as f32;
    core::array::from_fn(|i| ramp[below][i] * (1.0 - rest) + ramp[below + 1][i] * rest)
}

/// A number for a scale: three digits.
fn tick(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if (0.01..1000.0).contains(&size) {
        let digits = if size < 1.0 {
            3
        } else if size < 100.0 {
            2
        } else {
            0
        };
        let text = format!("{value:.digits$}");
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    } else {
        format!("{value:.1e}")
    }
}

/// The greatest of a part's strengths (within its mask) or weights at each point.
fn largest<S: ModelSpace>(
    built: &BuiltRecipe<S>,
    rest: &[S],
    of: impl Fn((f64, f64), f64) -> f64,
) -> Vec<f64> {
    let mut most = vec![0.0_f64; rest.len()];
    let mut here = rest.to_vec();
    for part in &built.parts {
        for (index, (point, most)) in here.iter_mut().zip(&mut most).enumerate() {
            let site = Site::new(index, *point);
            let mask = part.mask.as_ref().map_or(1.0, |mask| mask.value(&site));
            *most = most.max(of(in_force(&part.warp, &site), mask));
            *point = part.deformation.map(&site);
        }
    }
    most
}

impl Painted {
    /// The field at the model's points, which a deformation moves from `rest` to `moved`.
    pub(crate) fn new<S: ModelSpace>(
        field: PreviewField,
        built: &BuiltRecipe<S>,
        whole: &dyn Deformation<S>,
        rest: &[S],
        moved: &[S],
        size: f64,
    ) -> Result<Self, Failure> {
        Ok(match field {
            PreviewField::Det => {
                if whole.domain() == Domain::Model {
                    return Err(Failure::new(
                        "--preview-field det: a field of the recipe lives on the model, so that there is no derivative to paint; \
                         choose another field, or leave that warp out",
                    ));
                }
                let determinant = |(index, &point): (usize, &S)| {
                    let jacobian = whole.jacobian(&Site::new(index, point), size);
                    jacobian.map_or(f64::NAN, |j| j.determinant())
                };
                Self::determinants(&rest.iter().enumerate().map(determinant).collect::<Vec<_>>())
            }
            PreviewField::Strength => Self::rising(
                "strength",
                &largest(built, rest, |(strength, _), mask| (strength * mask).abs()),
            ),
            PreviewField::Weight => {
                Self::rising("weight", &largest(built, rest, |(_, weight), _| weight))
            }
            PreviewField::Displacement => {
                let far = rest.iter().zip(moved).map(|(&a, &b)| a.distance(b));
                Self::rising("displacement", &far.collect::<Vec<_>>())
            }
        })
    }

    fn rising(what: &'static str, values: &[f64]) -> Self {
        let finite = values.iter().copied().filter(|v| v.is_finite());
        let most = finite.fold(0.0, f64::max);
        let share = |value: f64| {
            if most > 0.0 { value / most } else { 0.0 }
        };
        Self {
            colours: values.iter().map(|&v| colour(&RISING, share(v))).collect(),
            what,
            ramp: RISING,
            ticks: [0.0, 0.25, 0.5, 0.75, 1.0].map(|s| tick(s * most)).to_vec(),
            folded: 0,
        }
    }

    fn determinants(values: &[f64]) -> Self {
        let octaves = |value: f64| value.log2().clamp(-MOST_OCTAVES, MOST_OCTAVES);
        let most = values
            .iter()
            .filter(|v| **v > 0.0)
            .map(|v| octaves(*v).abs())
            .fold(LEAST_OCTAVES, f64::max);
        let of = |value: &f64| {
            if *value <= 0.0 {
                FOLDED
            } else if value.is_nan() {
                AROUND[2]
            } else {
                colour(&AROUND, 0.5 + 0.5 * octaves(*value) / most)
            }
        };
        let factor = |share: f64| tick((share * most).exp2());
        Self {
            colours: values.iter().map(of).collect(),
            what: if values.is_empty() { "" } else { "determinant" },
            ramp: AROUND,
            ticks: [-1.0, -0.5, 0.0, 0.5, 1.0].map(factor).to_vec(),
            folded: values.iter().filter(|v| **v <= 0.0).count(),
        }
    }

    /// What the colours mean, in a sentence.
    pub(crate) fn sentence(&self) -> String {
        let (low, high) = (&self.ticks[0], &self.ticks[self.ticks.len() - 1]);
        let folded = match self.folded {
            0 => String::new(),
            1 => "; 1 vertex is turned inside out (magenta)".to_owned(),
            count => format!("; {count} vertices are turned inside out (magenta)"),
        };
        format!("painted: {} from {low} to {high}{folded}", self.what)
    }

    /// The picture with a scale at its foot.
    pub(crate) fn with_scale(
        &self,
        picture: &Picture,
        theme: ThemeName,
    ) -> Result<Picture, PreviewError> {
        let (_, width, height) = picture.rgba();
        let (width, height) = (f64::from(width), f64::from(height));
        let unit = (width.min(height) / 900.0).clamp(0.35, 8.0);
        let ink = Ink {
            rgb: match theme {
                ThemeName::Light => [60, 62, 66],
                ThemeName::Dark => [214, 216, 220],
            },
            opacity: 1.0,
        };
        let mut figure = Figure::new(width, height, ink);
        let length = 0.26 * width;
        let (left, top, thick) = (0.5 * (width - length), height - 52.0 * unit, 12.0 * unit);
        let rgb = |c: Colour| {
            // The edge of the picture: eight bits.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            c.map(|c| (c * 255.0).round() as u8)
        };
        let opaque = |c: Colour| Ink {
            rgb: rgb(c),
            opacity: 1.0,
        };
        const STEPS: i32 = 96;
        for step in 0..STEPS {
            let (from, to) = (
                f64::from(step) / f64::from(STEPS),
                f64::from(step + 1) / f64::from(STEPS),
            );
            let [a, b] = [from, to].map(|s| left + s * length);
            figure.area(
                &[
                    [a, top],
                    [b + 0.5, top],
                    [b + 0.5, top + thick],
                    [a, top + thick],
                ],
                opaque(colour(&self.ramp, 0.5 * (from + to))),
            );
        }
        let letters = 10.0 * unit;
        #[allow(clippy::cast_precision_loss)]
        let last = (self.ticks.len() - 1) as f64;
        for (number, text) in self.ticks.iter().enumerate() {
            #[allow(clippy::cast_precision_loss)]
            let x = left + length * number as f64 / last;
            let foot = top + thick;
            figure.line(&[[x, foot], [x, foot + 4.0 * unit]], ink, 1.2 * unit);
            let at = [x, foot + 18.0 * unit];
            figure.words(at, letters, Anchor::Middle, ink, text);
        }
        let at = [left - 14.0 * unit, top + thick];
        figure.words(at, letters, Anchor::End, ink, self.what);
        if self.folded > 0 {
            let side = left + length + 26.0 * unit;
            figure.area(
                &[
                    [side, top],
                    [side + thick, top],
                    [side + thick, top + thick],
                    [side, top + thick],
                ],
                opaque(FOLDED),
            );
            let at = [side + thick + 8.0 * unit, top + thick];
            figure.words(at, letters, Anchor::Start, ink, "folded");
        }
        figure.over(picture)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_middle_have_their_colours() {
        let painted = Painted::determinants(&[0.5, 1.0, 2.0, -0.1, f64::NAN]);
        assert_eq!(painted.colours[0], AROUND[0]);
        assert_eq!(painted.colours[1], AROUND[2]);
        assert_eq!(painted.colours[2], AROUND[4]);
        assert_eq!(painted.colours[3], FOLDED);
        assert_eq!(painted.colours[4], AROUND[2]);
        assert_eq!(painted.ticks, ["0.5", "0.707", "1", "1.41", "2"]);
        let sentence = painted.sentence();
        assert!(sentence.contains("1 vertex"), "{sentence}");

        let painted = Painted::rising("displacement", &[0.0, 1.5, 3.0, f64::INFINITY]);
        assert_eq!(painted.colours[0], RISING[0]);
        assert_eq!(painted.colours[1], RISING[2]);
        assert_eq!(painted.colours[2], RISING[4]);
        assert_eq!(painted.colours[3], RISING[4]);
        let still = Painted::rising("displacement", &[0.0, 0.0]);
        assert_eq!(still.colours, [RISING[0]; 2]);
    }
}
