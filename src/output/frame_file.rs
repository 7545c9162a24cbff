//! Files of single films.

use std::borrow::Cow;
use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};

use png::{BitDepth, ColorType, Compression, Filter};

use super::channels::Channels;
use super::frame_pixels::{FramePixels, LinearFrame};
use super::provenance::{PixelFingerprint, Provenance};
use super::{atomic_file, exr_file, hdr_file, pfm_file, png_file, ppm_file};
use crate::color::Transfer;
use crate::trace::{Film, FrameFingerprint, Passes};

/// The file format of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameFormat {
    /// PNG with lossless compression, 8 bits per channel.
    Png(Channels),
    /// PNG with lossless compression, 16 bits per channel.
    Png16(Channels),
    /// Portable pixmap, binary (P6): uncompressed, 8 bits per channel.
    Ppm,
    /// Portable float map: uncompressed, linear light, 32 bits per channel.
    Pfm,
    /// OpenEXR: lossless compression, linear light, 32 bits per channel, with the given passes.
    Exr(Channels, Passes),
    /// Radiance HDR: run-length encoded linear light, 8 bits per channel with an exponent per pixel.
    Hdr,
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
            Self::Hdr => "hdr",
        }
    }

    /// Returns whether the format requires linear light, so that output bytes do not suffice.
    #[must_use]
    pub fn is_linear(self) -> bool {
        !matches!(self, Self::Png(Channels::Rgb) | Self::Ppm)
    }

    /// Returns the colour channels of the format.
    #[must_use]
    pub fn channels(self) -> Channels {
        match self {
            Self::Png(channels) | Self::Png16(channels) | Self::Exr(channels, _) => channels,
            Self::Ppm | Self::Pfm | Self::Hdr => Channels::Rgb,
        }
    }

    /// Returns the passes of the format.
    #[must_use]
    pub fn passes(self) -> Passes {
        match self {
            Self::Exr(_, passes) => passes,
            Self::Png(_) | Self::Png16(_) | Self::Ppm | Self::Pfm | Self::Hdr => Passes::default(),
        }
    }
}

/// An error of writing a frame file.
#[derive(thiserror::Error)]
pub enum WriteError {
    /// The file system reported an error.
    #[error("cannot write `{}`", path.display())]
    File {
        /// Path of the frame file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The encoder reported an error.
    #[error("cannot encode `{}`", path.display())]
    Encoding {
        /// Path of the frame file.
        path: PathBuf,
        /// The encoder's error.
        source: EncodeError,
    },
}

debug_as_message!(WriteError);

/// An error of encoding a frame file.
#[derive(thiserror::Error)]
pub enum EncodeError {
    /// The PNG encoder reported an error, as for a picture without pixels.
    #[error(transparent)]
    Png(#[from] png::EncodingError),
    /// The OpenEXR encoder reported an error, or the library was built without the feature `exr`.
    #[error("{0}")]
    Exr(String),
    /// The Radiance HDR encoder reported an error, or the library was built without the feature `image`.
    #[error(transparent)]
    Hdr(Box<dyn Error + Send + Sync>),
    /// The format requires linear light, but only output bytes are available.
    #[error("its format is made of linear light, of which only rounded bytes are left")]
    NoLight,
}

debug_as_message!(EncodeError);

/// Encodes a film as a frame file.
///
/// # Errors
///
/// If the encoder rejects the film's size.
pub fn encode(film: &Film, transfer: Transfer, format: FrameFormat) -> Result<Vec<u8>, EncodeError> {
    encode_frame(&pixels_of(film, transfer, format), format, None).map(|parts| parts.concat())
}

/// Returns a film's pixels for a format, without passes and with full coverage.
fn pixels_of(film: &Film, transfer: Transfer, format: FrameFormat) -> FramePixels {
    if format.is_linear() {
        FramePixels::Linear(LinearFrame { film: film.clone(), alpha: None, transfer, passes: None })
    } else {
        FramePixels::Encoded(film.encoded(transfer))
    }
}

/// Encodes a film as a PNG file that is faster to write and read but somewhat larger, for interactive use and reports. It is not marked as
/// sRGB, which browsers assume. Pixels are encoded on the threads of the current rayon pool.
///
/// # Errors
///
/// If the encoder rejects the film's size.
pub fn encode_quickly(film: &Film, transfer: Transfer) -> Result<Vec<u8>, EncodeError> {
    let (film, mut bytes) = (film.encoded(transfer), Vec::new());
    let mut encoder = png::Encoder::new(&mut bytes, film.width(), film.height());
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(Filter::Sub);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(film.bytes())?;
    writer.finish()?;
    Ok(bytes)
}

/// Encodes pixels as a file, in parts. If `frame` is given, the file contains its provenance.
pub(super) fn encode_frame(
    pixels: &FramePixels,
    format: FrameFormat,
    frame: Option<FrameFingerprint>,
) -> Result<[Cow<'_, [u8]>; 3], EncodeError> {
    let size = pixels.size();
    let provenance =
        |bytes: &[u8]| frame.map(|frame| Provenance { frame, pixels: PixelFingerprint::of(bytes, size) });
    let light = || pixels.linear().ok_or(EncodeError::NoLight);
    let png = |bytes: &[u8], channels, depth| {
        png_file::encode(bytes, channels, depth, size, provenance(bytes).as_ref())
    };
    let single = |bytes: Vec<u8>| [bytes.into(), Cow::default(), Cow::default()];
    Ok(match format {
        FrameFormat::Png(Channels::Rgb) => single(png(&pixels.encoded(), Channels::Rgb, BitDepth::Eight)?),
        FrameFormat::Png(Channels::Rgba) => {
            single(png(&light()?.encoded_with_alpha(), Channels::Rgba, BitDepth::Eight)?)
        }
        FrameFormat::Png16(channels) => {
            single(png(&light()?.encoded_16(channels), channels, BitDepth::Sixteen)?)
        }
        FrameFormat::Ppm => {
            let bytes = pixels.encoded();
            [ppm_file::header(size, provenance(&bytes).as_ref()).into_bytes().into(), bytes, Cow::default()]
        }
        FrameFormat::Pfm => {
            let bytes = pfm_file::pixels(&light()?.film);
            let trailer = pfm_file::trailer(provenance(&bytes).as_ref());
            [pfm_file::header(size).into_bytes().into(), bytes.into(), trailer.into_bytes().into()]
        }
        FrameFormat::Hdr => {
            let body = hdr_file::body(&light()?.film).map_err(EncodeError::Hdr)?;
            let comment = hdr_file::comment(provenance(&body).as_ref());
            [hdr_file::SIGNATURE.into(), comment.into_bytes().into(), body.into()]
        }
        FrameFormat::Exr(channels, passes) => {
            single(exr_file::encode(light()?, channels, passes, frame).map_err(EncodeError::Exr)?)
        }
    })
}

/// Writes a frame file completely or not at all.
///
/// # Errors
///
/// If the file system or the encoder reports an error. No partial file remains.
pub fn write(path: &Path, film: &Film, transfer: Transfer, format: FrameFormat) -> Result<(), WriteError> {
    write_pixels(path, &pixels_of(film, transfer, format), format)
}

/// Writes a frame file of pixels like [`write`].
pub(super) fn write_pixels(path: &Path, pixels: &FramePixels, format: FrameFormat) -> Result<(), WriteError> {
    put(path, pixels, format, None)?;
    settle(path)
}

/// Writes the file of a frame with its provenance, completely or not at all.
#[cfg(feature = "live")]
pub(crate) fn write_frame(
    path: &Path,
    film: crate::trace::EncodedFilm,
    format: FrameFormat,
    frame: FrameFingerprint,
) -> Result<(), WriteError> {
    put(path, &FramePixels::Encoded(film), format, Some(frame))?;
    settle(path)
}

/// Writes a file like [`write_pixels`], but a machine failure may lose it until it is [settled](settle).
pub(super) fn put(
    path: &Path,
    pixels: &FramePixels,
    format: FrameFormat,
    frame: Option<FrameFingerprint>,
) -> Result<(), WriteError> {
    let encoded = encode_frame(pixels, format, frame);
    let parts = encoded.map_err(|source| WriteError::Encoding { path: path.to_owned(), source })?;
    atomic_file::put(path, &parts.each_ref().map(|part| &**part))
        .map_err(|source| WriteError::File { path: path.to_owned(), source })
}

/// Makes a file written by [`put`], and all earlier files in its folder, durable against machine failures.
pub(super) fn settle(path: &Path) -> Result<(), WriteError> {
    atomic_file::settle(path).map_err(|source| WriteError::File { path: path.to_owned(), source })
}

/// Writes bytes to a file completely or not at all.
///
/// # Errors
///
/// If the file system reports an error. No partial file remains.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    atomic_file::write(path, bytes).map_err(|source| WriteError::File { path: path.to_owned(), source })
}

/// Writes bytes to a file that must not exist yet, completely or not at all.
///
/// # Errors
///
/// If the file exists, in which case it stays unchanged, or if the file system reports an error. No partial file remains.
pub fn write_new(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    atomic_file::write_new(path, bytes).map_err(|source| WriteError::File { path: path.to_owned(), source })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_failed_write_leaves_nothing_behind() {
        let directory = tempfile::tempdir().unwrap();
        let film = Film::new(4, 3);
        // A directory occupies the path of the file.
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
