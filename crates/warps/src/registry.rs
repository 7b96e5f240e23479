//! Every warp that a recipe can name: one line each, in the order of the framework paper.
//!
//! The registry feeds the recipe schema, the lists of the command line, the gallery, the benchmarks and the law tests.
//!
//! *Source*: Milliron et al. 2002, §3–§6 for the order.

use crate::{
    barr, features, grids, lattices, lines, meshes, multilevel, polynomials, radial, scodef, wires,
};
use anamorph_catalog::WarpEntry;
use anamorph_core::{Plane, Solid};
use anamorph_transforms::Rotational;
use wires::axial_parameters::Framed;

/// Warps that work in the plane and in space.
fn both<S: Rotational>() -> Vec<WarpEntry<S>> {
    vec![
        features::parameters::points(),
        features::parameters::frames(),
        features::parameters::vortex(),
        lattices::parameters::lattice(),
        lattices::parameters::spline_lattice(),
        lattices::parameters::frame_lattice(),
        lines::parameters::elements(),
        barr::parameters::taper(),
        barr::parameters::bend(),
        barr::parameters::axial(),
        meshes::parameters::mesh(),
        radial::parameters::radial(),
        radial::parameters::thin_plate(),
        scodef::parameters::scodef(),
        polynomials::parameters::polynomial(),
        multilevel::parameters::multilevel(),
    ]
}

/// Warps of the plane alone.
fn plane_only() -> Vec<WarpEntry<Plane>> {
    vec![
        lines::parameters::local_lines(),
        lines::parameters::global_lines(),
        grids::parameters::grid(),
    ]
}

/// Warps by curves, in the plane and in space.
fn by_curves<S: Framed>() -> Vec<WarpEntry<S>> {
    vec![
        wires::parameters::wires(),
        wires::parameters::continuous(),
        wires::axial_parameters::axial_curve(),
    ]
}

/// Warps of space alone.
fn solid_only() -> Vec<WarpEntry<Solid>> {
    vec![barr::parameters::twist(), wires::parameters::depth()]
}

/// The warps of the plane.
pub fn plane() -> Vec<WarpEntry<Plane>> {
    let mut all = both();
    all.extend(plane_only());
    all.extend(by_curves());
    all
}

/// The warps of space.
pub fn solid() -> Vec<WarpEntry<Solid>> {
    let mut all = both();
    all.extend(by_curves());
    all.extend(solid_only());
    all
}
