//! What is seen of an image: one picture of red, green, blue and coverage, whatever layers and channels the file has.

use super::{Channel, ChannelKind, ImageError, ImageFile, ImageLayer};
use anamorph_raster::Raster;

impl ImageFile {
    /// Red, green, blue and coverage in premultiplied linear light, of the first layer with colours without a prefix, else of the
    /// first with colours. Grey counts as all three; without alpha the coverage is 1. Of an image without any colours the
    /// first channel is seen as grey, from its least finite number (black) to its largest (white).
    ///
    /// # Errors
    /// [`ImageError::NoColour`] for an image of nothing but 32-bit whole numbers; [`ImageError::Raster`] for one that does not fit
    /// into memory.
    pub fn light(&self) -> Result<Raster, ImageError> {
        let colours = || {
            self.layers().iter().filter_map(|layer| {
                let raster = layer.raster.as_ref()?;
                let is_colour = |c: &&Channel| c.kind() == ChannelKind::Colour;
                let plain = layer
                    .mixed()
                    .filter(is_colour)
                    .find(|c| c.parts().0.is_empty());
                let found = plain.or_else(|| layer.mixed().find(is_colour))?;
                Some((layer, raster, found.parts().0))
            })
        };
        let plain = colours().find(|(_, _, prefix)| prefix.is_empty());
        if let Some((layer, raster, prefix)) = plain.or_else(|| colours().next()) {
            return coloured(layer, raster, prefix);
        }
        let Some(raster) = self.layers().iter().find_map(|layer| layer.raster.as_ref()) else {
            let names = self.layers().iter().flat_map(ImageLayer::channels);
            return Err(ImageError::NoColour {
                channels: names.map(Channel::name).collect::<Vec<_>>().join(", "),
            });
        };
        grey(raster)
    }
}

fn coloured(layer: &ImageLayer, raster: &Raster, prefix: &str) -> Result<Raster, ImageError> {
    let place = |name: &str| layer.mixed().position(|c| c.parts() == (prefix, name));
    let grey = place("Y");
    let sources = ["R", "G", "B"].map(|name| place(name).or(grey));
    let alpha = place("A");
    let mut light = Raster::new(raster.window(), 4)?.with_display(raster.display());
    let (pixels, _) = light.samples_mut().as_chunks_mut::<4>();
    for (pixel, from) in pixels
        .iter_mut()
        .zip(raster.samples().chunks_exact(raster.channels()))
    {
        let sample = |at: Option<usize>| at.and_then(|at| from.get(at)).copied();
        let [r, g, b] = sources.map(|at| sample(at).unwrap_or(0.0));
        *pixel = [r, g, b, sample(alpha).unwrap_or(1.0)];
    }
    Ok(light)
}

fn grey(raster: &Raster) -> Result<Raster, ImageError> {
    let channels = raster.channels();
    let numbers = || raster.samples().iter().step_by(channels).copied();
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for number in numbers().filter(|number| number.is_finite()) {
        (low, high) = (low.min(number), high.max(number));
    }
    let scale = if high > low {
        1.0 / (f64::from(high) - f64::from(low))
    } else {
        0.0
    };
    let mut light = Raster::new(raster.window(), 4)?.with_display(raster.display());
    let (pixels, _) = light.samples_mut().as_chunks_mut::<4>();
    for (pixel, number) in pixels.iter_mut().zip(numbers()) {
        let share = ((f64::from(number) - f64::from(low)) * scale) as f32;
        let grey = if number.is_finite() { share } else { 0.0 };
        *pixel = [grey, grey, grey, 1.0];
    }
    Ok(light)
}
