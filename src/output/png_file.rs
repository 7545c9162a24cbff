//! PNG files with 8 or 16 bits per channel.

use std::io::{BufRead, Seek, SeekFrom};

use png::{
    BitDepth, ColorType, Compression, DecodeOptions, Decoder, Encoder, Filter, Reader, ScaledFloat,
    SrgbRenderingIntent, Transformations,
};

use super::channels::Channels;
use super::picture::{FileChannels, FileColors, StoredPicture};
use super::provenance::Provenance;

/// Gamma value of sRGB files, for readers that do not know the chunk `sRGB` (W3C, "Portable Network Graphics", third edition, 2025,
/// section 11.3.2.5).
const GAMMA: u32 = 45_455;

/// Encodes channels as a file; 16-bit samples are in big-endian order. The colours are marked as sRGB: a pixel's bytes are the file's own
/// colours.
pub(super) fn encode(
    bytes_of_channels: &[u8],
    channels: Channels,
    depth: BitDepth,
    (width, height): (u32, u32),
    provenance: Option<&Provenance>,
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(color_type(channels));
    encoder.set_depth(depth);
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(Filter::Adaptive);
    encoder.set_source_gamma(ScaledFloat::from_scaled(GAMMA));
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    if let Some(provenance) = provenance {
        encoder.add_text_chunk(Provenance::KEYWORD.to_owned(), provenance.to_string())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(bytes_of_channels)?;
    writer.finish()?;
    Ok(bytes)
}

fn color_type(channels: Channels) -> ColorType {
    match channels {
        Channels::Rgb => ColorType::Rgb,
        Channels::Rgba => ColorType::Rgba,
    }
}

/// Returns the width and height from the beginning of a file.
pub(super) fn size(file: impl BufRead + Seek) -> Option<(u32, u32)> {
    Decoder::new(file).read_info().ok().map(|reader| reader.info().size())
}

/// Decodes a file completely and verifies all bytes. Returns the reason if the file is not valid.
pub(super) fn decode(
    file: &mut (impl BufRead + Seek),
    channels: Channels,
    depth: BitDepth,
) -> Result<StoredPicture, String> {
    let mut reader = checking(&mut *file).read_info().map_err(describe)?;
    if reader.output_color_type() != (color_type(channels), depth) {
        let names = match channels {
            Channels::Rgb => "red, green and blue",
            Channels::Rgba => "red, green, blue and alpha",
        };
        return Err(format!("it does not have {} bits of {names} in each pixel", depth as u8));
    }
    let bytes = all_bytes(&mut reader)?;
    let info = reader.info();
    let texts = info.uncompressed_latin1_text.iter();
    let mut texts = texts.filter(|chunk| chunk.keyword == Provenance::KEYWORD);
    let provenance = texts.next().map(|chunk| chunk.text.clone());
    let size = info.size();
    drop(reader);
    let place = file.stream_position().map_err(|error| error.to_string())?;
    let end = file.seek(SeekFrom::End(0)).map_err(|error| error.to_string())?;
    if place != end {
        return Err("there is more after its end".to_owned());
    }
    Ok(StoredPicture { size, bytes, provenance })
}

/// Reads a file with any kind of channels.
pub(super) fn channels(file: impl BufRead + Seek) -> Result<FileChannels, String> {
    let mut decoder = checking(file);
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(describe)?;
    let (color, depth) = reader.output_color_type();
    let (size, bytes) = (reader.info().size(), all_bytes(&mut reader)?);
    let samples: Vec<f64> = match depth {
        BitDepth::Sixteen => {
            bytes.as_chunks().0.iter().map(|sample| f64::from(u16::from_be_bytes(*sample)) / 257.0).collect()
        }
        _ => bytes.into_iter().map(f64::from).collect(),
    };
    let pixels = samples.chunks_exact(color.samples());
    let color_of = |pixel: &[f64]| match *pixel {
        [red, green, blue] | [red, green, blue, _] => [red, green, blue],
        [gray, ..] => [gray; 3],
        [] => [0.0; 3],
    };
    let has_alpha = matches!(color, ColorType::GrayscaleAlpha | ColorType::Rgba);
    #[expect(clippy::cast_possible_truncation, reason = "rounding to f32 is the point")]
    let share = |pixel: &[f64]| pixel.last().map_or(1.0, |alpha| (alpha / 255.0) as f32);
    let alpha = has_alpha.then(|| pixels.clone().map(share).collect());
    Ok(FileChannels { size, colors: FileColors::Encoded(pixels.map(color_of).collect()), alpha })
}

/// Returns a decoder that verifies all checksums.
fn checking<R: BufRead + Seek>(file: R) -> Decoder<R> {
    let mut options = DecodeOptions::default();
    options.set_ignore_adler32(false);
    options.set_skip_ancillary_crc_failures(false);
    Decoder::new_with_options(file, options)
}

/// Reads the first picture and the rest of the file.
fn all_bytes(reader: &mut Reader<impl BufRead + Seek>) -> Result<Vec<u8>, String> {
    let mut bytes = vec![0; reader.output_buffer_size().ok_or("it is too large")?];
    reader.next_frame(&mut bytes).map_err(describe)?;
    reader.finish().map_err(describe)?;
    Ok(bytes)
}

#[expect(clippy::needless_pass_by_value, reason = "it maps errors")]
fn describe(error: png::DecodingError) -> String {
    error.to_string()
}
