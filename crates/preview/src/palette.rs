//! The colours of the two themes, in linear light.
//!
//! *Source* of the features' hues: Milliron et al., *A Framework for Geometric Warps and Deformations*, ACM TOG 21(1),
//! 2002, whose figures draw source features orange and target features blue.

use anamorph_core::Role;

use crate::Theme;
use crate::mesh::decode_srgb;

/// A colour in linear light.
pub(crate) type Linear = [f32; 3];

/// Everything that has a colour or an intensity.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Palette {
    /// Background at the top, at the bottom, and in the pool of light behind the model.
    pub top: Linear,
    pub bottom: Linear,
    pub pool: Linear,
    /// Outside and inside of surfaces without colours of their own.
    pub material: Linear,
    pub inside: Linear,
    /// Points in space without colours of their own.
    pub dot: Linear,
    /// Points of the plane, lines of the model.
    pub ink: Linear,
    /// Filled triangles of the plane, and those turned over.
    pub fill: Linear,
    pub turned: Linear,
    /// Grid of the plane, and the line between panels.
    pub grid: Linear,
    pub divider: Linear,
    /// Intensities of the sky, the key light, the fill light, the rim.
    pub sky: f32,
    pub key: f32,
    pub fill_light: f32,
    pub rim: f32,
    /// How much of the floor's shadow shows, 0 to 1.
    pub shadow: f32,
    /// How much of a mark shows through the model, 0 to 1.
    pub hidden: f32,
    features: [Linear; 4],
    /// Whether outlines of points are darker (light theme) or the background's colour (dark theme).
    pub outline: f32,
}

impl Palette {
    pub(crate) fn of(theme: Theme) -> Self {
        match theme {
            Theme::Light => Self {
                top: hex(0xd6d9de),
                bottom: hex(0xe6e4e1),
                pool: hex(0xf3f2f0),
                material: hex(0xdcd2c5),
                inside: hex(0x8195ac),
                dot: hex(0x6c7888),
                ink: hex(0x3c424c),
                fill: hex(0xddd3c6),
                turned: hex(0x9fb0c4),
                grid: hex(0xc3c6cc),
                divider: hex(0xb9bcc2),
                sky: 0.57,
                key: 0.67,
                fill_light: 0.13,
                rim: 0.16,
                shadow: 0.85,
                hidden: 0.30,
                features: [hex(0xf2700c), hex(0x1b62dc), hex(0xef9a58), hex(0x78a2e8)],
                outline: 0.32,
            },
            Theme::Dark => Self {
                top: hex(0x1b1e23),
                bottom: hex(0x22252a),
                pool: hex(0x353a42),
                material: hex(0xd8cfc3),
                inside: hex(0x6d84a0),
                dot: hex(0xd8cfc3),
                ink: hex(0xd5d8de),
                fill: hex(0x8d857a),
                turned: hex(0x54677f),
                grid: hex(0x3a3f47),
                divider: hex(0x555b65),
                sky: 0.42,
                key: 0.74,
                fill_light: 0.10,
                rim: 0.30,
                shadow: 0.9,
                hidden: 0.34,
                features: [hex(0xff8a2a), hex(0x4f9bff), hex(0xb9743c), hex(0x4a76b8)],
                outline: 0.25,
            },
        }
    }

    /// Colour of a mark.
    pub(crate) fn feature(&self, role: Role) -> Linear {
        let [source, target, source_guide, target_guide] = self.features;
        match role {
            Role::Source => source,
            Role::Target => target,
            Role::SourceGuide => source_guide,
            Role::TargetGuide => target_guide,
        }
    }

    /// The background of a panel at a place given in parts of its width and height.
    pub(crate) fn background(&self, x: f32, y: f32, aspect: f32) -> Linear {
        let (dx, dy) = ((x - 0.5) * aspect, (y - 0.52) * 1.1);
        let pool = (-(dx * dx + dy * dy) * 4.2).exp();
        mix(mix(self.top, self.bottom, y), self.pool, pool)
    }
}

/// The straight blend, `a` at 0 and `b` at 1.
pub(crate) fn mix(a: Linear, b: Linear, t: f32) -> Linear {
    [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * t)
}

/// The colour times a number.
pub(crate) fn scale(colour: Linear, factor: f32) -> Linear {
    colour.map(|part| part * factor)
}

fn hex(code: u32) -> Linear {
    [16, 8, 0].map(|shift| decode_srgb(((code >> shift) & 255) as f32 / 255.0))
}
