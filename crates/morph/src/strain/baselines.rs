//! What strain fields are measured against: vertices that go straight, and as-rigid-as-possible in-betweens.
//!
//! Straight: `(1 − t) p + t q` for every vertex. As rigid as possible: each element is to go by `R_{γt} ((1 − t) I + t S)`, where `R_γ S` is the
//! polar decomposition of its map and `|γ| ≤ π`, and the vertices make the sum of the squared differences from that least, one vertex
//! going straight. Elements count alike or by area.
//!
//! *Source*: M. Alexa, D. Cohen-Or, D. Levin, *As-Rigid-As-Possible Shape Interpolation*, SIGGRAPH 2000, eqs. (6) to (11).

use super::body::cut;
use super::cells::{Points, Where};
use super::settings::{Settings, Weight};
use super::stitching::Stitching;
use super::system::Kept;
use super::tensor::{Strain, rotation, turn};
use super::{Frame, FrameError, InBetween, Pair, PrepareError, Solution};
use anamorph_core::glam::{DMat2, DVec2};
use std::sync::{Mutex, PoisonError};

/// Every vertex goes straight.
#[derive(Debug, Clone)]
pub struct VertexLinear {
    source: Vec<DVec2>,
    target: Vec<DVec2>,
}

impl VertexLinear {
    /// The in-betweens of a pair.
    pub fn new(pair: &Pair) -> Self {
        Self {
            source: pair.source().to_vec(),
            target: pair.target().to_vec(),
        }
    }
}

impl InBetween for VertexLinear {
    fn name(&self) -> &'static str {
        "vertex-linear"
    }
    fn at(&self, t: f64) -> Result<Frame, FrameError> {
        super::check_time(t)?;
        let pairs = self.source.iter().zip(&self.target);
        Ok(Frame {
            time: t,
            positions: pairs.map(|(a, b)| *a * (1.0 - t) + *b * t).collect(),
            solution: Solution::default(),
        })
    }
    fn frames(&self, times: &[f64]) -> Result<Vec<Frame>, FrameError> {
        super::each_alone(self, times)
    }
}

/// Room for a frame of a part: a factor, right sides and places.
type Room = (Kept, Vec<f64>, Vec<DVec2>);

struct Part {
    vertices: Vec<usize>,
    points: Points,
    stitching: Stitching,
    /// Angles and stretches at the points.
    maps: Vec<(f64, DMat2)>,
    /// The vertex that goes straight.
    pinned: usize,
    rooms: Mutex<Vec<Room>>,
}

/// As-rigid-as-possible in-betweens.
pub struct AsRigidAsPossible {
    straight: VertexLinear,
    parts: Vec<Part>,
}

impl AsRigidAsPossible {
    /// Prepares the in-betweens of a pair: [`Settings::pinned`] goes straight, and in parts without it the first vertex.
    ///
    /// # Errors
    /// [`PrepareError`] for a pinned vertex that there is not.
    pub fn new(pair: &Pair, settings: &Settings) -> Result<Self, PrepareError> {
        let pinned = settings.pinned;
        let there = |vertices: &[usize]| vertices.binary_search(&pinned).ok();
        if !pair.parts().iter().any(|p| there(&p.vertices).is_some()) {
            return Err(PrepareError::NoAnchor { vertex: pinned });
        }
        let even = settings.weight == Weight::None;
        let mut parts = Vec::new();
        for part in pair.parts() {
            let (elements, source, target) = cut(pair, part);
            let points = Points::new(&elements, &source, Where::Gauss);
            let pinned = there(&part.vertices).unwrap_or(0);
            let stitching = Stitching::new(&points, source.len(), pinned, even)?;
            let mut maps = Vec::with_capacity(points.len());
            points.each_gradient(&target, |_, _, gradient| {
                let angle = rotation(gradient);
                maps.push((angle, turn(-angle) * gradient));
            });
            parts.push(Part {
                vertices: part.vertices.clone(),
                points,
                stitching,
                maps,
                pinned,
                rooms: Mutex::default(),
            });
        }
        Ok(Self {
            straight: VertexLinear::new(pair),
            parts,
        })
    }
}

impl InBetween for AsRigidAsPossible {
    fn name(&self) -> &'static str {
        "as-rigid-as-possible"
    }

    fn at(&self, t: f64) -> Result<Frame, FrameError> {
        let mut frame = self.straight.at(t)?;
        for part in &self.parts {
            let rooms = || part.rooms.lock().unwrap_or_else(PoisonError::into_inner);
            let count = part.vertices.len();
            let taken = rooms().pop();
            let (mut factor, mut right, mut places) = taken.unwrap_or_else(|| {
                (
                    Kept::default(),
                    vec![0.0; 2 * count],
                    vec![DVec2::ZERO; count],
                )
            });
            let between = |point: usize| {
                let (angle, stretch) = part.maps[point];
                turn(t * angle) * (DMat2::IDENTITY * (1.0 - t) + stretch * t)
            };
            let solved =
                part.stitching
                    .places(&part.points, &mut factor, between, &mut right, &mut places);
            let origin = frame.positions[part.vertices[part.pinned]];
            for (&vertex, place) in part.vertices.iter().zip(&places) {
                frame.positions[vertex] = origin + *place;
            }
            rooms().push((factor, right, places));
            solved.map_err(|error| FrameError::Solver { time: t, error })?;
        }
        Ok(frame)
    }

    fn frames(&self, times: &[f64]) -> Result<Vec<Frame>, FrameError> {
        super::each_alone(self, times)
    }

    fn wanted(&self, target: Strain, t: f64) -> Option<Strain> {
        let stretch = target.stretch().matrix();
        Some(Strain::of(DMat2::IDENTITY * (1.0 - t) + stretch * t))
    }
}
