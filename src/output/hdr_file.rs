//! Radiance HDR files: linear light in 8 bits per channel with an exponent per pixel, run-length encoded.

use std::error::Error;
use std::io::{BufRead, Cursor};

use image::DynamicImage;
use image::codecs::hdr::{HdrDecoder, HdrEncoder};

use super::picture::{FileChannels, FileColors, StoredPicture};
use super::provenance::Provenance;
use crate::color::Rgb;
use crate::trace::Film;

/// The first line of a file.
pub(super) const SIGNATURE: &[u8] = b"#?RADIANCE\n";

/// Returns the bytes of a file after its first line, without comments.
pub(super) fn body(film: &Film) -> Result<Vec<u8>, Box<dyn Error + Send + Sync>> {
    let pixels: Vec<_> = film.pixels().iter().map(|pixel| image::Rgb(rounded(*pixel).to_array())).collect();
    let mut file = Vec::new();
    HdrEncoder::new(&mut file).encode(&pixels, film.width() as usize, film.height() as usize)?;
    Ok(without_comments(&file[SIGNATURE.len()..]).0)
}

/// Returns the comment with the provenance, which follows the first line.
pub(super) fn comment(provenance: Option<&Provenance>) -> String {
    provenance.map(|provenance| format!("# {} {provenance}\n", Provenance::KEYWORD)).unwrap_or_default()
}

/// Rounds light to three integers from 0 to 255 times a power of two, as files store it. The encoder truncates, takes exponents from a
/// logarithm, which may depend on the platform, and wraps exponents that do not fit; rounded numbers are unaffected.
fn rounded(light: Rgb) -> Rgb {
    /// Range of exponents: the highest that files have, and one far below all visible light, where units are still normal numbers.
    const EXPONENTS: (i32, i32) = (-100, 127);
    let (_, exponent) = libm::frexpf(light.max_element());
    let unit = libm::ldexpf(1.0, exponent.clamp(EXPONENTS.0, EXPONENTS.1) - 8);
    (light / unit).round().min(Rgb::splat(255.0)) * unit
}

/// Splits the lines of a header after the first, and all that follows, into comments and the rest.
fn without_comments(mut bytes: &[u8]) -> (Vec<u8>, Vec<&[u8]>) {
    let (mut rest, mut comments) = (Vec::new(), Vec::new());
    while let Some(end) = bytes.iter().position(|byte| *byte == b'\n') {
        let (line, after) = bytes.split_at(end + 1);
        match line {
            // An empty line ends the header.
            b"\n" => break,
            [b'#', comment @ ..] => comments.push(comment),
            _ => rest.extend(line),
        }
        bytes = after;
    }
    rest.extend(bytes);
    (rest, comments)
}

/// Returns the width and height from the beginning of a file.
pub(super) fn size(file: impl BufRead) -> Option<(u32, u32)> {
    let metadata = HdrDecoder::new(file).ok()?.metadata();
    Some((metadata.width, metadata.height))
}

/// Decodes a file completely. Returns the reason if the file is not valid. The stored bytes are all bytes after the first line, except
/// comments.
pub(super) fn decode(bytes: &[u8]) -> Result<StoredPicture, String> {
    let FileChannels { size, .. } = channels(bytes)?;
    let (rest, comments) =
        without_comments(bytes.strip_prefix(SIGNATURE).ok_or("its first line is another")?);
    let own = |comment: &[u8]| {
        let text = std::str::from_utf8(comment).ok()?.strip_prefix(' ')?.strip_suffix('\n')?;
        Some(text.strip_prefix(Provenance::KEYWORD)?.strip_prefix(' ')?.to_owned())
    };
    Ok(StoredPicture { size, bytes: rest, provenance: comments.into_iter().find_map(own) })
}

/// Reads the colours of a file.
pub(super) fn channels(bytes: &[u8]) -> Result<FileChannels, String> {
    let mut file = Cursor::new(bytes);
    let decoded = HdrDecoder::new(&mut file).and_then(DynamicImage::from_decoder);
    let picture = decoded.map_err(|error| error.to_string())?.into_rgb32f();
    if file.position() != bytes.len() as u64 {
        return Err("there is more after its end".to_owned());
    }
    let light = picture.pixels().map(|pixel| Rgb::from_array(pixel.0)).collect();
    Ok(FileChannels { size: picture.dimensions(), colors: FileColors::Light(light), alpha: None })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_of_any_size_is_rounded_to_the_nearest_number() {
        let light = [0.0, 1e-45, 1e-30, 0.1, 0.25, 0.999_999_94, 1.0, 1_023.999_9, 3e9, 1e38, f32::MAX];
        let film = Film::from_pixels(11, 1, light.iter().map(|light| Rgb::new(*light, 0.4 * light, 0.0)));
        let file = [SIGNATURE, &body(&film).unwrap()].concat();
        let FileColors::Light(found) = channels(&file).unwrap().colors else { panic!("it has no light") };
        for (found, light) in found.iter().zip(film.pixels()) {
            let most = Rgb::splat(if light.x < 1e-30 { 1e-30 } else { light.x / 256.0 });
            let is_near = (*found - *light).abs().cmple(most).all();
            assert!(is_near || light.x == f32::MAX && found.x == libm::ldexpf(255.0, 119), "{light} {found}");
        }
    }
}
