//! Snakes settle on edges that are known, from rough curves, on clear, blurred and noisy images, and stay where there is no edge.

// A test that cannot be set up has nothing to say.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::math;
use anamorph_raster::snake::{Ends, Snake, SnakeError, relax};
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

/// An image whose light is a function of the pixel's centre, averaged over the pixel.
fn image(size: usize, light: impl Fn(DVec2) -> f64) -> Raster {
    let window = Window::new(0, 0, size, size).unwrap();
    let mut image = Raster::new(window, 1).unwrap();
    for row in 0..size {
        for column in 0..size {
            let mut sum = 0.0;
            for i in 0..16 {
                let part = dvec2(f64::from(i % 4), f64::from(i / 4)) * 0.25 - 0.375;
                sum += light(window.centre(column, row) + part);
            }
            image.pixel_mut(column, row)[0] = (sum / 16.0) as f32;
        }
    }
    image
}

/// A disc of light 1 on a ground of light 0.2, its edge `soft` pixels wide.
fn disc(size: usize, centre: DVec2, radius: f64, soft: f64) -> Raster {
    image(size, |p| {
        let share = (radius - p.distance(centre)) / soft.max(1e-9) + 0.5;
        let share = share.clamp(0.0, 1.0);
        0.2 + 0.8 * share * share * (3.0 - 2.0 * share)
    })
}

fn circle(centre: DVec2, radius: f64, count: usize, mut off: impl FnMut() -> f64) -> Vec<DVec2> {
    (0..count)
        .map(|i| {
            let (sin, cos) = math::sin_cos(std::f64::consts::TAU * i as f64 / count as f64);
            centre + dvec2(cos, sin) * (radius + off())
        })
        .collect()
}

const CLOSED: Snake = Snake {
    closed: true,
    ends: Ends::Free,
    sigma: 1.0,
    reach: 10.0,
    alpha: 1.0,
    beta: 1.0,
    points: None,
};

#[test]
fn rough_circles_settle_on_the_edge_of_a_disc() {
    let mut chance = Chance(7);
    for (radius, count) in [(9.0, 12), (20.0, 16), (41.5, 40), (60.0, 9)] {
        for (soft, noise) in [(0.0, 0.0), (4.0, 0.0), (1.0, 0.06), (4.0, 0.03)] {
            for (off, rough) in [(0.0, 1.5), (5.0, 0.0), (-4.0, 1.0), (2.0, 3.0)] {
                let centre = dvec2(80.3, 77.8) + dvec2(chance.next(), chance.next());
                let mut image = disc(160, centre, radius, soft);
                for sample in image.samples_mut() {
                    *sample += (noise * chance.next()) as f32;
                }
                let drawn_about = centre + dvec2(chance.next(), chance.next());
                let drawn = circle(drawn_about, radius + off, count, || rough * chance.next());
                let options = Snake {
                    sigma: if noise > 0.0 { 2.0 } else { 1.0 },
                    points: Some(200),
                    ..CLOSED
                };
                let (settled, report) = relax(&image, &[1.0], &drawn, &options).unwrap();
                assert_eq!(settled.len(), 200);
                let far = |p: &DVec2| (p.distance(centre) - radius).abs();
                let worst = settled.iter().map(far).fold(0.0, f64::max);
                let mean = settled.iter().map(far).sum::<f64>() / 200.0;
                let what = format!(
                    "radius {radius}, {count} points, soft {soft}, noise {noise}, off {off}, rough {rough}: \
                     worst {worst}, mean {mean}, {report:?}"
                );
                assert!(worst < 0.5, "{what}");
                // Smoothing draws the edge of a disc inwards, by about σ²/2r.
                let inwards = options.sigma * options.sigma / (2.0 * radius);
                assert!(mean < 0.15 + inwards, "{what}");
                assert!(report.edge_after >= report.edge_before, "{what}");
                // And evenly all round.
                let steps = settled.windows(2).map(|pair| pair[0].distance(pair[1]));
                let (least, most) = steps.fold((f64::INFINITY, 0.0_f64), |(low, high), step| {
                    (low.min(step), high.max(step))
                });
                assert!(most < 1.1 * least, "{what}: {least} to {most}");
            }
        }
    }
}

#[test]
fn given_points_are_followed_one_by_one() {
    let centre = dvec2(60.0, 62.0);
    let drawn = circle(centre, 33.0, 24, || 0.0);
    let (settled, report) = relax(&disc(128, centre, 30.0, 1.0), &[1.0], &drawn, &CLOSED).unwrap();
    assert_eq!(settled.len(), drawn.len());
    for (from, to) in drawn.iter().zip(&settled) {
        // Straight in, not along the edge.
        let [a, b] = [from, to].map(|p| (*p - centre).normalize());
        assert!(a.distance(b) < 0.01, "{from} {to}");
    }
    assert!(
        (report.mean - 3.0).abs() < 0.2 && report.farthest < 3.4,
        "{report:?}"
    );
    assert!(report.settled, "{report:?}");
}

#[test]
fn a_flat_image_leaves_the_curve_where_it_is() {
    let mut chance = Chance(3);
    let drawn = circle(dvec2(30.0, 31.0), 12.0, 20, || chance.next());
    for light in [0.0, 0.7, 1e6] {
        let flat = image(64, |_| light);
        let (settled, report) = relax(&flat, &[1.0], &drawn, &CLOSED).unwrap();
        assert_eq!(settled, drawn);
        assert_eq!((report.farthest, report.steps), (0.0, 0));
        assert!(report.settled);
    }
    // An edge that is out of reach is no reason to shrink either.
    let far = image(300, |p| if p.x > 250.0 { 1.0 } else { 0.0 });
    let (settled, report) = relax(&far, &[1.0], &drawn, &CLOSED).unwrap();
    assert_eq!(settled, drawn, "{report:?}");
}

#[test]
fn open_curves_settle_and_fixed_ends_stay() {
    // An edge along a wave.
    let wave = |x: f64| 50.0 + 8.0 * math::sin(x / 14.0);
    let picture = image(100, |p| if p.y > wave(p.x) { 0.9 } else { 0.1 });
    let drawn: Vec<DVec2> = (0..12)
        .map(|i| {
            let x = 8.0 + 7.5 * f64::from(i);
            dvec2(x, wave(x) + if i % 2 == 0 { 3.0 } else { -3.5 })
        })
        .collect();
    let options = Snake {
        points: Some(60),
        ..Snake::default()
    };
    let (settled, _) = relax(&picture, &[1.0], &drawn, &options).unwrap();
    for p in &settled {
        assert!((p.y - wave(p.x)).abs() < 0.5, "{p} {}", wave(p.x));
    }
    let fixed = Snake {
        ends: Ends::Fixed,
        ..Snake::default()
    };
    let (settled, _) = relax(&picture, &[1.0], &drawn, &fixed).unwrap();
    assert_eq!((settled[0], settled[11]), (drawn[0], drawn[11]));
    for p in &settled[2..10] {
        assert!((p.y - wave(p.x)).abs() < 0.5, "{p} {}", wave(p.x));
    }
}

#[test]
fn the_channels_that_count_are_those_asked_for_and_windows_may_begin_anywhere() {
    let centre = dvec2(-40.0, 1030.0);
    let window = Window::new(-90, 980, 100, 100).unwrap();
    let mut image = Raster::new(window, 3).unwrap();
    for row in 0..100 {
        for column in 0..100 {
            let p = window.centre(column, row);
            let inside = |radius: f64| f32::from(u8::from(p.distance(centre) < radius));
            let own = [inside(20.0), inside(30.0), f32::NAN];
            image.pixel_mut(column, row).copy_from_slice(&own);
        }
    }
    let drawn = circle(centre, 25.0, 30, || 0.0);
    for (weights, radius) in [([1.0, 0.0, 0.0], 20.0), ([0.0, 1.0, 0.0], 30.0)] {
        let (settled, _) = relax(&image, &weights, &drawn, &CLOSED).unwrap();
        for p in settled {
            assert!((p.distance(centre) - radius).abs() < 0.5, "{p} {radius}");
        }
    }
    // What is not finite is no edge.
    let (settled, _) = relax(&image, &[0.0, 0.0, 1.0], &drawn, &CLOSED).unwrap();
    assert_eq!(settled, drawn);
}

#[test]
fn threads_change_nothing() {
    let centre = dvec2(50.0, 50.0);
    let image = disc(100, centre, 27.0, 2.0);
    let mut chance = Chance(11);
    let drawn = circle(centre, 30.0, 25, || 2.0 * chance.next());
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| relax(&image, &[1.0], &drawn, &CLOSED).unwrap())
    };
    assert_eq!(of(1), of(3));
}

#[test]
fn bad_curves_and_settings_are_refused() {
    let image = disc(64, dvec2(32.0, 32.0), 20.0, 1.0);
    let good = circle(dvec2(32.0, 32.0), 21.0, 10, || 0.0);
    let fails = |weights: &[f64], points: &[DVec2], options: Snake, says: &str| {
        let error = relax(&image, weights, points, &options).unwrap_err();
        assert!(error.to_string().contains(says), "{error}");
        error
    };
    let one = &[1.0][..];
    fails(one, &[], CLOSED, "0 points");
    fails(one, &good[..1], Snake::default(), "1 point,");
    fails(one, &good[..2], CLOSED, "a closed curve needs at least 3");
    fails(one, &[good[0]; 5], CLOSED, "in one place");
    let mut odd = good.clone();
    odd[4].y = f64::NAN;
    let error = fails(one, &odd, CLOSED, "point 4");
    assert_eq!(error, SnakeError::NotFinite { index: 4 });
    odd[4] = dvec2(70.0, 3.0);
    fails(one, &odd, CLOSED, "(70, 3)");
    fails(&[], &good, CLOSED, "0 weights");
    fails(&[0.0], &good, CLOSED, "not all 0");
    fails(&[f64::NAN], &good, CLOSED, "finite");
    for (options, says) in [
        (
            Snake {
                sigma: 0.0,
                ..CLOSED
            },
            "`sigma` is 0",
        ),
        (
            Snake {
                sigma: f64::NAN,
                ..CLOSED
            },
            "`sigma`",
        ),
        (
            Snake {
                reach: -1.0,
                ..CLOSED
            },
            "`reach`",
        ),
        (
            Snake {
                alpha: -0.5,
                ..CLOSED
            },
            "`alpha`",
        ),
        (
            Snake {
                beta: f64::INFINITY,
                ..CLOSED
            },
            "`beta`",
        ),
        (
            Snake {
                points: Some(2),
                ..CLOSED
            },
            "`points` is 2",
        ),
    ] {
        fails(one, &good, options, says);
    }
    // Tiny images and doubled points are odd, and no errors.
    let tiny = Raster::new(Window::new(0, 0, 1, 1).unwrap(), 1).unwrap();
    let line = [dvec2(0.1, 0.2), dvec2(0.1, 0.2), dvec2(0.9, 0.4)];
    let (settled, _) = relax(&tiny, one, &line, &Snake::default()).unwrap();
    assert_eq!(settled, line);
}
