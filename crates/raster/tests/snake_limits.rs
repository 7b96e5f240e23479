//! Snakes along weak edges and noise: none goes farther than its reach, and none crosses itself that did not.

// A test that cannot be set up has nothing to say.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::math;
use anamorph_raster::snake::{Ends, Snake, relax};
use anamorph_raster::{Raster, Window};

/// Numbers from −1 to 1, the same every time.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

fn image(width: usize, height: usize, mut light: impl FnMut(DVec2) -> f64) -> Raster {
    let window = Window::new(0, 0, width, height).unwrap();
    let mut image = Raster::new(window, 1).unwrap();
    for row in 0..height {
        for column in 0..width {
            image.pixel_mut(column, row)[0] = light(window.centre(column, row)) as f32;
        }
    }
    image
}

fn segments(points: &[DVec2], closed: bool) -> Vec<[DVec2; 2]> {
    let mut line = points.to_vec();
    if closed {
        line.push(points[0]);
    }
    line.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}

fn distance(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let squared = (b - a).length_squared().max(1e-300);
    let share = ((p - a).dot(b - a) / squared).clamp(0.0, 1.0);
    p.distance(a + (b - a) * share)
}

/// Whether a curve crosses itself, all pairs of segments tried.
fn crosses(points: &[DVec2], closed: bool) -> bool {
    let all = segments(points, closed);
    let side = |[a, b]: [DVec2; 2], p: DVec2| (b - a).perp_dot(p - a);
    (0..all.len()).any(|i| {
        (i + 2..all.len()).any(|j| {
            let neighbours = closed && i == 0 && j + 1 == all.len();
            let (one, other) = (all[i], all[j]);
            !neighbours
                && side(one, other[0]) * side(one, other[1]) < 0.0
                && side(other, one[0]) * side(other, one[1]) < 0.0
        })
    })
}

/// Spots of light of many sizes, all weak, and noise.
fn spots(size: usize, chance: &mut Chance) -> Raster {
    let spots: Vec<(DVec2, f64, f64)> = (0..60)
        .map(|_| {
            let half = size as f64 / 2.0;
            let centre = dvec2(half, half) + dvec2(chance.next(), chance.next()) * half;
            (centre, 6.0 + 5.0 * chance.next(), 0.03 * chance.next())
        })
        .collect();
    image(size, size, |p| {
        let own = spots.iter().map(|(centre, wide, light)| {
            light * math::exp(-p.distance_squared(*centre) / (wide * wide))
        });
        0.5 + own.sum::<f64>() + 0.01 * chance.next()
    })
}

#[test]
fn along_weak_edges_and_noise_curves_stay_within_reach_and_do_not_cross_themselves() {
    let mut chance = Chance(17);
    let (mut held, mut slowed) = (0, 0);
    for number in 0..14 {
        let picture = spots(140, &mut chance);
        let closed = number % 2 == 0;
        let count = [9, 30, 120][number % 3];
        let drawn: Vec<DVec2> = (0..count)
            .map(|i| {
                let share = i as f64 / count as f64;
                if closed {
                    // A flower with narrow leaves.
                    let (sin, cos) = math::sin_cos(std::f64::consts::TAU * share);
                    let wave = math::sin(std::f64::consts::TAU * 5.0 * share);
                    dvec2(70.0, 70.0) + dvec2(cos, sin) * (36.0 + 22.0 * wave)
                } else {
                    // Hairpins, a few pixels apart.
                    let turn = (share * 8.0).floor();
                    let along = 100.0 * (share * 8.0 - turn);
                    let x = if turn % 2.0 == 0.0 {
                        along
                    } else {
                        100.0 - along
                    };
                    dvec2(20.0 + x, 30.0 + 7.0 * turn + 0.05 * along)
                }
            })
            .collect();
        if crosses(&drawn, closed) {
            continue;
        }
        for (reach, alpha, points) in [
            (4.0, 1.0, None),
            (12.0, 0.05, None),
            (12.0, 0.0, Some(300)),
            (30.0, 1.0, Some(150)),
        ] {
            let options = Snake {
                closed,
                ends: Ends::Free,
                sigma: 1.5,
                reach,
                alpha,
                beta: alpha,
                points,
            };
            let (settled, report) = relax(&picture, &[1.0], &drawn, &options).unwrap();
            let what = format!("{number}, reach {reach}, alpha {alpha}: {report:?}");
            let first = segments(&drawn, closed);
            for p in &settled {
                let far = first.iter().map(|s| distance(*p, *s));
                let far = far.fold(f64::INFINITY, f64::min);
                assert!(far <= reach + 1e-9, "{p} is {far} away; {what}");
            }
            if points.is_none() {
                for (from, to) in drawn.iter().zip(&settled) {
                    assert!(from.distance(*to) <= reach + 1e-9, "{from} {to}; {what}");
                }
            }
            assert!(report.farthest <= reach + 1e-9, "{what}");
            assert_eq!(report.held > 0, report.held_at.is_some());
            if !report.crossed_before {
                assert!(!crosses(&settled, closed), "{what}");
                assert_eq!(report.crossing, None, "{what}");
            }
            held += report.held;
            slowed += report.slowed;
        }
    }
    assert!(held > 0 && slowed > 0, "{held} {slowed}");
}

#[test]
fn a_slope_without_end_pulls_no_farther_than_the_reach() {
    // The light grows faster and faster to the right: wherever one is, the edge is stronger a little farther on.
    let picture = image(300, 60, |p| p.x * p.x / 9e4);
    let drawn: Vec<DVec2> = (0..9)
        .map(|i| dvec2(60.0, 10.0 + 5.0 * f64::from(i)))
        .collect();
    for reach in [0.0, 3.0, 10.0, 25.0] {
        let options = Snake {
            reach,
            ..Snake::default()
        };
        let (settled, report) = relax(&picture, &[1.0], &drawn, &options).unwrap();
        assert!(report.farthest <= reach * (1.0 + 1e-12), "{report:?}");
        assert!(
            report.farthest >= 0.99 * reach && report.held > 8,
            "{report:?}"
        );
        let at = report.held_at.unwrap();
        assert!((at.x - 60.0 - reach).abs() < 1e-6, "{at}");
        assert!(settled.iter().all(|p| (p.x - 60.0 - reach).abs() < 1e-6));
    }
    // An edge within the reach holds nobody back.
    let edge = image(300, 60, |p| if p.x > 65.0 { 1.0 } else { 0.0 });
    let (_, report) = relax(&edge, &[1.0], &drawn, &Snake::default()).unwrap();
    assert_eq!((report.held, report.held_at), (0, None));
    assert_eq!((report.slowed, report.crossing), (0, None));
}

#[test]
fn curves_that_are_drawn_across_themselves_are_said_to_be() {
    let picture = spots(100, &mut Chance(5));
    let eight = [
        dvec2(30.0, 30.0),
        dvec2(70.0, 70.0),
        dvec2(70.0, 30.0),
        dvec2(30.0, 70.0),
    ];
    let options = Snake {
        closed: true,
        ..Snake::default()
    };
    let (_, report) = relax(&picture, &[1.0], &eight, &options).unwrap();
    assert!(report.crossed_before, "{report:?}");
    let crossing = report.crossing.unwrap();
    assert!(crossing.distance(dvec2(50.0, 50.0)) < 45.0, "{crossing}");
}

#[test]
fn twenty_thousand_points_are_no_trouble() {
    let centre = dvec2(150.0, 150.0);
    let mut chance = Chance(23);
    let picture = image(300, 300, |p| {
        let share = (100.0 - p.distance(centre)).clamp(-0.5, 0.5);
        share + 0.02 * chance.next()
    });
    for closed in [true, false] {
        let round = if closed { 1.0 } else { 0.8 };
        let drawn: Vec<DVec2> = (0..20_000)
            .map(|i| {
                let angle = round * std::f64::consts::TAU * f64::from(i) / 20_000.0;
                let (sin, cos) = math::sin_cos(angle);
                centre + dvec2(cos, sin) * (103.0 + 2.0 * math::sin(9.0 * angle))
            })
            .collect();
        let options = Snake {
            closed,
            ..Snake::default()
        };
        let (settled, report) = relax(&picture, &[1.0], &drawn, &options).unwrap();
        assert_eq!(settled.len(), drawn.len());
        let far = settled.iter().map(|p| (p.distance(centre) - 100.0).abs());
        let worst = far.fold(0.0, f64::max);
        assert!(worst < 0.5, "{worst}, {report:?}");
        assert_eq!((report.held, report.crossing), (0, None), "{report:?}");
    }
}
