//! The picture of a motion: the path with ticks at equal times and its frames, and beside it distance and speed by time.
//!
//! *Source*: the figures of *Interpolation Techniques*, chapter 2 (equally spaced points of the parameter against those of
//! time; distance–time and velocity–time curves).

use anamorph_core::{Bounds, Solid};
use anamorph_preview::{Anchor, Figure, Ink};
use anamorph_recipe::{BuiltMotion, Subject};
use std::f64::consts::TAU;

/// The colours of a picture.
pub(crate) struct Palette {
    ground: Ink,
    panel: Ink,
    ink: Ink,
    faint: Ink,
    grid: Ink,
    path: Ink,
    tick: Ink,
    forward: Ink,
    up: Ink,
    side: Ink,
    alarm: Ink,
}

impl Palette {
    pub(crate) const LIGHT: Self = Self {
        ground: Ink::new(250, 250, 248),
        panel: Ink::new(255, 255, 255),
        ink: Ink::new(38, 46, 56),
        faint: Ink::new(128, 138, 150),
        grid: Ink::new(226, 230, 234),
        path: Ink::new(70, 88, 108),
        tick: Ink::new(224, 116, 24),
        forward: Ink::new(36, 99, 190),
        up: Ink::new(38, 150, 100),
        side: Ink::new(194, 70, 90),
        alarm: Ink::new(214, 60, 60),
    };
    pub(crate) const DARK: Self = Self {
        ground: Ink::new(21, 24, 28),
        panel: Ink::new(28, 32, 37),
        ink: Ink::new(226, 230, 235),
        faint: Ink::new(140, 150, 162),
        grid: Ink::new(52, 58, 66),
        path: Ink::new(150, 168, 188),
        tick: Ink::new(245, 150, 66),
        forward: Ink::new(98, 160, 245),
        up: Ink::new(86, 200, 148),
        side: Ink::new(236, 116, 134),
        alarm: Ink::new(245, 106, 106),
    };
}

/// Equal steps of time that are marked on the path: about as many, at most half as many more.
const TICKS: f64 = 20.0;
/// Ticks from which on only every second one has its frame drawn.
const MANY_TICKS: usize = 16;
/// Upright lines of faults in a plot; more would be one red area.
const ALARMS: usize = 256;
/// Points of the recipe that are drawn; more would hide the path.
const MOST_POINTS: usize = 64;
/// Straight pieces of the path, and of the plots.
const PIECES: u32 = 720;

/// What the picture shows, for those who cannot see it.
pub(crate) fn label(built: &BuiltMotion) -> String {
    format!(
        "A motion along a {} path with its {} frames at equal times; distance and speed by time",
        built.family, built.orientation
    )
}

/// From space to the plane of the picture: right, up, and towards the viewer.
#[derive(Clone, Copy)]
struct View {
    right: Solid,
    above: Solid,
}

impl View {
    /// From the front for paths of the plane, else from the front right, a little above.
    fn of(plane: bool) -> Self {
        if plane {
            return Self {
                right: Solid::X,
                above: Solid::Y,
            };
        }
        let (turn, tilt) = (0.55_f64, 0.45_f64);
        Self {
            right: Solid::new(turn.cos(), 0.0, -turn.sin()),
            above: Solid::new(
                -turn.sin() * tilt.sin(),
                tilt.cos(),
                -turn.cos() * tilt.sin(),
            ),
        }
    }

    fn at(&self, point: Solid) -> [f64; 2] {
        [self.right.dot(point), self.above.dot(point)]
    }
}

/// A rectangle of the picture.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Frame {
    fn corners(self) -> [[f64; 2]; 4] {
        [
            [self.left, self.top],
            [self.right, self.top],
            [self.right, self.bottom],
            [self.left, self.bottom],
        ]
    }

    fn inner(self, by: f64) -> Self {
        Self {
            left: self.left + by,
            top: self.top + by,
            right: self.right - by,
            bottom: self.bottom - by,
        }
    }
}

/// The whole picture.
pub(crate) fn figure(built: &BuiltMotion, size: [f64; 2], palette: &Palette) -> Figure {
    let [width, height] = size;
    // Lengths are those of a picture 900 high and 1600 wide.
    let unit = (width / 1600.0).min(height / 900.0);
    let mut figure = Figure::new(width, height, palette.ground);
    let edge = 28.0 * unit;
    let split = width * 0.6;
    let left = Frame {
        left: edge,
        top: edge,
        right: split,
        bottom: height - edge,
    };
    let middle = 0.5 * height;
    let upper = Frame {
        left: split + edge,
        top: edge,
        right: width - edge,
        bottom: middle - 0.5 * edge,
    };
    let lower = Frame {
        top: middle + 0.5 * edge,
        bottom: height - edge,
        ..upper
    };
    for panel in [left, upper, lower] {
        figure.area(&panel.corners(), palette.panel);
        let mut outline = panel.corners().to_vec();
        outline.push(outline[0]);
        figure.line(&outline, palette.grid, unit);
    }
    draw_path(&mut figure, built, left, unit, palette);
    draw_plots(&mut figure, built, [upper, lower], unit, palette);
    figure
}

/// Times of a round number of seconds from each other, from 0 on.
fn marks(duration: f64) -> Vec<f64> {
    ticks(0.0, duration, TICKS)
}

/// Times from 0 to the end in equal steps.
fn steps(duration: f64, count: u32) -> impl Iterator<Item = f64> {
    (0..=count).map(move |i| duration * (f64::from(i) / f64::from(count)))
}

fn draw_path(figure: &mut Figure, built: &BuiltMotion, frame: Frame, unit: f64, palette: &Palette) {
    let motion = &built.motion;
    let path = motion.path();
    let (start, end) = path.domain();
    let line: Vec<Solid> = (0..=PIECES)
        .map(|i| path.point(start + (end - start) * (f64::from(i) / f64::from(PIECES))))
        .collect();
    let view = View::of(built.plane);
    let bounds = Bounds::of(&line).unwrap_or_else(|| Bounds::new(Solid::ZERO, Solid::ZERO));
    let size = bounds.diagonal().max(f64::MIN_POSITIVE);
    // The path's shadow on a floor below it tells how high it is.
    let floor = bounds.min.y - 0.08 * size;
    let down = |p: Solid| Solid::new(p.x, floor, p.z);
    let arm = 0.075 * size;
    let times = marks(motion.duration());
    let rotations = built.rotations(&times);

    let mut all: Vec<[f64; 2]> = line.iter().map(|p| view.at(*p)).collect();
    if !built.plane {
        all.extend(line.iter().map(|p| view.at(down(*p))));
    }
    for (time, q) in times.iter().zip(&rotations) {
        let at = motion.position(*time);
        all.extend([Solid::X, Solid::Y, Solid::Z].map(|axis| view.at(at + *q * axis * arm)));
    }
    let shown = built.points.len() <= MOST_POINTS;
    if shown {
        all.extend(built.points.iter().map(|p| view.at(*p)));
    }
    // What is looked at, unless the path would be a speck beside it.
    let target = built.target.filter(|target| {
        let far = (*target - bounds.min)
            .length()
            .max((*target - bounds.max).length());
        far <= 4.0 * size
    });
    all.extend(target.map(|target| view.at(target)));
    let low = all
        .iter()
        .fold([f64::INFINITY; 2], |m, p| [m[0].min(p[0]), m[1].min(p[1])]);
    let high = all.iter().fold([f64::NEG_INFINITY; 2], |m, p| {
        [m[0].max(p[0]), m[1].max(p[1])]
    });
    let room = Frame {
        top: frame.top + 84.0 * unit,
        ..frame
    }
    .inner(26.0 * unit);
    let extent = [0, 1].map(|k| (high[k] - low[k]).max(1e-12 * size));
    let scale = ((room.right - room.left) / extent[0]).min((room.bottom - room.top) / extent[1]);
    let centre = [
        0.5 * (room.left + room.right),
        0.5 * (room.top + room.bottom),
    ];
    let place = |p: Solid| {
        let [x, y] = view.at(p);
        [
            centre[0] + (x - 0.5 * (low[0] + high[0])) * scale,
            centre[1] - (y - 0.5 * (low[1] + high[1])) * scale,
        ]
    };

    if !built.plane {
        let shadow: Vec<[f64; 2]> = line.iter().map(|p| place(down(*p))).collect();
        figure.line(&shadow, palette.grid, 3.5 * unit);
        for time in &times {
            let at = motion.position(*time);
            figure.line(&[place(at), place(down(at))], palette.grid, unit);
        }
    }
    if shown {
        let mut polygon: Vec<[f64; 2]> = built.points.iter().map(|p| place(*p)).collect();
        if path.is_closed() {
            polygon.extend(polygon.first().copied());
        }
        figure.line(&polygon, palette.faint.fading(0.35), unit);
        for at in polygon {
            figure.disc(at, 4.0 * unit, palette.faint);
            figure.disc(at, 2.6 * unit, palette.panel);
        }
    }
    let drawn: Vec<[f64; 2]> = line.iter().map(|p| place(*p)).collect();
    figure.line(&drawn, palette.path, 2.6 * unit);
    if let Some(at) = target.map(place) {
        let arm = 7.0 * unit;
        for [x, y] in [[arm, arm], [arm, -arm]] {
            let cross = [[at[0] - x, at[1] - y], [at[0] + x, at[1] + y]];
            figure.line(&cross, palette.tick, 2.2 * unit);
        }
        figure.words(
            [at[0] + 12.0 * unit, at[1] - 9.0 * unit],
            11.0 * unit,
            Anchor::Start,
            palette.faint,
            "target",
        );
    }
    let each = if times.len() > MANY_TICKS { 2 } else { 1 };
    for (i, (time, q)) in times.iter().zip(&rotations).enumerate() {
        if !i.is_multiple_of(each) {
            continue;
        }
        let at = motion.position(*time);
        // Seen from a camera, forward is its −z and its left is −x.
        let sign = match built.subject {
            Subject::Object => 1.0,
            Subject::Camera => -1.0,
        };
        for (axis, ink) in [
            (Solid::X * sign, palette.side),
            (Solid::Y, palette.up),
            (Solid::Z * sign, palette.forward),
        ] {
            figure.line(&[place(at), place(at + *q * axis * arm)], ink, 2.2 * unit);
        }
    }
    for time in &times {
        figure.disc(place(motion.position(*time)), 4.6 * unit, palette.tick);
    }
    for (time, radius) in [(0.0, 8.0), (motion.duration(), 5.0)] {
        let at = place(motion.position(time));
        let ring: Vec<[f64; 2]> = (0..=32)
            .map(|k| TAU * f64::from(k) / 32.0)
            .map(|a| {
                [
                    at[0] + radius * unit * a.cos(),
                    at[1] + radius * unit * a.sin(),
                ]
            })
            .collect();
        figure.line(&ring, palette.ink, 1.6 * unit);
    }
    heading(figure, built, frame, unit, palette);
}

/// The words over the path.
fn heading(figure: &mut Figure, built: &BuiltMotion, frame: Frame, unit: f64, palette: &Palette) {
    let (x, y) = (frame.left + 26.0 * unit, frame.top + 42.0 * unit);
    let title = format!("{} · {}", built.family, built.orientation);
    figure.words([x, y], 17.0 * unit, Anchor::Start, palette.ink, &title);
    let step = marks(built.motion.duration())
        .get(1)
        .copied()
        .unwrap_or(0.0);
    let below = format!("a tick every {} s", number(step));
    let y = y + 32.0 * unit;
    figure.disc([x + 5.0 * unit, y - 5.0 * unit], 4.6 * unit, palette.tick);
    figure.words(
        [x + 18.0 * unit, y],
        11.0 * unit,
        Anchor::Start,
        palette.faint,
        &below,
    );
    let mut at = x + 250.0 * unit;
    for (word, ink) in [
        ("forward", palette.forward),
        ("up", palette.up),
        ("left", palette.side),
    ] {
        figure.line(
            &[[at, y - 5.0 * unit], [at + 20.0 * unit, y - 5.0 * unit]],
            ink,
            2.6 * unit,
        );
        figure.words(
            [at + 28.0 * unit, y],
            11.0 * unit,
            Anchor::Start,
            palette.faint,
            word,
        );
        #[allow(clippy::cast_precision_loss)]
        {
            at += (70.0 + 11.0 * word.len() as f64) * unit;
        }
    }
}

/// A number of few digits.
fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e6).contains(&value.abs()) {
        return format!("{value:.1e}");
    }
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Round numbers in a range, about `wanted` of them.
pub(crate) fn ticks(low: f64, high: f64, wanted: f64) -> Vec<f64> {
    let rough = (high - low) / wanted;
    if !(rough > 0.0 && rough.is_finite()) {
        return Vec::new();
    }
    let power = 10.0_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|m| m * power)
        .find(|step| *step >= rough)
        .unwrap_or(10.0 * power);
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    let mut all = Vec::new();
    let mut i = first;
    while i <= last && all.len() < 64 {
        // Rounded, so that 0.6000000000000001 is 0.6, and without a sign on zero.
        let value = i * step;
        all.push(format!("{value:.10e}").parse().unwrap_or(value) + 0.0);
        i += 1.0;
    }
    all
}

/// Distance and speed over the time.
fn draw_plots(
    figure: &mut Figure,
    built: &BuiltMotion,
    frames: [Frame; 2],
    unit: f64,
    palette: &Palette,
) {
    let motion = &built.motion;
    let duration = motion.duration();
    // Both sides of every break, so that jumps are upright.
    let mut times: Vec<f64> = steps(duration, PIECES).collect();
    for at in motion.control().breaks() {
        for time in [at - 1e-7 * duration, at, at + 1e-7 * duration] {
            if (0.0..=duration).contains(&time) && times.len() < 20_000 {
                times.push(time);
            }
        }
    }
    times.sort_by(f64::total_cmp);
    // Faults that stand on the same pixels are one line.
    let mut alarms: Vec<f64> = Vec::new();
    for time in built
        .findings
        .iter()
        .filter_map(anamorph_curves::motion::Finding::time)
    {
        let apart = duration / (4 * ALARMS) as f64;
        if alarms.len() < ALARMS && alarms.last().is_none_or(|last| time - last > apart) {
            alarms.push(time);
        }
    }
    let curves: [(&str, Vec<f64>, Ink); 2] = [
        (
            "distance",
            times.iter().map(|t| motion.distance(*t)).collect(),
            palette.path,
        ),
        (
            "speed",
            times.iter().map(|t| motion.speed(*t)).collect(),
            palette.forward,
        ),
    ];
    for ((title, values, ink), frame) in curves.into_iter().zip(frames) {
        let room = Frame {
            left: frame.left + 84.0 * unit,
            top: frame.top + 64.0 * unit,
            right: frame.right - 26.0 * unit,
            bottom: frame.bottom - 56.0 * unit,
        };
        let [low, high] = range(&values);
        let x = |time: f64| room.left + (room.right - room.left) * (time / duration);
        let y = |value: f64| {
            let share = (value - low) / (high - low);
            room.bottom - (room.bottom - room.top) * share.clamp(-0.03, 1.03)
        };
        let small = 11.0 * unit;
        for tick in ticks(0.0, duration, 6.0) {
            figure.line(
                &[[x(tick), room.top], [x(tick), room.bottom]],
                palette.grid,
                unit,
            );
            figure.words(
                [x(tick), room.bottom + 22.0 * unit],
                small,
                Anchor::Middle,
                palette.faint,
                &number(tick),
            );
        }
        for tick in ticks(low, high, 5.0) {
            figure.line(
                &[[room.left, y(tick)], [room.right, y(tick)]],
                palette.grid,
                unit,
            );
            figure.words(
                [room.left - 10.0 * unit, y(tick) + 0.5 * small],
                small,
                Anchor::End,
                palette.faint,
                &number(tick),
            );
        }
        let zero = y(0.0);
        figure.line(
            &[[room.left, zero], [room.right, zero]],
            palette.faint,
            1.4 * unit,
        );
        for time in &alarms {
            figure.line(
                &[[x(*time), room.top], [x(*time), room.bottom]],
                palette.alarm.fading(0.55),
                1.4 * unit,
            );
        }
        let points: Vec<[f64; 2]> = times
            .iter()
            .zip(&values)
            .filter(|(_, value)| !value.is_nan())
            .map(|(time, value)| [x(*time), y(*value)])
            .collect();
        figure.line(&points, ink, 2.6 * unit);
        for time in marks(duration) {
            let value = if title == "distance" {
                motion.distance(time)
            } else {
                motion.speed(time)
            };
            figure.disc([x(time), y(value)], 3.2 * unit, palette.tick);
        }
        figure.words(
            [frame.left + 26.0 * unit, frame.top + 40.0 * unit],
            14.0 * unit,
            Anchor::Start,
            palette.ink,
            title,
        );
        let shown = values
            .iter()
            .copied()
            .filter(|v| v.is_finite() && *v <= high);
        let most = shown.fold(0.0_f64, f64::max);
        figure.words(
            [room.right, frame.top + 40.0 * unit],
            small,
            Anchor::End,
            palette.faint,
            &format!("up to {}", number(most)),
        );
        figure.words(
            [room.right, frame.bottom - 12.0 * unit],
            small,
            Anchor::End,
            palette.faint,
            "time (s)",
        );
    }
}

/// What a plot shows of values: all, but no more than eight times what nearly all of them are within, for those that are
/// infinite at single moments. 0 is always in it.
fn range(values: &[f64]) -> [f64; 2] {
    let mut sizes: Vec<f64> = values
        .iter()
        .map(|v| v.abs())
        .filter(|v| v.is_finite())
        .collect();
    sizes.sort_by(f64::total_cmp);
    let usual = sizes
        .get(sizes.len().saturating_sub(1) * 95 / 100)
        .copied()
        .unwrap_or(1.0);
    let most = if usual > 0.0 {
        8.0 * usual
    } else {
        f64::INFINITY
    };
    let inside = values
        .iter()
        .filter(|v| v.is_finite())
        .map(|v| v.clamp(-most, most));
    let [low, high] = inside.fold([0.0_f64; 2], |m, v| [m[0].min(v), m[1].max(v)]);
    if high - low > 0.0 {
        let room = 0.04 * (high - low);
        [if low < 0.0 { low - room } else { low }, high + room]
    } else {
        [-0.5, 1.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        assert_eq!(ticks(0.0, 1.0, 5.0), [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
        assert_eq!(ticks(-3.0, 7.0, 5.0), [-2.0, 0.0, 2.0, 4.0, 6.0]);
        assert_eq!(ticks(0.0, 0.3, 3.0), [0.0, 0.1, 0.2, 0.3]);
        assert!(ticks(0.0, 0.0, 5.0).is_empty() && ticks(0.0, f64::NAN, 5.0).is_empty());
        assert_eq!(ticks(0.0, 4e9, 4.0), [0.0, 1e9, 2e9, 3e9, 4e9]);
    }

    #[test]
    fn the_view_is_a_rotation() {
        for plane in [true, false] {
            let view = View::of(plane);
            assert!((view.right.length() - 1.0).abs() < 1e-12);
            assert!((view.above.length() - 1.0).abs() < 1e-12);
            assert!(view.right.dot(view.above).abs() < 1e-12);
        }
    }

    #[test]
    fn infinite_speeds_do_not_flatten_a_plot() {
        let mut values = vec![1.0; 1000];
        values[0] = f64::INFINITY;
        values[1] = 1e12;
        let [low, high] = range(&values);
        assert!(low == 0.0 && (1.0..10.0).contains(&high));
        assert_eq!(range(&[0.0, 0.0]), [-0.5, 1.0]);
    }
}
