//! D4, D6, D8: pairs of shapes become each other with nothing set, and nothing is turned over.
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing Based on Strain Field Interpolation*, 2004; errata S6 and S10.

use anamorph_tests::pairs::{Measured, load, measure};
use rayon::prelude::*;
use std::path::Path;

/// All pairs within each group: animals, letters with and without holes, simple shapes and icons of several parts, countries of several parts with
/// holes.
const GROUPS: [&[&str]; 5] = [
    &[
        "alpaca-side.json",
        "bull-side.json",
        "horse-prancing.json",
        "horse-side.json",
        "wolf-side.json",
    ],
    &[
        "letter-A.json",
        "letter-B.json",
        "letter-C.json",
        "letter-8.json",
    ],
    &[
        "mk-circle.svg",
        "mk-heart.svg",
        "mk-square.svg",
        "mk-star.svg",
        "fl-cloud.svg",
        "fl-star.svg",
        "fl-red-heart.svg",
        "fl-crescent-moon.svg",
    ],
    &["fl-camel.svg", "fl-ox.svg", "fl-cow.svg", "fl-elephant.svg"],
    &[
        "germany-110m.geojson",
        "spain-110m.geojson",
        "egypt-110m.geojson",
        "switzerland-50m.geojson",
        "south-africa-50m.geojson",
        "italy-50m.geojson",
    ],
];

#[test]
fn pairs_of_shapes_have_no_faults() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/shapes");
    let mut pairs = Vec::new();
    for group in GROUPS {
        for (i, a) in group.iter().enumerate() {
            pairs.extend(group[i + 1..].iter().map(|b| (*a, *b)));
        }
    }
    assert!(pairs.len() >= 60, "{}", pairs.len());
    let shape = |name: &str| load(&std::fs::read(folder.join(name)).unwrap(), None).unwrap();
    let found: Vec<(String, Result<Measured, String>)> = pairs
        .par_iter()
        .map(|(a, b)| (format!("{a} and {b}"), measure(&shape(a), &shape(b), 1)))
        .collect();
    let (mut ours, mut overlaid) = (0, 0);
    for (pair, found) in &found {
        let found = found.as_ref().unwrap_or_else(|e| panic!("{pair}: {e}"));
        assert!(found.is_good(), "{pair}: {found:?}");
        // Points are added where one mesh alone would need few; where both cross often, most of them go away.
        ours += found.triangles.min(found.overlaid);
        overlaid += found.overlaid;
    }
    assert!(4 * ours < 3 * overlaid, "{ours} of {overlaid}");
}
