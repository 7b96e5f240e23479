//! The parameter of a cubic at a length from its start, for one curve or for many.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Reparameterizing by arc length"; errata C13 (a tolerance on length). The
//! guess is the inverse of a table of seven stretches, each measured by the trapezoidal rule with its end correction
//! (Euler–Maclaurin); from there the length is known to a tolerance, and steps are those of [`step`].
//!
//! For many curves the work is done in passes, as for [lengths](super::cubic): zeros, guesses and cuts, sums, steps.

use super::cubic::{
    BLOCK, Cuts, HEIGHT, Interval, Plan, Stretch, Vectors, Waiting, Work, apply_one,
    find_own_zeros, find_zeros, plan, sums, with_vectors,
};
use super::inverse::{STEPS, step};
use super::sensible;
use super::zeros::LANES;
use crate::Cubic;
use anamorph_core::Space;

/// The length of a cubic's stretch is asked to this share of the accuracy.
const FINE: f64 = 0.05;

/// Ends of the stretches of the table that a guess is read from: a vector of speeds.
const ENDS: usize = LANES;

/// About where the length from the start is `target`.
#[inline(always)]
fn guess(plan: &Plan, dim: usize, target: f64) -> f64 {
    let width = 1.0 / (ENDS - 1) as f64;
    // Speeds at the ends, with their derivatives.
    let (mut square, mut product) = ([0.0; ENDS], [0.0; ENDS]);
    for &[a, b, c] in &plan.velocity.axes[..dim] {
        for i in 0..ENDS {
            let x = i as f64 * width;
            let (v, dv) = (a + x * (b + x * c), b + 2.0 * x * c);
            square[i] += v * v;
            product[i] += v * dv;
        }
    }
    let (mut speed, mut change) = ([0.0; ENDS], [0.0; ENDS]);
    for i in 0..ENDS {
        speed[i] = square[i].sqrt();
        change[i] = product[i] / speed[i].max(f64::MIN_POSITIVE);
    }
    let target = target / plan.scale;
    let (mut before, mut length, mut at) = (0.0, 0.0, 0);
    let mut sum = 0.0;
    for i in 0..ENDS - 1 {
        let mean = 0.5 * (speed[i] + speed[i + 1]);
        let bend = (change[i] - change[i + 1]) * (width / 12.0);
        // Beside a cusp the correction may be worse than none.
        let piece = width
            * if bend.abs() < 0.5 * mean {
                mean + bend
            } else {
                mean
            };
        let here = sum <= target;
        before = if here { sum } else { before };
        length = if here { piece } else { length };
        at = if here { i } else { at };
        sum += piece;
    }
    // The cubic with the inverse's slopes at the stretch's ends.
    let share = ((target - before) / length).min(1.0);
    let (p, q) = (
        length / (width * speed[at]),
        length / (width * speed[at + 1]),
    );
    let rest = 1.0 - share;
    let curved = share * share * (3.0 - 2.0 * share) + share * rest * (p * rest - q * share);
    let share = if curved > 0.0 && curved < 1.0 {
        curved
    } else {
        share
    };
    let u = (at as f64 + share) * width;
    if u > 0.0 && u < 1.0 { u } else { 1.0 }
}

/// What is asked of one curve.
#[derive(Clone, Copy)]
struct Question {
    target: f64,
    accuracy: f64,
}

/// The parameter at the target, from a parameter `u` up to which the length is `s`.
#[inline(always)]
fn settle<S: Space, T: Vectors>(
    vectors: T,
    plan: &Plan,
    waiting: &mut Waiting,
    Question { target, accuracy }: Question,
    mut u: f64,
    mut s: f64,
) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..STEPS {
        let miss = s - target;
        if miss.abs() <= 0.5 * accuracy || (miss < 0.0 && u >= 1.0) {
            return u;
        }
        if miss < 0.0 {
            low = u;
        } else {
            high = u;
        }
        let next = u + step(-miss, plan.speeds(S::DIM, u));
        let next = if next > low && next < high {
            next
        } else if next >= 1.0 && high == 1.0 && u < 1.0 {
            // Behind the end, for all that is known.
            1.0
        } else {
            0.5 * (low + high)
        };
        if next == u || next == low {
            break;
        }
        let (from, to) = if next > u { (u, next) } else { (next, u) };
        let mut cuts = Cuts::new(Stretch { from, to }, plan, FINE * accuracy);
        let mut way = 0.0;
        while let Some((rule, middle, half)) = cuts.next(waiting) {
            way += apply_one::<S, T>(vectors, plan, rule, middle, half, FINE * accuracy);
        }
        way *= plan.scale;
        s += if next > u { way } else { -way };
        u = next;
    }
    u
}

/// The local parameter of a cubic at the length `s > 0`; 1 where it is shorter.
pub(super) fn one<S: Space>(cubic: &Cubic<S>, s: f64, accuracy: f64) -> f64 {
    let question = Question {
        target: s,
        accuracy,
    };
    let mut plan = plan(cubic);
    with_vectors!(vectors => one_in::<S, _>(vectors, &mut plan, question))
}

#[inline(always)]
fn one_in<S: Space, T: Vectors>(vectors: T, plan: &mut Plan, question: Question) -> f64 {
    find_own_zeros::<S>(plan);
    let u = guess(plan, S::DIM, question.target);
    let mut waiting: Waiting = [(0.0, 0.0); HEIGHT];
    let accuracy = FINE * question.accuracy;
    let mut cuts = Cuts::new(Stretch { from: 0.0, to: u }, plan, accuracy);
    let mut s = 0.0;
    while let Some((rule, middle, half)) = cuts.next(&mut waiting) {
        s += apply_one::<S, T>(vectors, plan, rule, middle, half, accuracy);
    }
    let s = s * plan.scale;
    settle::<S, T>(vectors, plan, &mut waiting, question, u, s)
}

/// The accuracy that is possible for a curve with these coefficients.
fn possible<S: Space>(cubic: &Cubic<S>, accuracy: f64) -> f64 {
    let size = cubic.0[1].length() + cubic.0[2].length() + cubic.0[3].length();
    sensible(accuracy, size)
}

/// The local parameter, from 0 to 1, of one cubic Bézier curve at a length from its start. The curve's length up to it is within
/// `accuracy` (absolute, in scene units) of `s`. Lengths before and behind the curve give its ends, one that is not a number the start.
pub fn cubic_parameter_at<S: Space>(curve: &[S; 4], s: f64, accuracy: f64) -> f64 {
    if s.is_nan() || s <= 0.0 {
        return 0.0;
    }
    let cubic = Cubic::from_bezier(*curve);
    one(&cubic, s, possible(&cubic, accuracy))
}

/// The parameters of many cubic Bézier curves, each at a length of its own: [`cubic_parameter_at`] for every pair, and equal to it bit
/// for bit, but faster. One number a pair; where one list is longer, its rest is not read.
pub fn cubic_parameters_at<S: Space>(
    curves: &[[S; 4]],
    lengths: &[f64],
    accuracy: f64,
    out: &mut Vec<f64>,
) {
    out.clear();
    let mut plans: Vec<(usize, Stretch, Plan)> = Vec::with_capacity(BLOCK);
    let mut questions: Vec<Question> = Vec::with_capacity(BLOCK);
    let mut work = Work::default();
    let count = curves.len().min(lengths.len());
    let blocks = curves[..count]
        .chunks(BLOCK)
        .zip(lengths[..count].chunks(BLOCK));
    for (curves, targets) in blocks {
        plans.clear();
        questions.clear();
        for (slot, (curve, &target)) in curves.iter().zip(targets).enumerate() {
            let cubic = Cubic::from_bezier(*curve);
            plans.push((slot, super::WHOLE, plan(&cubic)));
            let accuracy = possible(&cubic, accuracy);
            questions.push(Question { target, accuracy });
        }
        with_vectors!(vectors => block::<S, _>(vectors, &mut plans, &questions, &mut work, out));
    }
}

/// All passes over one block.
#[inline(always)]
fn block<S: Space, T: Vectors>(
    vectors: T,
    plans: &mut [(usize, Stretch, Plan)],
    questions: &[Question],
    work: &mut Work,
    out: &mut Vec<f64>,
) {
    let mut waiting: Waiting = [(0.0, 0.0); HEIGHT];
    let (mut parameters, mut reached) = ([0.0; BLOCK], [0.0; BLOCK]);
    find_zeros::<S>(plans);
    for ((_, _, plan), (question, u)) in plans.iter().zip(questions.iter().zip(&mut parameters)) {
        *u = guess(plan, S::DIM, question.target);
    }
    work.clear();
    let each = plans.iter().zip(questions.iter().zip(&parameters));
    for (stretch, ((_, _, plan), (question, &to))) in each.enumerate() {
        let stretch_to = Stretch { from: 0.0, to };
        let mut cuts = Cuts::new(stretch_to, plan, FINE * question.accuracy);
        while let Some((rule, middle, half)) = cuts.next(&mut waiting) {
            work.add(
                rule,
                Interval {
                    stretch,
                    middle,
                    half,
                },
            );
        }
    }
    sums::<S, T>(vectors, work, plans, FINE * questions[0].accuracy);
    for (at, value) in work.intervals.iter().zip(&work.values) {
        reached[at.stretch] += value;
    }
    let each = plans
        .iter()
        .zip(questions.iter().zip(parameters.iter().zip(&reached)));
    for ((_, _, plan), (&question, (&u, &s))) in each {
        let s = s * plan.scale;
        out.push(if question.target > 0.0 {
            settle::<S, T>(vectors, plan, &mut waiting, question, u, s)
        } else {
            0.0
        });
    }
}
