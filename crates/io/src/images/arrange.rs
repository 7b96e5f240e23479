//! Images with other channels: grey as red, green and blue, and coverage where a file has none.
//!
//! So that images whose channels differ only in that can be mixed. Grey stands in all three colours with the same light, which encodes to
//! the same codes; without alpha everything is covered, by 1.

use super::{Channel, ChannelKind, ImageError, ImageFile, Kept, SampleType};
use anamorph_raster::Raster;

/// Where the numbers of a channel come from.
#[derive(Clone, Copy)]
enum From {
    /// A channel of the raster.
    Own(usize),
    /// Coverage that the file does not mention.
    Covered,
}

impl ImageFile {
    /// The image with these channels in one of its layers, in this order, beside those of whole numbers; OpenEXR wants them sorted by their
    /// names. A colour that it lacks is its grey; coverage that it lacks is 1; channels that are not named are left out.
    ///
    /// # Errors
    /// [`ImageError::NoChannel`] where a channel can be made from nothing; [`ImageError::Cannot`] for a name that OpenEXR cannot hold.
    pub fn with_channels(mut self, layer: usize, names: &[&str]) -> Result<Self, ImageError> {
        let Some(old) = self.layers.get_mut(layer) else {
            return Ok(self);
        };
        let mixed: Vec<Channel> = old.mixed().cloned().collect();
        if mixed.iter().map(Channel::name).eq(names.iter().copied()) {
            return Ok(self);
        }
        let mut sources = Vec::new();
        let mut channels = Vec::new();
        for name in names {
            let wanted = Channel::new(*name, SampleType::Float32);
            let (prefix, _) = wanted.parts();
            let find = |full: &str| mixed.iter().position(|c| c.name() == full);
            let grey = match prefix {
                "" => find("Y"),
                prefix => find(&format!("{prefix}.Y")),
            };
            let light = mixed
                .iter()
                .position(|c| c.kind() == ChannelKind::Colour && c.parts().0 == prefix);
            let (from, like) = match (find(name), wanted.kind()) {
                (Some(own), _) => (From::Own(own), own),
                (None, ChannelKind::Colour) => {
                    let Some(grey) = grey else {
                        return Err(no_channel(name, &mixed));
                    };
                    (From::Own(grey), grey)
                }
                (None, ChannelKind::Alpha) => {
                    let Some(light) = light else {
                        return Err(no_channel(name, &mixed));
                    };
                    (From::Covered, light)
                }
                (None, ChannelKind::Data) => return Err(no_channel(name, &mixed)),
            };
            sources.push(from);
            channels.push(Channel::new(*name, mixed[like].sample()));
        }
        old.raster = old
            .raster
            .as_ref()
            .map(|raster| taken(raster, &sources))
            .transpose()?;
        let whole = |c: &&Channel| c.sample() == SampleType::Integer32;
        let whole: Vec<Channel> = old.channels.iter().filter(whole).cloned().collect();
        let widened = mixed.iter().any(|c| c.name() == "Y") && names.contains(&"R");
        match &mut self.kept {
            Kept::Codes(kept) if widened => kept.widen(),
            Kept::Codes(_) => {}
            Kept::OpenExr(kept) => {
                channels.extend(whole);
                channels.sort_by(|a, b| a.name().cmp(b.name()));
                kept.set_channels(layer, &channels)?;
            }
        }
        old.channels = channels;
        Ok(self)
    }
}

fn no_channel(name: &str, among: &[Channel]) -> ImageError {
    let all: Vec<&str> = among.iter().map(Channel::name).collect();
    ImageError::NoChannel {
        name: name.to_owned(),
        channels: all.join(", "),
    }
}

fn taken(raster: &Raster, sources: &[From]) -> Result<Raster, ImageError> {
    let mut new = Raster::new(raster.window(), sources.len())?.with_display(raster.display());
    let old = raster.samples().chunks_exact(raster.channels());
    for (new, old) in new.samples_mut().chunks_exact_mut(sources.len()).zip(old) {
        for (slot, from) in new.iter_mut().zip(sources) {
            *slot = match from {
                From::Own(own) => old[*own],
                From::Covered => 1.0,
            };
        }
    }
    Ok(new)
}

#[cfg(test)]
mod tests {
    use super::super::{EncodeOptions, ImageFormat, ImageLimits};
    use super::*;
    use anamorph_raster::Window;

    fn grey() -> ImageFile {
        let window = Window::new(0, 0, 2, 1).unwrap();
        let raster = Raster::from_samples(window, 1, vec![0.25, 0.75]).unwrap();
        ImageFile::data(&raster, &["Y"]).unwrap()
    }

    fn again(image: &ImageFile, format: ImageFormat) -> ImageFile {
        let (bytes, _) = image.encode(format, &EncodeOptions::default()).unwrap();
        ImageFile::read(&bytes, ImageLimits::NONE).unwrap()
    }

    #[test]
    fn grey_becomes_covered_colour() {
        for format in [ImageFormat::OpenExr, ImageFormat::Png] {
            let image = again(&grey(), format);
            let names = match format {
                ImageFormat::OpenExr => ["A", "B", "G", "R"],
                _ => ["R", "G", "B", "A"],
            };
            let own = image.layers()[0].raster.clone().unwrap();
            let wide = image.with_channels(0, &names).unwrap();
            let read = again(&wide, format);
            let found: Vec<&str> = read.layers()[0]
                .channels()
                .iter()
                .map(Channel::name)
                .collect();
            assert_eq!(found, names);
            let raster = read.layers()[0].raster.as_ref().unwrap();
            let alpha = names.iter().position(|n| *n == "A").unwrap();
            for (i, grey) in own.samples().iter().enumerate() {
                for (channel, sample) in raster.pixel(i, 0).iter().enumerate() {
                    let wanted = if channel == alpha { 1.0 } else { *grey };
                    assert_eq!(*sample, wanted);
                }
            }
        }
    }

    #[test]
    fn what_is_made_from_nothing_is_an_error() {
        let error = grey().with_channels(0, &["Y", "Z"]).unwrap_err();
        assert!(error.to_string().contains("no channel Z"), "{error}");
    }
}
