//! PFM files: linear light in 32 bits per channel, uncompressed.

use std::io::BufRead;

use super::picture::{FileChannels, FileColors, StoredPicture};
use super::portable_map::Words;
use super::provenance::Provenance;
use crate::color::Rgb;
use crate::trace::Film;

/// File type with three channels.
const COLOR: &str = "PF";
/// Scale field of files with unscaled values in little-endian order.
const LITTLE_ENDIAN: &str = "-1.0";

/// Returns the header, which precedes the pixels.
pub(super) fn header((width, height): (u32, u32)) -> String {
    format!("{COLOR}\n{width} {height}\n{LITTLE_ENDIAN}\n")
}

/// Returns the bytes of the pixels, lowest row first.
pub(super) fn pixels(film: &Film) -> Vec<u8> {
    let rows = film.pixels().chunks(film.width().max(1) as usize).rev();
    rows.flatten().flat_map(Rgb::to_array).flat_map(f32::to_le_bytes).collect()
}

/// Returns the provenance, which follows the pixels where readers ignore it, since the format has no comments.
pub(super) fn trailer(provenance: Option<&Provenance>) -> String {
    provenance.map(|provenance| format!("{} {provenance}\n", Provenance::KEYWORD)).unwrap_or_default()
}

/// Parses the header and returns the width and height.
fn read_size(file: &mut impl BufRead) -> Result<(u32, u32), String> {
    let mut words = Words::default();
    if words.next(file)? != COLOR {
        return Err("it is not a portable float map with three channels".to_owned());
    }
    let size = (words.side(file)?, words.side(file)?);
    // Programs write the scale with different numbers of digits.
    let scale = words.next(file)?.parse::<f64>();
    if scale != Ok(-1.0) {
        return Err("its numbers are not written as they are, the least significant byte first".to_owned());
    }
    Ok(size)
}

/// Returns the width and height from the beginning of a file.
pub(super) fn size(file: &mut impl BufRead) -> Option<(u32, u32)> {
    read_size(file).ok()
}

/// Decodes a file completely. Returns the reason if the file is not valid.
pub(super) fn decode(mut bytes: &[u8]) -> Result<StoredPicture, String> {
    let size = read_size(&mut bytes)?;
    let count = u128::from(size.0) * u128::from(size.1) * 12;
    let is_all = usize::try_from(count).ok().filter(|count| *count <= bytes.len());
    let count = is_all.ok_or_else(|| format!("it has {} bytes of pixels instead of {count}", bytes.len()))?;
    let (pixels, trailer) = bytes.split_at(count);
    let own = |text: &str| {
        let text = text.strip_prefix(Provenance::KEYWORD)?.strip_prefix(' ')?.strip_suffix('\n')?;
        Some(text.to_owned())
    };
    let provenance = std::str::from_utf8(trailer).ok().and_then(own);
    if provenance.is_none() && !trailer.is_empty() {
        return Err("there is more after its end".to_owned());
    }
    Ok(StoredPicture { size, bytes: pixels.to_vec(), provenance })
}

/// Reads the colours of a file.
pub(super) fn channels(bytes: &[u8]) -> Result<FileChannels, String> {
    let StoredPicture { size, bytes, .. } = decode(bytes)?;
    let (numbers, _) = bytes.as_chunks::<4>();
    let (pixels, _) = numbers.as_chunks::<3>();
    let rows = pixels.chunks(size.0.max(1) as usize).rev();
    let light = rows.flatten().map(|pixel| Rgb::from_array(pixel.map(f32::from_le_bytes))).collect();
    Ok(FileChannels { size, colors: FileColors::Light(light), alpha: None })
}
