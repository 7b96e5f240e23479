//! Images of one format as another.

use super::{
    Channel, ChannelKind, ImageError, ImageFile, ImageFormat, ImageLayer, Kept as AnyKept,
    SampleType, codes, openexr,
};
use crate::Lost;
use anamorph_raster::{Raster, Window};

/// An image of codes as OpenEXR: halves for 8 bits, 32-bit numbers otherwise.
pub(super) fn to_openexr(
    image: &ImageFile,
    kept: &codes::Kept,
) -> Result<(Vec<u8>, Lost), ImageError> {
    let mut lost = Lost::default();
    lost.add(kept.profile.is_some(), "the colour profile");
    lost.add(kept.exif.is_some(), "the Exif notes");
    let Some((layer, raster)) = image
        .layers
        .first()
        .and_then(|layer| Some((layer, layer.raster.clone()?)))
    else {
        return Err(ImageError::Empty {
            width: 0,
            height: 0,
        });
    };
    let wide = |channel: &Channel| {
        let sample = match channel.sample() {
            SampleType::Code8 => SampleType::Half,
            _ => SampleType::Float32,
        };
        Channel::new(channel.name(), sample)
    };
    let channels = layer.channels.iter().map(wide).collect();
    let raster = raster.with_display(image.display);
    let file = openexr::created(&raster, channels)?;
    let AnyKept::OpenExr(new) = &file.kept else {
        return Ok((Vec::new(), lost));
    };
    let (bytes, more) = openexr::encode(&file, new)?;
    lost.0.extend(more.0);
    Ok((bytes, lost))
}

/// The colours of an OpenEXR image as one layer of 32-bit numbers, ready to be encoded.
pub(super) fn to_codes(
    image: &ImageFile,
    whole: bool,
) -> Result<(ImageFile, codes::Kept, Lost), ImageError> {
    let mut lost = Lost::default();
    let all = || image.layers.iter().flat_map(ImageLayer::mixed);
    // The colours without a prefix first, then those of the first prefix.
    let is_colour = |c: &&Channel| c.kind() == ChannelKind::Colour;
    let colours = || {
        image.layers.iter().filter_map(|layer| {
            let plain = layer
                .mixed()
                .find(|c| is_colour(c) && c.parts().0.is_empty());
            let any = || layer.mixed().find(is_colour);
            Some((layer, layer.raster.as_ref()?, plain.or_else(any)?.parts().0))
        })
    };
    let plain = colours().find(|(_, _, prefix)| prefix.is_empty());
    let Some((layer, raster, prefix)) = plain.or_else(|| colours().next()) else {
        let names: Vec<&str> = image
            .layers
            .iter()
            .flat_map(|layer| layer.channels.iter().map(Channel::name))
            .collect();
        return Err(ImageError::NoColour {
            channels: names.join(", "),
        });
    };
    let place = |name: &str| layer.mixed().position(|c| c.parts() == (prefix, name));
    let rgb = ["R", "G", "B"].map(place);
    let mut sources: Vec<Option<usize>> = if rgb.iter().any(Option::is_some) {
        rgb.to_vec()
    } else {
        vec![place("Y")]
    };
    sources.extend(place("A").map(Some));
    let used = sources.iter().flatten().count();
    let others = all().count() - used
        + image
            .layers
            .iter()
            .map(|layer| layer.channels.len() - layer.mixed().count())
            .sum::<usize>();
    lost.add(others > 0, format!("{others} other channels"));
    lost.add(
        image.layers.len() > 1,
        format!("{} other layers", image.layers.len() - 1),
    );
    lost.add(true, "the attributes of OpenEXR");

    let data = raster.window();
    let window = if whole { data } else { image.display };
    lost.add(
        !whole && data.union(&window)? != window,
        "pixels outside of the display window",
    );
    let mut drawn = Raster::new(window, sources.len())?;
    copy(raster, &mut drawn, &sources);
    if place("A").is_some() {
        let mut pixels = drawn.samples().chunks_exact(sources.len());
        let alpha = sources.len() - 1;
        let mut lit = false;
        let empty = pixels.all(|pixel| {
            lit |= pixel[..alpha].iter().any(|light| *light != 0.0);
            pixel[alpha] == 0.0
        });
        lost.add(
            empty && lit,
            "the light of a picture whose alpha is 0 everywhere (it is empty; leave out the alpha channel, or write OpenEXR)",
        );
    }
    let of = |name: &&str| Channel::new(*name, SampleType::Float32);
    let layer = ImageLayer {
        name: None,
        channels: codes::names(sources.len()).iter().map(of).collect(),
        raster: Some(drawn),
        identifiers: None,
    };
    let kept = codes::Kept::default();
    let new = ImageFile {
        format: ImageFormat::OpenExr,
        display: window,
        layers: vec![layer],
        notes: Vec::new(),
        kept: AnyKept::Codes(kept.clone()),
    };
    Ok((new, kept, lost))
}

/// Copies channels where both rasters have pixels.
fn copy(from: &Raster, to: &mut Raster, sources: &[Option<usize>]) {
    let (source, target): (Window, Window) = (from.window(), to.window());
    let (dx, dy) = (target.x() - source.x(), target.y() - source.y());
    let shifted = |at: usize, by: i64, size: usize| {
        let place = i64::try_from(at).ok()?.checked_add(by)?;
        usize::try_from(place).ok().filter(|&place| place < size)
    };
    for row in 0..target.height() {
        let Some(y) = shifted(row, dy, source.height()) else {
            continue;
        };
        for column in 0..target.width() {
            let Some(x) = shifted(column, dx, source.width()) else {
                continue;
            };
            let pixel = from.pixel(x, y);
            let new = to.pixel_mut(column, row);
            for (slot, place) in new.iter_mut().zip(sources) {
                *slot = place.and_then(|p| pixel.get(p)).copied().unwrap_or(0.0);
            }
        }
    }
}
