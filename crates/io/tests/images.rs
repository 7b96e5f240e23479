//! Images keep their pixels and what stands beside them; damaged ones are errors.
#![cfg(feature = "images")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_io::images::{
    Channel, ChannelKind, EncodeOptions, ImageError, ImageFile, ImageFormat, ImageLimits,
    SampleType,
};
use anamorph_raster::{Raster, Window};
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples, Image,
    ImageAttributes, IntegerBounds, Layer, LayerAttributes, Layers, LineOrder, Text, Vec2,
    WritableImage, f16,
};
use image::{DynamicImage, ImageBuffer};
use std::io::Cursor;

fn read(bytes: &[u8]) -> Result<ImageFile, ImageError> {
    ImageFile::read(bytes, ImageLimits::of_file(bytes.len()))
}

fn again(file: &ImageFile, format: ImageFormat) -> (Vec<u8>, Vec<String>) {
    let (bytes, lost) = file.encode(format, &EncodeOptions::default()).unwrap();
    (bytes, lost.0)
}

fn bytes_of(picture: &DynamicImage, format: image::ImageFormat) -> Vec<u8> {
    let mut out = Vec::new();
    picture
        .write_to(&mut Cursor::new(&mut out), format)
        .unwrap();
    out
}

/// All codes, in a scrambled order; alpha among them, so that hidden colours and small coverages occur.
fn scrambled<T>(channels: u32, of: impl Fn(u32) -> T) -> (u32, u32, Vec<T>) {
    let (width, height) = (320, 205);
    let count = width * height * channels;
    (
        width,
        height,
        (0..count)
            .map(|i| of(i.wrapping_mul(2_654_435_761) >> 9))
            .collect(),
    )
}

macro_rules! buffer {
    ($pixel:ty, $channels:expr, $code:ty) => {{
        let (width, height, codes) = scrambled($channels, |i| i as $code);
        let buffer: ImageBuffer<$pixel, _> = ImageBuffer::from_raw(width, height, codes).unwrap();
        DynamicImage::from(buffer)
    }};
}

fn pictures() -> Vec<DynamicImage> {
    vec![
        buffer!(image::Luma<u8>, 1, u8),
        buffer!(image::LumaA<u8>, 2, u8),
        buffer!(image::Rgb<u8>, 3, u8),
        buffer!(image::Rgba<u8>, 4, u8),
        buffer!(image::Luma<u16>, 1, u16),
        buffer!(image::LumaA<u16>, 2, u16),
        buffer!(image::Rgb<u16>, 3, u16),
        buffer!(image::Rgba<u16>, 4, u16),
    ]
}

#[test]
fn codes_of_8_and_16_bits_come_back_exactly() {
    for picture in pictures() {
        let bytes = bytes_of(&picture, image::ImageFormat::Png);
        let file = read(&bytes).unwrap();
        assert_eq!(file.format(), ImageFormat::Png);
        assert_eq!(file.has_alpha(), picture.color().has_alpha());
        let (out, lost) = again(&file, ImageFormat::Png);
        assert!(lost.is_empty(), "{lost:?}");
        let back = image::load_from_memory(&out).unwrap();
        assert!(back == picture, "{:?}", picture.color());
    }
}

#[test]
fn tiff_and_webp_keep_what_they_can_hold() {
    for picture in pictures() {
        let wide = bytes_of(&picture, image::ImageFormat::Png);
        let file = read(&wide).unwrap();
        let (out, lost) = again(&file, ImageFormat::Tiff);
        assert!(lost.is_empty(), "{lost:?}");
        let back = image::load_from_memory(&out).unwrap();
        assert_eq!(
            back.to_rgba16(),
            picture.to_rgba16(),
            "{:?}",
            picture.color()
        );
        assert_eq!(read(&out).unwrap().format(), ImageFormat::Tiff);

        let (out, lost) = again(&file, ImageFormat::WebP);
        let sixteen = matches!(file.layers()[0].channels()[0].sample(), SampleType::Code16);
        assert_eq!(lost.is_empty(), !sixteen, "{lost:?}");
        let back = image::load_from_memory(&out).unwrap();
        // Colours that nobody sees are kept by this encoder, too.
        if !sixteen {
            assert_eq!(back.to_rgba8(), picture.to_rgba8());
        }
    }
}

#[test]
fn light_is_linear_and_premultiplied() {
    let picture: ImageBuffer<image::Rgba<u8>, _> =
        ImageBuffer::from_raw(1, 1, vec![188_u8, 0, 255, 51]).unwrap();
    let file = read(&bytes_of(&picture.into(), image::ImageFormat::Png)).unwrap();
    let layer = &file.layers()[0];
    let pixel = layer.raster.as_ref().unwrap().pixel(0, 0).to_vec();
    assert!((pixel[0] - 0.5029 * 0.2).abs() < 1e-3, "{pixel:?}");
    assert_eq!(pixel[1], 0.0);
    assert!((pixel[2] - 0.2).abs() < 1e-6 && (pixel[3] - 0.2).abs() < 1e-6);
    let kinds: Vec<ChannelKind> = layer.channels().iter().map(Channel::kind).collect();
    assert_eq!(kinds[3], ChannelKind::Alpha);
    assert_eq!(kinds[0], ChannelKind::Colour);
}

#[test]
fn jpeg_is_near_and_keeps_its_profile() {
    let gradient = ImageBuffer::from_fn(64, 48, |x, y| {
        image::Rgb([(x * 4) as u8, (y * 5) as u8, 90])
    });
    let mut bytes = Vec::new();
    let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 98);
    let profile = vec![7_u8; 300];
    image::ImageEncoder::set_icc_profile(&mut encoder, profile.clone()).unwrap();
    encoder.encode_image(&gradient).unwrap();
    let file = read(&bytes).unwrap();
    for format in [
        ImageFormat::Jpeg,
        ImageFormat::Png,
        ImageFormat::Tiff,
        ImageFormat::WebP,
    ] {
        let (out, lost) = again(&file, format);
        assert!(lost.is_empty(), "{format:?} {lost:?}");
        // Read again and written as PNG, whose decoder says what the profile is.
        let (png, _) = again(&read(&out).unwrap(), ImageFormat::Png);
        let decoder = image::codecs::png::PngDecoder::new(Cursor::new(&png));
        let kept = image::ImageDecoder::icc_profile(&mut decoder.unwrap()).unwrap();
        assert!(kept.as_deref() == Some(&profile[..]), "{format:?}");
        let back = image::load_from_memory(&out).unwrap().to_rgb8();
        let apart = back.as_raw().iter().zip(gradient.as_raw());
        let most = apart.map(|(a, b)| a.abs_diff(*b)).max();
        assert!(most < Some(12), "{format:?} {most:?}");
    }
}

#[test]
fn text_and_resolution_of_png_files_stay() {
    let picture = bytes_of(&buffer!(image::Rgb<u8>, 3, u8), image::ImageFormat::Png);
    let chunk = |name: &[u8; 4], data: &[u8]| {
        let mut chunk = (data.len() as u32).to_be_bytes().to_vec();
        chunk.extend_from_slice(name);
        chunk.extend_from_slice(data);
        // The checksum of PNG, bit by bit.
        let mut sum = u32::MAX;
        for &byte in &chunk[4..] {
            sum ^= u32::from(byte);
            for _ in 0..8 {
                sum = sum >> 1 ^ (0xedb8_8320 & (sum & 1).wrapping_neg());
            }
        }
        chunk.extend_from_slice(&(!sum).to_be_bytes());
        chunk
    };
    let text = chunk(b"tEXt", b"Title\0A title");
    let metres = chunk(b"pHYs", &[0, 0, 11, 19, 0, 0, 11, 19, 1]);
    let histogram = chunk(b"hIST", &[0, 1]);
    let mut bytes = picture.clone();
    bytes.splice(33..33, [text.clone(), metres.clone(), histogram].concat());
    let file = read(&bytes).unwrap();
    assert!(file.notes()[0].contains("hIST"), "{:?}", file.notes());
    let (out, _) = again(&file, ImageFormat::Png);
    for kept in [&text, &metres] {
        assert!(out.windows(kept.len()).any(|part| part == &kept[..]));
    }
    assert_eq!(
        read(&out).unwrap().layers()[0].raster,
        file.layers()[0].raster
    );
}

type Exr = Image<Layers<AnyChannels<FlatSamples>>>;

/// Two layers with offset windows, all types of samples and odd values among them.
fn exr_image(blocks: Blocks, compression: Compression) -> Exr {
    let odd = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        -0.0,
        1e-42,
        6.1e-5,
        65504.0,
        0.3,
    ];
    let layer = |name: &str, position: Vec2<i32>, size: Vec2<usize>| {
        let count = size.area();
        let number = |i: usize| {
            odd.get(i % 61)
                .copied()
                .unwrap_or((i as f32 * 0.37).sin() * 9.0)
        };
        let float = |i: usize| number(i) * if i % 61 < 4 { 1.0 } else { 1e5 };
        let list = [
            (
                "A",
                FlatSamples::F16((0..count).map(|i| f16::from_f32(number(i))).collect()),
            ),
            (
                "R",
                FlatSamples::F16((0..count).map(|i| f16::from_f32(number(i + 3))).collect()),
            ),
            ("Z", FlatSamples::F32((0..count).map(float).collect())),
            (
                "id",
                FlatSamples::U32((0..count).map(|i| u32::MAX - i as u32 * 77_777).collect()),
            ),
        ];
        let channels = list.into_iter();
        let list = channels
            .map(|(n, samples)| AnyChannel::new(n, samples))
            .collect();
        let mut attributes = LayerAttributes::named(name);
        attributes.layer_position = position;
        attributes.comments = Some(Text::from("a remark"));
        let own = AttributeValue::F32(2.5);
        attributes.other.insert(Text::from("grain"), own);
        let encoding = Encoding {
            compression,
            blocks,
            line_order: LineOrder::Increasing,
        };
        Layer::new(size, attributes, encoding, AnyChannels { list })
    };
    let display = IntegerBounds::new(Vec2(-5, 3), Vec2(90, 70));
    let mut attributes = ImageAttributes::new(display);
    attributes.pixel_aspect = 1.5;
    let mut layers = Layers::new();
    layers.push(layer("beauty", Vec2(-9, 4), Vec2(70, 53)));
    layers.push(layer("behind", Vec2(20, -8), Vec2(31, 33)));
    Image {
        attributes,
        layer_data: layers,
    }
}

fn exr_bytes(image: &Exr) -> Vec<u8> {
    let mut out = Vec::new();
    image
        .write()
        .non_parallel()
        .to_buffered(Cursor::new(&mut out))
        .unwrap();
    out
}

fn exr_again(bytes: &[u8]) -> Exr {
    use exr::prelude::{ReadChannels, ReadLayers};
    let reader = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level();
    let reader = reader
        .all_channels()
        .all_layers()
        .all_attributes()
        .non_parallel();
    reader.from_buffered(Cursor::new(bytes)).unwrap()
}

/// The bits of all samples, channel by channel.
fn bits(image: &Exr) -> Vec<(String, Vec<u32>)> {
    let channels = image
        .layer_data
        .iter()
        .flat_map(|layer| &layer.channel_data.list);
    let of = |channel: &AnyChannel<FlatSamples>| {
        let bits = match &channel.sample_data {
            FlatSamples::F16(v) => v.iter().map(|v| u32::from(v.to_bits())).collect(),
            FlatSamples::F32(v) => v.iter().map(|v| v.to_bits()).collect(),
            FlatSamples::U32(v) => v.clone(),
        };
        (channel.name.to_string(), bits)
    };
    channels.map(of).collect()
}

#[test]
fn openexr_keeps_samples_windows_attributes_and_compression() {
    for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(16, 24))] {
        for compression in [
            Compression::Uncompressed,
            Compression::RLE,
            Compression::ZIP1,
            Compression::ZIP16,
            Compression::PIZ,
        ] {
            let original = exr_image(blocks, compression);
            let bytes = exr_bytes(&original);
            let file = read(&bytes).unwrap();
            assert_eq!(file.layers().len(), 2);
            assert_eq!(file.layers()[1].name(), Some("behind"));
            assert_eq!(file.layers()[0].window(), Window::new(-9, 4, 70, 53).ok());
            assert_eq!(file.display(), Window::new(-5, 3, 90, 70).unwrap());
            let (out, lost) = again(&file, ImageFormat::OpenExr);
            assert!(lost.is_empty(), "{lost:?}");
            let back = exr_again(&out);
            assert!(bits(&back) == bits(&original), "{blocks:?} {compression:?}");
            assert_eq!(back.attributes, original.attributes);
            for (a, b) in back.layer_data.iter().zip(&original.layer_data) {
                assert_eq!(a.attributes, b.attributes);
                assert_eq!(a.encoding.compression, compression);
                assert_eq!(a.encoding.blocks, blocks);
            }
        }
    }
}

#[test]
fn a_data_window_may_change_and_channels_may_not() {
    let bytes = exr_bytes(&exr_image(Blocks::ScanLines, Compression::ZIP16));
    let mut file = read(&bytes).unwrap();
    let larger = Window::new(-20, -10, 33, 44).unwrap();
    file.layers_mut()[0].raster = Raster::new(larger, 3).ok();
    file.layers_mut()[0].identifiers = Raster::new(larger, 2).ok();
    let (out, _) = again(&file, ImageFormat::OpenExr);
    let back = read(&out).unwrap();
    assert_eq!(back.layers()[0].window(), Some(larger));
    assert_eq!(back.display(), file.display());
    file.layers_mut()[0].raster = Raster::new(larger, 4).ok();
    let error = file.encode(ImageFormat::OpenExr, &EncodeOptions::default());
    assert!(matches!(
        error,
        Err(ImageError::Mismatch {
            found: 4,
            needed: 3
        })
    ));
}

#[test]
fn conversions_name_what_gets_lost() {
    let bytes = exr_bytes(&exr_image(Blocks::ScanLines, Compression::ZIP16));
    let file = read(&bytes).unwrap();
    let (out, lost) = again(&file, ImageFormat::Png);
    let lost = lost.join("; ");
    for part in [
        "other channels",
        "other layer",
        "display window",
        "not numbers",
        "16 bits",
    ] {
        assert!(lost.contains(part), "{part}: {lost}");
    }
    let png = image::load_from_memory(&out).unwrap();
    assert_eq!((png.width(), png.height()), (90, 70));

    // Codes to light and back: halves tell all codes of 8 bits apart.
    let picture = buffer!(image::Rgb<u8>, 3, u8);
    let file = read(&bytes_of(&picture, image::ImageFormat::Png)).unwrap();
    let (exr, lost) = again(&file, ImageFormat::OpenExr);
    assert!(lost.is_empty(), "{lost:?}");
    let (tiff, _) = again(&read(&exr).unwrap(), ImageFormat::WebP);
    assert_eq!(image::load_from_memory(&tiff).unwrap(), picture);

    let depth = Raster::new(Window::new(0, 0, 3, 2).unwrap(), 1).unwrap();
    let data = ImageFile::data(&depth, &["Z"]).unwrap();
    let error = data.encode(ImageFormat::Png, &EncodeOptions::default());
    assert!(matches!(error, Err(ImageError::NoColour { .. })));
}

#[test]
fn data_files_hold_their_channels_by_name() {
    let window = Window::new(0, 0, 2, 1).unwrap();
    let raster = Raster::from_samples(window, 2, vec![1.0, 2.0, f32::MIN_POSITIVE, -3.5]).unwrap();
    let file = ImageFile::data(&raster, &["forward.v", "forward.u"]).unwrap();
    let (bytes, _) = again(&file, ImageFormat::OpenExr);
    let back = exr_again(&bytes);
    let names: Vec<String> = bits(&back).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["forward.u", "forward.v"]);
    let u = &bits(&back)[0].1;
    assert_eq!(u[..], [2.0_f32.to_bits(), (-3.5_f32).to_bits()]);
}

#[test]
fn files_that_claim_more_than_they_hold_are_refused() {
    // 144 million pixels of zeros: within what deflate can do, beyond what a picture of this size has.
    let bomb = DynamicImage::new_luma8(12_000, 12_000);
    let mut bytes = bytes_of(&bomb, image::ImageFormat::Png);
    assert!(bytes.len() < 1_000_000);
    assert!(matches!(read(&bytes), Err(ImageError::TooLarge { .. })));
    // And the header is enough to tell.
    bytes.truncate(60);
    assert!(matches!(read(&bytes), Err(ImageError::TooLarge { .. })));
    let huge = exr_image(Blocks::ScanLines, Compression::ZIP16);
    let small = ImageFile::read(&exr_bytes(&huge), ImageLimits { samples: 1000 });
    assert!(matches!(small, Err(ImageError::TooLarge { .. })));
}

#[test]
fn damaged_files_are_errors() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/fixtures/damaged");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "exr" || e == "png") {
            let error = read(&std::fs::read(&path).unwrap())
                .unwrap_err()
                .to_string();
            assert!(error.contains(';'), "{path:?}: {error}");
            seen += 1;
        }
    }
    assert!(seen >= 13, "{seen}");
    assert!(matches!(read(b""), Err(ImageError::UnknownFormat)));
    assert!(matches!(read(b"v 0 0 0\n"), Err(ImageError::UnknownFormat)));
}

#[test]
fn cut_and_scrambled_files_never_panic() {
    let small = DynamicImage::from(ImageBuffer::from_fn(23, 17, |x, y| {
        image::Rgb([(x * 9) as u8, (y * 13) as u8, (x * y) as u8])
    }));
    let mut files: Vec<Vec<u8>> = [
        image::ImageFormat::Png,
        image::ImageFormat::Jpeg,
        image::ImageFormat::Tiff,
        image::ImageFormat::WebP,
    ]
    .into_iter()
    .map(|format| bytes_of(&small, format))
    .collect();
    files.push(exr_bytes(&exr_image(Blocks::ScanLines, Compression::PIZ)));
    files.push(exr_bytes(&exr_image(
        Blocks::Tiles(Vec2(16, 16)),
        Compression::ZIP16,
    )));
    for file in files {
        let step = file.len().div_ceil(60);
        for cut in (0..file.len()).step_by(step) {
            let _ = read(&file[..cut]);
            // Headers are where numbers are; so many of the places are there.
            for place in [cut, cut / 16] {
                for value in [0x00, 0x7f, 0xff] {
                    let mut scrambled = file.clone();
                    scrambled[place] = value;
                    if let Ok(file) = read(&scrambled) {
                        let _ = file.encode(file.format(), &EncodeOptions::default());
                    }
                }
            }
        }
        assert!(read(&file).is_ok());
    }
}
