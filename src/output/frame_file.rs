//! Writes one film to one file.

use std::io;
use std::path::{Path, PathBuf};

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::codecs::pnm::{PnmEncoder, PnmSubtype, SampleEncoding};
use image::{ExtendedColorType, ImageEncoder};
use rayon::prelude::*;

use super::whole_file;
use crate::color::Transfer;
use crate::trace::Film;

/// The file format of frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrameFormat {
    /// Lossless and compressed, 8 bits a channel.
    #[default]
    Png,
    /// Portable pixmap, binary (P6): uncompressed, 8 bits a channel.
    Ppm,
}

impl FrameFormat {
    /// Returns the file name extension.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Ppm => "ppm",
        }
    }
}

/// The reason why a frame file could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The file system refused.
    #[error("cannot write `{}`", path.display())]
    File {
        /// The frame file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The encoder refused.
    #[error("cannot encode `{}`", path.display())]
    Encoding {
        /// The frame file.
        path: PathBuf,
        /// The encoder's error.
        source: image::ImageError,
    },
}

/// Returns the bytes of a frame file.
///
/// # Errors
///
/// If the encoder refuses the film's size.
pub fn encode(film: &Film, transfer: Transfer, format: FrameFormat) -> Result<Vec<u8>, image::ImageError> {
    encode_pixels(&transfer.encode_all(film.pixels()), film.width(), film.height(), format)
}

/// Returns a PNG file that takes less time to write and to read, and some more space: for an interactive reader. Runs on the
/// current rayon pool's threads.
///
/// # Errors
///
/// If the encoder refuses the film's size.
pub fn encode_quickly(film: &Film, transfer: Transfer) -> Result<Vec<u8>, image::ImageError> {
    const TOGETHER: usize = 1 << 14;
    let mut pixels = vec![[0; 3]; film.pixels().len()];
    let linear = film.pixels().par_chunks(TOGETHER);
    pixels.par_chunks_mut(TOGETHER).zip(linear).for_each(|(bytes, linear)| {
        bytes.copy_from_slice(&transfer.encode_all(linear));
    });
    png(pixels.as_flattened(), film.width(), film.height(), FilterType::Sub)
}

/// Returns the bytes of a file of these pixels, row by row from the top.
pub(super) fn encode_pixels(
    pixels: &[[u8; 3]],
    width: u32,
    height: u32,
    format: FrameFormat,
) -> Result<Vec<u8>, image::ImageError> {
    let rgb = pixels.as_flattened();
    match format {
        FrameFormat::Png => png(rgb, width, height, FilterType::Adaptive),
        FrameFormat::Ppm => {
            /// More than the header takes.
            const HEADER: usize = 64;
            let mut bytes = Vec::with_capacity(HEADER + rgb.len());
            PnmEncoder::new(&mut bytes)
                .with_subtype(PnmSubtype::Pixmap(SampleEncoding::Binary))
                .write_image(rgb, width, height, ExtendedColorType::Rgb8)?;
            Ok(bytes)
        }
    }
}

fn png(rgb: &[u8], width: u32, height: u32, filter: FilterType) -> Result<Vec<u8>, image::ImageError> {
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, filter).write_image(
        rgb,
        width,
        height,
        ExtendedColorType::Rgb8,
    )?;
    Ok(bytes)
}

/// Writes a frame file: whole, or not at all.
///
/// # Errors
///
/// If the file system or the encoder refuses; nothing is left behind.
pub fn write(path: &Path, film: &Film, transfer: Transfer, format: FrameFormat) -> Result<(), WriteError> {
    write_encoded(path, encode(film, transfer, format))
}

/// Writes as [`write`] does, but if the machine fails, the file may be absent as long as it is not [settled](settle).
pub(super) fn put(
    path: &Path,
    film: &Film,
    transfer: Transfer,
    format: FrameFormat,
) -> Result<(), WriteError> {
    let encoded = encode(film, transfer, format);
    let bytes = encoded.map_err(|source| WriteError::Encoding { path: path.to_owned(), source })?;
    whole_file::put(path, &bytes).map_err(|source| WriteError::File { path: path.to_owned(), source })
}

/// Makes a file that was [put](put), and all before it in its folder, durable even if the machine fails.
pub(super) fn settle(path: &Path) -> Result<(), WriteError> {
    whole_file::settle(path).map_err(|source| WriteError::File { path: path.to_owned(), source })
}

/// Writes the encoder's output: whole, or not at all.
pub(super) fn write_encoded(
    path: &Path,
    encoded: Result<Vec<u8>, image::ImageError>,
) -> Result<(), WriteError> {
    let bytes = encoded.map_err(|source| WriteError::Encoding { path: path.to_owned(), source })?;
    write_bytes(path, &bytes)
}

/// Writes a file of these bytes: whole, or not at all.
///
/// # Errors
///
/// If the file system refuses; nothing is left behind.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    whole_file::write(path, bytes).map_err(|source| WriteError::File { path: path.to_owned(), source })
}

/// Writes a file of these bytes where there is none: whole, or not at all.
///
/// # Errors
///
/// If there is a file already, which stays as it is, or if the file system refuses; nothing is left behind.
pub fn write_new(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    whole_file::write_new(path, bytes).map_err(|source| WriteError::File { path: path.to_owned(), source })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_failed_write_leaves_nothing_behind() {
        let directory = tempfile::tempdir().unwrap();
        let film = Film::new(4, 3);
        // A directory stands where the file should go.
        let path = directory.path().join("frame.png");
        fs::create_dir(&path).unwrap();
        assert!(write(&path, &film, Transfer::Classic, FrameFormat::Png).is_err());
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
        let missing = directory.path().join("no/such/frame.ppm");
        let error = write(&missing, &film, Transfer::Classic, FrameFormat::Ppm).unwrap_err().to_string();
        assert!(error.contains("frame.ppm"), "{error}");
    }

    #[test]
    fn both_formats_hold_the_same_pixels() {
        let film = Film::new(5, 2);
        let png =
            image::load_from_memory(&encode(&film, Transfer::Classic, FrameFormat::Png).unwrap()).unwrap();
        let ppm =
            image::load_from_memory(&encode(&film, Transfer::Classic, FrameFormat::Ppm).unwrap()).unwrap();
        assert_eq!(png.to_rgb8(), ppm.to_rgb8());
        assert!(encode(&film, Transfer::Classic, FrameFormat::Ppm).unwrap().starts_with(b"P6\n"));
    }
}
