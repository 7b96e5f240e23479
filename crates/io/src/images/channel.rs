//! Channels of an image, by their names.

/// How a file stores a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SampleType {
    /// A code of 8 bits.
    Code8,
    /// A code of 16 bits.
    Code16,
    /// A floating-point number of 16 bits.
    Half,
    /// A floating-point number of 32 bits.
    Float32,
    /// A whole number of 32 bits: the name of something, not an amount.
    Integer32,
}

impl SampleType {
    /// What it is called in prose.
    pub fn title(self) -> &'static str {
        match self {
            Self::Code8 => "8 bits",
            Self::Code16 => "16 bits",
            Self::Half => "half",
            Self::Float32 => "float",
            Self::Integer32 => "32-bit whole numbers",
        }
    }
}

/// What a channel is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ChannelKind {
    /// Light: red, green, blue, or grey.
    Colour,
    /// Coverage.
    Alpha,
    /// Anything else, such as depth: it is resampled like light, and never treated as such otherwise.
    Data,
}

/// A channel: its name and how it is stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    name: String,
    sample: SampleType,
}

impl Channel {
    pub(super) fn new(name: impl Into<String>, sample: SampleType) -> Self {
        Self {
            name: name.into(),
            sample,
        }
    }
    /// Its whole name, such as `R` or `diffuse.R`.
    pub fn name(&self) -> &str {
        &self.name
    }
    /// How it is stored.
    pub fn sample(&self) -> SampleType {
        self.sample
    }
    /// What precedes the last point of its name, and what follows it.
    pub(super) fn parts(&self) -> (&str, &str) {
        self.name.rsplit_once('.').unwrap_or(("", &self.name))
    }
    /// What it is about, by the names of OpenEXR: R, G, B and Y are light, A is coverage, behind any `layer.`.
    pub fn kind(&self) -> ChannelKind {
        match (self.sample, self.parts().1) {
            (SampleType::Integer32, _) => ChannelKind::Data,
            (_, "R" | "G" | "B" | "Y") => ChannelKind::Colour,
            (_, "A") => ChannelKind::Alpha,
            _ => ChannelKind::Data,
        }
    }
}
