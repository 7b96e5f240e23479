//! One pixel of a line from the pixels of another: the mean of what it covers, or linear interpolation.
//!
//! A pixel of the result comes from an interval of the line. Where that is a pixel long or longer, the line shrinks, and the
//! pixel is the mean of the interval with the line constant on each of its pixels. Where it is shorter, the line grows, and
//! the pixel is the mean of the interval of length 1 with the same middle: linear interpolation between pixel centres. The
//! two agree where the length is 1. Sums of many pixels are in `f64`, those of three are what the middle one differs by, so that
//! a constant line stays that constant.
//!
//! *Source*: K. M. Fant, *A Nonaliasing, Real-Time Spatial Transform Technique*, IEEE Computer Graphics and Applications 6(1),
//! 1986, which mixes both in one scan; G. Wolberg, *Digital Image Warping*, 1990, §5.6. Deviation: each pixel from its own
//! interval, where Fant's scan carries remainders along and shifts what it interpolates by up to half a pixel.

use anamorph_raster::Edge;

/// Ends of intervals nearer to whole pixels than this are whole: rounding of positions neither smears a move by whole pixels nor
/// spreads what is not finite.
const WHOLE: f64 = 1e-9;

/// 1.5 · 2⁵²: adding and subtracting it rounds a number below 2⁵¹ to the nearest whole one.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

#[inline(always)]
fn snapped(place: f64) -> f64 {
    let whole = (place + ROUNDER) - ROUNDER;
    if (place - whole).abs() < WHOLE {
        whole
    } else {
        place
    }
}

/// The interval of a pixel, of length 1 at least, from two places in any order: a fold is seen from behind.
#[inline(always)]
fn interval(from: f64, to: f64) -> (f64, f64) {
    let (low, high) = if to < from { (to, from) } else { (from, to) };
    let grows = high - low < 1.0;
    let start = snapped(if grows { 0.5 * (low + high) - 0.5 } else { low });
    (start, if grows { start + 1.0 } else { snapped(high) })
}

/// A line of `count` pixels, one every `stride` samples from `start` on.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    pub(super) samples: &'a [f32],
    pub(super) start: usize,
    pub(super) stride: usize,
    pub(super) count: usize,
    pub(super) edge: Edge,
}

impl Line<'_> {
    /// The pixel that comes from between `from` and `to`, in pixels from the start of the line.
    #[inline]
    pub(super) fn pixel(&self, from: f64, to: f64, out: &mut [f32]) {
        match out.len() {
            1 => self.few::<1>(from, to, 0, out),
            2 => self.few::<2>(from, to, 0, out),
            3 => self.few::<3>(from, to, 0, out),
            4 => self.few::<4>(from, to, 0, out),
            _ => {
                for (group, out) in out.chunks_mut(4).enumerate() {
                    match out.len() {
                        1 => self.few::<1>(from, to, 4 * group, out),
                        2 => self.few::<2>(from, to, 4 * group, out),
                        3 => self.few::<3>(from, to, 4 * group, out),
                        _ => self.few::<4>(from, to, 4 * group, out),
                    }
                }
            }
        }
    }

    /// `N` channels from number `channel` on.
    #[inline(always)]
    fn few<const N: usize>(&self, from: f64, to: f64, channel: usize, out: &mut [f32]) {
        let (from, to) = interval(from, to);
        if !(from >= 0.0 && to <= self.count as f64) {
            self.beyond::<N>(from, to, channel, out);
            return;
        }
        let first = from as usize;
        let end = to as usize;
        let behind_first = (first + 1) as f64;
        if from == first as f64 && to == behind_first {
            // Bits are kept.
            let pixel = &self.samples[self.start + first * self.stride + channel..][..N];
            out[..N].copy_from_slice(pixel);
            return;
        }
        let share = 1.0 / (to - from);
        let mut sum = Sum::<N>::new();
        sum.add(self, first, channel, (behind_first - from) * share);
        for pixel in first + 1..end {
            sum.add(self, pixel, channel, share);
        }
        let rest = to - end as f64;
        if rest > 0.0 {
            sum.add(self, end, channel, rest * share);
        }
        sum.write(out);
    }

    /// The same where the interval leaves the line.
    #[cold]
    fn beyond<const N: usize>(&self, from: f64, to: f64, channel: usize, out: &mut [f32]) {
        let mut sum = Sum::<N>::new();
        let share = 1.0 / (to - from);
        let count = self.count as f64;
        if matches!(self.edge, Edge::Clamp | Edge::Transparent) {
            // Within the line pixel by pixel, all beyond at once.
            let (inner, outer) = (from.clamp(0.0, count), to.clamp(0.0, count));
            self.inside(inner, outer, share, |pixel, weight| {
                sum.add(self, pixel as usize, channel, weight);
            });
            if self.edge == Edge::Clamp {
                let left = (to.min(0.0) - from).max(0.0);
                let right = (to - from.max(count)).max(0.0);
                for (pixel, length) in [(0, left), (self.count - 1, right)] {
                    if length > 0.0 {
                        sum.add(self, pixel, channel, length * share);
                    }
                }
            }
        } else {
            // Whole periods at once: in each every pixel stands as often as in any other.
            let period = if self.edge == Edge::Mirror {
                2.0 * count
            } else {
                count
            };
            let rounds = ((to - from) / period).floor();
            if rounds > 0.0 {
                let weight = rounds * (period / count) * share;
                for pixel in 0..self.count {
                    sum.add(self, pixel, channel, weight);
                }
            }
            let start = from - (from / period).floor() * period;
            let rest = (to - from - rounds * period).max(0.0);
            self.inside(start, start + rest, share, |index, weight| {
                if let Some(pixel) = self.edge.pixel(index, self.count) {
                    sum.add(self, pixel, channel, weight);
                }
            });
        }
        sum.write(out);
    }

    /// Calls `add(pixel, weight)` for the pixels between two places that are not negative.
    fn inside(&self, from: f64, to: f64, share: f64, mut add: impl FnMut(i64, f64)) {
        let mut pixel = from as i64;
        while (pixel as f64) < to {
            let length = to.min((pixel + 1) as f64) - from.max(pixel as f64);
            if length > 0.0 {
                add(pixel, length * share);
            }
            pixel += 1;
        }
    }
}

/// A weighted sum of pixels.
struct Sum<const N: usize>([f64; N]);

impl<const N: usize> Sum<N> {
    #[inline(always)]
    fn new() -> Self {
        Self([0.0; N])
    }
    #[inline(always)]
    fn add(&mut self, line: &Line<'_>, pixel: usize, channel: usize, weight: f64) {
        let samples = &line.samples[line.start + pixel * line.stride + channel..][..N];
        for (sum, sample) in self.0.iter_mut().zip(samples) {
            *sum += f64::from(*sample) * weight;
        }
    }
    #[inline(always)]
    fn write(self, out: &mut [f32]) {
        for (out, sum) in out.iter_mut().zip(self.0) {
            *out = sum as f32;
        }
    }
}

/// Pixels whose intervals are found together.
pub(super) const RUN: usize = 64;

/// A run of pixels, at most [`RUN`] of `N` channels: pixel `i` from between `from[i]` and `to[i]` of the line that begins
/// `i · step` samples behind `line`. Start, stride and step are whole pixels.
///
/// The quick way is for intervals inside the line that touch no more than three pixels and for numbers that are finite; all others
/// go through [`Line::pixel`]. Which way a pixel goes depends on nothing but itself.
#[inline(always)]
pub(super) fn run<const N: usize>(
    line: Line<'_>,
    step: usize,
    from: &[f64; RUN],
    to: &[f64; RUN],
    pixels: &mut [[f32; N]],
) {
    // The first pixel or −1, whether there is a second and a third with weight, and the weights of the outer two.
    let mut first = [0_i32; RUN];
    let (mut second, mut third) = ([0_u32; RUN], [0_u32; RUN]);
    let (mut before, mut behind) = ([0.0_f32; RUN], [0.0_f32; RUN]);
    // Whole numbers of the quick way have 32 bits.
    let count = if line.count < 1 << 30 {
        line.count as f64
    } else {
        0.0
    };
    // A fixed number and no branches, so that the compiler takes many at a time.
    for i in 0..RUN {
        let (start, end) = interval(from[i], to[i]);
        let inside = (start >= 0.0) & (end <= count);
        let whole = if inside { start } else { 0.0 } as i32;
        let next = f64::from(whole) + 1.0;
        // Of three pixels there are up to one on either side of the middle one.
        let (left, right) = ((next - start) as f32, (end - next - 1.0) as f32);
        let share = 1.0 / (end - start) as f32;
        let usable = inside & (end <= next + 2.0);
        first[i] = if usable { whole } else { -1 };
        second[i] = u32::from(end > next);
        third[i] = u32::from(right > 0.0);
        before[i] = left * share;
        behind[i] = right.max(0.0) * share;
    }
    let slow = |i: usize, pixel: &mut [f32; N]| {
        let line = Line {
            start: line.start + i * step,
            ..line
        };
        line.pixel(from[i], to[i], pixel);
    };
    let (samples, _) = line.samples.as_chunks::<N>();
    let (begin, stride, step_pixels) = (line.start / N, line.stride / N, step / N);
    for (i, pixel) in pixels.iter_mut().enumerate().take(RUN) {
        if let Ok(first) = usize::try_from(first[i]) {
            let at = begin + i * step_pixels + first * stride;
            let second = at + second[i] as usize * stride;
            // A third pixel without weight is the second once more.
            let third = second + third[i] as usize * stride;
            let taps = [at, second, third].map(|at| samples.get(at));
            if let [Some(a), Some(b), Some(c)] = taps {
                if second == at {
                    // Bits are kept.
                    *pixel = *a;
                    continue;
                }
                let mut sums = [0.0_f32; N];
                for channel in 0..N {
                    // What the middle one differs by, so that what is constant stays so.
                    sums[channel] = b[channel]
                        + (a[channel] - b[channel]) * before[i]
                        + (c[channel] - b[channel]) * behind[i];
                }
                *pixel = sums;
                continue;
            }
        }
        slow(i, pixel);
    }
    // All of them, without an end in between, so that the compiler takes many at a time.
    let samples = pixels.as_flattened().iter();
    if samples.fold(false, |wild, sample| wild | !sample.is_finite()) {
        for (i, pixel) in pixels.iter_mut().enumerate().take(RUN) {
            if pixel.iter().any(|sample| !sample.is_finite()) {
                slow(i, pixel);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLES: [f32; 5] = [1.0, 4.0, -2.0, 8.0, 3.0];

    fn line(edge: Edge) -> Line<'static> {
        Line {
            samples: &SAMPLES,
            start: 0,
            stride: 1,
            count: 5,
            edge,
        }
    }
    fn pixel(edge: Edge, from: f64, to: f64) -> f32 {
        let mut out = [f32::NAN];
        line(edge).pixel(from, to, &mut out);
        out[0]
    }

    #[test]
    fn whole_pixels_are_copied_and_intervals_are_means() {
        for edge in Edge::all() {
            for (i, sample) in SAMPLES.iter().enumerate() {
                let at = i as f64;
                assert_eq!(pixel(edge, at, at + 1.0), *sample);
                assert_eq!(pixel(edge, at + 1e-12, at + 1.0 - 1e-12), *sample);
                // The middle of a pixel, looked at closely.
                assert_eq!(pixel(edge, at + 0.4, at + 0.6), *sample);
            }
            assert_eq!(pixel(edge, 0.0, 5.0), 2.8);
            assert_eq!(pixel(edge, 1.5, 3.5), (2.0 - 2.0 + 4.0) / 2.0);
            // Half way between two centres.
            assert_eq!(pixel(edge, 0.9, 1.1), 2.5);
            assert_eq!(pixel(edge, 1.1, 0.9), 2.5);
        }
    }

    #[test]
    fn beyond_the_ends_edges_go_on() {
        let brute = |edge: Edge, from: i64, to: i64| {
            let sum: f64 = (from..to)
                .filter_map(|i| edge.pixel(i, 5))
                .map(|i| f64::from(SAMPLES[i]))
                .sum();
            (sum / (to - from) as f64) as f32
        };
        for edge in Edge::all() {
            for (from, to) in [
                (-3, 2),
                (-30, -28),
                (4, 6),
                (7, 8),
                (-2, 9),
                (-1000, 1001),
                (3, 64),
            ] {
                let found = pixel(edge, from as f64, to as f64);
                let expected = brute(edge, from, to);
                assert!(
                    (found - expected).abs() < 1e-5,
                    "{edge:?} {from} {to} {found} {expected}"
                );
            }
            // Far away and long: an answer, soon.
            let far = pixel(edge, -1e15, 1e15);
            assert!(far.is_finite(), "{edge:?}");
            assert!(pixel(edge, 1e15, 1e15 + 2.0).is_finite());
        }
    }

    #[test]
    fn what_is_not_finite_shows_where_it_is_covered() {
        let samples = [1.0, f32::INFINITY, 1.0, f32::NAN, 1.0];
        let line = Line {
            samples: &samples,
            ..line(Edge::Clamp)
        };
        let pixel = |from, to| {
            let mut out = [0.0];
            line.pixel(from, to, &mut out);
            out[0]
        };
        assert_eq!(pixel(0.0, 1.0), 1.0);
        assert_eq!(pixel(2.0 - 1e-12, 3.0 - 1e-12), 1.0);
        assert_eq!(pixel(0.5, 1.5), f32::INFINITY);
        assert!(pixel(2.5, 3.5).is_nan());
        assert_eq!(pixel(4.0, 6.0), 1.0);
    }

    #[test]
    fn runs_are_their_pixels() {
        let value = |i: usize| ((i * 7919) % 101) as f32 - 50.0;
        let mut samples: Vec<f32> = (0..3 * 40).map(value).collect();
        samples[61] = f32::INFINITY;
        samples[90] = f32::NAN;
        samples[30] = -0.0;
        let (mut from, mut to) = ([0.0; RUN], [0.0; RUN]);
        for i in 0..RUN {
            from[i] = ((i * 53) % 47) as f64 * 0.9 - 2.0;
            to[i] = from[i] + [0.0, 0.2, 1.0, 1.3, 1.9, 2.0, 2.7, 9.4, -0.5][i % 9];
            if i % 5 == 0 {
                (from[i], to[i]) = (from[i].round(), to[i].round());
            }
        }
        for edge in Edge::all() {
            let line = Line {
                samples: &samples,
                start: 0,
                stride: 3,
                count: 40,
                edge,
            };
            let mut pixels = [[0.0; 3]; RUN - 3];
            run::<3>(line, 0, &from, &to, &mut pixels);
            for (i, pixel) in pixels.iter().enumerate() {
                let mut expected = [0.0; 3];
                line.pixel(from[i], to[i], &mut expected);
                for (found, expected) in pixel.iter().zip(expected) {
                    let off = (*found - expected).abs();
                    let same =
                        *found == expected || off < 2e-5 || found.is_nan() && expected.is_nan();
                    assert!(same, "{edge:?} {} {} {found} {expected}", from[i], to[i]);
                }
            }
        }
    }

    #[test]
    fn constants_stay_and_channels_do_not_mix() {
        let value = 0.1_f32;
        for channels in [1, 2, 3, 4, 5, 7, 9] {
            let samples: Vec<f32> = (0..20 * channels)
                .map(|i| value + (i % channels) as f32)
                .collect();
            let line = Line {
                samples: &samples,
                start: 0,
                stride: channels,
                count: 20,
                edge: Edge::Clamp,
            };
            for (from, to) in [
                (0.3, 0.9),
                (-0.2, 0.77),
                (3.01, 17.3),
                (5.2, 6.2),
                (-40.0, 90.1),
            ] {
                let mut out = vec![0.0; channels];
                line.pixel(from, to, &mut out);
                assert_eq!(out, samples[..channels], "{from} {to}");
            }
        }
    }
}
