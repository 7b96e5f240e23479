//! What moves nothing: strength 0, mask 0, identity targets, places outside the support.

use crate::laws;
use anamorph_core::{
    Address, Affine, Deformation, Facts, Influences, Masked, Modulated, Site, Space, Support, Warp,
};
use anamorph_tests::measure::first_difference;
use anamorph_tests::models::boxes;
use anamorph_tests::random::Random;
use anamorph_tests::settings::Setting;
use anamorph_tests::subjects::{Registered, Subject, parameters};

laws!(
    strength_zero_moves_nothing,
    mask_zero_moves_nothing,
    every_term_at_strength_zero_is_the_identity,
    identity_targets_move_nothing,
    nothing_moves_outside_the_support,
);

/// Points of a subject with negative zeros among their coordinates, which a sum with 0 would lose.
fn points_with_zeros<S: Registered>(subject: &Subject<S>, count: usize) -> Vec<S> {
    let mut points = subject.points(count, 21);
    for (i, p) in points.iter_mut().enumerate().filter(|(i, _)| i % 7 == 3) {
        *p = S::from_fn(|axis| {
            if axis == i % S::DIM {
                -0.0
            } else {
                p.component(axis)
            }
        });
    }
    points
}

/// Asserts that a deformation leaves points as they are, alone and in runs.
fn assert_still<S: Space>(what: &str, deformation: &dyn Deformation<S>, points: &[S]) {
    let mut moved = points.to_vec();
    deformation.map_points(0, &mut moved);
    if let Some(i) = first_difference(points, &moved) {
        panic!("{what}: {:?} moved to {:?}", points[i], moved[i]);
    }
    let alone: Vec<S> = points
        .iter()
        .enumerate()
        .map(|(i, &p)| deformation.map(&Site::new(i, p)))
        .collect();
    assert_eq!(first_difference(points, &alone), None, "{what}, one site");
}

/// A field that is zero everywhere but does not say so.
struct SilentZero;
impl<S: Space> anamorph_core::Field<S> for SilentZero {
    fn value(&self, _: &Site<S>) -> f64 {
        0.0
    }
    fn support(&self) -> Support<S> {
        Support::Everywhere
    }
    fn smoothness(&self) -> anamorph_core::Smoothness {
        anamorph_core::Smoothness::Smooth
    }
}

fn strength_zero_moves_nothing<S: Registered>() {
    for subject in Subject::<S>::all() {
        let points = points_with_zeros(&subject, 150);
        let what = subject.to_string();
        let zero = Modulated::new(subject.warp()).with_strength(Box::new(0.0));
        assert_still(&what, &zero, &points);
        let silent = Modulated::new(subject.warp()).with_strength(Box::new(SilentZero));
        assert_still(&what, &silent, &points);
        // With a weight and an ambient term the terms are evaluated one by one.
        let ambient = Modulated::new(subject.warp())
            .with_strength(Box::new(SilentZero))
            .with_weight(Box::new(0.5))
            .with_ambient(0.1);
        assert_still(&what, &ambient, &points);
    }
}

fn mask_zero_moves_nothing<S: Registered>() {
    for subject in Subject::<S>::some() {
        let points = points_with_zeros(&subject, 600);
        let what = subject.to_string();
        assert_still(&what, &Masked::new(subject.warp(), Box::new(0.0)), &points);
        assert_still(
            &what,
            &Masked::new(subject.warp(), Box::new(SilentZero)),
            &points,
        );
        let weight = Modulated::new(subject.warp()).with_weight(Box::new(SilentZero));
        assert_still(&what, &weight, &points);
    }
}

/// A warp with all strengths set to zero, term by term.
struct Powerless<S: Space>(Box<dyn Warp<S>>);
impl<S: Space> Deformation<S> for Powerless<S> {
    fn map(&self, site: &Site<S>) -> S {
        anamorph_core::evaluate(self, site)
    }
    fn facts(&self) -> Facts<S> {
        Facts::identity()
    }
}
impl<S: Space> Warp<S> for Powerless<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        self.0.influences(site, out);
    }
    fn scaled(&self, address: Address, _: f64) -> Affine<S> {
        self.0.scaled(address, 0.0)
    }
}

fn every_term_at_strength_zero_is_the_identity<S: Registered>() {
    for subject in Subject::<S>::all() {
        let (points, warp) = (points_with_zeros(&subject, 60), subject.warp());
        let mut list = Influences::default();
        for (i, &p) in points.iter().enumerate() {
            list.clear();
            warp.influences(&Site::new(i, p), &mut list);
            for influence in &list.list {
                let none = warp.scaled(influence.address, 0.0);
                assert_eq!(none, Affine::IDENTITY, "{subject}\nat {p:?}");
            }
        }
        assert_still(&subject.to_string(), &Powerless(warp), &points);
    }
}

fn identity_targets_move_nothing<S: Registered>() {
    let all = |a: &str| format!("[{}]", vec![a; S::DIM].join(","));
    let star = all("\"*\"");
    let mut still = vec![
        (
            "points",
            "point = [{ from = \"50%\" }, { from = \"20%\", to = \"20%\" }]".to_owned(),
        ),
        (
            "points",
            "radius = \"40%\"\npoint = [{ from = \"50%\" }]".to_owned(),
        ),
        (
            "frames",
            "frame = [{ at = \"50%\" }, { at = \"20%\", scale = 1 }]".to_owned(),
        ),
        (
            "scodef",
            "radius = \"40%\"\npoint = [{ from = \"50%\" }, { from = \"60%\", radius = \"20%\" }]".to_owned(),
        ),
        ("lattice", format!("shape = {}", all("4"))),
        (
            "lattice",
            format!(
                "shape = {}\nmove = [{{ index = {star}, by = \"0%\" }}]",
                all("3")
            ),
        ),
        ("spline-lattice", format!("shape = {}", all("5"))),
        ("frame-lattice", format!("shape = {}", all("3"))),
        (
            "frame-lattice",
            format!(
                "shape = {}\nframe = [{{ index = {star}, scale = 1 }}]",
                all("2")
            ),
        ),
        ("taper", "axis = \"x\"\nfactor = 1".to_owned()),
        (
            "taper",
            "axis = \"x\"\nprofile = [[0, 1], [1, 1]]".to_owned(),
        ),
        ("taper", "axis = \"y\"\npolynomial = [1]".to_owned()),
        (
            "bend",
            "axis = \"y\"\ntoward = \"x\"\nangle = \"0deg\"".to_owned(),
        ),
        (
            "bend",
            "axis = \"y\"\ntoward = \"x\"\nangle = \"0deg\"\nlimits = \"smooth\"".to_owned(),
        ),
        (
            "elements",
            "element = [{ source = [\"50%\", \"70%\"] }, { source = [\"20%\"], target = [\"20%\"] }]".to_owned(),
        ),
        (
            "axial",
            "axis = \"x\"\nscale = [[0, 1, 1]]\nshift = [[0, 0, 0, 0], [1, 0, 0, 0]]".to_owned(),
        ),
    ];
    if S::DIM == 3 {
        still.push(("twist", "axis = \"x\"\nangle = \"0deg\"".to_owned()));
        still.push((
            "twist",
            "axis = [1, 2, 3]\npolynomial = [0]\nrange = [0, 1]".to_owned(),
        ));
        still.push((
            "vortex",
            "centre = \"50%\"\nangle = \"0deg\"\nradius = \"50%\"\naxis = \"z\"".to_owned(),
        ));
    } else {
        still.push((
            "vortex",
            "centre = \"50%\"\nangle = \"0deg\"\nradius = \"50%\"".to_owned(),
        ));
        for kind in ["lines", "global-lines"] {
            still.push((
                kind,
                "line = [{ source = [\"50%\", [\"70%\", \"45%\"]] }, { source = [\"20%\", \"20%\"] },
                    { source = [\"60%\", \"90%\"], target = [\"60%\", \"90%\"], b = 1, a = 1 }]"
                    .to_owned(),
            ));
        }
    }
    for bounds in boxes::<S>() {
        for (kind, toml) in &still {
            assert!(parameters(toml).is_object());
            let setting = Setting {
                kind,
                toml: toml.clone(),
                scaling: None,
                example: false,
            };
            let subject = Subject::<S>::new(setting, bounds);
            let points = points_with_zeros(&subject, 203);
            assert_still(&subject.to_string(), &subject.warp(), &points);
        }
    }
}

fn nothing_moves_outside_the_support<S: Registered>() {
    let mut bounded = 0;
    for subject in Subject::<S>::all() {
        let warp = subject.warp();
        let support = warp.facts().support;
        let mut points = points_with_zeros(&subject, 400);
        // Just outside the faces of a box or the surface of a ball.
        if let Some(bounds) = support.bounds() {
            bounded += 1;
            let mut random = Random::new(3);
            for _ in 0..400 {
                let at = bounds.at(S::from_fn(|_| random.between(-0.01, 1.01)));
                let axis = random.below(S::DIM);
                let (low, high) = (bounds.min.component(axis), bounds.max.component(axis));
                let out = [low.next_down(), high.next_up(), low, high][random.below(4)];
                points.push(S::from_fn(
                    |i| if i == axis { out } else { at.component(i) },
                ));
            }
        }
        points.retain(|&p| !support.contains(p));
        assert_still(&subject.to_string(), &warp, &points);
    }
    assert!(bounded > 100, "{bounded}");
}
