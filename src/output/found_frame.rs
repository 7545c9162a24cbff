//! Inspection of frame files, including every byte of them.

use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Cursor, ErrorKind, Read, Seek};
use std::path::Path;

use png::BitDepth;

use super::picture::StoredPicture;
use super::provenance::{PixelFingerprint, Provenance};
use super::{FrameFormat, exr_file, hdr_file, pfm_file, png_file, ppm_file};
use crate::trace::{EncodedFilm, FrameFingerprint};

/// The state of a frame's file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FoundFrame {
    /// There is no file.
    Missing,
    /// A corrupt file, with the reason: it cannot be read completely, is not of its format, or has other pixels than were written.
    Corrupt(String),
    /// A complete picture without known provenance: from another program, or an earlier version.
    Unknown {
        /// Width and height in pixels.
        size: (u32, u32),
    },
    /// A picture of another size than expected, which was not decoded.
    OtherSize {
        /// Width and height in pixels.
        size: (u32, u32),
    },
    /// A complete frame.
    Complete {
        /// Fingerprint of all that was rendered, as stored in the file.
        fingerprint: FrameFingerprint,
        /// Width and height in pixels.
        size: (u32, u32),
    },
}

impl FoundFrame {
    /// Inspects the file of a frame of the expected `size`. Memory is bounded by this size, regardless of the file's header and length.
    #[must_use]
    pub fn expected_at(path: &Path, format: FrameFormat, size: (u32, u32)) -> Self {
        let bytes = match read(path, most_bytes(size)) {
            Ok(bytes) => bytes,
            Err(error) => return Self::unread(&error),
        };
        match size_of(Cursor::new(&bytes), format) {
            Some(found) if found != size => Self::OtherSize { size: found },
            _ => Self::of(&bytes, format),
        }
    }

    fn unread(error: &io::Error) -> Self {
        match error.kind() {
            ErrorKind::NotFound => Self::Missing,
            _ => Self::Corrupt(error.to_string()),
        }
    }

    /// Inspects the bytes of a file.
    #[must_use]
    pub fn of(bytes: &[u8], format: FrameFormat) -> Self {
        let StoredPicture { size, bytes, provenance } = match decode(bytes, format) {
            Ok(picture) => picture,
            Err(reason) => return Self::Corrupt(reason),
        };
        let Some(Ok(provenance)) = provenance.map(|text| text.parse::<Provenance>()) else {
            return Self::Unknown { size };
        };
        if PixelFingerprint::of(&bytes, size) == provenance.pixels {
            Self::Complete { fingerprint: provenance.frame, size }
        } else {
            Self::Corrupt("its pixels are not those that were written".to_owned())
        }
    }
}

/// Returns the maximum size of the file of a frame in bytes.
fn most_bytes(size: (u32, u32)) -> u64 {
    /// Bytes per pixel with alpha and all passes: 16 channels of 4 bytes.
    const OF_A_PIXEL: u64 = 64;
    /// Upper bound on the bytes of headers and of compression overhead.
    const OF_THE_REST: u64 = 1 << 20;
    u64::from(size.0) * u64::from(size.1) * OF_A_PIXEL + OF_THE_REST
}

/// Returns the bytes of a frame's file. `None` unless it is complete, with this fingerprint and the expected `size`.
#[cfg(feature = "live")]
pub(crate) fn read_complete(
    path: &Path,
    format: FrameFormat,
    size: (u32, u32),
    fingerprint: FrameFingerprint,
) -> Option<Vec<u8>> {
    let bytes = read(path, most_bytes(size)).ok()?;
    let is_complete = size_of(Cursor::new(&bytes), format) == Some(size)
        && FoundFrame::of(&bytes, format) == FoundFrame::Complete { fingerprint, size };
    is_complete.then_some(bytes)
}

/// Decodes a PNG file of red, green and blue in 8 bits; `None` if it is not valid.
#[cfg(feature = "live")]
pub(crate) fn decode_png(png: &[u8]) -> Option<EncodedFilm> {
    let StoredPicture { size: (width, height), bytes, .. } = decode(png, FrameFormat::default()).ok()?;
    EncodedFilm::from_bytes(width, height, &bytes)
}

/// Reads the output bytes of a frame, regardless of its provenance.
///
/// # Errors
///
/// If the file is missing or not valid, or if its format has no such bytes. The error describes the reason.
pub fn read_frame(path: &Path, format: FrameFormat) -> Result<EncodedFilm, String> {
    let bytes = read(path, u64::MAX).map_err(|error| error.to_string())?;
    if format.is_linear() {
        return Err("it does not have 8 bits of red, green and blue in each pixel".to_owned());
    }
    let StoredPicture { size: (width, height), bytes, .. } = decode(&bytes, format)?;
    EncodedFilm::from_bytes(width, height, &bytes)
        .ok_or_else(|| "its size is not that of its pixels".to_owned())
}

fn decode(bytes: &[u8], format: FrameFormat) -> Result<StoredPicture, String> {
    match format {
        FrameFormat::Png(channels) => png_file::decode(&mut Cursor::new(bytes), channels, BitDepth::Eight),
        FrameFormat::Png16(channels) => {
            png_file::decode(&mut Cursor::new(bytes), channels, BitDepth::Sixteen)
        }
        FrameFormat::Ppm => ppm_file::decode(bytes),
        FrameFormat::Pfm => pfm_file::decode(bytes),
        FrameFormat::Exr(channels, passes) => exr_file::decode(bytes, channels, passes),
        FrameFormat::Hdr => hdr_file::decode(bytes),
    }
}

/// Returns the width and height of a frame from the beginning of its file, or `None` if they are not found there.
#[must_use]
pub fn frame_size(path: &Path, format: FrameFormat) -> Option<(u32, u32)> {
    if !fs::metadata(path).ok()?.is_file() {
        return None;
    }
    size_of(BufReader::new(File::open(path).ok()?), format)
}

pub(super) fn size_of(mut file: impl BufRead + Seek, format: FrameFormat) -> Option<(u32, u32)> {
    match format {
        FrameFormat::Png(_) | FrameFormat::Png16(_) => png_file::size(file),
        FrameFormat::Ppm => ppm_file::size(&mut file),
        FrameFormat::Pfm => pfm_file::size(&mut file),
        FrameFormat::Exr(..) => exr_file::size(file),
        FrameFormat::Hdr => hdr_file::size(file),
    }
}

/// Reads a regular file of at most `most` bytes. Other files, such as pipes, may never end.
pub(super) fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let metadata = fs::metadata(path)?;
    if !metadata.is_file() {
        return Err(io::Error::other("it is not a regular file"));
    }
    if metadata.len() > most {
        return Err(io::Error::other("it is longer than a picture of this size can be"));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::{Rgb, Transfer};
    use crate::output::frame_file::encode_frame;
    use crate::output::{Channels, FramePixels, LinearFrame};
    use crate::trace::{Film, Pass, PassPixel};

    fn formats() -> Vec<FrameFormat> {
        let exr = |channels, passes: &[Pass]| FrameFormat::Exr(channels, passes.iter().copied().collect());
        let mut formats = vec![
            FrameFormat::Png(Channels::Rgb),
            FrameFormat::Png(Channels::Rgba),
            FrameFormat::Png16(Channels::Rgb),
            FrameFormat::Png16(Channels::Rgba),
            FrameFormat::Ppm,
            FrameFormat::Pfm,
        ];
        if cfg!(feature = "image") {
            formats.push(FrameFormat::Hdr);
        }
        if cfg!(feature = "exr") {
            formats.extend([
                exr(Channels::Rgb, &[]),
                exr(Channels::Rgba, &[]),
                exr(Channels::Rgb, &Pass::ALL),
                exr(Channels::Rgba, &Pass::ALL),
            ]);
        }
        formats
    }

    fn frame(format: FrameFormat, seed: u8) -> Vec<u8> {
        let pixels = (0..35_u8).map(|index| Rgb::splat(f32::from(index.wrapping_mul(seed)) / 255.0));
        let film = Film::from_pixels(7, 5, pixels);
        let pass = |index: u8| PassPixel {
            depth: f32::from(index),
            distance: f32::from(index) + 0.5,
            normal: [f32::from(index); 3],
            id: index.into(),
            ..PassPixel::NOTHING
        };
        let passes = Some(Film::from_values(7, 5, (0..35_u8).map(pass).collect()));
        let alpha = Some(Film::from_values(7, 5, (0..35_u8).map(|index| f32::from(index) / 34.0).collect()));
        let pixels = FramePixels::Linear(LinearFrame { film, alpha, transfer: Transfer::Classic, passes });
        let frame = format!("{seed:032x}").parse().unwrap();
        encode_frame(&pixels, format, Some(frame)).unwrap().concat()
    }

    #[test]
    fn complete_frames_are_recognized() {
        for format in formats() {
            let FoundFrame::Complete { fingerprint, size } = FoundFrame::of(&frame(format, 3), format) else {
                panic!("{format:?} is not complete: {:?}", FoundFrame::of(&frame(format, 3), format));
            };
            assert_eq!((size, fingerprint.to_string()), ((7, 5), format!("{:032x}", 3)));
        }
        for format in formats().into_iter().filter(|format| format.passes().is_empty()) {
            let film = Film::new(7, 5);
            let bytes = crate::output::encode(&film, Transfer::Srgb, format).unwrap();
            assert_eq!(FoundFrame::of(&bytes, format), FoundFrame::Unknown { size: (7, 5) });
        }
    }

    #[test]
    fn frames_of_another_format_are_corrupt() {
        for (index, format) in formats().into_iter().enumerate() {
            for (other_index, other) in formats().into_iter().enumerate() {
                let found = FoundFrame::of(&frame(format, 3), other);
                assert_eq!(
                    matches!(found, FoundFrame::Corrupt(_)),
                    index != other_index,
                    "{format:?} as {other:?}"
                );
            }
        }
    }

    #[test]
    fn truncated_and_changed_frames_are_not_complete() {
        for format in formats() {
            let bytes = frame(format, 3);
            let complete = FoundFrame::of(&bytes, format);
            for end in 0..bytes.len() {
                let cut = FoundFrame::of(&bytes[..end], format);
                let is_detected = match format {
                    // The provenance comes last in the file.
                    FrameFormat::Pfm => !matches!(cut, FoundFrame::Complete { .. }),
                    _ => matches!(cut, FoundFrame::Corrupt(_)),
                };
                assert!(is_detected, "{format:?} cut at {end}: {cut:?}");
            }
            for place in 0..bytes.len() {
                for bit in 0..8 {
                    let mut flipped = bytes.clone();
                    flipped[place] ^= 1 << bit;
                    let found = FoundFrame::of(&flipped, format);
                    // A changed fingerprint identifies another frame.
                    assert_ne!(found, complete, "{format:?} at {place}");
                }
            }
            let longer = [&bytes[..], b"x"].concat();
            assert!(matches!(FoundFrame::of(&longer, format), FoundFrame::Corrupt(_)), "{format:?}");
            let zeros = vec![0; bytes.len()];
            assert!(matches!(FoundFrame::of(&zeros, format), FoundFrame::Corrupt(_)), "{format:?}");
        }
    }

    /// Checks that the pixels of one frame with the fingerprint of another are corrupt, even if the file is complete.
    #[test]
    fn wrong_pixels_with_a_valid_fingerprint_are_corrupt() {
        let (own, other) = (frame(FrameFormat::Ppm, 3), frame(FrameFormat::Ppm, 5));
        let start = own.len() - 105;
        let mixed = [&own[..start], &other[start..]].concat();
        assert!(matches!(FoundFrame::of(&mixed, FrameFormat::Ppm), FoundFrame::Corrupt(_)));
    }

    #[test]
    fn missing_files_and_folders_are_reported() {
        let folder = tempfile::tempdir().unwrap();
        let at =
            |name: &str| FoundFrame::expected_at(&folder.path().join(name), FrameFormat::default(), (4, 4));
        assert_eq!(at("none.png"), FoundFrame::Missing);
        fs::create_dir(folder.path().join("folder.png")).unwrap();
        assert_eq!(at("folder.png"), FoundFrame::Corrupt("it is not a regular file".to_owned()));
    }
}
