//! Verdicts of the report against brute force.

use anamorph_core::guarantees::{Property, Verdict, continuity, interpolation, no_fold, undecided};
use anamorph_core::{
    Affine, Deformation, Linear, Masked, Modulated, Plane, Site, Solid, Space, Term, Terms, Warp,
    difference_jacobian,
    glam::{dvec2, dvec3},
};
use anamorph_fields::falloffs::Wires;
use anamorph_fields::{Attribute, Radial};
use anamorph_tests::models::boxes;
use anamorph_tests::random::Random;
use anamorph_tests::settings::Setting;
use anamorph_tests::subjects::{Registered, Subject};

crate::laws!(
    interpolation_verdicts_are_measured,
    fold_verdicts_are_measured
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
    let (mut folds, mut open) = (0, 0);
    for subject in Subject::<S>::some() {
        let (warp, mut random) = (subject.warp(), Random::new(19));
        let points: Vec<S> = (0..120).map(|_| subject.inside(&mut random)).collect();
        let verdict = no_fold(&warp, &points, subject.size());
        let witness = verdict.witness.unwrap();
        let at = points.iter().position(|p| *p == witness.place).unwrap();
        let site = Site::new(at, witness.place);
        let exact = warp.jacobian(&site, subject.size()).unwrap();
        assert_eq!(exact.determinant(), witness.value, "{subject}");
        for (i, &p) in points.iter().enumerate() {
            let jacobian = warp.jacobian(&Site::new(i, p), subject.size()).unwrap();
            assert!(jacobian.determinant() >= witness.value, "{subject}");
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
            Verdict::Proved => panic!("{subject}: a search proves nothing"),
        }
    }
    assert!(folds > 5 && open > 10, "{folds}, {open}");
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
    let ends = [line[0], line[20]];
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
