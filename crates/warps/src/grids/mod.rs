//! A grid of nodes in the plane: each cell follows its corners.
//!
//! Computes `p̃ = p + Σ_ij N_i(x) N_j(y) (P*_ij − P_ij)` between the first and last column and row, a point outside stays. `N` are
//! the hat functions of the columns and rows (each cell is bilinear), or cubics that meet the nodes with the slope of the
//! chord between their neighbours, at the ends of the chord to the only one (Catmull–Rom's on even spacing). As terms of eq. (3):
//! the nodes' displacements are translations, `N_i N_j` their strengths, summed without an average because cubics have negative parts.
//!
//! *Source*: N. Burtnyk, M. Wein, *Interactive Skeleton Techniques for Enhancing Motion Dynamics in Key Frame Animation*, CACM
//! 19(10), 1976; *Interpolation Techniques*, slides, "2-D grid deformation"; E. Catmull, R. Rom, *A Class of Local Interpolating
//! Splines*, 1974, by G. Wolberg's mesh warping, *Digital Image Warping* 1990, §7.7.

#[cfg(feature = "recipe")]
pub(crate) mod parameters;

use anamorph_core::glam::dvec2;
use anamorph_core::{
    Address, Affine, Average, Bounds, Condition, Deformation, Facts, Influences, Linear, Mark,
    Plane, Role, Shape, Site, Smoothness, Space, Support, Unmapped, Warp, evaluate,
    evaluate_points,
};

/// Most nodes of a grid.
pub const MOST_NODES: usize = 1 << 20;

/// What is wrong with a grid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GridError {
    /// Fewer than two columns or rows.
    #[error("there are {count} {what}, and a grid has at least 2")]
    TooFew {
        /// `columns` or `rows`.
        what: &'static str,
        /// How many.
        count: usize,
    },
    /// Columns or rows that do not ascend.
    #[error(
        "number {index} of the {what} does not lie behind the one before it; give finite numbers that ascend"
    )]
    Order {
        /// `columns` or `rows`.
        what: &'static str,
        /// Which, from 0.
        index: usize,
    },
    /// Too many nodes.
    #[error("the grid has {columns} by {rows} nodes, and at most {MOST_NODES} are served")]
    TooMany {
        /// How many columns.
        columns: usize,
        /// How many rows.
        rows: usize,
    },
    /// A list of displacements of the wrong length.
    #[error(
        "there are {found} displacements for {expected} nodes; give one for each, column by column"
    )]
    Count {
        /// How many nodes.
        expected: usize,
        /// How many displacements.
        found: usize,
    },
    /// A displacement that is not finite.
    #[error("node {node} moves to a place that is not finite; move it less")]
    NotFinite {
        /// The node, counted column by column.
        node: usize,
    },
}

/// How displacements go on between nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Between {
    /// Each cell is bilinear: continuous, with creases along columns and rows.
    Bilinear,
    /// Bicubic: no creases.
    Smooth,
}

/// Four nodes in a row from `first` on, and their shares.
struct Shares {
    first: usize,
    values: [f64; 4],
    slopes: [f64; 4],
}

/// A grid and the displacements of its nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct GridWarp {
    columns: Vec<f64>,
    rows: Vec<f64>,
    between: Between,
    displacements: Vec<Plane>,
    facts: Facts<Plane>,
}

/// Shares of the nodes about `x`; `None` outside.
fn shares(at: &[f64], x: f64, between: Between) -> Option<Shares> {
    let last = at.len() - 1;
    if !(at[0]..=at[last]).contains(&x) {
        return None;
    }
    let span = at.partition_point(|&node| node <= x).clamp(1, last) - 1;
    let width = at[span + 1] - at[span];
    let t = (x - at[span]) / width;
    if between == Between::Bilinear {
        return Some(Shares {
            first: span,
            values: [1.0 - t, t, 0.0, 0.0],
            slopes: [-1.0 / width, 1.0 / width, 0.0, 0.0],
        });
    }
    // Hermite's cubics: shares of the ends, and of the slopes there, times the width.
    let (left, right) = (span.max(1) - 1, (span + 2).min(last));
    let chords = [at[span + 1] - at[left], at[right] - at[span]].map(|chord| width / chord);
    let u = 1.0 - t;
    let parts = |ends: [f64; 2], inner: [f64; 2]| {
        let [a, b] = [inner[0] * chords[0], inner[1] * chords[1]];
        // The slope at the left end is the chord from `left` to the right end, that at the right end from the left end to `right`.
        let mut list = [-a, ends[0] - b, ends[1] + a, b];
        if left == span {
            list[1] += list[0];
            list[0] = 0.0;
        }
        if right == span + 1 {
            list[2] += list[3];
            list[3] = 0.0;
        }
        if left == span {
            list = [list[1], list[2], list[3], 0.0];
        }
        list
    };
    let values = parts(
        [(1.0 + 2.0 * t) * u * u, (1.0 + 2.0 * u) * t * t],
        [t * u * u, -t * t * u],
    );
    let rise = 6.0 * t * u / width;
    let slopes = parts(
        [-rise, rise],
        [u * (u - 2.0 * t) / width, t * (t - 2.0 * u) / width],
    );
    Some(Shares {
        first: left,
        values,
        slopes,
    })
}

impl GridWarp {
    /// The grid with nodes at the crossings of `columns` (their x, ascending) and `rows` (their y), whose node `(i, j)` moves by
    /// `displacements[i · rows + j]`.
    ///
    /// # Errors
    /// [`GridError`] for fewer than two columns or rows, such as do not ascend, a list of the wrong length, and displacements
    /// that are not finite.
    pub fn construct(
        columns: Vec<f64>,
        rows: Vec<f64>,
        between: Between,
        displacements: Vec<Plane>,
    ) -> Result<Self, GridError> {
        for (what, list) in [("columns", &columns), ("rows", &rows)] {
            if list.len() < 2 {
                let count = list.len();
                return Err(GridError::TooFew { what, count });
            }
            let ascends = |i: usize| {
                let width = list[i] - if i == 0 { 0.0 } else { list[i - 1] };
                // Wide enough that its reciprocal is a number.
                list[i].is_finite() && (i == 0 || width >= f64::MIN_POSITIVE && width.is_finite())
            };
            if let Some(index) = (0..list.len()).find(|&i| !ascends(i)) {
                return Err(GridError::Order { what, index });
            }
        }
        let (width, height) = (columns.len(), rows.len());
        let expected = width.saturating_mul(height);
        if expected > MOST_NODES {
            return Err(GridError::TooMany {
                columns: width,
                rows: height,
            });
        }
        if displacements.len() != expected {
            let found = displacements.len();
            return Err(GridError::Count { expected, found });
        }
        if let Some(node) = displacements.iter().position(|d| !d.is_finite()) {
            return Err(GridError::NotFinite { node });
        }
        let mut warp = Self {
            columns,
            rows,
            between,
            displacements,
            facts: Facts::identity(),
        };
        warp.facts = warp.derive_facts();
        Ok(warp)
    }

    /// The places of the nodes of a grid, column by column.
    pub fn nodes(columns: &[f64], rows: &[f64]) -> Vec<Plane> {
        let column = |&x: &f64| rows.iter().map(move |&y| dvec2(x, y));
        columns.iter().flat_map(column).collect()
    }

    /// The displacements of the nodes, column by column.
    pub fn displacements(&self) -> &[Plane] {
        &self.displacements
    }

    /// Whether all nodes within `rings` of the border stay.
    fn still(&self, rings: usize) -> bool {
        let (width, height) = (self.columns.len(), self.rows.len());
        let outer = |i: usize, count: usize| i < rings || i + rings >= count;
        let nodes = self.displacements.iter().enumerate();
        nodes
            .filter(|(node, _)| outer(node / height, width) || outer(node % height, height))
            .all(|(_, d)| *d == Plane::ZERO)
    }

    fn derive_facts(&self) -> Facts<Plane> {
        if self.displacements.iter().all(|d| *d == Plane::ZERO) {
            return Facts::identity();
        }
        let inside = match (self.between, self.displacements.len()) {
            // A single cell is one polynomial.
            (_, 4) => Smoothness::Smooth,
            (Between::Bilinear, _) => Smoothness::C(0),
            (Between::Smooth, _) => Smoothness::C(1),
        };
        let edge = match (self.between, self.still(1)) {
            (_, false) => Smoothness::Jump,
            (Between::Smooth, true) if self.still(2) => Smoothness::C(1),
            _ => Smoothness::C(0),
        };
        let corner = |pick: fn(&Vec<f64>) -> f64| dvec2(pick(&self.columns), pick(&self.rows));
        let bounds = Bounds::new(corner(|list| list[0]), corner(|list| list[list.len() - 1]));
        let facts = Facts {
            support: Support::Box(bounds),
            inside,
            edge,
            stretch: (self.between == Between::Bilinear).then(|| self.steepest()),
            ..Facts::identity()
        };
        if edge == Smoothness::Jump {
            facts.with_note("nodes of the border move: the warp jumps at the edge of the grid; keep the outer nodes still")
        } else {
            facts
        }
    }

    /// A bound of the derivative of the displacement of bilinear cells: along an axis it is between those of the cell's two edges.
    fn steepest(&self) -> f64 {
        let (width, height) = (self.columns.len(), self.rows.len());
        let apart = |a: usize, b: usize| self.displacements[a].distance(self.displacements[b]);
        let (mut along, mut up) = (0.0_f64, 0.0_f64);
        for i in 0..width {
            for j in 0..height {
                let node = i * height + j;
                if i + 1 < width {
                    let step = self.columns[i + 1] - self.columns[i];
                    along = along.max(apart(node, node + height) / step);
                }
                if j + 1 < height {
                    let step = self.rows[j + 1] - self.rows[j];
                    up = up.max(apart(node, node + 1) / step);
                }
            }
        }
        dvec2(along, up).length() * (1.0 + 1e-9)
    }

    /// The grid before and after, for pictures.
    pub fn marks(&self) -> Vec<Mark<Plane>> {
        let rest = Self::nodes(&self.columns, &self.rows);
        let moved: Vec<Plane> = rest
            .iter()
            .zip(&self.displacements)
            .map(|(&p, &d)| p + d)
            .collect();
        let mut marks = Vec::new();
        for (points, role) in [(rest, Role::SourceGuide), (moved, Role::Target)] {
            let height = self.rows.len();
            let mut line =
                |points: Vec<Plane>| marks.push(Mark::new(role, Shape::Polyline(points)));
            for column in points.chunks_exact(height) {
                line(column.to_vec());
            }
            for j in 0..height {
                line(points[j..].iter().copied().step_by(height).collect());
            }
        }
        marks
    }
}

impl Deformation<Plane> for GridWarp {
    fn map(&self, site: &Site<Plane>) -> Plane {
        evaluate(self, site)
    }
    fn map_points(&self, first: usize, points: &mut [Plane]) -> Unmapped {
        evaluate_points(self, first, points)
    }
    fn facts(&self) -> Facts<Plane> {
        self.facts.clone()
    }

    /// `J = I + Σ d_ij ∇(N_i N_j)ᵀ`; on a crease that of the cell to the right and above, on the last column and row to the left and below.
    fn jacobian(&self, site: &Site<Plane>, _: f64) -> Option<<Plane as Space>::Linear> {
        let mut jacobian = <Plane as Space>::Linear::IDENTITY;
        let along = shares(&self.columns, site.point.x, self.between);
        let up = shares(&self.rows, site.point.y, self.between);
        if let (Some(along), Some(up)) = (along, up) {
            for i in 0..4 {
                for j in 0..4 {
                    let node = (along.first + i) * self.rows.len() + up.first + j;
                    let gradient = dvec2(
                        along.slopes[i] * up.values[j],
                        along.values[i] * up.slopes[j],
                    );
                    if gradient != Plane::ZERO
                        && let Some(&d) = self.displacements.get(node)
                    {
                        jacobian += <Plane as Space>::Linear::outer(d, gradient);
                    }
                }
            }
        }
        Some(jacobian)
    }
}

impl Warp<Plane> for GridWarp {
    fn influences(&self, site: &Site<Plane>, out: &mut Influences) {
        let Some(along) = shares(&self.columns, site.point.x, self.between) else {
            return;
        };
        let Some(up) = shares(&self.rows, site.point.y, self.between) else {
            return;
        };
        for (i, x) in along.values.into_iter().enumerate() {
            for (j, y) in up.values.into_iter().enumerate() {
                if x * y != 0.0 {
                    let node = (along.first + i) * self.rows.len() + up.first + j;
                    let address = Address::of(u32::try_from(node).unwrap_or(u32::MAX));
                    out.push(address, x * y, 1.0);
                }
            }
        }
    }
    fn scaled(&self, address: Address, strength: f64) -> Affine<Plane> {
        let displacement = self.displacements.get(address.feature as usize);
        Affine::translation(displacement.copied().unwrap_or(Plane::ZERO) * strength)
    }
    fn average(&self) -> Average {
        Average::Plain
    }
    fn conditions(&self) -> Vec<Condition<Plane>> {
        let nodes = Self::nodes(&self.columns, &self.rows);
        let all = nodes.into_iter().zip(&self.displacements).enumerate();
        all.filter(|(_, (_, d))| **d != Plane::ZERO)
            .map(|(node, (source, &d))| Condition {
                feature: u32::try_from(node).unwrap_or(u32::MAX),
                source,
                target: source + d,
            })
            .collect()
    }
}
