//! Free-form deformation with frame features: every control point of a Bernstein lattice carries a coordinate frame.
//!
//! Computes `p̃ = p + Σ_ijk B_i B_j B_k (A_ijk − I)⟨p⟩`, where `A_ijk` takes the rest frame at control point `P_ijk` to its
//! target. Turning one frame turns the model about it, which no moving of points can do.
//!
//! *Source*: Milliron et al. 2002, §5.1, Figs. 13–14. Errata F3: outside the box nothing moves; that the outer planes'
//! frames are the identity transformation is *sufficient* for continuity across the faces.

use super::bernstein::{MOST_POINTS, control_point, end_derivatives, lattice_note};
use super::grid::face_smoothness;
use super::{Grid, LatticeError};
use anamorph_core::{
    Address, Affine, Condition, Deformation, Facts, Influences, Linear, Mark, Role, Scaling, Shape,
    Site, Smoothness, Space, Transformation, Unmapped, Warp,
};
use anamorph_fields::basis;

/// A Bernstein lattice of frames.
pub struct FrameLattice<S: Space> {
    grid: Grid<S>,
    transformations: Vec<Box<dyn Transformation<S>>>,
    /// `A − I` for the transformations that are not the identity, with their flat indices.
    active: Vec<(usize, S::Linear, S)>,
    facts: Facts<S>,
}

impl<S: Space> FrameLattice<S> {
    /// The lattice on `grid` whose control frame `i` (flat, last index fastest) undergoes `transformations[i]`, an affine
    /// map of space (usually about the control point).
    ///
    /// # Errors
    /// [`LatticeError`] for fewer than two or more than 32 points along an axis, a list of the wrong length, or a
    /// transformation that is not finite.
    pub fn construct(
        grid: Grid<S>,
        transformations: Vec<Box<dyn Transformation<S>>>,
    ) -> Result<Self, LatticeError> {
        for (axis, &points) in grid.shape().iter().enumerate().take(S::DIM) {
            if !(2..=MOST_POINTS).contains(&points) {
                let need = format!("a lattice of frames takes 2 to {MOST_POINTS}");
                return Err(LatticeError::Shape { axis, points, need });
            }
        }
        if transformations.len() != grid.len() {
            return Err(LatticeError::Count {
                expected: grid.len(),
                found: transformations.len(),
            });
        }
        let mut active = Vec::new();
        for (index, transformation) in transformations.iter().enumerate() {
            let affine = transformation.affine();
            if !affine.is_finite() {
                return Err(LatticeError::NotFinite { index });
            }
            if affine != Affine::IDENTITY {
                active.push((
                    index,
                    affine.linear - S::Linear::IDENTITY,
                    affine.translation,
                ));
            }
        }
        let mut lattice = Self {
            grid,
            transformations,
            active,
            facts: Facts::identity(),
        };
        lattice.facts = lattice.derive_facts();
        Ok(lattice)
    }

    /// The box and its grid.
    pub fn grid(&self) -> &Grid<S> {
        &self.grid
    }

    /// Rest position of a control frame's origin: evenly spaced in the box.
    pub fn control_point(&self, flat: usize) -> S {
        control_point(&self.grid, flat)
    }

    fn derive_facts(&self) -> Facts<S> {
        if self.active.is_empty() {
            return Facts::identity();
        }
        let size = self.grid.bounds().diagonal();
        let entries = |linear: &S::Linear, translation: S| {
            let mut list: Vec<f64> = (0..S::DIM).map(|i| translation.component(i)).collect();
            for column in 0..S::DIM {
                list.extend((0..S::DIM).map(|row| linear.entry(row, column) * size));
            }
            list
        };
        let mut moves = vec![vec![0.0; S::DIM * (S::DIM + 1)]; self.grid.len()];
        let mut scale = 0.0_f64;
        for (flat, linear, translation) in &self.active {
            moves[*flat] = entries(linear, *translation);
            scale = moves[*flat].iter().fold(scale, |m, e| m.max(e.abs()));
        }
        let derivative = |axis: usize, order: u8, end: bool| {
            end_derivatives(self.grid.shape()[axis], usize::from(order), end)
        };
        let edge = face_smoothness(&self.grid, Smoothness::Smooth, scale, derivative, &|flat| {
            moves[flat].clone()
        });
        let note = lattice_note(
            edge,
            "identity frames on the outer k + 1 planes suffice for C^k",
        );
        let moved = self
            .active
            .iter()
            .map(|(flat, ..)| &self.transformations[*flat]);
        let translations_only = moved.clone().all(Transformation::is_translation);
        let strength_blends = moved
            .clone()
            .all(|t| t.is_translation() || t.scaling() == Scaling::Displacement);
        let support = self.grid.support();
        Facts {
            support,
            edge,
            translations_only,
            strength_blends,
            ..Facts::identity()
        }
        .with_note(note)
    }

    fn basis(&self, local: S, derivative_axis: Option<usize>) -> [Vec<f64>; 3] {
        core::array::from_fn(|axis| {
            let mut values = vec![1.0; self.grid.shape()[axis]];
            if axis < S::DIM {
                let t = local.component(axis);
                if derivative_axis == Some(axis) {
                    basis::bernstein::derivatives(t, &mut values);
                } else {
                    basis::bernstein::values(t, &mut values);
                }
            }
            values
        })
    }

    /// The frames before and after, and the cage, for pictures.
    pub fn marks(&self) -> Vec<Mark<S>> {
        let rest: Vec<S> = (0..self.grid.len())
            .map(|i| self.control_point(i))
            .collect();
        let still = vec![false; rest.len()];
        let mut moved = still.clone();
        let mut targets = rest.clone();
        for (flat, ..) in &self.active {
            moved[*flat] = true;
            targets[*flat] = self.transformations[*flat].affine().apply(rest[*flat]);
        }
        let mut marks = self.grid.cage(&rest, &moved, false);
        marks.extend(self.grid.cage(&targets, &moved, true));
        let shape = self.grid.shape();
        for (flat, ..) in &self.active {
            let affine = self.transformations[*flat].affine();
            for (axis, &count) in shape.iter().enumerate().take(S::DIM) {
                #[allow(clippy::cast_precision_loss)]
                let edge = self.grid.edges().column(axis) * (0.6 / (count.max(2) - 1) as f64);
                let (from, to) = (rest[*flat], rest[*flat] + edge);
                marks.push(Mark::new(Role::Source, Shape::Arrow(from, to)));
                marks.push(Mark::new(
                    Role::Target,
                    Shape::Arrow(affine.apply(from), affine.apply(to)),
                ));
            }
        }
        marks
    }
}

impl<S: Space> Deformation<S> for FrameLattice<S> {
    fn map(&self, site: &Site<S>) -> S {
        let Some(local) = self.grid.local(site.point) else {
            return site.point;
        };
        let basis = self.basis(local, None);
        let mut moved = S::ZERO;
        for (flat, linear, translation) in &self.active {
            let [i, j, k] = self.grid.triple(*flat);
            moved += (linear.apply(site.point) + *translation)
                * (basis[0][i] * basis[1][j] * basis[2][k]);
        }
        site.point.moved_by(moved)
    }

    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        for (i, point) in points.iter_mut().enumerate() {
            *point = self.map(&Site::new(first + i, *point));
        }
        Unmapped::none()
    }

    fn jacobian(&self, site: &Site<S>, _: f64) -> Option<S::Linear> {
        let Some(local) = self.grid.local(site.point) else {
            return Some(S::Linear::IDENTITY);
        };
        let gradients = self.grid.local_gradients();
        let basis = self.basis(local, None);
        let slopes: Vec<[Vec<f64>; 3]> = (0..S::DIM)
            .map(|axis| self.basis(local, Some(axis)))
            .collect();
        let mut jacobian = S::Linear::IDENTITY;
        for (flat, linear, translation) in &self.active {
            let [i, j, k] = self.grid.triple(*flat);
            let weight = |b: &[Vec<f64>; 3]| b[0][i] * b[1][j] * b[2][k];
            let displacement = linear.apply(site.point) + *translation;
            let mut gradient = S::ZERO;
            for (axis, slopes) in slopes.iter().enumerate() {
                gradient += gradients.column(axis) * weight(slopes);
            }
            jacobian =
                jacobian + *linear * weight(&basis) + S::Linear::outer(displacement, gradient);
        }
        Some(jacobian)
    }

    fn facts(&self) -> Facts<S> {
        self.facts.clone()
    }
}

impl<S: Space> Warp<S> for FrameLattice<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        let Some(local) = self.grid.local(site.point) else {
            return;
        };
        let basis = self.basis(local, None);
        for flat in 0..self.grid.len() {
            let [i, j, k] = self.grid.triple(flat);
            let weight = basis[0][i] * basis[1][j] * basis[2][k];
            if weight != 0.0 {
                out.push(
                    Address::of(u32::try_from(flat).unwrap_or(u32::MAX)),
                    1.0,
                    weight,
                );
            }
        }
    }
    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        self.transformations
            .get(address.feature as usize)
            .map_or(Affine::IDENTITY, |t| t.scaled(strength))
    }
    fn conditions(&self) -> Vec<Condition<S>> {
        let moved = self.active.iter();
        moved
            .map(|(flat, ..)| {
                let source = self.control_point(*flat);
                let target = self.transformations[*flat].affine().apply(source);
                Condition {
                    feature: u32::try_from(*flat).unwrap_or(u32::MAX),
                    source,
                    target,
                }
            })
            .collect()
    }
}
