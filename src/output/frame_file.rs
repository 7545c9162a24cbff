//! Writes one film to one file.

use std::borrow::Cow;
use std::io;
use std::path::{Path, PathBuf};

use png::{BitDepth, Filter};

use super::channels::Channels;
use super::frame_pixels::{FramePixels, LinearFrame};
use super::provenance::{PixelFingerprint, Provenance};
use super::{exr_file, pfm_file, png_file, ppm_file, whole_file};
use crate::color::Transfer;
use crate::trace::{Film, FrameFingerprint, Passes};

/// The file format of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameFormat {
    /// Lossless and compressed, 8 bits a channel.
    Png(Channels),
    /// Lossless and compressed, 16 bits a channel.
    Png16(Channels),
    /// Portable pixmap, binary (P6): uncompressed, 8 bits a channel.
    Ppm,
    /// Portable float map: uncompressed, linear light, 32 bits a channel.
    Pfm,
    /// OpenEXR: compressed without loss, linear light, 32 bits a channel; and such passes.
    Exr(Channels, Passes),
}

/// [PNG](FrameFormat::Png) without alpha.
impl Default for FrameFormat {
    fn default() -> Self {
        Self::Png(Channels::Rgb)
    }
}

impl FrameFormat {
    /// Returns the file name extension.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Png(_) | Self::Png16(_) => "png",
            Self::Ppm => "ppm",
            Self::Pfm => "pfm",
            Self::Exr(..) => "exr",
        }
    }

    /// Returns whether it is made of linear light: output bytes are not enough for it.
    #[must_use]
    pub fn is_linear(self) -> bool {
        !matches!(self, Self::Png(Channels::Rgb) | Self::Ppm)
    }

    /// Returns what it says of each pixel's light.
    #[must_use]
    pub fn channels(self) -> Channels {
        match self {
            Self::Png(channels) | Self::Png16(channels) | Self::Exr(channels, _) => channels,
            Self::Ppm | Self::Pfm => Channels::Rgb,
        }
    }

    /// Returns the passes that it has.
    #[must_use]
    pub fn passes(self) -> Passes {
        match self {
            Self::Exr(_, passes) => passes,
            Self::Png(_) | Self::Png16(_) | Self::Ppm | Self::Pfm => Passes::default(),
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
        source: EncodeError,
    },
}

/// The reason why there are no bytes of a frame file.
#[derive(Debug, thiserror::Error)]
pub enum EncodeError {
    /// The PNG encoder refused, as it does a picture without pixels.
    #[error(transparent)]
    Png(#[from] png::EncodingError),
    /// The OpenEXR encoder refused.
    #[error(transparent)]
    Exr(#[from] exr::error::Error),
    /// The format is made of linear light, and there are only output bytes.
    #[error("its format is made of linear light, of which only rounded bytes are left")]
    NoLight,
}

/// Returns the bytes of a frame file.
///
/// # Errors
///
/// If the encoder refuses the film's size.
pub fn encode(film: &Film, transfer: Transfer, format: FrameFormat) -> Result<Vec<u8>, EncodeError> {
    encode_frame(&pixels_of(film, transfer, format), format, None).map(|parts| parts.concat())
}

/// Returns a film's pixels for a format, without passes. All of each pixel is covered.
fn pixels_of(film: &Film, transfer: Transfer, format: FrameFormat) -> FramePixels {
    if format.is_linear() {
        FramePixels::Linear(LinearFrame { film: film.clone(), alpha: None, transfer, passes: Vec::new() })
    } else {
        FramePixels::Encoded(film.encoded(transfer))
    }
}

/// Returns a PNG file that takes less time to write and to read, and some more space: for an interactive reader. Runs on the
/// current rayon pool's threads.
///
/// # Errors
///
/// If the encoder refuses the film's size.
pub fn encode_quickly(film: &Film, transfer: Transfer) -> Result<Vec<u8>, EncodeError> {
    let (film, size) = (film.encoded(transfer), (film.width(), film.height()));
    let kind = (Channels::Rgb, BitDepth::Eight);
    Ok(png_file::encode(film.bytes(), kind, size, Filter::Sub, None)?)
}

/// Returns the bytes of a file of these pixels, in parts. If it is a frame, the file says which.
pub(super) fn encode_frame(
    pixels: &FramePixels,
    format: FrameFormat,
    frame: Option<FrameFingerprint>,
) -> Result<[Cow<'_, [u8]>; 3], EncodeError> {
    let size = pixels.size();
    let told =
        |bytes: &[u8]| frame.map(|frame| Provenance { frame, pixels: PixelFingerprint::of(bytes, size) });
    let light = || pixels.linear().ok_or(EncodeError::NoLight);
    let png =
        |bytes: &[u8], kind| png_file::encode(bytes, kind, size, Filter::Adaptive, told(bytes).as_ref());
    let whole = |bytes: Vec<u8>| [bytes.into(), Cow::default(), Cow::default()];
    Ok(match format {
        FrameFormat::Png(Channels::Rgb) => whole(png(&pixels.encoded(), (Channels::Rgb, BitDepth::Eight))?),
        FrameFormat::Png(Channels::Rgba) => {
            whole(png(&light()?.encoded_with_alpha(), (Channels::Rgba, BitDepth::Eight))?)
        }
        FrameFormat::Png16(channels) => {
            whole(png(&light()?.encoded_16(channels), (channels, BitDepth::Sixteen))?)
        }
        FrameFormat::Ppm => {
            let bytes = pixels.encoded();
            [ppm_file::header(size, told(&bytes).as_ref()).into_bytes().into(), bytes, Cow::default()]
        }
        FrameFormat::Pfm => {
            let bytes = pfm_file::pixels(&light()?.film);
            let trailer = pfm_file::trailer(told(&bytes).as_ref());
            [pfm_file::header(size).into_bytes().into(), bytes.into(), trailer.into_bytes().into()]
        }
        FrameFormat::Exr(channels, passes) => whole(exr_file::encode(light()?, (channels, passes), frame)?),
    })
}

/// Writes a frame file: whole, or not at all.
///
/// # Errors
///
/// If the file system or the encoder refuses; nothing is left behind.
pub fn write(path: &Path, film: &Film, transfer: Transfer, format: FrameFormat) -> Result<(), WriteError> {
    write_pixels(path, &pixels_of(film, transfer, format), format)
}

/// Writes a frame file of pixels as [`write`] does.
pub(super) fn write_pixels(path: &Path, pixels: &FramePixels, format: FrameFormat) -> Result<(), WriteError> {
    put(path, pixels, format, None)?;
    settle(path)
}

/// Writes as [`write_pixels`] does, but if the machine fails, the file may be absent as long as it is not [settled](settle).
pub(super) fn put(
    path: &Path,
    pixels: &FramePixels,
    format: FrameFormat,
    frame: Option<FrameFingerprint>,
) -> Result<(), WriteError> {
    let encoded = encode_frame(pixels, format, frame);
    let parts = encoded.map_err(|source| WriteError::Encoding { path: path.to_owned(), source })?;
    whole_file::put(path, &parts.each_ref().map(|part| &**part))
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
        assert!(write(&path, &film, Transfer::Classic, FrameFormat::default()).is_err());
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
        let missing = directory.path().join("no/such/frame.ppm");
        let error = write(&missing, &film, Transfer::Classic, FrameFormat::Ppm).unwrap_err().to_string();
        assert!(error.contains("frame.ppm"), "{error}");
    }

    #[test]
    fn both_formats_hold_the_same_pixels() {
        let film = Film::new(5, 2);
        let png = image::load_from_memory(&encode(&film, Transfer::Classic, FrameFormat::default()).unwrap())
            .unwrap();
        let ppm =
            image::load_from_memory(&encode(&film, Transfer::Classic, FrameFormat::Ppm).unwrap()).unwrap();
        assert_eq!(png.to_rgb8(), ppm.to_rgb8());
        assert!(encode(&film, Transfer::Classic, FrameFormat::Ppm).unwrap().starts_with(b"P6\n"));
    }
}
