//! Hierarchical maps keep their bound where a warp has kinks at single places and names them: every pixel is measured.

// A test that cannot be set up has nothing to say.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::{DMat2, DVec2, dvec2};
use anamorph_core::{Affine, Deformation, Facts, Inverse, Plane, Site, Smoothness, Stack, Support};
use anamorph_features::PointPair;
use anamorph_fields::falloffs::Linear;
use anamorph_raster::{Hierarchy, PixelMap, Window, hierarchical_map};
use anamorph_warps::features::{Reach, points::PointWarp};
use anamorph_warps::radial::{Kernel, RadialWarp};

/// Numbers from 0 to 1, the same every time.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
    fn place(&mut self) -> DVec2 {
        dvec2(self.next(), self.next())
    }
}

const SIZE: usize = 200;

/// The largest error of a map over all pixels, and how many evaluations there were for a pixel.
fn worst(deformation: &dyn Deformation<Plane>) -> (f64, f64) {
    let window = Window::new(0, 0, SIZE, SIZE).unwrap();
    let (map, report) = hierarchical_map(deformation, window, &Hierarchy::default()).unwrap();
    let exact = PixelMap::from_deformation(deformation, window).unwrap();
    let pairs = map.offsets().iter().zip(exact.offsets());
    let far = pairs.map(|(a, b)| f64::from((a[0] - b[0]).hypot(a[1] - b[1])));
    let share = report.evaluations as f64 / (SIZE * SIZE) as f64;
    (far.fold(0.0, f64::max), share)
}

/// Cones at random centres, moved by at most `far` pixels.
fn cones(count: usize, far: f64, chance: &mut Chance) -> RadialWarp<Plane> {
    let pairs = (0..count).map(|_| {
        let source = chance.place() * SIZE as f64;
        let target = source + (chance.place() - 0.5) * 2.0 * far;
        PointPair { source, target }
    });
    RadialWarp::construct(pairs.collect(), Kernel::Linear, true, 0.0).unwrap()
}

#[test]
fn cones_at_random_centres_keep_the_bound() {
    let mut chance = Chance(41);
    for number in 0..12 {
        for (count, far) in [(5, 15.0), (12, 8.0), (30, 4.0)] {
            let warp = cones(count, far, &mut chance);
            assert_eq!(warp.facts().kinks.len(), count);
            let (error, share) = worst(&warp);
            assert!(error <= 0.0501, "{number}, {count} centres: {error}");
            assert!(share < 0.75, "{number}, {count} centres: {share}");
        }
    }
}

#[test]
fn kinks_are_known_through_inverses_and_stacks() {
    let mut chance = Chance(43);
    for number in 0..4 {
        let turned = Affine {
            linear: DMat2::from_angle(0.3) * 1.1,
            translation: dvec2(20.0, -30.0),
        };
        let both: Vec<Box<dyn Deformation<Plane>>> = vec![
            Box::new(turned),
            Box::new(cones(8, 5.0, &mut chance)),
            Box::new(cones(6, 5.0, &mut chance)),
        ];
        let stack = Stack::new(both);
        // Behind the affine map the kinks of the first cones are known, those of the second, behind cones, are not.
        let kinks = stack.facts().kinks;
        assert_eq!(kinks.len(), 8);
        let named = stack.parts()[1].facts().kinks;
        for (kink, own) in kinks.iter().zip(&named) {
            assert!(turned.apply(*kink).distance(*own) < 1e-9);
        }
        // The inverse, which images are drawn by, knows all.
        let inverse = Inverse::new(&stack, SIZE as f64);
        let kinks = inverse.facts().kinks;
        assert_eq!(kinks.len(), 14);
        let taken = |part: usize, p: DVec2| stack.parts()[part].map(&Site::anywhere(p));
        let last = stack.parts()[2].facts().kinks;
        for (kink, own) in kinks.iter().zip(&named) {
            assert!(kink.distance(taken(2, taken(1, *own))) < 1e-9);
        }
        for (kink, own) in kinks[8..].iter().zip(&last) {
            assert!(kink.distance(taken(2, *own)) < 1e-9);
        }
        let (error, _) = worst(&inverse);
        assert!(error <= 0.0501, "{number}: {error}");
    }
}

#[test]
fn falloffs_with_a_tip_and_functions_name_their_kinks() {
    let mut chance = Chance(47);
    for number in 0..20 {
        let centre = chance.place() * SIZE as f64;
        let reach = Reach {
            radius: Some(70.0),
            falloff: &Linear,
        };
        let pair = PointPair {
            source: centre,
            target: centre + dvec2(9.0, -14.0),
        };
        let warp = PointWarp::construct(vec![(pair, reach)]).unwrap();
        assert_eq!(warp.facts().kinks, [centre]);
        let (error, _) = worst(&warp);
        assert!(error <= 0.0501, "{number}: {error}");
    }
    // A tip so narrow that it is seen nowhere but where it is.
    struct Tip(DVec2);
    impl Deformation<Plane> for Tip {
        fn map(&self, site: &Site<Plane>) -> DVec2 {
            let far = site.point.distance(self.0);
            site.point + dvec2(0.6, 0.2) * (1.0 - far / 1.5).max(0.0)
        }
        fn facts(&self) -> Facts<Plane> {
            Facts {
                support: Support::Everywhere,
                inside: Smoothness::C(0),
                kinks: vec![self.0],
                ..Facts::identity()
            }
        }
    }
    for _ in 0..200 {
        let at = chance.place() * SIZE as f64;
        let (error, _) = worst(&Tip(at));
        assert!(error <= 0.0501, "{at}: {error}");
    }
}
