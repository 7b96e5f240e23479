//! Forward mapping: exact where it can be, without holes, with folds and gaps as said.

// A test that cannot be set up has nothing to say.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::{DMat2, DVec2, dvec2};
use anamorph_core::{Affine, Deformation, Facts, Plane, Site, Support, math};
use anamorph_raster::{
    Edge, Filter, Overlap, Raster, SplatOptions, Window, resample_through, splat,
};

struct Given<F>(F);

impl<F: Fn(DVec2) -> DVec2 + Send + Sync> Deformation<Plane> for Given<F> {
    fn map(&self, site: &Site<Plane>) -> DVec2 {
        (self.0)(site.point)
    }
    fn facts(&self) -> Facts<Plane> {
        Facts {
            support: Support::Everywhere,
            ..Facts::identity()
        }
    }
}

fn ramp(width: usize, height: usize, channels: usize) -> Raster {
    let window = Window::new(0, 0, width, height).unwrap();
    let mut raster = Raster::new(window, channels).unwrap();
    for y in 0..height {
        for x in 0..width {
            for (c, sample) in raster.pixel_mut(x, y).iter_mut().enumerate() {
                *sample = x as f32 + 0.01 * y as f32 + c as f32;
            }
        }
    }
    raster
}

#[test]
fn whole_moves_give_the_same_pixels_and_every_pixel_once() {
    for channels in [1, 4] {
        let picture = ramp(23, 17, channels);
        let moved = Affine::translation(dvec2(5.0, -3.0));
        let window = Window::new(5, -3, 23, 17).unwrap();
        let out = splat(&picture, &moved, window, SplatOptions::default()).unwrap();
        assert_eq!(out.raster.samples(), picture.samples());
        assert!(out.layers.iter().all(|&n| n == 1));
    }
}

#[test]
fn smooth_maps_cover_every_pixel_once_and_agree_with_inverse_mapping() {
    let picture = ramp(64, 64, 2);
    let linear = DMat2::from_angle(0.6) * 3.7;
    let forward = Affine {
        linear,
        translation: dvec2(80.0, -60.0),
    };
    let window = Window::new(0, 0, 200, 200).unwrap();
    let out = splat(&picture, &forward, window, SplatOptions::default()).unwrap();
    let inverse = forward.inverted().unwrap();
    let drawn =
        resample_through(&picture, &inverse, Filter::BILINEAR, Edge::Clamp, window).unwrap();
    for y in 0..200 {
        for x in 0..200 {
            let from = inverse.apply(window.centre(x, y));
            // The outline's pixels, less than √½ from it, are covered in part.
            let part = 0.75 / 3.7;
            let inside = from.min_element() > part && from.max_element() < 64.0 - part;
            let outside = from.min_element() < -part || from.max_element() > 64.0 + part;
            let layers = out.layers[y * 200 + x];
            if inside {
                assert_eq!(layers, 1, "({x}, {y})");
                for (a, b) in out.raster.pixel(x, y).iter().zip(drawn.pixel(x, y)) {
                    assert!((a - b).abs() < 1e-4, "({x}, {y}): {a} {b}");
                }
            } else if outside {
                assert_eq!((layers, out.raster.pixel(x, y)), (0, &[0.0, 0.0][..]));
            }
        }
    }
}

#[test]
fn mirrored_pictures_are_covered_too() {
    let picture = ramp(9, 5, 1);
    let mirror = Affine {
        linear: DMat2::from_diagonal(dvec2(-1.0, 1.0)),
        translation: dvec2(9.0, 0.0),
    };
    let out = splat(&picture, &mirror, picture.window(), SplatOptions::default()).unwrap();
    for y in 0..5 {
        for x in 0..9 {
            assert_eq!(out.layers[y * 9 + x], 1);
            assert_eq!(out.raster.pixel(x, y), picture.pixel(8 - x, y));
        }
    }
}

/// The right half folded over the left about `x = 20`.
#[test]
fn folds_show_the_last_the_first_or_the_mean() {
    let picture = ramp(40, 8, 1);
    let fold = Given(|p: DVec2| dvec2(20.0 - (p.x - 20.0).abs(), p.y));
    let draw = |overlap| {
        let options = SplatOptions {
            overlap,
            tear: None,
        };
        splat(&picture, &fold, picture.window(), options).unwrap()
    };
    let (last, first, mean) = (
        draw(Overlap::Last),
        draw(Overlap::First),
        draw(Overlap::Mean),
    );
    assert_eq!(last.layers, first.layers);
    for y in 0..8 {
        for x in 0..40 {
            let layers = last.layers[y * 40 + x];
            // The cell across the fold lies flat on its own axis; next to it everything is covered twice.
            if x < 19 {
                assert_eq!(layers, 2, "({x}, {y})");
                let (a, b) = (picture.pixel(x, y)[0], picture.pixel(39 - x, y)[0]);
                assert_eq!(first.raster.pixel(x, y), [a]);
                assert_eq!(last.raster.pixel(x, y), [b]);
                assert!((mean.raster.pixel(x, y)[0] - 0.5 * (a + b)).abs() < 1e-5);
            } else if x >= 20 {
                assert_eq!(layers, 0, "({x}, {y})");
            }
        }
    }
}

/// The right half pulled away by ten pixels.
#[test]
fn gaps_are_filled_unless_they_may_tear() {
    let picture = ramp(20, 6, 1);
    let part = Given(|p: DVec2| if p.x > 10.0 { p + dvec2(10.0, 0.0) } else { p });
    let window = Window::new(0, 0, 30, 6).unwrap();
    let filled = splat(&picture, &part, window, SplatOptions::default()).unwrap();
    assert!(filled.layers.iter().all(|&n| n == 1));
    let row: Vec<f32> = (0..30).map(|x| filled.raster.pixel(x, 0)[0]).collect();
    assert!(row.windows(2).all(|w| w[1] > w[0]), "{row:?}");
    let options = SplatOptions {
        tear: Some(3.0),
        ..SplatOptions::default()
    };
    let torn = splat(&picture, &part, window, options).unwrap();
    let holes =
        |x: usize| (0..6).all(|y| torn.layers[y * 30 + x] == 0 && torn.raster.pixel(x, y) == [0.0]);
    let gap: Vec<usize> = (0..30).filter(|&x| holes(x)).collect();
    // The cell between the last pixel that stays and the first that goes owns its left side.
    assert!(
        gap.len() >= 10 && gap.iter().all(|x| (9..=20).contains(x)),
        "{gap:?}"
    );
    let broken = SplatOptions {
        tear: Some(f64::NAN),
        ..options
    };
    assert!(splat(&picture, &part, window, broken).is_err());
}

#[test]
fn what_is_not_finite_is_left_out_and_threads_change_nothing() {
    let picture = ramp(60, 50, 3);
    let wild = Given(|p: DVec2| {
        if p.x > 30.0 && p.x < 32.0 {
            DVec2::NAN
        } else {
            p + dvec2(math::sin(p.y * 0.3), math::cos(p.x * 0.2)) * 9.0
        }
    });
    let window = Window::new(-10, -10, 80, 90).unwrap();
    let draw = |threads: usize, overlap| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            splat(
                &picture,
                &wild,
                window,
                SplatOptions {
                    overlap,
                    tear: None,
                },
            )
            .unwrap()
        })
    };
    for overlap in [Overlap::Last, Overlap::First, Overlap::Mean] {
        let one = draw(1, overlap);
        assert!(one.raster.samples().iter().all(|s| s.is_finite()));
        assert!(one.layers.contains(&0) && one.layers.iter().any(|&n| n > 1));
        assert_eq!(draw(3, overlap), one);
    }
}

/// A picture of ones, turned and enlarged, is as opaque as the share of each pixel that it covers.
#[test]
fn outlines_are_as_opaque_as_they_are_covered() {
    let window = Window::new(0, 0, 40, 30).unwrap();
    let mut picture = Raster::new(window, 2).unwrap();
    picture.samples_mut().fill(1.0);
    let target = Window::new(0, 0, 90, 90).unwrap();
    for (turn, scale) in [(20.0_f64, 1.0), (20.0, 1.35), (-67.0, 0.4), (3.0, 2.2)] {
        let forward = Affine {
            linear: DMat2::from_angle(turn.to_radians()) * scale,
            translation: dvec2(31.3, 30.7),
        };
        let inverse = forward.inverted().unwrap();
        let out = splat(&picture, &forward, target, SplatOptions::default()).unwrap();
        let mut shades = 0;
        for y in 0..90 {
            for x in 0..90 {
                let corner = target.centre(x, y) - 0.5;
                let mut share = 0.0;
                for i in 0..1024_u32 {
                    let own = dvec2(f64::from(i % 32) + 0.5, f64::from(i / 32) + 0.5) / 32.0;
                    let from = inverse.apply(corner + own);
                    let is_in =
                        from.cmpge(DVec2::ZERO).all() && from.cmplt(dvec2(40.0, 30.0)).all();
                    share += f64::from(u8::from(is_in)) / 1024.0;
                }
                let found = out.raster.pixel(x, y);
                assert_eq!(found[0], found[1]);
                let error = (f64::from(found[0]) - share).abs();
                assert!(
                    error < 0.02,
                    "{turn}° × {scale}, ({x}, {y}): {found:?}, not {share}"
                );
                // What is whole is so exactly, and so is what is empty.
                let from = inverse.apply(corner + 0.5);
                let margin = 0.75 / scale;
                let low = from.min_element();
                let room = low.min(40.0 - from.x).min(30.0 - from.y);
                if room > margin {
                    assert_eq!(found, [1.0, 1.0]);
                } else if room < -margin {
                    assert_eq!(found, [0.0, 0.0]);
                }
                shades += usize::from(found[0] > 0.05 && found[0] < 0.95);
            }
        }
        assert!(shades > 30, "{turn}° × {scale}: {shades}");
    }
}

/// Along a slanted outline the coverage falls step by step, never back.
#[test]
fn coverage_across_a_slanted_outline_is_a_ramp() {
    let window = Window::new(0, 0, 60, 60).unwrap();
    let mut picture = Raster::new(window, 1).unwrap();
    picture.samples_mut().fill(1.0);
    let forward = Affine {
        linear: DMat2::from_angle(0.2) * 1.1,
        translation: dvec2(20.0, 5.0),
    };
    let target = Window::new(0, 0, 80, 80).unwrap();
    let out = splat(&picture, &forward, target, SplatOptions::default()).unwrap();
    // Down through the upper outline, which rises by tan 0.2 = 0.2027 a pixel.
    let whole: Vec<f64> = (30..60)
        .map(|x| (0..30).map(|y| f64::from(out.raster.pixel(x, y)[0])).sum())
        .collect();
    for pair in whole.windows(2) {
        let rise = pair[0] - pair[1];
        assert!((rise - 0.2027).abs() < 1e-3, "{rise}");
    }
    for x in 30..60 {
        let column: Vec<f32> = (0..30).map(|y| out.raster.pixel(x, y)[0]).collect();
        assert!(
            column.windows(2).all(|pair| pair[0] <= pair[1]),
            "{column:?}"
        );
        assert!(column.iter().filter(|&&v| v > 0.0 && v < 1.0).count() <= 2);
    }
}
