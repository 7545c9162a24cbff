//! OpenEXR files: linear light in 32 bits per channel, and passes, with lossless compression.
//!
//! An attribute of every file holds the digest of all its bytes, with zeros in place of the digest itself. The format's own checks cover
//! only part of the bytes, and decoders are not safe from corrupt files, so the digest is verified before decoding.

use std::io::{BufRead, Cursor};

use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer};
use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Chromaticities, Text};
use exr::meta::header::LayerAttributes;
use exr::prelude::{Compression, LineOrder, ReadChannels, ReadLayers, Vec2, WritableImage, read};
use rayon::iter::ParallelIterator;

use super::channels::Channels;
use super::frame_pixels::LinearFrame;
use super::picture::{FileChannels, FileColors, StoredPicture};
use super::provenance::{PixelFingerprint, Provenance};
use crate::color::Rgb;
use crate::trace::{Film, FrameFingerprint, Pass, PassPixel, Passes};

/// Name of the attribute that holds the digest of the file.
const DIGEST: &str = "rayreelDigest";
/// Comment in files whose channel `Z` is the distance along the view axis. Earlier versions wrote distances along rays into `Z`, without
/// this comment.
const DEPTH: &str = "Z is the distance along the view axis";
/// Placeholder for the digits of the digest.
const NO_DIGEST: [u8; 32] = [b'0'; 32];

/// Names of the colour channels.
const LIGHT: [&str; 3] = ["R", "G", "B"];
/// Name of the alpha channel.
const ALPHA: &str = "A";

/// Returns the channel names of a pass.
fn names_of(pass: Pass) -> &'static [&'static str] {
    match pass {
        Pass::Depth => &["Z"],
        Pass::Distance => &["distance"],
        Pass::Normal => &["normal.X", "normal.Y", "normal.Z"],
        Pass::Id => &["id"],
        Pass::Albedo => &["albedo.R", "albedo.G", "albedo.B"],
        Pass::Position => &["position.X", "position.Y", "position.Z"],
    }
}

/// Returns the names of all channels in file order.
fn names(channels: Channels, passes: Passes) -> Vec<&'static str> {
    let passes = Pass::ALL.into_iter().filter(|pass| passes.contains(*pass));
    let alpha = (channels == Channels::Rgba).then_some(ALPHA);
    let mut names: Vec<_> =
        LIGHT.into_iter().chain(alpha).chain(passes.flat_map(names_of).copied()).collect();
    names.sort_unstable();
    names
}

/// Returns the names and samples of a pass's channels.
fn samples_of(pass: Pass, pixels: &[PassPixel]) -> impl Iterator<Item = (&'static str, FlatSamples)> {
    names_of(pass).iter().enumerate().map(move |(axis, name)| {
        let samples =
            |value: &dyn Fn(&PassPixel) -> f32| FlatSamples::F32(pixels.iter().map(value).collect());
        let samples = match pass {
            Pass::Depth => samples(&|pixel| pixel.depth),
            Pass::Distance => samples(&|pixel| pixel.distance),
            Pass::Normal => samples(&|pixel| pixel.normal[axis]),
            Pass::Id => FlatSamples::U32(pixels.iter().map(|pixel| pixel.id).collect()),
            Pass::Albedo => samples(&|pixel| pixel.albedo[axis]),
            Pass::Position => samples(&|pixel| pixel.position[axis]),
        };
        (*name, samples)
    })
}

/// Returns the names and samples of a frame's channels in file order.
fn samples(frame: &LinearFrame, channels: Channels, passes: Passes) -> Vec<(&'static str, FlatSamples)> {
    let light = LIGHT.into_iter().enumerate().map(|(channel, name)| {
        (name, FlatSamples::F32(frame.film.pixels().iter().map(|pixel| pixel[channel]).collect()))
    });
    let alpha = (channels == Channels::Rgba).then(|| (ALPHA, FlatSamples::F32(frame.alpha().collect())));
    let passes = Pass::ALL.into_iter().filter(|pass| passes.contains(*pass));
    let passes = passes.flat_map(|pass| samples_of(pass, frame.passes.as_ref().map_or(&[], Film::pixels)));
    let mut samples: Vec<_> = light.chain(alpha).chain(passes).collect();
    samples.sort_by_key(|(name, _)| *name);
    samples
}

/// Encodes a frame as a file. If `fingerprint` is given, the file contains its provenance.
pub(super) fn encode(
    frame: &LinearFrame,
    channels: Channels,
    passes: Passes,
    fingerprint: Option<FrameFingerprint>,
) -> Result<Vec<u8>, String> {
    let (width, height) = (frame.film.width(), frame.film.height());
    let channels = samples(frame, channels, passes);
    let provenance = fingerprint.map(|frame| {
        let samples = channels.iter().map(|(_, samples)| samples);
        Provenance { frame, pixels: PixelFingerprint::of(&bytes_of(samples), (width, height)) }
    });
    let list = channels.into_iter().map(|(name, samples)| AnyChannel::new(name, samples)).collect();
    let encoding = Encoding {
        compression: Compression::ZIP16,
        line_order: LineOrder::Increasing,
        ..Encoding::SMALL_LOSSLESS
    };
    let size = Vec2(width as usize, height as usize);
    let mut attributes =
        LayerAttributes { software_name: Some(Text::from("rayreel")), ..LayerAttributes::default() };
    if passes.contains(Pass::Depth) {
        attributes.comments = Some(Text::from(DEPTH));
    }
    let attribute = |name, text: &str| (Text::from(name), AttributeValue::Text(Text::from(text)));
    // Each of the two maps holds at most one attribute, since the attributes of a map are written in random order.
    attributes.other.extend(provenance.map(|text| attribute(Provenance::KEYWORD, &text.to_string())));
    let layer = Layer::new(size, attributes, encoding, AnyChannels { list });
    let mut image = Image::from_layer(layer);
    image.attributes.other.extend([attribute(DIGEST, &String::from_utf8_lossy(&NO_DIGEST))]);
    // Primaries and white point of sRGB and BT.709, the colour space of scenes.
    image.attributes.chromaticities = Some(Chromaticities {
        red: Vec2(0.64, 0.33),
        green: Vec2(0.3, 0.6),
        blue: Vec2(0.15, 0.06),
        white: Vec2(0.3127, 0.329),
    });
    let mut bytes = Vec::new();
    let written = image.write().non_parallel().to_buffered(Cursor::new(&mut bytes));
    written.map_err(|error| error.to_string())?;
    if let Some(place) = after(&bytes, &DIGEST_BEGINS) {
        let digest = digest(&bytes, place);
        bytes[place..][..digest.len()].copy_from_slice(&digest);
    }
    Ok(bytes)
}

/// Returns the width and height from the beginning of a file.
pub(super) fn size(file: impl BufRead) -> Option<(u32, u32)> {
    let metadata = MetaData::read_from_buffered(file, true).ok()?;
    let size = metadata.headers.first()?.layer_size;
    u32::try_from(size.width()).ok().zip(u32::try_from(size.height()).ok())
}

/// Decodes a file completely. Returns the reason if the file is not valid.
pub(super) fn decode(bytes: &[u8], channels: Channels, passes: Passes) -> Result<StoredPicture, String> {
    let layer = layer(bytes)?;
    let list = &layer.channel_data.list;
    let (found, expected) = (list.iter().map(|channel| channel.name.to_string()), names(channels, passes));
    if !found.eq(expected.iter().copied()) {
        return Err(format!("it does not have the channels {}", expected.join(", ")));
    }
    let attribute = |name| match layer.attributes.other.get(&Text::from(name)) {
        Some(AttributeValue::Text(text)) => Some(text.to_string()),
        _ => None,
    };
    if passes.contains(Pass::Depth) && layer.attributes.comments != Some(Text::from(DEPTH)) {
        return Err("an earlier version wrote it, with distances along rays in its channel Z".to_owned());
    }
    let provenance = attribute(Provenance::KEYWORD);
    Ok(StoredPicture {
        size: layer_size(&layer)?,
        bytes: bytes_of(list.iter().map(|channel| &channel.sample_data)),
        provenance,
    })
}

/// Reads the colours and the alpha of a file.
pub(super) fn channels(bytes: &[u8]) -> Result<FileChannels, String> {
    let layer = layer(bytes)?;
    let (size, list) = (layer_size(&layer)?, layer.channel_data.list);
    let samples = |name: &str| -> Option<Vec<f32>> {
        let channel = list.iter().find(|channel| channel.name == *name)?;
        Some(channel.sample_data.values_as_f32().collect())
    };
    let [red, green, blue] = LIGHT.map(samples);
    let light = red.zip(green).zip(blue);
    let ((red, green), blue) = light.ok_or("it does not have the channels R, G and B")?;
    let light = red.into_iter().zip(green).zip(blue).map(|((red, green), blue)| Rgb::new(red, green, blue));
    Ok(FileChannels { size, colors: FileColors::Light(light.collect()), alpha: samples(ALPHA) })
}

/// Reads the layer of a file that was written by this module.
fn layer(bytes: &[u8]) -> Result<Layer<AnyChannels<FlatSamples>>, String> {
    ensure_unchanged(bytes)?;
    let reader = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let reader = reader.all_attributes().pedantic().non_parallel();
    let image = reader.from_buffered(Cursor::new(bytes)).map_err(|error| error.to_string())?;
    Ok(image.layer_data)
}

/// Returns the width and height of a layer.
fn layer_size(layer: &Layer<AnyChannels<FlatSamples>>) -> Result<(u32, u32), String> {
    let sides = [layer.size.width(), layer.size.height()].map(u32::try_from);
    let [Ok(width), Ok(height)] = sides else { return Err("it is too large".to_owned()) };
    Ok((width, height))
}

/// Verifies that bytes have not changed since this module wrote them.
fn ensure_unchanged(bytes: &[u8]) -> Result<(), String> {
    if !bytes.starts_with(&MAGIC) {
        return Err("it is not an OpenEXR file".to_owned());
    }
    let place = after(bytes, &DIGEST_BEGINS)
        .ok_or("it has no digest of its bytes, so that they cannot be checked: only files that rayreel wrote are read")?;
    let stored = bytes.get(place..place + NO_DIGEST.len()).ok_or("its header ends early")?;
    let is_unchanged = stored == digest(bytes, place);
    is_unchanged.then_some(()).ok_or_else(|| "its bytes are not those that were written".to_owned())
}

/// Magic number of OpenEXR files.
const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// Name, type and length of the digest attribute.
const DIGEST_BEGINS: [&[u8]; 3] = [DIGEST.as_bytes(), b"\0string\0", &[32, 0, 0, 0]];

/// Returns the position after the first occurrence of `these` in `bytes`.
fn after(bytes: &[u8], these: &[&[u8]]) -> Option<usize> {
    let these = these.concat();
    bytes.windows(these.len()).position(|window| window == these).map(|place| place + these.len())
}

/// Returns the bytes of samples, channel by channel, in little-endian order.
fn bytes_of<'a>(channels: impl Iterator<Item = &'a FlatSamples>) -> Vec<u8> {
    let mut bytes = Vec::new();
    for samples in channels {
        match samples {
            FlatSamples::F16(values) => bytes.extend(values.iter().flat_map(|value| value.to_le_bytes())),
            FlatSamples::F32(values) => bytes.extend(values.iter().flat_map(|value| value.to_le_bytes())),
            FlatSamples::U32(values) => bytes.extend(values.iter().flat_map(|value| value.to_le_bytes())),
        }
    }
    bytes
}

/// Returns the hexadecimal digits of the digest of `bytes`. The digest itself, at `place`, counts as zeros.
fn digest(bytes: &[u8], place: usize) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    let (before, after) = (&bytes[..place], &bytes[place + NO_DIGEST.len()..]);
    hasher.update(before).update(&NO_DIGEST).update(after);
    let mut digits = NO_DIGEST;
    digits.copy_from_slice(&hasher.finalize().to_hex().as_bytes()[..NO_DIGEST.len()]);
    digits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Transfer;

    #[test]
    fn depth_channels_of_earlier_versions_are_errors() {
        let film = Film::from_pixels(2, 1, [Rgb::ZERO; 2].into_iter());
        let passes = Some(Film::from_values(2, 1, vec![PassPixel::NOTHING; 2]));
        let frame = LinearFrame { film, alpha: None, transfer: Transfer::Classic, passes };
        let (channels, passes) = (Channels::Rgb, Passes::from_iter([Pass::Depth]));
        let mut bytes = encode(&frame, channels, passes, None).unwrap();
        assert!(decode(&bytes, channels, passes).is_ok());
        let attribute = after(&bytes, &[DEPTH.as_bytes()]).unwrap();
        bytes[attribute - 1] = b'X';
        let place = after(&bytes, &DIGEST_BEGINS).unwrap();
        let digest = digest(&bytes, place);
        bytes[place..][..digest.len()].copy_from_slice(&digest);
        assert!(
            decode(&bytes, channels, passes).err().is_some_and(|error| error.contains("earlier version"))
        );
    }
}
