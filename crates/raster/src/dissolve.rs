//! Cross-dissolve: two rasters in one, the second coming as the first goes.
//!
//! *Source*: T. Porter and T. Duff, *Compositing Digital Images*, SIGGRAPH 1984 (the operators *dissolve* and *plus*), which
//! mix premultiplied samples; G. Wolberg, *Digital Image Warping*, 1990.

use crate::{Raster, RasterError, parallel};

/// Samples a task mixes.
const TASK: usize = 1 << 16;

/// `(1 − t)·first + t·second`, sample by sample, for rasters in premultiplied linear light. At `t = 0` and `t = 1` exactly
/// the first and the second; the other's numbers that are not finite do not show. The display window is the first's.
///
/// # Errors
/// [`RasterError::Windows`], [`RasterError::Channels`] where the two differ; [`RasterError::OutOfRange`] for `t` outside
/// [0, 1].
pub fn cross_dissolve(first: &Raster, second: &Raster, t: f64) -> Result<Raster, RasterError> {
    let mut mixed = first.clone();
    dissolve_into(&mut mixed, second, t)?;
    Ok(mixed)
}

/// As [`cross_dissolve`], in the memory of the first.
///
/// # Errors
/// As of [`cross_dissolve`]; then the first is as it was.
pub fn dissolve_into(first: &mut Raster, second: &Raster, t: f64) -> Result<(), RasterError> {
    first.check_alike(second)?;
    if !(0.0..=1.0).contains(&t) {
        return Err(RasterError::OutOfRange {
            name: "t",
            value: t,
            range: "from 0 to 1",
        });
    }
    if t == 0.0 {
        return Ok(());
    }
    let (keep, take) = ((1.0 - t) as f32, t as f32);
    parallel::chunks(first.samples_mut(), TASK, |task, chunk| {
        let other = &second.samples()[task * TASK..];
        if t == 1.0 {
            chunk.copy_from_slice(&other[..chunk.len()]);
            return;
        }
        for (a, b) in chunk.iter_mut().zip(other) {
            *a = *a * keep + b * take;
        }
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Window;

    #[test]
    fn ends_are_exact_and_the_middle_is_the_mean() {
        let window = Window::new(0, 0, 3, 1).unwrap();
        let a = Raster::from_samples(window, 1, vec![0.1, f32::NAN, 0.5]).unwrap();
        let b = Raster::from_samples(window, 1, vec![0.3, 0.25, f32::INFINITY]).unwrap();
        let bits = |r: &Raster| r.samples().iter().map(|s| s.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&cross_dissolve(&a, &b, 0.0).unwrap()), bits(&a));
        assert_eq!(bits(&cross_dissolve(&a, &b, 1.0).unwrap()), bits(&b));
        let half = cross_dissolve(&a, &b, 0.5).unwrap();
        assert!((half.samples()[0] - 0.2).abs() < 1e-7);
        assert!(half.samples()[1].is_nan() && half.samples()[2] == f32::INFINITY);
        for t in [-0.1, 1.1, f64::NAN] {
            assert!(cross_dissolve(&a, &b, t).is_err());
        }
    }

    #[test]
    fn premultiplied_light_does_not_darken_at_the_edge_of_a_shape() {
        // Opaque white into nothing: half covered white, not grey.
        let window = Window::new(0, 0, 1, 1).unwrap();
        let white = Raster::from_samples(window, 2, vec![1.0, 1.0]).unwrap();
        let nothing = Raster::new(window, 2).unwrap();
        let mut half = cross_dissolve(&white, &nothing, 0.5).unwrap();
        crate::colour::unpremultiply(&mut half, 1).unwrap();
        assert_eq!(half.samples(), [1.0, 0.5]);
    }

    #[test]
    fn unlike_rasters_are_refused() {
        let small = Raster::new(Window::new(0, 0, 1, 1).unwrap(), 1).unwrap();
        let moved = Raster::new(Window::new(1, 0, 1, 1).unwrap(), 1).unwrap();
        let coloured = Raster::new(small.window(), 3).unwrap();
        assert!(matches!(
            cross_dissolve(&small, &moved, 0.5),
            Err(RasterError::Windows { .. })
        ));
        assert!(matches!(
            cross_dissolve(&small, &coloured, 0.5),
            Err(RasterError::Channels {
                first: 1,
                second: 3
            })
        ));
    }
}
