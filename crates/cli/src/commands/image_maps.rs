//! Maps that compositors read and write: ST maps and motion vectors, as OpenEXR.

use crate::error::Failure;
use crate::files;
use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::{Deformation, Plane};
use anamorph_io::images::{Channel, ImageFile, ImageFormat, ImageLimits, SampleType};
use anamorph_raster::{PixelMap, Raster, Window};
use std::path::Path;

/// The place of each target pixel in the source, as compositors keep it: shares of the display window's sides, v going up.
/// Pixels without a place have −1 in both.
pub(super) fn stmap(map: &PixelMap, display: Window) -> Result<ImageFile, Failure> {
    let window = map.window();
    let (width, height) = (display.width() as f64, display.height() as f64);
    let mut samples = Vec::with_capacity(2 * map.offsets().len());
    for row in 0..window.height() {
        for column in 0..window.width() {
            let place = map.position(column, row).filter(|p| p.is_finite());
            let (u, v) = place.map_or((-1.0, -1.0), |place| {
                let from = place - display.corner();
                (from.x / width, 1.0 - from.y / height)
            });
            samples.extend([u as f32, v as f32]);
        }
    }
    let raster = Raster::from_samples(window, 2, samples).map_err(Failure::new)?;
    ImageFile::data(&raster.with_display(display), &["R", "G"]).map_err(Failure::new)
}

/// The map that a file holds, for an image with that display window.
pub(super) fn read_stmap(path: &Path, display: Window) -> Result<(PixelMap, Window), Failure> {
    let wrong =
        |error: &dyn core::fmt::Display| Failure::new(format!("{}: {error}", files::shown(path)));
    let bytes = files::read(path)?;
    let limits = ImageLimits::of_file(bytes.len());
    let image = ImageFile::read(&bytes, limits).map_err(|error| wrong(&error))?;
    let found = image.layers().iter().find_map(|layer| {
        let names = [["R", "G"], ["u", "v"], ["U", "V"]];
        let is_mixed = |c: &&Channel| c.sample() != SampleType::Integer32;
        let mixed = || layer.channels().iter().filter(is_mixed);
        let place = |name: &str| mixed().position(|c| c.name() == name);
        let pairs = names.iter().find_map(|[u, v]| place(u).zip(place(v)));
        Some((layer.raster.as_ref()?, pairs?))
    });
    let Some((raster, (u, v))) = found.filter(|_| image.format() == ImageFormat::OpenExr) else {
        return Err(wrong(
            &"no ST map; it needs to be OpenEXR with the channels R and G, or u and v, as `warp --stmap` writes it",
        ));
    };
    let (width, height) = (display.width() as f64, display.height() as f64);
    let shown = raster.display();
    let map = PixelMap::from_positions(raster.window(), |column, row| {
        let pixel = raster.pixel(column, row);
        let at = |channel: usize| pixel.get(channel).map_or(f64::NAN, |&s| f64::from(s));
        let (u, v) = (at(u), at(v));
        if (u, v) == (-1.0, -1.0) {
            return DVec2::NAN;
        }
        display.corner() + dvec2(u * width, (1.0 - v) * height)
    })
    .map_err(|error| wrong(&error))?;
    Ok((map, shown))
}

/// How far each source pixel moves, in pixels, v going up. Pixels that go nowhere have 0.
pub(super) fn motion(
    forward: &dyn Deformation<Plane>,
    window: Window,
    display: Window,
) -> Result<ImageFile, Failure> {
    let map = PixelMap::from_deformation(forward, window).map_err(Failure::new)?;
    let finite = |x: f32| if x.is_finite() { x } else { 0.0 };
    let offsets = map.offsets().iter();
    let samples = offsets
        .flat_map(|&[x, y]| [finite(x), finite(-y)])
        .collect();
    let raster = Raster::from_samples(window, 2, samples).map_err(Failure::new)?;
    let raster = raster.with_display(display);
    ImageFile::data(&raster, &["forward.u", "forward.v"]).map_err(Failure::new)
}
