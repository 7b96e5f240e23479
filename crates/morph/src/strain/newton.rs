//! Newton's search for the least energy.
//!
//! Steps solve `K d = −φ`, eq. (11). The projected search takes the true Hessian where its factor exists, which is where it is positive
//! definite on the free numbers, and else the sum of what is positive at each point; it is ended by a step of the true one alone. Steps
//! go no farther than nine tenths of the way to the first place at which an element has no area, and down by Armijo's rule.
//! Moves and turns as a whole, which change no energy, are taken out of steps. Between two factors come corrections with the one that is there, as
//! long as they shrink fast, since a factor costs as much as several of them.
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004, eqs. (9) to (12); J. Smith, S. Schaefer, *Bijective
//! Parameterization with Free Boundaries*, SIGGRAPH 2015, §3; J. Teran et al., *Robust Quasistatic Finite Elements and Flesh Simulation*,
//! 2005; errata S5 and S5b.

use super::body::Body;
use super::energy::{BarrierTerm, Curvature, StrainTerm, Sums};
use super::system::Kept;
use super::tensor::{Strain, cross};
use super::untangle::{self, UntangleTerm};
use anamorph_core::glam::{DMat2, DVec2};
use anamorph_solvers::SolverError;

/// Steps after which a search is given up.
const MOST_STEPS: usize = 120;
/// A correction is worth more than a new factor while it is less than this share of the one before.
const SHRINKS: f64 = 0.6;
/// Steps that are shorter, in units of the root of the area, are near enough to the end to go on with less.
const NEAR: f64 = 1e-2;
/// Corrections that cost about as much as a factor.
const MOST_CORRECTIONS: usize = 12;
/// Steps with positive parts alone, one after the other, after which the true matrix is taken with a little on its diagonal.
const CRAWLS: usize = 3;
/// Of the way to the first element without area.
const SHARE: f64 = 0.9;
/// Determinants below this share of those wanted are held up by the barrier, where it is on.
pub(crate) const THRESHOLD: f64 = 0.1;
/// Steps in which turned elements are turned back.
const MOST_UNTANGLING: usize = 100;
/// Steps after that, and the share of the energy below which they end.
const MOST_POLISHING: usize = 15;
const POLISHED: f64 = 1e-3;

/// Room for the search, used again from frame to frame; nothing of a frame is left for the next.
#[derive(Default)]
pub(crate) struct Room {
    /// Where the vertices are.
    pub(crate) positions: Vec<DVec2>,
    trial: Vec<DVec2>,
    gradient: Vec<DVec2>,
    fixed: Vec<DVec2>,
    step: Vec<DVec2>,
    memory: Memory,
    values: Vec<f64>,
    pub(crate) right: Vec<f64>,
    /// Strains wanted, domain by domain.
    pub(crate) wanted: Vec<Vec<Strain>>,
    /// Determinants that the barrier begins at.
    pub(crate) thresholds: Vec<f64>,
    factor: Kept,
    pub(crate) stitch: Kept,
}

impl Room {
    pub(crate) fn new(body: &Body) -> Self {
        let count = body.source.len();
        let zeros = || vec![DVec2::ZERO; count];
        Self {
            positions: zeros(),
            trial: zeros(),
            gradient: zeros(),
            fixed: zeros(),
            step: zeros(),
            memory: Memory::default(),
            values: vec![0.0; body.system.len() + 1],
            right: vec![0.0; 2 * count],
            wanted: body.domains.iter().map(|_| Vec::new()).collect(),
            thresholds: Vec::new(),
            factor: Kept::default(),
            stitch: Kept::default(),
        }
    }
}

/// What is asked of a search.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Search {
    pub(crate) shear: f64,
    pub(crate) tolerance: f64,
    /// Whether elements may not be turned over.
    pub(crate) guarded: bool,
    /// Whether determinants are held up.
    pub(crate) barrier: bool,
}

/// Why a search ended before its end.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Halt {
    /// No step led down, or there were too many.
    Stalled,
    /// The Hessian is not positive definite, and was to be taken as it is.
    Indefinite,
    /// The equations could not be solved.
    Solver(SolverError),
}

/// How much was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Effort {
    pub(crate) steps: usize,
    pub(crate) projected: usize,
    pub(crate) corrections: usize,
}

impl std::ops::AddAssign for Effort {
    fn add_assign(&mut self, other: Self) {
        self.steps += other.steps;
        self.projected += other.projected;
        self.corrections += other.corrections;
    }
}

/// The energy of places.
pub(crate) fn energy(
    body: &Body,
    wanted: &[Vec<Strain>],
    thresholds: Option<&[f64]>,
    shear: f64,
    positions: &[DVec2],
) -> f64 {
    let mut sum = 0.0;
    for (domain, wanted) in body.domains.iter().zip(wanted) {
        sum += domain
            .points
            .energy(&StrainTerm { wanted, shear }, positions);
    }
    if let Some(thresholds) = thresholds {
        let stiffness = &body.stiffness;
        sum += body.guards.energy(
            &BarrierTerm {
                thresholds,
                stiffness,
            },
            positions,
        );
    }
    sum
}

/// The largest component of the energy's gradient.
pub(crate) fn residual(body: &Body, room: &mut Room, shear: f64) -> f64 {
    slopes(body, room, shear, false);
    largest(&room.gradient)
}

/// The gradient alone.
fn slopes(body: &Body, room: &mut Room, shear: f64, barrier: bool) {
    let Room {
        positions,
        gradient,
        wanted,
        thresholds,
        ..
    } = room;
    gradient.fill(DVec2::ZERO);
    for (domain, wanted) in body.domains.iter().zip(&*wanted) {
        let term = StrainTerm { wanted, shear };
        domain.points.gradient(&term, positions, gradient);
    }
    if barrier {
        let term = BarrierTerm {
            thresholds,
            stiffness: &body.stiffness,
        };
        body.guards.gradient(&term, positions, gradient);
    }
}

fn largest(list: &[DVec2]) -> f64 {
    list.iter().fold(0.0_f64, |most, d| {
        let size = d.abs().max_element();
        if size > most || size.is_nan() {
            size
        } else {
            most
        }
    })
}

/// The gradient and the matrix; returns the energy.
fn assemble(body: &Body, room: &mut Room, search: Search, curvature: Curvature) -> f64 {
    let Room {
        positions,
        gradient,
        values,
        wanted,
        thresholds,
        ..
    } = room;
    let mut sums = Sums::cleared(gradient, values);
    let places = &body.system.places;
    for (domain, wanted) in body.domains.iter().zip(&*wanted) {
        let term = StrainTerm {
            wanted,
            shear: search.shear,
        };
        domain
            .points
            .assemble(&term, positions, curvature, places, &mut sums);
    }
    if search.barrier {
        let term = BarrierTerm {
            thresholds,
            stiffness: &body.stiffness,
        };
        body.guards
            .assemble(&term, positions, curvature, places, &mut sums);
    }
    let energy = sums.energy;
    body.system.hold(values);
    energy
}

/// Turns the places so that the edge whose end is held across lies along x.
fn level(body: &Body, positions: &mut [DVec2]) {
    let [first, second] = body.gauge;
    let edge = positions[second] - positions[first];
    if edge.y.abs() <= 0.25 * edge.x.abs() {
        return;
    }
    let Some(along) = edge.try_normalize() else {
        return;
    };
    let middle = positions[first];
    for place in positions {
        let from = *place - middle;
        *place = DVec2::new(from.dot(along), along.perp_dot(from));
    }
}

/// Takes the mean move and the mean turn out of a step.
fn without_rigid(positions: &[DVec2], step: &mut [DVec2]) {
    let count = positions.len() as f64;
    let middle = positions.iter().copied().sum::<DVec2>() / count;
    let mean = step.iter().copied().sum::<DVec2>() / count;
    let (mut turn, mut inertia) = (0.0, 0.0);
    for (place, d) in positions.iter().zip(&*step) {
        let arm = (*place - middle).perp();
        turn += arm.dot(*d - mean);
        inertia += arm.length_squared();
    }
    let turn = if inertia > 0.0 { turn / inertia } else { 0.0 };
    for (place, d) in positions.iter().zip(step) {
        *d -= mean + (*place - middle).perp() * turn;
    }
}

/// `−K⁻¹ φ`, `φ` being what stands in `gradient` with `plus` times what stands in `fixed`.
fn solve(body: &Body, room: &mut Room, plus: f64) -> Result<(), SolverError> {
    let Room {
        gradient,
        fixed,
        step,
        right,
        factor,
        ..
    } = room;
    for ((pair, g), f) in right.chunks_exact_mut(2).zip(gradient).zip(fixed) {
        let sum = -(*g + *f * plus);
        pair.copy_from_slice(&[sum.x, sum.y]);
    }
    body.system.still(right);
    factor.solve(right)?;
    for (step, pair) in step.iter_mut().zip(right.chunks_exact(2)) {
        *step = DVec2::new(pair[0], pair[1]);
    }
    Ok(())
}

/// Factors the matrix that stands in `values`; whether it is positive definite.
fn factor(body: &Body, room: &mut Room) -> Result<bool, SolverError> {
    let values = &room.values[..body.system.len()];
    match room.factor.renew(&body.system.symbolic, values) {
        Ok(()) => Ok(true),
        Err(SolverError::NotPositiveDefinite { .. }) => Ok(false),
        Err(other) => Err(other),
    }
}

/// Searches from where the vertices are.
pub(crate) fn projected(body: &Body, room: &mut Room, search: Search) -> Result<Effort, Halt> {
    let mut effort = Effort::default();
    let mut before = f64::INFINITY;
    let (mut crawled, mut lift) = (0, 1e-4);
    for number in 0..MOST_STEPS {
        level(body, &mut room.positions);
        let smooth = number == 0;
        let energy_here = assemble(
            body,
            room,
            search,
            if smooth {
                Curvature::Smooth
            } else {
                Curvature::True
            },
        );
        if !energy_here.is_finite() {
            return Err(Halt::Stalled);
        }
        let whole = factor(body, room).map_err(Halt::Solver)?;
        if whole {
            crawled = 0;
        } else {
            effort.projected += 1;
            crawled += 1;
            let shifted = crawled > CRAWLS && shift(body, room, &mut lift)?;
            if !shifted && !make_positive(body, room, search)? {
                return Err(Halt::Stalled);
            }
        }
        solve(body, room, 0.0).map_err(Halt::Solver)?;
        without_rigid(&room.positions, &mut room.step);
        effort.steps += 1;
        let size = largest(&room.step);
        let mut share = reach(body, room, search);
        let near = size
            < if whole && !smooth {
                search.tolerance
            } else {
                1e-10
            };
        if near && share == 1.0 {
            advance(room, 1.0);
            std::mem::swap(&mut room.positions, &mut room.trial);
            return Ok(effort);
        }
        let slope: f64 = room
            .gradient
            .iter()
            .zip(&room.step)
            .map(|(g, d)| g.dot(*d))
            .sum();
        // What rounding leaves of a sum of squares.
        let noise = 1e-14 * energy_here + 1e-30;
        // Where the least energy is flat, as it is at a vanishing element, steps are long and gain nothing that could be seen.
        if !whole && share == 1.0 && -slope < noise {
            return Ok(effort);
        }
        loop {
            advance(room, share);
            let thresholds = search.barrier.then_some(&room.thresholds[..]);
            let there = energy(body, &room.wanted, thresholds, search.shear, &room.trial);
            if there <= energy_here + 1e-4 * share * slope + noise {
                break;
            }
            share *= 0.5;
            if share * size < 1e-13 || share < 1e-12 {
                return Err(Halt::Stalled);
            }
        }
        std::mem::swap(&mut room.positions, &mut room.trial);
        // Steps that a vanishing element stops lead nowhere.
        if share * size < 1e-9 && !near && before < 1e-9 {
            return Err(Halt::Stalled);
        }
        before = share * size;
        if whole && share == 1.0 && size < 0.5 {
            let more = corrections(body, room, search, size, &mut effort);
            if more.map_err(Halt::Solver)? {
                return Ok(effort);
            }
        }
    }
    Err(Halt::Stalled)
}

/// The sum of what is positive at each point in place of the matrix; whether it has a factor.
fn make_positive(body: &Body, room: &mut Room, search: Search) -> Result<bool, Halt> {
    assemble(body, room, search, Curvature::Positive);
    lift_diagonal(body, room, 1e-9);
    factor(body, room).map_err(Halt::Solver)
}

/// Adds a share of the largest diagonal entry to all of them.
fn lift_diagonal(body: &Body, room: &mut Room, share: f64) {
    let diagonal = &body.system.diagonal;
    let most = diagonal
        .iter()
        .fold(0.0_f64, |most, &k| most.max(room.values[k as usize]));
    for &place in diagonal {
        room.values[place as usize] += share * most;
    }
}

/// The true matrix with as little on its diagonal as makes it positive definite, beginning at what did last time: near a minimum where it
/// is all but singular, Newton's steps are kept by that. Whether little was enough.
fn shift(body: &Body, room: &mut Room, lift: &mut f64) -> Result<bool, Halt> {
    let (mut whole, mut next) = (0.0, (0.1 * *lift).max(1e-12));
    while next < 0.1 {
        lift_diagonal(body, room, next - whole);
        whole = next;
        if factor(body, room).map_err(Halt::Solver)? {
            *lift = whole;
            return Ok(true);
        }
        next *= 10.0;
    }
    Ok(false)
}

/// How much of a step may be made.
fn reach(body: &Body, room: &Room, search: Search) -> f64 {
    if !search.guarded {
        return 1.0;
    }
    let corners = body.corners.iter();
    let first = corners.fold(f64::INFINITY, |least, corner| {
        least.min(corner.first_root(&room.positions, &room.step))
    });
    (SHARE * first).min(1.0)
}

/// Further steps with the factor that is there, as long as each is a part of the one before; whether they came to the end. What the steps so far
/// have told of the Hessian is added to the factor by the formula of Broyden, Fletcher, Goldfarb and Shanno, which keeps it positive definite.
fn corrections(
    body: &Body,
    room: &mut Room,
    search: Search,
    size: f64,
    effort: &mut Effort,
) -> Result<bool, SolverError> {
    let mut before = size;
    room.memory.used = 0;
    for _ in 0..MOST_CORRECTIONS {
        room.fixed.copy_from_slice(&room.gradient);
        slopes(body, room, search.shear, search.barrier);
        if !remember(room) {
            return Ok(false);
        }
        from_memory(body, room)?;
        without_rigid(&room.positions, &mut room.step);
        let size = largest(&room.step);
        let ratio = size / before;
        effort.corrections += 1;
        let most = if size < NEAR { SHRINKS } else { 0.4 * SHRINKS };
        if ratio.is_nan() || ratio >= most || reach(body, room, search) < 1.0 {
            return Ok(false);
        }
        advance(room, 1.0);
        std::mem::swap(&mut room.positions, &mut room.trial);
        // What is left is about the next step.
        if ratio * size < 1e2 * search.tolerance * search.tolerance || size < 1e-14 {
            return Ok(true);
        }
        before = size;
    }
    Ok(false)
}

/// Steps of a search since its last factor.
#[derive(Default)]
struct Memory {
    pairs: Vec<Pair>,
    used: usize,
}

/// A step and what it changed the gradient by, one over their product, and room for a number.
#[derive(Default)]
struct Pair {
    step: Vec<DVec2>,
    change: Vec<DVec2>,
    inverse: f64,
    share: f64,
}

fn product(a: &[DVec2], b: &[DVec2]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}

/// Keeps the last step, at whose begin the gradient was what stands in `fixed`; whether the energy is convex along it.
fn remember(room: &mut Room) -> bool {
    let Memory { pairs, used } = &mut room.memory;
    if pairs.len() == *used {
        pairs.push(Pair::default());
    }
    let Some(pair) = pairs.get_mut(*used) else {
        return false;
    };
    *used += 1;
    pair.step.clear();
    pair.step.extend_from_slice(&room.step);
    pair.change.clear();
    let gradients = room.gradient.iter().zip(&room.fixed);
    pair.change
        .extend(gradients.map(|(now, then)| *now - *then));
    let convex = product(&pair.step, &pair.change);
    pair.inverse = 1.0 / convex;
    convex > 0.0 && pair.inverse.is_finite()
}

/// The step that the factor and the memory give: two loops around a solution.
fn from_memory(body: &Body, room: &mut Room) -> Result<(), SolverError> {
    let Room {
        gradient,
        trial,
        step,
        right,
        factor,
        memory,
        ..
    } = room;
    trial.copy_from_slice(gradient);
    let pairs = &mut memory.pairs[..memory.used];
    for pair in pairs.iter_mut().rev() {
        pair.share = pair.inverse * product(&pair.step, trial);
        for (left, change) in trial.iter_mut().zip(&pair.change) {
            *left -= *change * pair.share;
        }
    }
    for (numbers, left) in right.chunks_exact_mut(2).zip(&*trial) {
        numbers.copy_from_slice(&[-left.x, -left.y]);
    }
    body.system.still(right);
    factor.solve(right)?;
    for (step, numbers) in step.iter_mut().zip(right.chunks_exact(2)) {
        *step = DVec2::new(numbers[0], numbers[1]);
    }
    for pair in pairs {
        let back = pair.share + pair.inverse * product(&pair.change, step);
        for (step, other) in step.iter_mut().zip(&pair.step) {
            *step -= *other * back;
        }
    }
    Ok(())
}

fn advance(room: &mut Room, share: f64) {
    let moved = room.positions.iter().zip(&room.step);
    for (to, (from, d)) in room.trial.iter_mut().zip(moved) {
        *to = *from + *d * share;
    }
}

/// Turns elements back from where the vertices are, towards stretches with those inverses at the guards. Whether all lie right then.
pub(crate) fn untangle(
    body: &Body,
    room: &mut Room,
    inverses: &[DMat2],
    effort: &mut Effort,
) -> Result<bool, Halt> {
    let least = |positions: &[DVec2]| {
        let mut least = f64::INFINITY;
        body.guards.each_gradient(positions, |point, _, gradient| {
            let det = cross(gradient.x_axis, gradient.y_axis) * inverses[point].determinant();
            least = if det < least || det.is_nan() {
                det
            } else {
                least
            };
        });
        least
    };
    let (mut smallest, mut polished) = (least(&room.positions), 0);
    for _ in 0..MOST_UNTANGLING {
        level(body, &mut room.positions);
        let epsilon = untangle::epsilon(smallest);
        let term = UntangleTerm {
            inverses,
            shares: &body.shares,
            epsilon,
        };
        let Room {
            positions,
            gradient,
            values,
            ..
        } = room;
        let mut sums = Sums::cleared(gradient, values);
        let places = &body.system.places;
        body.guards
            .assemble(&term, positions, Curvature::Positive, places, &mut sums);
        let energy_here = sums.energy;
        body.system.hold(values);
        if !energy_here.is_finite() || !factor(body, room).map_err(Halt::Solver)? {
            break;
        }
        solve(body, room, 0.0).map_err(Halt::Solver)?;
        without_rigid(&room.positions, &mut room.step);
        effort.steps += 1;
        effort.projected += 1;
        let pairs = room.gradient.iter().zip(&room.step);
        let slope: f64 = pairs.map(|(g, d)| g.dot(*d)).sum();
        let (mut share, mut gained) = (1.0, None);
        for _ in 0..40 {
            advance(room, share);
            let there = body.guards.energy(&term, &room.trial);
            let lowest = least(&room.trial);
            if there <= energy_here + 1e-4 * share * slope && (smallest <= 0.0 || lowest > 0.0) {
                gained = Some((energy_here - there, lowest));
                break;
            }
            share *= 0.5;
        }
        let Some((gain, lowest)) = gained else { break };
        std::mem::swap(&mut room.positions, &mut room.trial);
        polished += usize::from(smallest > 0.0);
        let done = smallest > 0.0 && (gain < POLISHED * energy_here || polished > MOST_POLISHING);
        smallest = lowest;
        if done {
            break;
        }
    }
    Ok(smallest > 0.0)
}

/// Eq. (11) as it comes, after `stages − 1` steps of eq. (12) if there are more stages than one.
pub(crate) fn plain(
    body: &Body,
    room: &mut Room,
    search: Search,
    stages: usize,
) -> Result<Effort, Halt> {
    let mut effort = Effort::default();
    level(body, &mut room.positions);
    room.fixed.fill(DVec2::ZERO);
    for step in 1..=MOST_STEPS {
        let energy = assemble(body, room, search, Curvature::True);
        if !energy.is_finite() {
            return Err(Halt::Stalled);
        }
        if step == 1 && stages > 1 {
            room.fixed.copy_from_slice(&room.gradient);
        }
        if !factor(body, room).map_err(Halt::Solver)? {
            return Err(Halt::Indefinite);
        }
        let plus = if step < stages {
            step as f64 / stages as f64 - 1.0
        } else {
            0.0
        };
        solve(body, room, plus).map_err(Halt::Solver)?;
        effort.steps += 1;
        advance(room, 1.0);
        std::mem::swap(&mut room.positions, &mut room.trial);
        if step >= stages && largest(&room.step) < search.tolerance {
            return Ok(effort);
        }
    }
    Err(Halt::Stalled)
}
