//! The layers and channels that all images of a morph are brought to.
//!
//! Images that differ only by alpha, or by grey and colour, are brought together: what has no alpha is opaque, and grey stands in red, green
//! and blue. Everything else that one has and the other lacks is refused.

use super::sources::Image;
use crate::error::Failure;
use anamorph_io::images::{Channel, ChannelKind, ImageFormat, ImageLayer, SampleType};

/// The order of channels in files of codes.
const CODES: [&str; 5] = ["Y", "R", "G", "B", "A"];

/// A channel that is drawn.
#[derive(Clone, PartialEq)]
struct Drawn {
    name: String,
    kind: ChannelKind,
}

impl Drawn {
    /// What precedes the last point of its name, and what follows it.
    fn parts(&self) -> (&str, &str) {
        self.name.rsplit_once('.').unwrap_or(("", &self.name))
    }
}

/// The channels of a layer that are drawn, in order.
fn drawn(layer: &ImageLayer) -> Vec<Drawn> {
    let drawn = |c: &&Channel| c.sample() != SampleType::Integer32;
    let one = |c: &Channel| Drawn {
        name: c.name().to_owned(),
        kind: c.kind(),
    };
    layer.channels().iter().filter(drawn).map(one).collect()
}

fn names(channels: &[Drawn]) -> Vec<&str> {
    channels.iter().map(|c| c.name.as_str()).collect()
}

/// The channels of each layer of the result.
#[derive(Clone, PartialEq)]
pub(super) struct Form {
    format: ImageFormat,
    /// The image that it was begun with.
    first: String,
    layers: Vec<(Option<String>, Vec<Drawn>)>,
}

impl Form {
    /// That of an image.
    pub(super) fn of(image: &Image) -> Self {
        let layer = |layer: &ImageLayer| (layer.name().map(str::to_owned), drawn(layer));
        Self {
            format: image.file.format(),
            first: image.name.clone(),
            layers: image.file.layers().iter().map(layer).collect(),
        }
    }

    /// Adds what another image has. Refuses one that differs in more than alpha, or grey and colour.
    pub(super) fn join(&mut self, image: &Image) -> Result<(), Failure> {
        let own = image.file.layers();
        if own.len() != self.layers.len() {
            return Err(Failure::new(format!(
                "{}: it has {} layers, and {} has {}; morph images with the same layers",
                image.name,
                own.len(),
                self.first,
                self.layers.len()
            )));
        }
        let alone = own.len() == 1;
        for (own, (name, channels)) in own.iter().zip(&mut self.layers) {
            let mine = drawn(own);
            let joined = if alone || own.name() == name.as_deref() {
                joined(channels, &mine)
            } else {
                Err(None)
            };
            *channels = joined.map_err(|only| {
                let layer = own
                    .name()
                    .map_or(String::new(), |n| format!(" in layer {n}"));
                let which = only.map_or(String::new(), |only| {
                    format!(" (only one of them has {only})")
                });
                Failure::new(format!(
                    "{}: it has the channels {}{layer}, and {} has {}{which}; convert one of them, so that both have the same",
                    image.name,
                    names(&mine).join(", "),
                    self.first,
                    names(channels).join(", ")
                ))
            })?;
            let place = |c: &Drawn| CODES.iter().position(|code| *code == c.name);
            match self.format {
                ImageFormat::OpenExr => channels.sort_by(|a, b| a.name.cmp(&b.name)),
                _ => channels.sort_by_key(place),
            }
        }
        Ok(())
    }

    /// The image in this form.
    pub(super) fn fit(&self, image: Image) -> Result<Image, Failure> {
        let mut with = self.clone();
        with.join(&image)?;
        if with != *self {
            return Err(Failure::new(format!(
                "{}: it has more channels than the first pictures of the morph; convert it, so that all of its series have the same",
                image.name
            )));
        }
        let Image { mut file, name } = image;
        for (number, (_, channels)) in self.layers.iter().enumerate() {
            file = file
                .with_channels(number, &names(channels))
                .map_err(|error| Failure::new(format!("{name}: {error}")))?;
        }
        Ok(Image { file, name })
    }

    /// What becomes of an image in this form, in words.
    pub(super) fn changes(&self, image: &Image) -> Option<String> {
        let pairs = || image.file.layers().iter().zip(&self.layers);
        let any = |test: &dyn Fn(&[Drawn], &[Drawn]) -> bool| {
            pairs().any(|(own, (_, wanted))| test(&drawn(own), wanted))
        };
        let has = |list: &[Drawn], name: &str| list.iter().any(|c| c.parts().1 == name);
        let covered = any(&|own, wanted| has(wanted, "A") && !has(own, "A"));
        let coloured = any(&|own, wanted| has(wanted, "R") && !has(own, "R"));
        let mut words = Vec::new();
        if coloured {
            words.push("it is grey, which stands in R, G and B");
        }
        if coloured && image.file.has_profile() {
            words.push("its colour profile, one of grey, is left out");
        }
        if covered {
            words.push("it has no alpha, so it is opaque");
        }
        (!words.is_empty()).then(|| format!("{}: {}", image.name, words.join("; ")))
    }
}

/// The channels of both; what only one has and the other cannot get is an error.
fn joined(a: &[Drawn], b: &[Drawn]) -> Result<Vec<Drawn>, Option<String>> {
    let mut all = a.to_vec();
    all.extend(b.iter().filter(|c| !a.contains(c)).cloned());
    let colours = |list: &[Drawn], prefix: &str| {
        let own = |c: &&Drawn| c.kind == ChannelKind::Colour && c.parts().0 == prefix;
        let mut found: Vec<String> = list
            .iter()
            .filter(own)
            .map(|c| c.parts().1.to_owned())
            .collect();
        found.sort();
        found
    };
    let mut grey = Vec::new();
    for channel in &all {
        if a.contains(channel) && b.contains(channel) {
            continue;
        }
        let (prefix, _) = channel.parts();
        let sides = [colours(a, prefix), colours(b, prefix)];
        let can = match channel.kind {
            ChannelKind::Alpha => sides.iter().all(|side| !side.is_empty()),
            ChannelKind::Colour => {
                let is = |side: &[String], wanted: &[&str]| side.iter().eq(wanted.iter());
                let [a, b] = &sides;
                [(a, b), (b, a)]
                    .iter()
                    .any(|(a, b)| is(a, &["Y"]) && is(b, &["B", "G", "R"]))
            }
            ChannelKind::Data => false,
        };
        if !can {
            return Err(Some(channel.name.clone()));
        }
        if channel.kind == ChannelKind::Colour && channel.parts().1 == "Y" {
            grey.push(channel.clone());
        }
    }
    all.retain(|channel| !grey.contains(channel));
    Ok(all)
}
