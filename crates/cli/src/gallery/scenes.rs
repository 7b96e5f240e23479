//! What the gallery shows: a recipe of the documentation, the model it was made for, and a side to look from.
//!
//! *Source*: the order and the figure numbers of T. Milliron, R. J. Jensen, R. Barzel and A. Finkelstein, *A Framework for
//! Geometric Warps and Deformations*, ACM TOG 21(1), 2002; the figures themselves are our own models.

use crate::arguments::Side;

/// A model that comes with the program.
pub(super) struct Exhibit {
    /// Name of its file.
    pub(super) file: &'static str,
    /// Its bytes.
    pub(super) bytes: &'static [u8],
    /// The credit beside its pictures.
    pub(super) credit: &'static str,
}

/// A part of the page.
pub(super) struct Part {
    /// Its heading.
    pub(super) title: &'static str,
    /// What it shows, in a sentence.
    pub(super) about: &'static str,
    /// Its scenes, in the paper's order.
    pub(super) scenes: &'static [Scene],
}

/// One picture and what belongs to it.
pub(super) struct Scene {
    /// Name of the recipe, without extension; also that of its picture.
    pub(super) name: &'static str,
    /// The recipe.
    pub(super) recipe: &'static str,
    /// The model it warps.
    pub(super) exhibit: &'static Exhibit,
    /// Name and bytes of the files that the recipe reads.
    pub(super) files: &'static [(&'static str, &'static [u8])],
    /// From where one looks.
    pub(super) side: Side,
    /// The figure of the paper, where it is not the one that its warp names.
    pub(super) figure: Option<&'static str>,
}

macro_rules! exhibit {
    ($file:literal, $credit:literal) => {
        Exhibit {
            file: $file,
            bytes: include_bytes!(concat!("../../../../tests/fixtures/valid/", $file)),
            credit: $credit,
        }
    };
}

macro_rules! scene {
    ($name:literal, $exhibit:ident, $side:ident, as $figure:literal) => {
        Scene {
            figure: Some($figure),
            ..scene!($name, $exhibit, $side)
        }
    };
    ($name:literal, $exhibit:ident, $side:ident $(, $file:literal)*) => {
        Scene {
            figure: None,
            name: $name,
            recipe: include_str!(concat!("../../../../docs/recipes/", $name, ".toml")),
            exhibit: &$exhibit,
            files: &[$((
                $file,
                include_bytes!(concat!("../../../../docs/recipes/", $file)),
            )),*],
            side: Side::$side,
        }
    };
}

static SPOT: Exhibit = exhibit!("spot.obj", "Spot by Keenan Crane, CC0 1.0");
static TEAPOT: Exhibit = exhibit!(
    "teapot.obj",
    "Utah teapot by Martin Newell, 1975, public domain"
);
static GRID: Exhibit = exhibit!("grid.csv", "A grid of points, made for anamorph, CC0 1.0");

/// All of the page.
pub(super) static PARTS: &[Part] = &[
    Part {
        title: "Warps by features",
        about: "The framework's own examples: pairs of points and of frames, each with a strength and a weight.",
        scenes: &[
            scene!("points", TEAPOT, ThreeQuarter),
            scene!("frames", SPOT, BackQuarter),
            scene!("vortex", SPOT, BackQuarter),
            scene!("vortex-plane", GRID, Front),
        ],
    },
    Part {
        title: "Warps of the literature, cast in the framework",
        about: "Lattices, lines and axes: known deformations as weighted averages of scaled transformations.",
        scenes: &[
            scene!("lattice", SPOT, BackQuarter),
            scene!("cage", SPOT, BackQuarter, "cage.obj", "cage-edited.obj"),
            scene!("spline-lattice", SPOT, BackQuarter),
            scene!("fit", SPOT, BackQuarter),
            scene!("lines", GRID, Front),
            scene!("elements", TEAPOT, ThreeQuarter),
            scene!("radial", SPOT, BackQuarter),
            scene!("thin-plate", GRID, Front),
            scene!("scodef", TEAPOT, ThreeQuarter),
            scene!("multilevel", GRID, Front),
            scene!("polynomial", GRID, Front),
            scene!("grid", GRID, Front),
            scene!("taper", TEAPOT, ThreeQuarter),
            scene!("twist", SPOT, BackQuarter),
            scene!("bend", TEAPOT, Front),
            scene!("axial", TEAPOT, ThreeQuarter),
            scene!("wires", SPOT, BackQuarter),
            scene!("axial-curve", TEAPOT, ThreeQuarter),
            scene!("depth-wires", SPOT, Right),
        ],
    },
    Part {
        title: "Variants that the framework invents",
        about: "What becomes possible when the parts of a warp are exchanged.",
        scenes: &[
            scene!("lattice-centre", SPOT, BackQuarter, as "§5.1, Fig. 13"),
            scene!("frame-lattice", SPOT, BackQuarter),
            scene!("global-lines", GRID, Front),
            scene!(
                "mesh",
                SPOT,
                BackQuarter,
                "mesh-cage.obj",
                "mesh-edited.obj"
            ),
            scene!("continuous-wires", GRID, Front),
        ],
    },
    Part {
        title: "Stacks and masks",
        about: "Warps one after the other, each on the model as the one before leaves it, and each only where its mask lets it.",
        scenes: &[scene!("stack", SPOT, BackQuarter)],
    },
];
