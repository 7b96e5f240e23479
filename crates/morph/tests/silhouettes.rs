//! Silhouettes follow what an image shows to a fraction of a pixel, with holes, closed at the border.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_meshing::planar::Region;
use anamorph_morph::shapes::{area, crossings};
use anamorph_morph::silhouette::{
    Measure, SilhouetteError, SilhouetteOptions, silhouette, simplify_rings, smooth,
};
use anamorph_raster::{Raster, Window};

/// An image of one channel: how much of each pixel is covered, by 16 × 16 places in it.
fn painted(width: usize, height: usize, inside: impl Fn(DVec2) -> bool) -> Raster {
    let window = Window::new(0, 0, width, height).unwrap();
    let mut image = Raster::new(window, 1).unwrap();
    for y in 0..height {
        for x in 0..width {
            let places = (0..256).map(|k| {
                dvec2(f64::from(k % 16) + 0.5, f64::from(k / 16) + 0.5) / 16.0
                    + dvec2(x as f64, y as f64)
            });
            let covered = places.filter(|p| inside(*p)).count();
            image.pixel_mut(x, y)[0] = covered as f32 / 256.0;
        }
    }
    image
}

fn options() -> SilhouetteOptions {
    SilhouetteOptions {
        measure: Measure::Channel(0),
        ..SilhouetteOptions::default()
    }
}

fn exact() -> SilhouetteOptions {
    SilhouetteOptions {
        smoothing: 0,
        tolerance: 0.0,
        least_area: 0.0,
        ..options()
    }
}

fn assert_simple(regions: &[Region]) {
    for region in regions {
        let rings: Vec<&[DVec2]> = core::iter::once(&region.outer)
            .chain(&region.holes)
            .map(Vec::as_slice)
            .collect();
        assert_eq!(crossings(&rings, 5), []);
        assert!(area(&region.outer) > 0.0 && region.holes.iter().all(|hole| area(hole) < 0.0));
    }
}

#[test]
fn a_disk_is_followed_to_a_twentieth_of_a_pixel() {
    let centre = dvec2(31.3, 28.9);
    let image = painted(64, 60, |p| p.distance(centre) < 20.4);
    for (options, most) in [
        (exact(), 0.05),
        (
            SilhouetteOptions {
                tolerance: 0.0,
                ..options()
            },
            0.05,
        ),
        (options(), 0.15),
    ] {
        let regions = silhouette(&image, &options).unwrap();
        assert_simple(&regions);
        assert_eq!((regions.len(), regions[0].holes.len()), (1, 0));
        let off = regions[0]
            .outer
            .iter()
            .map(|p| (p.distance(centre) - 20.4).abs())
            .fold(0.0, f64::max);
        assert!(off < most, "{off}");
        let whole = core::f64::consts::PI * 20.4 * 20.4;
        assert!((area(&regions[0].outer) - whole).abs() < 0.01 * whole);
        if options.tolerance > 0.0 {
            assert!(regions[0].outer.len() < 60);
        }
    }
    // The window's place is the outline's.
    let moved = Raster::from_samples(
        Window::new(100, -50, 64, 60).unwrap(),
        1,
        image.samples().to_vec(),
    )
    .unwrap();
    let there = silhouette(&moved, &exact()).unwrap();
    let here = silhouette(&image, &exact()).unwrap();
    for (p, q) in there[0].outer.iter().zip(&here[0].outer) {
        assert!((*p - *q - dvec2(100.0, -50.0)).length() < 1e-9);
    }
}

#[test]
fn rings_have_holes_and_borders_are_closed() {
    let centre = dvec2(20.0, 20.0);
    let ring = painted(40, 40, |p| (8.0..15.0).contains(&p.distance(centre)));
    let regions = silhouette(&ring, &options()).unwrap();
    assert_simple(&regions);
    assert_eq!((regions.len(), regions[0].holes.len()), (1, 1));

    let all = painted(7, 5, |_| true);
    let regions = silhouette(&all, &exact()).unwrap();
    assert_simple(&regions);
    assert_eq!(regions.len(), 1);
    // All but the corners, which are cut.
    assert!(
        (area(&regions[0].outer) - 35.0).abs() < 0.51,
        "{}",
        area(&regions[0].outer)
    );
    for point in &regions[0].outer {
        assert!(
            point.x >= -1e-9 && point.x <= 7.0 + 1e-9 && point.y >= -1e-9 && point.y <= 5.0 + 1e-9
        );
    }
}

#[test]
fn what_is_left_open_is_decided_once() {
    // Every cell of a chequerboard is ambiguous.
    for level in [0.3, 0.5, 0.7] {
        let mut image = Raster::new(Window::new(0, 0, 9, 9).unwrap(), 1).unwrap();
        for y in 0..9 {
            for x in 0..9 {
                image.pixel_mut(x, y)[0] = ((x + y) % 2) as f32;
            }
        }
        let regions = silhouette(&image, &SilhouetteOptions { level, ..exact() }).unwrap();
        assert_simple(&regions);
        // Joined where the saddle is inside, apart where it is not.
        assert_eq!(regions.len() == 1, level <= 0.5, "{level}");
    }
    let mut seed = 4_u64;
    for round in 0..40 {
        let samples = (0..30 * 20).map(|_| {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            if round % 2 == 0 {
                (seed >> 63) as f32
            } else {
                (seed >> 40) as f32 / (1 << 24) as f32
            }
        });
        let image =
            Raster::from_samples(Window::new(0, 0, 30, 20).unwrap(), 1, samples.collect()).unwrap();
        for options in [
            exact(),
            options(),
            SilhouetteOptions {
                tolerance: 1.5,
                ..options()
            },
        ] {
            assert_simple(&silhouette(&image, &options).unwrap());
        }
    }
}

#[test]
fn smoothing_keeps_the_area_and_takes_off_steps() {
    // A disk of whole pixels.
    let centre = dvec2(25.0, 25.0);
    let image = painted(50, 50, |p| (p.floor() + 0.5).distance(centre) < 18.0);
    let rough = silhouette(&image, &exact()).unwrap();
    let ring = &rough[0].outer;
    let soft = smooth(ring, 20);
    assert!((area(ring) - area(&soft)).abs() < 1e-9 * area(ring));
    let turning = |ring: &[DVec2]| -> f64 {
        let n = ring.len();
        let turn = |i: usize| {
            (ring[(i + 1) % n] - ring[i])
                .angle_to(ring[(i + 2) % n] - ring[(i + 1) % n])
                .abs()
        };
        (0..n).map(turn).sum()
    };
    // Once round is the least.
    assert!(
        turning(ring) > 20.0 && turning(&soft) < 7.5,
        "{} {}",
        turning(ring),
        turning(&soft)
    );
    let off = |ring: &[DVec2]| {
        ring.iter()
            .map(|p| (p.distance(centre) - 18.0).abs())
            .fold(0.0, f64::max)
    };
    assert!(off(&soft) < off(ring), "{} {}", off(&soft), off(ring));
}

#[test]
fn dropping_points_keeps_to_the_tolerance_and_to_the_topology() {
    // A wavy band so thin that its sides would cross.
    let wave = |x: f64| (x * 0.9).sin() * 2.0;
    let mut band: Vec<DVec2> = (0..100)
        .map(|i| f64::from(i) * 0.3)
        .map(|x| dvec2(x, wave(x)))
        .collect();
    let back: Vec<DVec2> = band.iter().rev().map(|p| *p + dvec2(0.0, 0.15)).collect();
    band.extend(back);
    for tolerance in [0.01, 0.1, 0.5, 3.0] {
        let simple = simplify_rings(&[band.clone()], tolerance);
        assert_eq!(crossings(&[&simple[0]], 1), []);
        assert!(simple[0].len() < band.len());
        let n = simple[0].len();
        for p in &band {
            let far = |i: usize| {
                let (a, b) = (simple[0][i], simple[0][(i + 1) % n]);
                let t = ((*p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
                p.distance(a + (b - a) * t)
            };
            let off = (0..n).map(far).fold(f64::INFINITY, f64::min);
            assert!(off <= tolerance + 1e-12, "{tolerance} {off}");
        }
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let image = painted(9, 9, |_| false);
    assert!(matches!(
        silhouette(&image, &options()),
        Err(SilhouetteError::Nothing { .. })
    ));
    let channel = SilhouetteOptions {
        measure: Measure::Channel(3),
        ..options()
    };
    assert_eq!(
        silhouette(&image, &channel),
        Err(SilhouetteError::NoChannel {
            channel: 3,
            channels: 1
        })
    );
    for level in [0.0, f64::NAN, f64::INFINITY] {
        let error = silhouette(&image, &SilhouetteOptions { level, ..options() });
        assert!(matches!(
            error,
            Err(SilhouetteError::Option { name: "level", .. })
        ));
    }
    // Numbers that are none are nothing, and dark is the reverse of light.
    let mut bad = painted(9, 9, |p| p.distance(dvec2(4.5, 4.5)) < 3.0);
    bad.pixel_mut(0, 0)[0] = f32::NAN;
    bad.pixel_mut(8, 8)[0] = f32::INFINITY;
    let regions = silhouette(&bad, &exact()).unwrap();
    assert_eq!(regions.len(), 2);
    let dark = SilhouetteOptions {
        measure: Measure::Darkness,
        ..exact()
    };
    let regions = silhouette(&bad, &dark).unwrap();
    assert_eq!(regions.iter().map(|r| r.holes.len()).sum::<usize>(), 1);
}
