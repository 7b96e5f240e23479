//! Snakes: a curve drawn roughly relaxes onto the edges of an image, so that its points can be features of a warp.
//!
//! The curve `v` minimises `∫ α|(v − r)′|² + β|(v − r)″|² − σ² S(v)/S₀`, where `S` is the length of the gradient of the image's
//! luminance, smoothed by a Gaussian of `σ` pixels, `S₀` the strongest edge within the curve's reach, and `r` a *rest shape*.
//! Two things differ from the energy of the sources. It is the displacement from the rest shape that must be smooth, not the
//! curve: so nothing shrinks to a point where there is no edge, and a flat image leaves the curve where it is. And the rest
//! shape follows: each round begins from where the last one ended (the proximal point method), so that at the end no elastic
//! force pulls the curve off the edge; the energy says in which order shapes are tried, smooth moves first. With the factor
//! `σ²` the force near an edge is the distance to it, in pixels.
//!
//! Rounds go from coarse scales, whose edges are seen from afar, to the scale asked for, where the elasticity fades round by
//! round. Steps are semi-implicit: the elastic part by a pentadiagonal system (cyclic for closed curves), the edges' force as
//! it stands, and only across the curve, because sliding along itself changes no shape. No point goes farther than the reach
//! from where it began, and no round makes a curve cross itself that did not; each step and each such check takes a time
//! linear in the number of points.
//!
//! *Source*: M. Kass, A. Witkin, D. Terzopoulos, *Snakes: Active Contour Models*, International Journal of Computer Vision 1,
//! 1988 (energy, semi-implicit steps, scale space); S.-Y. Lee, K.-Y. Chwa, S. Y. Shin, *Image Metamorphosis Using Snakes and
//! Free-Form Deformations*, SIGGRAPH 1995 (snakes as features of a metamorphosis). The proximal rounds are R. T. Rockafellar's,
//! *Monotone Operators and the Proximal Point Algorithm*, SIAM Journal on Control and Optimization 14(5), 1976.

mod crossings;
mod curve;
mod edges;
mod limits;
mod solve;

use crate::{Raster, RasterError, Window, parallel};
use anamorph_core::glam::DVec2;
use curve::Curve;
use edges::Edges;
use limits::{Limits, held};
use solve::Stiffness;

/// Semi-implicit steps of a round at most.
const STEPS: usize = 24;
/// Rounds on a scale at most.
const ROUNDS: usize = 60;
/// A round that moves no point farther than this, in pixels, is the last one of its scale.
const SETTLED: f64 = 0.01;
/// On the finest scale each round has this share of the elasticity of the one before,
const FADING: f64 = 0.5;
/// down to this share of the whole: what is left keeps single points from following noise.
const LEAST: f64 = 1.0 / 32.0;
/// Standard deviations from which an edge is seen: its force there is a tenth of its largest.
const SEEN: f64 = 2.5;
/// Points of a curve at most.
const MOST: usize = 1 << 20;
const TOO_MANY: SnakeError = SnakeError::TooMany { most: MOST };
/// Points that one task works on.
const TOGETHER: usize = 1024;

/// What an open curve's ends do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ends {
    /// They move like all other points.
    #[default]
    Free,
    /// They stay where they are.
    Fixed,
}

/// How a curve relaxes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Snake {
    /// Whether the last point is joined to the first.
    pub closed: bool,
    /// What the ends of an open curve do.
    pub ends: Ends,
    /// Standard deviation of the Gaussian that smooths the image on the finest scale, in pixels; from 0.5 to 100.
    pub sigma: f64,
    /// How far away an edge may be and still be found, and how far the curve may go, in pixels; from 0 to 1000. It decides on the
    /// coarsest scale. A given point ends no farther than this from its own place, all of the curve no farther than this from the curve
    /// as it was given.
    pub reach: f64,
    /// Stiffness against stretching: `α/σ²`; not negative.
    pub alpha: f64,
    /// Stiffness against bending: `β/σ⁴`; not negative.
    pub beta: f64,
    /// How many points the result has, the same distance from each other along the curve. If `None`, each of the given
    /// points where it has gone.
    pub points: Option<usize>,
}

impl Default for Snake {
    /// An open curve with free ends, smoothed by 1 pixel, that sees edges 10 pixels away; both stiffnesses 1.
    fn default() -> Self {
        Self {
            closed: false,
            ends: Ends::Free,
            sigma: 1.0,
            reach: 10.0,
            alpha: 1.0,
            beta: 1.0,
            points: None,
        }
    }
}

/// What became of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SnakeReport {
    /// Semi-implicit steps over all scales.
    pub steps: usize,
    /// How far the given points have moved: the farthest, in pixels.
    pub farthest: f64,
    /// The mean of that.
    pub mean: f64,
    /// Mean edge strength along the curve before, on the finest scale: change of luminance for each pixel.
    pub edge_before: f64,
    /// The same after.
    pub edge_after: f64,
    /// Whether it came to rest; else it was stopped after many rounds, or because it would have crossed itself.
    pub settled: bool,
    /// How many points of the curve wanted to go farther than `reach` in the end and were held there.
    pub held: usize,
    /// Where the first of them is.
    pub held_at: Option<DVec2>,
    /// In how many rounds parts of the curve went less far than they would have, or stayed, because the curve would have crossed
    /// itself.
    pub slowed: usize,
    /// Whether the curve crossed itself as it was given (with the number of points asked for). Only then can the result.
    pub crossed_before: bool,
    /// A place where the result crosses or touches itself, if it does.
    pub crossing: Option<DVec2>,
}

/// Why a curve cannot relax.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SnakeError {
    /// Too few points for a curve.
    #[error(
        "the curve has {found} {points}, and {kind} needs at least {needed}; draw more of it",
        points = if *found == 1 { "point" } else { "points" }
    )]
    TooFew {
        /// How many there are.
        found: usize,
        /// What it is.
        kind: &'static str,
        /// How many are needed.
        needed: usize,
    },
    /// Far more points than pixels.
    #[error("the curve has more than {most} points, or is as long; leave out some")]
    TooMany {
        /// How many there may be.
        most: usize,
    },
    /// A point that is not finite.
    #[error("point {index} of the curve (counted from 0) is not finite; correct or remove it")]
    NotFinite {
        /// Its number.
        index: usize,
    },
    /// A point that lies on no pixel.
    #[error(
        "point {index} of the curve (counted from 0), ({x}, {y}), is outside of the image's {window}; coordinates are pixels, \
         y going down"
    )]
    Outside {
        /// Its number.
        index: usize,
        /// Where it is.
        x: f64,
        /// Where it is.
        y: f64,
        /// The pixels there are.
        window: Window,
    },
    /// All points in one place.
    #[error("all points of the curve are in one place; draw them along the edge")]
    NoLength,
    /// Weights of channels that do not fit the image or count none of its channels.
    #[error(
        "{found} weights are given for {channels} channels, and one for each is needed, finite and not all 0"
    )]
    Weights {
        /// How many were given.
        found: usize,
        /// Channels of the image.
        channels: usize,
    },
    /// A setting outside its range.
    #[error("`{name}` is {value}, and must be {range}")]
    OutOfRange {
        /// The setting.
        name: &'static str,
        /// The number given.
        value: f64,
        /// The range, in words.
        range: &'static str,
    },
    /// What is wrong with the image.
    #[error(transparent)]
    Raster(#[from] RasterError),
}

impl Snake {
    fn check(&self) -> Result<(), SnakeError> {
        let stiff = 0.0..=1e6;
        for (name, value, range, words) in [
            ("sigma", self.sigma, 0.5..=100.0, "from 0.5 to 100 pixels"),
            ("reach", self.reach, 0.0..=1000.0, "from 0 to 1000 pixels"),
            ("alpha", self.alpha, stiff.clone(), "from 0 to 1000000"),
            ("beta", self.beta, stiff.clone(), "from 0 to 1000000"),
        ] {
            if !range.contains(&value) {
                return Err(SnakeError::OutOfRange {
                    name,
                    value,
                    range: words,
                });
            }
        }
        let least = self.least();
        match self.points {
            Some(count) if count < least || count > MOST => Err(SnakeError::OutOfRange {
                name: "points",
                value: count as f64,
                range: if self.closed {
                    "from 3 to 1048576"
                } else {
                    "from 2 to 1048576"
                },
            }),
            _ => Ok(()),
        }
    }

    /// Points that a curve has at least.
    fn least(&self) -> usize {
        if self.closed { 3 } else { 2 }
    }

    /// Standard deviations of the scales, the coarsest first: halves down to `sigma`.
    fn scales(&self) -> Vec<f64> {
        let coarsest = self.reach / SEEN;
        let mut scales = vec![self.sigma];
        let mut scale = self.sigma * 2.0;
        while scale <= coarsest * 1.25 {
            scales.push(scale);
            scale *= 2.0;
        }
        scales.reverse();
        scales
    }
}

/// Refuses curves that are none, and such that leave the image.
fn check_points(points: &[DVec2], window: Window, options: &Snake) -> Result<(), SnakeError> {
    let needed = options.least();
    if points.len() < needed {
        return Err(SnakeError::TooFew {
            found: points.len(),
            kind: if options.closed {
                "a closed curve"
            } else {
                "an open curve"
            },
            needed,
        });
    }
    if points.len() > MOST {
        return Err(TOO_MANY);
    }
    if let Some(index) = points.iter().position(|point| !point.is_finite()) {
        return Err(SnakeError::NotFinite { index });
    }
    let (low, size) = (
        window.corner(),
        DVec2::new(window.width() as f64, window.height() as f64),
    );
    let inside = |p: &DVec2| p.cmpge(low).all() && p.cmple(low + size).all();
    if let Some(index) = points.iter().position(|point| !inside(point)) {
        return Err(SnakeError::Outside {
            index,
            x: points[index].x,
            y: points[index].y,
            window,
        });
    }
    if points.iter().all(|point| *point == points[0]) {
        return Err(SnakeError::NoLength);
    }
    Ok(())
}

/// Lets a curve relax onto the edges of `image`: `points` along it in pixel coordinates. `weights` says how much each channel counts in the
/// luminance whose edges are looked for (for red, green and blue in linear light 0.2126, 0.7152 and 0.0722). What is not finite in the image
/// counts as the pixel before it.
///
/// # Errors
/// [`SnakeError`]: settings outside their ranges; too few points, such that are not finite or outside the image, all in
/// one place; weights that do not fit the channels.
///
/// ```
/// use anamorph_core::glam::dvec2;
/// use anamorph_raster::{Raster, Window, snake::{Snake, relax}};
///
/// // Light right of column 20, and a line drawn some pixels off.
/// let mut image = Raster::new(Window::new(0, 0, 40, 30)?, 1)?;
/// for (i, sample) in image.samples_mut().iter_mut().enumerate() {
///     *sample = if i % 40 >= 20 { 1.0 } else { 0.0 };
/// }
/// let drawn = [dvec2(16.0, 5.0), dvec2(24.0, 15.0), dvec2(17.0, 25.0)];
/// let (settled, report) = relax(&image, &[1.0], &drawn, &Snake::default())?;
/// assert!(settled.iter().all(|point| (point.x - 20.0).abs() < 0.2));
/// assert!(report.edge_after > report.edge_before);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn relax(
    image: &Raster,
    weights: &[f64],
    points: &[DVec2],
    options: &Snake,
) -> Result<(Vec<DVec2>, SnakeReport), SnakeError> {
    options.check()?;
    check_points(points, image.window(), options)?;
    let counted = weights.iter().any(|&weight| weight != 0.0);
    if weights.len() != image.channels() || !counted || !weights.iter().all(|w| w.is_finite()) {
        return Err(SnakeError::Weights {
            found: weights.len(),
            channels: image.channels(),
        });
    }
    let scales = options.scales();
    let coarsest = scales.first().copied().unwrap_or(options.sigma);
    let finest = Edges::new(image, weights, points, options.sigma, coarsest)?;
    let mut curve = Curve::new(points, options.closed, options.sigma.max(1.0)).ok_or(TOO_MANY)?;
    let limits = Limits::new(&curve, options);
    let mut report = SnakeReport {
        steps: 0,
        farthest: 0.0,
        mean: 0.0,
        edge_before: curve.mean(|p| finest.strength(p)),
        edge_after: 0.0,
        settled: true,
        held: 0,
        held_at: None,
        slowed: 0,
        crossed_before: limits.crossed_before(),
        crossing: None,
    };
    for &sigma in &scales {
        let is_finest = sigma == options.sigma;
        let own;
        let edges = if is_finest {
            &finest
        } else {
            own = Edges::new(image, weights, points, sigma, coarsest)?;
            &own
        };
        let mut share = 1.0;
        report.settled = false;
        for _ in 0..ROUNDS {
            let Round { steps, ends, held } = round(&curve, edges, options, sigma, share);
            report.steps += steps;
            report.held = held.len();
            report.held_at = held.first().map(|&i| ends[i]);
            let faded = !is_finest || share <= LEAST;
            let moved = farthest(&curve.points, &ends);
            if moved > 0.0 {
                let (next, is_whole) = limits.stepped(&curve, &ends)?;
                report.slowed += usize::from(!is_whole);
                let is_stuck = next.is_none();
                curve = next.unwrap_or(curve);
                // Without a way on, stiffer or softer ones end here, too.
                if is_stuck && faded {
                    break;
                }
            }
            if moved <= SETTLED && faded {
                report.settled = true;
                break;
            }
            if !faded {
                share *= FADING;
            }
        }
    }
    let gone = curve.given();
    report.farthest = farthest(points, &gone);
    let ways = points.iter().zip(&gone);
    report.mean = ways.map(|(from, to)| from.distance(*to)).sum::<f64>() / points.len() as f64;
    report.edge_after = curve.mean(|p| finest.strength(p));
    let result = curve.result(options.points);
    report.crossing = limits.crossing(&result);
    Ok((result, report))
}

/// The longest way from points to others.
fn farthest(points: &[DVec2], others: &[DVec2]) -> f64 {
    let ways = points.iter().zip(others);
    ways.map(|(from, to)| from.distance(*to))
        .fold(0.0, f64::max)
}

/// What a round comes to.
struct Round {
    /// How many steps it took.
    steps: usize,
    /// Where the points end.
    ends: Vec<DVec2>,
    /// Those that the reach held back in the last step.
    held: Vec<usize>,
}

/// Relaxes a curve from its present shape as rest shape.
fn round(curve: &Curve, edges: &Edges, options: &Snake, sigma: f64, share: f64) -> Round {
    let mut round = Round {
        steps: 0,
        ends: curve.points.clone(),
        held: Vec::new(),
    };
    let reference = edges.reference(curve, SEEN * sigma);
    if reference <= 0.0 {
        return round;
    }
    let fixed = !options.closed && options.ends == Ends::Fixed;
    let squared = sigma * sigma;
    let stiffness = Stiffness::new(
        &curve.lengths(),
        options.closed,
        fixed,
        share * options.alpha * squared,
        share * options.beta * squared * squared,
    );
    let origins = curve.origins();
    let rest = &curve.points;
    let mut now = curve.with_points(rest.clone());
    let mut next = vec![DVec2::ZERO; rest.len()];
    for _ in 0..STEPS {
        // The step of time is 1: the force near an edge is the distance to it, so that larger ones would overshoot.
        parallel::chunks(&mut next, TOGETHER, |run, next| {
            for (i, next) in (run * TOGETHER..).zip(next) {
                let (normal, p) = (now.normal(i), now.points[i]);
                let force = edges.slope(p) * (squared / reference);
                *next = p - rest[i] + normal * normal.dot(force);
            }
        });
        stiffness.solve(&mut next);
        let mut change = 0.0_f64;
        round.held.clear();
        let each = next.iter().zip(rest).zip(&origins).zip(&mut now.points);
        for (i, (((next, rest), &origin), point)) in each.enumerate() {
            let wanted = *rest + *next;
            let near = held(wanted, origin, options.reach);
            if near.distance(wanted) > 0.1 * SETTLED {
                round.held.push(i);
            }
            // The part of the image is convex and holds all of the first shape, so that this leads no farther from it.
            let to = edges.within(near);
            change = change.max(to.distance(*point));
            *point = to;
        }
        round.steps += 1;
        if change < 0.2 * SETTLED {
            break;
        }
    }
    round.ends = now.points;
    round
}
