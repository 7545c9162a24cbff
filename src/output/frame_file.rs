//! Writes one film to one file.

use std::borrow::Cow;
use std::io;
use std::path::{Path, PathBuf};

use png::Filter;

use super::provenance::{PixelFingerprint, Provenance};
use super::{png_file, ppm_file, whole_file};
use crate::color::Transfer;
use crate::trace::{Film, FrameFingerprint};

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
        source: png::EncodingError,
    },
}

/// Returns the bytes of a frame file.
///
/// # Errors
///
/// If the encoder refuses the film's size.
pub fn encode(film: &Film, transfer: Transfer, format: FrameFormat) -> Result<Vec<u8>, png::EncodingError> {
    let film = film.encoded(transfer);
    encode_pixels(film.bytes(), (film.width(), film.height()), format, None).map(|parts| parts.concat())
}

/// Returns a PNG file that takes less time to write and to read, and some more space: for an interactive reader. Runs on the
/// current rayon pool's threads.
///
/// # Errors
///
/// If the encoder refuses the film's size.
pub fn encode_quickly(film: &Film, transfer: Transfer) -> Result<Vec<u8>, png::EncodingError> {
    png_file::encode(film.encoded(transfer).bytes(), (film.width(), film.height()), Filter::Sub, None)
}

/// Returns the bytes of a file of these pixels, red, green and blue of one after the other, row by row from the top: in two parts. If
/// it is a frame, the file says which.
pub(super) fn encode_pixels(
    rgb: &[u8],
    size: (u32, u32),
    format: FrameFormat,
    frame: Option<FrameFingerprint>,
) -> Result<[Cow<'_, [u8]>; 2], png::EncodingError> {
    let provenance = frame.map(|frame| Provenance { frame, pixels: PixelFingerprint::of(rgb, size) });
    Ok(match format {
        FrameFormat::Png => {
            [png_file::encode(rgb, size, Filter::Adaptive, provenance.as_ref())?.into(), Cow::default()]
        }
        FrameFormat::Ppm => [ppm_file::header(size, provenance.as_ref()).into_bytes().into(), rgb.into()],
    })
}

/// Writes a frame file: whole, or not at all.
///
/// # Errors
///
/// If the file system or the encoder refuses; nothing is left behind.
pub fn write(path: &Path, film: &Film, transfer: Transfer, format: FrameFormat) -> Result<(), WriteError> {
    let film = film.encoded(transfer);
    write_pixels(path, film.bytes(), (film.width(), film.height()), format)
}

/// Writes a frame file of pixels as [`write`] does.
pub(super) fn write_pixels(
    path: &Path,
    rgb: &[u8],
    size: (u32, u32),
    format: FrameFormat,
) -> Result<(), WriteError> {
    put(path, rgb, size, format, None)?;
    settle(path)
}

/// Writes as [`write_pixels`] does, but if the machine fails, the file may be absent as long as it is not [settled](settle).
pub(super) fn put(
    path: &Path,
    rgb: &[u8],
    size: (u32, u32),
    format: FrameFormat,
    frame: Option<FrameFingerprint>,
) -> Result<(), WriteError> {
    let encoded = encode_pixels(rgb, size, format, frame);
    let parts = encoded.map_err(|source| WriteError::Encoding { path: path.to_owned(), source })?;
    let [first, second] = &parts;
    whole_file::put(path, &[first, second])
        .map_err(|source| WriteError::File { path: path.to_owned(), source })
}

/// Makes a file that was [put](put), and all before it in its folder, durable even if the machine fails.
pub(super) fn settle(path: &Path) -> Result<(), WriteError> {
    whole_file::settle(path).map_err(|source| WriteError::File { path: path.to_owned(), source })
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
