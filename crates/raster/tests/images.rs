//! Resampling: exact identities, an independent resampler, edges, numbers that are not finite, and shrinking without alias.

// A test that cannot be set up has nothing to say.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::{DMat2, DVec2, dvec2};
use anamorph_core::{Affine, Deformation, Facts, Plane, Site, Support, math};
use anamorph_raster::{
    Edge, Filter, PixelMap, Raster, Sampler, Window, resample, resample_into, resample_through,
};

fn window(width: usize, height: usize) -> Window {
    Window::new(0, 0, width, height).unwrap()
}

fn noise(window: Window, channels: usize) -> Raster {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let samples = (0..window.pixels().unwrap() * channels)
        .map(|_| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 40) as f32 / (1 << 24) as f32
        })
        .collect();
    Raster::from_samples(window, channels, samples).unwrap()
}

/// A smooth picture.
fn waves(window: Window, channels: usize) -> Raster {
    let mut raster = Raster::new(window, channels).unwrap();
    for y in 0..window.height() {
        for x in 0..window.width() {
            let p = window.centre(x, y);
            for (c, sample) in raster.pixel_mut(x, y).iter_mut().enumerate() {
                let phase = c as f64;
                *sample = (0.5
                    + 0.25 * math::sin(p.x * 0.11 + phase)
                    + 0.2 * math::cos(p.y * 0.07 - phase)) as f32;
            }
        }
    }
    raster
}

fn bits(raster: &Raster) -> Vec<u32> {
    raster.samples().iter().map(|s| s.to_bits()).collect()
}

#[test]
fn the_identity_gives_the_same_pixels() {
    for channels in [1, 2, 3, 4, 5, 9] {
        let window = Window::new(-7, 1_000_000, 19, 23).unwrap();
        let mut picture = noise(window, channels);
        let odd = [
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            -0.0,
            f32::MIN_POSITIVE / 8.0,
            f32::MAX,
        ];
        for (i, value) in odd.into_iter().enumerate() {
            picture.pixel_mut(3 * i, 2 * i + 1).fill(value);
        }
        let map = PixelMap::identity(window).unwrap();
        for filter in Filter::all().filter(|f| f.interpolates()) {
            for edge in Edge::all() {
                let same = resample(&picture, &map, filter, edge).unwrap();
                assert_eq!(
                    bits(&same),
                    bits(&picture),
                    "{filter:?} {edge:?} {channels}"
                );
            }
        }
    }
}

#[test]
fn moves_by_whole_pixels_are_exact_and_edges_go_on() {
    let picture = noise(window(5, 4), 4);
    for edge in Edge::all() {
        for filter in Filter::all().filter(|f| f.interpolates()) {
            let moved = resample_through(
                &picture,
                &Affine::translation(dvec2(-3.0, 2.0)),
                filter,
                edge,
                window(9, 9),
            )
            .unwrap();
            for y in 0..9_i64 {
                for x in 0..9_i64 {
                    let (sx, sy) = (x - 3, y + 2);
                    let expected: Vec<f32> = match edge {
                        Edge::Clamp => picture
                            .pixel(sx.clamp(0, 4) as usize, sy.clamp(0, 3) as usize)
                            .to_vec(),
                        Edge::Wrap => picture
                            .pixel(sx.rem_euclid(5) as usize, sy.rem_euclid(4) as usize)
                            .to_vec(),
                        Edge::Mirror => {
                            let m = |i: i64, n: i64| {
                                let j = i.rem_euclid(2 * n);
                                (if j < n { j } else { 2 * n - 1 - j }) as usize
                            };
                            picture.pixel(m(sx, 5), m(sy, 4)).to_vec()
                        }
                        Edge::Transparent if (0..5).contains(&sx) && (0..4).contains(&sy) => {
                            picture.pixel(sx as usize, sy as usize).to_vec()
                        }
                        Edge::Transparent => vec![0.0; 4],
                    };
                    assert_eq!(
                        moved.pixel(x as usize, y as usize),
                        expected,
                        "{filter:?} {edge:?} {x} {y}"
                    );
                }
            }
        }
    }
}

/// Another way to the same numbers: the kernels by their published formulas, the whole neighbourhood summed, in `f64`.
fn plainly(picture: &Raster, filter: Filter, at: DVec2, channel: usize) -> f64 {
    let cubic = |x: f64, b: f64, c: f64| {
        let x = x.abs();
        if x < 1.0 {
            ((12.0 - 9.0 * b - 6.0 * c) * x.powi(3) + (-18.0 + 12.0 * b + 6.0 * c) * x * x + 6.0
                - 2.0 * b)
                / 6.0
        } else if x < 2.0 {
            ((-b - 6.0 * c) * x.powi(3)
                + (6.0 * b + 30.0 * c) * x * x
                + (-12.0 * b - 48.0 * c) * x
                + 8.0 * b
                + 24.0 * c)
                / 6.0
        } else {
            0.0
        }
    };
    let sinc = |x: f64| {
        if x == 0.0 {
            1.0
        } else {
            (core::f64::consts::PI * x).sin() / (core::f64::consts::PI * x)
        }
    };
    let kernel = |x: f64| match filter.name() {
        "bilinear" => (1.0 - x.abs()).max(0.0),
        "catmull-rom" => cubic(x, 0.0, 0.5),
        "mitchell" => cubic(x, 1.0 / 3.0, 1.0 / 3.0),
        _ => {
            if x.abs() < 3.0 {
                sinc(x) * sinc(x / 3.0)
            } else {
                0.0
            }
        }
    };
    let (mut sum, mut total) = (0.0, 0.0);
    let (cx, cy) = (at.x.floor() as i64, at.y.floor() as i64);
    for y in cy - 4..=cy + 4 {
        for x in cx - 4..=cx + 4 {
            let weight = kernel(at.x - x as f64 - 0.5) * kernel(at.y - y as f64 - 0.5);
            let column = x.clamp(0, picture.width() as i64 - 1) as usize;
            let row = y.clamp(0, picture.height() as i64 - 1) as usize;
            sum += weight * f64::from(picture.pixel(column, row)[channel]);
            total += weight;
        }
    }
    sum / total
}

fn turn(angle: f64, centre: DVec2) -> Affine<Plane> {
    let linear = DMat2::from_angle(angle);
    Affine {
        linear,
        translation: centre - linear * centre,
    }
}

#[test]
fn a_known_rotation_agrees_with_an_independent_resampler() {
    for channels in [3, 4] {
        let picture = noise(window(41, 37), channels);
        let inverse = turn(0.37, dvec2(20.0, 19.0));
        for name in ["bilinear", "catmull-rom", "mitchell", "lanczos"] {
            let filter = Filter::by_name(name).unwrap();
            let turned =
                resample_through(&picture, &inverse, filter, Edge::Clamp, window(41, 37)).unwrap();
            for y in 0..37 {
                for x in 0..41 {
                    let at = inverse.apply(dvec2(x as f64 + 0.5, y as f64 + 0.5));
                    for c in 0..channels {
                        let exact = plainly(&picture, filter, at, c);
                        let ours = f64::from(turned.pixel(x, y)[c]);
                        // Positions are good to about 10⁻⁶ of a pixel, and neighbouring pixels differ by up to 1.
                        assert!(
                            (ours - exact).abs() < 2e-5,
                            "{name} ({x}, {y}): {ours} {exact}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn turning_and_turning_back_keeps_the_picture() {
    let picture = waves(window(128, 128), 4);
    let centre = dvec2(64.0, 64.0);
    let least = |name: &str| match name {
        "nearest" => 25.0,
        "bilinear" => 45.0,
        "mitchell" => 40.0,
        "anisotropic" => 38.0,
        _ => 70.0,
    };
    for filter in Filter::all() {
        let there = resample_through(
            &picture,
            &turn(0.5, centre),
            filter,
            Edge::Clamp,
            picture.window(),
        )
        .unwrap();
        let back = resample_through(
            &there,
            &turn(-0.5, centre),
            filter,
            Edge::Clamp,
            picture.window(),
        )
        .unwrap();
        let (mut error, mut count) = (0.0, 0);
        for y in 0..128 {
            for x in 0..128 {
                // What left the window does not come back.
                if (picture.window().centre(x, y) - centre).length() < 55.0 {
                    for (a, b) in back.pixel(x, y).iter().zip(picture.pixel(x, y)) {
                        error += f64::from(a - b).powi(2);
                        count += 1;
                    }
                }
            }
        }
        let psnr = -10.0 * (error / f64::from(count)).log10();
        assert!(psnr > least(filter.name()), "{filter:?}: {psnr} dB");
    }
}

#[test]
fn constants_stay_constant_everywhere() {
    let mut picture = Raster::new(window(33, 17), 3).unwrap();
    picture.samples_mut().fill(0.7);
    let inverse = Affine {
        linear: DMat2::from_cols_array(&[3.1, 0.4, -0.7, 1.9]),
        translation: dvec2(-40.0, -10.0),
    };
    for filter in Filter::all() {
        for edge in [Edge::Clamp, Edge::Wrap, Edge::Mirror] {
            let out = resample_through(&picture, &inverse, filter, edge, window(50, 40)).unwrap();
            for sample in out.samples() {
                assert!((sample - 0.7).abs() < 2e-6, "{filter:?} {edge:?} {sample}");
            }
        }
    }
}

#[test]
fn what_is_not_finite_shows_only_as_far_as_the_filter_reaches() {
    for (name, reach) in [
        ("nearest", 1),
        ("bilinear", 1),
        ("catmull-rom", 2),
        ("mitchell", 2),
        ("lanczos", 3),
        ("anisotropic", 1),
    ] {
        let filter = Filter::by_name(name).unwrap();
        for value in [f32::NAN, f32::INFINITY] {
            for channels in [1, 4] {
                let mut picture = noise(window(21, 21), channels);
                picture.pixel_mut(10, 10).fill(value);
                // Half way across, nothing down: the rows above and below have no weight.
                let half = Affine::translation(dvec2(0.5, 0.0));
                let out = resample_through(&picture, &half, filter, Edge::Clamp, picture.window())
                    .unwrap();
                let down = if filter.interpolates() { 0 } else { reach };
                for y in 0..21_i64 {
                    for x in 0..21_i64 {
                        let near = (x - 10).abs() <= reach && (y - 10).abs() <= down;
                        let finite = out
                            .pixel(x as usize, y as usize)
                            .iter()
                            .all(|s| s.is_finite());
                        assert!(near || finite, "{name} ({x}, {y})");
                    }
                }
                assert!(out.samples().iter().any(|s| !s.is_finite()), "{name}");
            }
        }
    }
}

#[test]
fn an_infinite_pixel_beside_a_finite_one_is_infinite_and_not_lost() {
    let picture = Raster::from_samples(window(2, 1), 1, vec![f32::INFINITY, 1.0]).unwrap();
    for filter in [Filter::BILINEAR, Filter::ANISOTROPIC] {
        let sampler = Sampler::new(&picture, filter, Edge::Clamp);
        let mut out = [0.0];
        sampler.sample(dvec2(1.0, 0.5), DMat2::IDENTITY, &mut out);
        assert_eq!(out, [f32::INFINITY], "{filter:?}");
    }
}

#[test]
fn positions_that_are_nowhere_give_nothing() {
    let picture = noise(window(3, 3), 4);
    for filter in Filter::all() {
        for edge in Edge::all() {
            let sampler = Sampler::new(&picture, filter, edge);
            for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut out = [5.0; 4];
                sampler.sample(dvec2(x, 1.0), DMat2::IDENTITY, &mut out);
                assert_eq!(out, [0.0; 4]);
            }
            for x in [1e300, -1e300, 1e18] {
                let mut out = [f32::NAN; 4];
                sampler.sample(dvec2(x, -x), DMat2::IDENTITY, &mut out);
                assert!(out.iter().all(|s| s.is_finite()), "{filter:?} {edge:?}");
            }
        }
    }
}

/// A chessboard of single pixels shrunk by 7.3: a filter that aliases shows patterns, one that does not is grey.
#[test]
fn shrinking_does_not_alias() {
    let mut board = Raster::new(window(401, 401), 1).unwrap();
    for y in 0..401 {
        for x in 0..401 {
            board.pixel_mut(x, y)[0] = ((x + y) % 2) as f32;
        }
    }
    let shrink = Affine {
        linear: DMat2::from_diagonal(dvec2(7.3, 7.3)),
        translation: dvec2(0.0, 0.0),
    };
    let spread = |filter: Filter| {
        let small = resample_through(&board, &shrink, filter, Edge::Clamp, window(54, 54)).unwrap();
        small
            .samples()
            .iter()
            .map(|s| (s - 0.5).abs())
            .fold(0.0, f32::max)
    };
    assert!(spread(Filter::CATMULL_ROM) > 0.3);
    assert!(
        spread(Filter::ANISOTROPIC) < 0.02,
        "{}",
        spread(Filter::ANISOTROPIC)
    );
}

/// Stripes squeezed across only: detail along them stays, detail across is averaged.
#[test]
fn the_anisotropic_filter_follows_the_direction() {
    let mut stripes = Raster::new(window(256, 256), 1).unwrap();
    for y in 0..256 {
        for x in 0..256 {
            let fine_across = (x % 2) as f32;
            let coarse_down = ((y / 8) % 2) as f32;
            stripes.pixel_mut(x, y)[0] = 0.5 * fine_across + 0.5 * coarse_down;
        }
    }
    let squeeze = Affine {
        linear: DMat2::from_diagonal(dvec2(8.0, 1.0)),
        translation: dvec2(0.0, 0.0),
    };
    let out = resample_through(
        &stripes,
        &squeeze,
        Filter::ANISOTROPIC,
        Edge::Mirror,
        window(32, 256),
    )
    .unwrap();
    for y in 0..256 {
        for x in 0..32 {
            let expected = 0.25 + 0.5 * ((y / 8) % 2) as f32;
            let sample = out.pixel(x, y)[0];
            assert!(
                (sample - expected).abs() < 0.02,
                "({x}, {y}): {sample} {expected}"
            );
        }
    }
}

#[test]
fn maps_and_deformations_draw_the_same_picture_on_any_number_of_threads() {
    struct Swirl;
    impl Deformation<Plane> for Swirl {
        fn map(&self, site: &Site<Plane>) -> DVec2 {
            let p = site.point;
            p + dvec2(math::sin(p.y * 0.1), math::cos(p.x * 0.13)) * 12.0
        }
        fn facts(&self) -> Facts<Plane> {
            Facts {
                support: Support::Everywhere,
                ..Facts::identity()
            }
        }
    }
    let picture = noise(Window::new(-3, 5, 90, 70).unwrap(), 4);
    let target = Window::new(-20, -10, 131, 97).unwrap();
    let map = PixelMap::from_deformation(&Swirl, target).unwrap();
    let draw = |threads: usize, filter: Filter| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let through = resample_through(&picture, &Swirl, filter, Edge::Mirror, target).unwrap();
            let mapped = resample(&picture, &map, filter, Edge::Mirror).unwrap();
            assert_eq!(bits(&through), bits(&mapped), "{filter:?}");
            bits(&mapped)
        })
    };
    for filter in Filter::all() {
        let one = draw(1, filter);
        assert_eq!(draw(2, filter), one);
        assert_eq!(draw(7, filter), one);
    }
}

#[test]
fn quick_and_plain_ways_agree() {
    // Four channels with the bilinear filter have a way of their own.
    let four = noise(window(40, 30), 4);
    let map = PixelMap::from_positions(four.window(), |x, y| {
        dvec2(x as f64 * 1.3 - 4.2, y as f64 * 0.9 + 0.125)
    })
    .unwrap();
    let quick = resample(&four, &map, Filter::BILINEAR, Edge::Mirror).unwrap();
    let sampler = Sampler::new(&four, Filter::BILINEAR, Edge::Mirror);
    for y in 0..30 {
        for x in 0..40 {
            let mut out = [0.0; 4];
            sampler.sample(map.position(x, y).unwrap(), DMat2::IDENTITY, &mut out);
            for (a, b) in quick.pixel(x, y).iter().zip(out) {
                assert!((a - b).abs() < 1e-6, "({x}, {y}): {a} {b}");
            }
        }
    }
}

#[test]
fn targets_that_do_not_fit_are_refused() {
    let picture = noise(window(4, 4), 3);
    let map = PixelMap::identity(window(4, 4)).unwrap();
    let draw =
        |target: &mut Raster| resample_into(&picture, &map, Filter::NEAREST, Edge::Clamp, target);
    assert!(draw(&mut Raster::new(window(4, 5), 3).unwrap()).is_err());
    assert!(draw(&mut Raster::new(window(4, 4), 4).unwrap()).is_err());
    let mut fits = Raster::new(window(4, 4), 3).unwrap();
    draw(&mut fits).unwrap();
    assert_eq!(fits, picture);
}
