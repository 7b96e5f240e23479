//! Verdicts of the report against brute force.

use anamorph_core::guarantees::{
    Property, Verdict, ambient_repair, commutation, continuity, continuity_of, coverage,
    interpolation, invertibility, no_fold, safe_strength, undecided,
};
use anamorph_core::{
    Affine, Deformation, Field, Inverse, Linear, Masked, Modulated, Plane, Site, Solid, Space,
    Term, Terms, Warp, difference_jacobian,
    glam::{dvec2, dvec3},
};
use anamorph_fields::falloffs::Wires;
use anamorph_fields::{Attribute, Radial};
use anamorph_tests::models::boxes;
use anamorph_tests::random::Random;
use anamorph_tests::settings::Setting;
use anamorph_tests::subjects::{Registered, Subject};
use std::sync::Arc;

crate::laws!(
    interpolation_verdicts_are_measured,
    fold_verdicts_are_measured,
    declared_proofs_hold_at_random_places,
    inverses_lead_back,
    verdicts_of_all_warps_survive_brute_force,
);

/// Greatest miss of a warp's conditions, computed here.
fn worst_miss<S: Space>(warp: &dyn Warp<S>) -> f64 {
    let miss =
        |c: &anamorph_core::Condition<S>| warp.map(&Site::anywhere(c.source)).distance(c.target);
    warp.conditions().iter().map(miss).fold(0.0, f64::max)
}

fn interpolation_verdicts_are_measured<S: Registered>() {
    let (mut exact, mut approximate, mut none) = (0, 0, 0);
    for subject in Subject::<S>::all() {
        let (warp, size) = (subject.warp(), subject.size());
        let verdict = interpolation(&warp, size);
        let worst = worst_miss(&warp);
        assert_eq!(verdict.property, Property::Interpolation);
        match verdict.verdict {
            Verdict::Proved => {
                assert!(worst <= 1e-9 * size, "{subject}: {worst}");
                exact += 1;
            }
            Verdict::Refuted => {
                let witness = verdict.witness.unwrap();
                let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b;
                assert!(
                    worst > 1e-9 * size && near(witness.value, worst),
                    "{subject}"
                );
                let named = warp.conditions();
                let mut there = named.iter().filter(|c| c.source == witness.place);
                let miss = |c: &anamorph_core::Condition<S>| {
                    warp.map(&Site::anywhere(c.source)).distance(c.target)
                };
                assert!(there.any(|c| near(miss(c), worst)), "{subject}");
                assert!(verdict.statement.starts_with("approximate"));
                approximate += 1;
            }
            Verdict::Unknown => {
                assert!(warp.conditions().is_empty(), "{subject}");
                none += 1;
            }
        }
    }
    assert!(exact > 10 && approximate > 10 && none > 10);
}

fn fold_verdicts_are_measured<S: Registered>() {
    let (mut folds, mut open, mut proved) = (0, 0, 0);
    for subject in Subject::<S>::some() {
        let (warp, mut random) = (subject.warp(), Random::new(19));
        let points: Vec<S> = (0..120).map(|_| subject.inside(&mut random)).collect();
        let verdict = no_fold(&warp, &points, subject.size());
        let witness = verdict.witness.unwrap();
        let site = Site::anywhere(witness.place);
        let exact = warp.jacobian(&site, subject.size()).unwrap();
        assert_eq!(exact.determinant(), witness.value, "{subject}");
        let reliable = |p: S| {
            // Quotients across a jump or a crease say nothing of either side.
            let at = |size: f64| {
                warp.jacobian(&Site::anywhere(p), size)
                    .unwrap()
                    .determinant()
            };
            let (a, b) = (at(subject.size()), at(subject.size() / 16.0));
            (a > 0.0 || (a - b).abs() <= 0.05 * a.abs()).then_some(a)
        };
        for &p in &points {
            if let Some(determinant) = reliable(p) {
                assert!(determinant >= witness.value, "{subject}");
            }
        }
        match verdict.verdict {
            Verdict::Refuted => {
                assert!(witness.value <= 0.0);
                // Seen by differences too, unless it hangs on a crease or on rounding.
                let seen = super::jacobians::smooth_jacobian(&warp, witness.place, subject.size());
                if let Some(seen) = seen.filter(|_| witness.value < -1e-4) {
                    assert!(seen.determinant() < 0.0, "{subject}");
                }
                folds += 1;
            }
            Verdict::Unknown => {
                assert!(witness.value > 0.0, "{subject}");
                open += 1;
            }
            Verdict::Proved => {
                assert!(
                    warp.facts().upright().is_some() && witness.value > 0.0,
                    "{subject}"
                );
                proved += 1;
            }
        }
    }
    assert!(
        folds > 5 && open > 5 && proved > 5,
        "{folds}, {open}, {proved}"
    );
}

/// What a warp declares of its Jacobian and its inverse, at places all over its box and around it.
fn declared_proofs_hold_at_random_places<S: Registered>() {
    let (mut bounded, mut upright, mut closed) = (0, 0, 0);
    for subject in Subject::<S>::all() {
        let (warp, mut random) = (subject.warp(), Random::new(29));
        let (facts, size) = (warp.facts(), subject.size());
        for _ in 0..60 {
            let site = Site::anywhere(subject.inside(&mut random));
            let jacobian = warp.jacobian(&site, size).unwrap();
            if let Some(bound) = facts.stretch() {
                let off = jacobian - S::Linear::IDENTITY;
                let longest = (0..20)
                    .map(|_| {
                        let way = S::from_fn(|_| random.between(-1.0, 1.0));
                        off.apply(way).length() / way.length()
                    })
                    .fold(0.0, f64::max);
                assert!(longest <= bound + 1e-9, "{subject}: {longest}, {bound}");
                bounded += 1;
            }
            if facts.upright().is_some() {
                assert!(jacobian.determinant() > 0.0, "{subject}: {:?}", site.point);
                upright += 1;
            }
            let image = Site::anywhere(warp.map(&site));
            if let Some(back) = warp.inverse_at(&image) {
                let off = warp.map(&Site::anywhere(back)).distance(image.point);
                // Numbers beyond the model's size lose digits of their own.
                let size = size.max(image.point.largest());
                assert!(off <= 1e-9 * size, "{subject}: {off}");
                if facts.one_to_one().is_some() {
                    assert!(back.distance(site.point) <= 1e-9 * size, "{subject}");
                }
                closed += 1;
            }
        }
    }
    assert!(
        bounded > 500 && upright > 500 && closed > 100,
        "{bounded} {upright} {closed}"
    );
}

/// The inverse of a warp moves no image elsewhere than back, wherever the report says that there is one (A7).
fn inverses_lead_back<S: Registered>() {
    let mut sure = 0;
    for subject in Subject::<S>::some() {
        let (warp, mut random) = (subject.warp(), Random::new(31));
        let size = subject.size();
        let inverse = Inverse::new(&warp, size);
        let invertible = warp.facts().one_to_one().is_some();
        for _ in 0..20 {
            let place = subject.inside(&mut random);
            let image = warp.map(&Site::anywhere(place));
            let found = inverse.find(&Site::anywhere(image));
            // What counts as found is measured, for every warp.
            let off = warp.map(&Site::anywhere(found.place)).distance(image);
            assert_eq!(off, found.residual, "{subject}");
            if invertible {
                assert!(
                    found.residual <= 1e-9 * size,
                    "{subject}: {}",
                    found.residual
                );
                assert!(found.place.distance(place) <= 1e-9 * size, "{subject}");
                sure += 1;
            }
        }
    }
    assert!(sure > 100, "{sure}");
}

/// No random search contradicts what the verdicts call proved, and every witness shows what it is said to show.
fn verdicts_of_all_warps_survive_brute_force<S: Registered>() {
    let (mut twice, mut proved) = (0, 0);
    for subject in Subject::<S>::some() {
        let (warp, mut random) = (subject.warp(), Random::new(37));
        let size = subject.size();
        let points: Vec<S> = (0..80).map(|_| subject.inside(&mut random)).collect();
        let fold = no_fold(&warp, &points, size);
        let at = fold.witness.filter(|_| fold.verdict == Verdict::Refuted);
        let verdict = invertibility(&warp, at, &points, size);
        match (verdict.verdict, verdict.witness) {
            (Verdict::Refuted, Some(witness)) => {
                let other = witness.other.unwrap();
                let (a, b) = (
                    warp.map(&Site::anywhere(witness.place)),
                    warp.map(&Site::anywhere(other)),
                );
                assert!(a.distance(b) <= 1e-8 * size, "{subject}");
                assert!(witness.place.distance(other) > 1e-7 * size, "{subject}");
                twice += 1;
            }
            (Verdict::Proved, _) => {
                // Places apart have images apart: as far as the steepest of random pairs tells.
                for pair in points.windows(2) {
                    let (a, b) = (
                        warp.map(&Site::anywhere(pair[0])),
                        warp.map(&Site::anywhere(pair[1])),
                    );
                    assert!(a.distance(b) > 1e-9 * size, "{subject}");
                }
                proved += 1;
            }
            (found, witness) => {
                assert_eq!((found, witness), (Verdict::Unknown, None), "{subject}");
            }
        }
        let known = continuity_of(&warp, &points, size);
        if let (Verdict::Refuted, Some(witness)) = (known.verdict, known.witness) {
            let other = witness.other.unwrap();
            let by = |p: S| warp.map(&Site::anywhere(p)) - p;
            assert!(witness.place.distance(other) <= 1e-9 * size, "{subject}");
            assert!(
                by(witness.place).distance(by(other)) > 1e-10 * size,
                "{subject}"
            );
        }
    }
    assert!(twice > 3 && proved > 3, "{twice}, {proved}");
}

/// Two radial pushes, `apart` from each other.
fn pushes(apart: f64) -> [Terms<Plane>; 2] {
    [0.0, apart].map(|x| {
        let field = Radial::new(dvec2(x, 0.0), 1.0, Wires).unwrap();
        let by = Affine::translation(dvec2(0.1, 0.2));
        Terms::new(vec![Term::new(by, field, 1.0)])
    })
}

#[test]
fn commutation_is_refuted_by_a_point_and_proved_where_it_is_sure() {
    let points: Vec<Plane> = (0..400)
        .map(|i| dvec2(f64::from(i % 20) * 0.2 - 1.0, f64::from(i / 20) * 0.1 - 1.0))
        .collect();
    let [a, b] = pushes(0.7);
    let found = commutation(&a, &b, &points, 3.0);
    assert_eq!(found.verdict, Verdict::Refuted);
    let witness = found.witness.unwrap();
    let through = |one: &Terms<Plane>, two: &Terms<Plane>| {
        two.map(&Site::anywhere(one.map(&Site::anywhere(witness.place))))
    };
    assert_eq!(through(&a, &b).distance(through(&b, &a)), witness.value);
    assert!(found.details.iter().any(|(name, _)| *name == "when bound"));
    // Apart, but nothing proves that a push keeps its support to itself: no difference is found, and no more is said.
    let [a, b] = pushes(5.0);
    assert_eq!(commutation(&a, &b, &points, 3.0).verdict, Verdict::Unknown);
    // Lattices that do not touch, and move little inside their still faces.
    let lattice = |x: f64| {
        let toml = format!(
            "shape = [4, 4, 4]\nbox = {{ min = [{x}, 0, 0], max = [{}, 1, 1] }}\nmove = [{{ index = [1, 1, 1], by = [0.05, 0, 0] }}]",
            x + 1.0
        );
        let setting = Setting {
            kind: "lattice",
            toml,
            scaling: None,
            example: false,
        };
        Subject::<Solid>::new(setting, boxes()[0]).warp()
    };
    let cube = [Solid::ZERO, Solid::ONE, dvec3(2.5, 0.5, 0.5)];
    let verdict = commutation(&lattice(0.0), &lattice(2.0), &cube, 4.0).verdict;
    assert_eq!(verdict, Verdict::Proved);
    let identity = Terms::<Solid>::new(Vec::new());
    let verdict = commutation(&identity, &lattice(0.0), &cube, 4.0).verdict;
    assert_eq!(verdict, Verdict::Proved);
}

#[test]
fn a_jump_is_found_measured_and_repaired() {
    // Strength 1 inside a weight of radius 1: the whole displacement at the edge (errata F4).
    let weight = Radial::new(Plane::ZERO, 1.0, Wires).unwrap();
    let by = Affine::translation(dvec2(0.0, 0.3));
    let warp: Arc<dyn Warp<Plane>> = Arc::new(Terms::new(vec![Term::new(by, 1.0, weight)]));
    let points: Vec<Plane> = (0..441)
        .map(|i| dvec2(f64::from(i % 21) * 0.2 - 2.0, f64::from(i / 21) * 0.2 - 2.0))
        .collect();
    let found = continuity_of(&warp, &points, 4.0);
    assert_eq!(found.verdict, Verdict::Refuted, "{}", found.statement);
    let witness = found.witness.unwrap();
    assert!((witness.value - 0.3).abs() < 1e-9);
    assert!((witness.place.length() - 1.0).abs() < 1e-9);
    let (ambient, miss) = ambient_repair(&warp, &points, 4.0).unwrap();
    assert!(ambient > 0.0 && miss.is_none());
    let repaired = Modulated::new(Box::new(Arc::clone(&warp))).with_ambient(ambient);
    assert_ne!(
        continuity_of(&repaired, &points, 4.0).verdict,
        Verdict::Refuted
    );
    // Three of the points of a coarser grid feel it.
    let few = [Plane::ZERO, Plane::X * 0.5, Plane::Y * 0.5, Plane::X * 3.0];
    let covered = coverage(&warp, &few, few.len());
    assert_eq!(covered.verdict, Verdict::Refuted);
    assert_eq!(covered.witness.unwrap().place, few[3]);
    assert_eq!(coverage(&warp, &few[..3], 3).verdict, Verdict::Proved);
}

#[test]
fn the_largest_safe_strength_is_where_the_fold_begins() {
    // A shear wave that folds where its slope passes −1: at half of its strength.
    struct Wave;
    impl Field<Plane> for Wave {
        fn value(&self, site: &Site<Plane>) -> f64 {
            anamorph_core::math::sin(2.0 * site.point.x)
        }
        fn support(&self) -> anamorph_core::Support<Plane> {
            anamorph_core::Support::Everywhere
        }
        fn smoothness(&self) -> anamorph_core::Smoothness {
            anamorph_core::Smoothness::Smooth
        }
    }
    let by = Affine::translation(dvec2(1.0, 0.0));
    let warp: Arc<dyn Warp<Plane>> = Arc::new(Terms::new(vec![Term::new(by, Wave, 1.0)]));
    let points: Vec<Plane> = (0..400).map(|i| dvec2(f64::from(i) * 0.01, 0.0)).collect();
    let strength = safe_strength(&warp, &points, 4.0).unwrap();
    assert!((strength - 0.5).abs() < 1e-3, "{strength}");
    let half = Modulated::new(Box::new(Arc::clone(&warp))).with_strength(Box::new(0.49));
    assert_ne!(no_fold(&half, &points, 4.0).verdict, Verdict::Refuted);
    assert_eq!(no_fold(&warp, &points, 4.0).verdict, Verdict::Refuted);
    let half: Arc<dyn Warp<Plane>> = Arc::new(half);
    assert_eq!(safe_strength(&half, &points, 4.0), None);
}

#[test]
fn small_moves_of_a_cubic_spline_lattice_are_proved_safe_and_large_ones_are_not() {
    // Choi and Lee (2000): below 0.403 of the spacing in space nothing folds, whatever the directions; at 0.6 something does.
    let lattice = |share: f64, alternate: bool| {
        let mut edits = String::new();
        for i in 0..6 {
            for j in 0..6 {
                for k in 0..6 {
                    let sign = if alternate && (i + j + k) % 2 == 1 {
                        -1.0
                    } else {
                        1.0
                    };
                    let by = share * sign / 3.0;
                    edits.push_str(&format!(
                        "{{ index = [{i}, {j}, {k}], by = [{by}, {by}, {by}] }},"
                    ));
                }
            }
        }
        let toml = format!(
            "shape = [6, 6, 6]\ndegree = 3\nknots = \"uniform\"\nbox = {{ min = [0, 0, 0], max = [1, 1, 1] }}\nmove = [{edits}]"
        );
        let setting = Setting {
            kind: "spline-lattice",
            toml,
            scaling: None,
            example: false,
        };
        Subject::<Solid>::new(setting, boxes()[0]).warp()
    };
    let points: Vec<Solid> = (0..1000)
        .map(|i| {
            dvec3(
                f64::from(i % 10),
                f64::from(i / 10 % 10),
                f64::from(i / 100),
            ) * 0.11
        })
        .collect();
    let small = lattice(0.40, true);
    let found = no_fold(&small, &points, 1.7);
    assert_eq!(found.verdict, Verdict::Proved, "{}", found.statement);
    assert!(found.statement.contains("Choi"), "{}", found.statement);
    assert!(found.witness.unwrap().value > 0.0);
    let large = lattice(1.4, true);
    assert_ne!(no_fold(&large, &points, 1.7).verdict, Verdict::Proved);
    // Four clamped points a side are evenly spaced like uniform ones, and another basis: the theorem says nothing of it.
    let clamped = |x: &str| {
        let toml = format!(
            "shape = [4, 4, 4]\ndegree = 3\nknots = \"clamped\"\nbox = {{ min = [0, 0, 0], max = [1, 1, 1] }}\nmove = [{x}]"
        );
        let setting = Setting {
            kind: "spline-lattice",
            toml,
            scaling: None,
            example: false,
        };
        Subject::<Solid>::new(setting, boxes()[0]).warp()
    };
    let mut edits = String::new();
    for index in 0..64_i32 {
        let (i, j, k) = (index / 16, index / 4 % 4, index % 4);
        let by = if (i + j + k) % 2 == 1 { -0.13 } else { 0.13 };
        edits.push_str(&format!(
            "{{ index = [{i}, {j}, {k}], by = [{by}, {by}, {by}] }},"
        ));
    }
    let facts = clamped(&edits).facts();
    assert!(facts.upright().is_none_or(|why| !why.contains("Choi")));
    let corner = [Solid::ZERO, Solid::splat(0.01), Solid::splat(0.02)];
    let found = no_fold(&clamped(&edits), &corner, 1.7);
    assert_eq!(found.verdict, Verdict::Refuted, "{}", found.statement);
}

/// A lattice whose middle planes change places.
fn folding() -> Subject<Solid> {
    let setting = Setting {
        kind: "lattice",
        toml: "shape = [4, 2, 2]\nmove = [{ index = [1, \"*\", \"*\"], by = [\"150%\", 0, 0] },
            { index = [2, \"*\", \"*\"], by = [\"-150%\", 0, 0] }]"
            .to_owned(),
        scaling: None,
        example: false,
    };
    Subject::new(setting, boxes()[0])
}

#[test]
fn a_lattice_made_to_fold_is_refuted_by_a_real_witness() {
    let subject = folding();
    let warp = subject.warp();
    let line: Vec<Solid> = (0..=20)
        .map(|i| dvec3(-1.0 + 0.1 * f64::from(i), 0.1, -0.2))
        .collect();
    let verdict = no_fold(&warp, &line, subject.size());
    assert_eq!(verdict.verdict, Verdict::Refuted);
    let witness = verdict.witness.unwrap();
    let site = Site::anywhere(witness.place);
    let seen = difference_jacobian(&warp, &site, subject.size()).unwrap();
    let determinant = Linear::<Solid>::determinant(&seen);
    assert!(determinant < -0.1 && (determinant - witness.value).abs() < 1e-6);
    // Two places of the line really come to lie in one: the image turns back.
    let x = |p: Solid| warp.map(&Site::anywhere(p)).x;
    let turns = line.windows(2).any(|w| x(w[1]) < x(w[0]));
    assert!(turns);
    // Away from the fold nothing is claimed.
    let ends = [line[0], line[1]];
    let verdict = no_fold(&warp, &ends, subject.size());
    assert_eq!(verdict.verdict, Verdict::Unknown);
    assert!(verdict.witness.unwrap().value > 0.0);
    assert_eq!(no_fold(&warp, &[], 1.0).verdict, Verdict::Unknown);
}

#[test]
fn an_undefined_determinant_hides_no_fold() {
    // The first point is so far out that its determinant is not a number.
    let term = Term::new(Affine::translation(dvec2(3.0, 0.0)), 1.0, 1.0);
    let mirror = Term::new(
        Affine::new(
            anamorph_core::glam::DMat2::from_cols(dvec2(-1.0, 0.0), dvec2(0.0, 1.0)),
            Plane::ZERO,
        ),
        1.0,
        3.0,
    );
    let warp = Terms::new(vec![term, mirror]);
    let points = [Plane::splat(f64::INFINITY), Plane::ZERO];
    let verdict = no_fold(&warp, &points, 1.0);
    assert_eq!(verdict.verdict, Verdict::Refuted);
    assert_eq!(verdict.witness.unwrap().place, Plane::ZERO);
}

#[test]
fn continuity_is_stated_with_its_place() {
    let setting = |kind, toml: &str| Setting {
        kind,
        toml: toml.to_owned(),
        scaling: None,
        example: false,
    };
    let statement = |kind, toml: &str| {
        let subject = Subject::<Solid>::new(setting(kind, toml), boxes()[0]);
        let verdict = continuity(&subject.warp());
        (verdict.verdict, verdict.statement)
    };
    let lattice = |index: &str| {
        let moves = format!("shape = [6, 6, 6]\nmove = [{{ index = {index}, by = \"10%\" }}]");
        statement("lattice", &moves)
    };
    // The outer k + 1 planes must stay for C^k (errata F3).
    let (verdict, text) = lattice("[0, 3, 3]");
    assert_eq!(verdict, Verdict::Unknown);
    assert!(text.contains("may jump at the edge"), "{text}");
    for (index, class) in [("[1, 3, 3]", "C0"), ("[[2, 3], 2, 3]", "C1")] {
        let (verdict, text) = lattice(index);
        assert_eq!(verdict, Verdict::Proved);
        assert!(
            text.contains(&format!("and {class} across its edge")),
            "{text}"
        );
    }
    let axis = "axis = \"y\"\nangle = \"90deg\"\n";
    let (verdict, text) = statement("twist", axis);
    assert_eq!(
        (verdict, text.as_str()),
        (Verdict::Proved, "at least C0 everywhere")
    );
    let (_, text) = statement("twist", &format!("{axis}limits = \"smooth\""));
    assert_eq!(text, "at least C2 everywhere");
    let (_, text) = statement("twist", "axis = \"y\"\npolynomial = [0, 1]");
    assert_eq!(text, "at least C∞ everywhere");
}

#[test]
fn what_lives_on_a_model_leaves_questions_open() {
    let weights = || Attribute::new("weight", vec![0.5; 4]).unwrap();
    let warp = || folding().warp();
    let masked = Masked::new(warp(), Box::new(weights()));
    assert_eq!(continuity(&masked).verdict, Verdict::Unknown);
    let points = [Solid::ZERO];
    let verdict = no_fold(&masked, &points, 1.0);
    assert_eq!((verdict.verdict, verdict.witness), (Verdict::Unknown, None));
    let modulated = Modulated::new(warp()).with_strength(Box::new(weights()));
    assert_eq!(interpolation(&modulated, 1.0).verdict, Verdict::Unknown);
    assert_eq!(
        undecided::<Solid>(Property::Commutation).verdict,
        Verdict::Unknown
    );
}

#[test]
fn a_field_that_jumps_is_no_continuous_warp() {
    let hard = anamorph_fields::BoxField::new(boxes::<Plane>()[0], 0.0, Wires).unwrap();
    let radial = Radial::new(Plane::ZERO, 1.0, Wires).unwrap();
    let term = Term::new(Affine::translation(Plane::X), radial, 1.0);
    let masked = Masked::new(Box::new(Terms::new(vec![term])), Box::new(hard));
    assert_eq!(continuity(&masked).verdict, Verdict::Unknown);
}
