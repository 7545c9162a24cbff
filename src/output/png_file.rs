//! PNG files, 8 or 16 bits a channel.

use std::io::{BufRead, Seek, SeekFrom};

use png::{
    BitDepth, ColorType, Compression, DecodeOptions, Decoder, Encoder, Filter, ScaledFloat,
    SrgbRenderingIntent,
};

use super::channels::Channels;
use super::picture::Picture;
use super::provenance::Provenance;

/// What a file of sRGB says of its gamma, for readers that do not know the chunk `sRGB` (W3C, "Portable Network Graphics", third edition,
/// 2025, section 11.3.2.5).
const GAMMA: u32 = 45_455;

/// Returns the bytes of a file of these channels, in 16 bits the more significant byte first. Its colours are marked as sRGB: a pixel's
/// bytes are the file's own colours.
pub(super) fn encode(
    bytes_of_channels: &[u8],
    (channels, depth): (Channels, BitDepth),
    (width, height): (u32, u32),
    filter: Filter,
    provenance: Option<&Provenance>,
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(color_type(channels));
    encoder.set_depth(depth);
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(filter);
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

/// Returns columns and rows, from the beginning of a file.
pub(super) fn size(file: &mut (impl BufRead + Seek)) -> Option<(u32, u32)> {
    Decoder::new(file).read_header_info().ok().map(png::Info::size)
}

/// Reads a file to its last byte, and checks all of them. Returns why it is not whole, in words.
pub(super) fn decode(
    file: &mut (impl BufRead + Seek),
    (channels, depth): (Channels, BitDepth),
) -> Result<Picture, String> {
    let mut options = DecodeOptions::default();
    options.set_ignore_adler32(false);
    options.set_skip_ancillary_crc_failures(false);
    let in_words = |error: png::DecodingError| error.to_string();
    let mut reader = Decoder::new_with_options(&mut *file, options).read_info().map_err(in_words)?;
    if reader.output_color_type() != (color_type(channels), depth) {
        let names = match channels {
            Channels::Rgb => "red, green and blue",
            Channels::Rgba => "red, green, blue and alpha",
        };
        return Err(format!("it does not have {} bits of {names} in each pixel", depth as u8));
    }
    let mut bytes = vec![0; reader.output_buffer_size().ok_or("it is too large")?];
    reader.next_frame(&mut bytes).map_err(in_words)?;
    reader.finish().map_err(in_words)?;
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
    Ok(Picture { size, bytes, provenance })
}
