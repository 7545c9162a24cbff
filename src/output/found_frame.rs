//! What is found where a frame's file should be. Every byte of it is looked at.

use std::fs::{self, File};
use std::io::{self, BufReader, Cursor, ErrorKind};
use std::path::Path;

use super::picture::Picture;
use super::provenance::{PixelFingerprint, Provenance};
use super::{FrameFormat, png_file, ppm_file};
use crate::trace::EncodedFilm;

/// What is found where a frame's file should be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FoundFrame {
    /// There is no file.
    Missing,
    /// It cannot be read to its end, is not of its format, or its pixels are not those that were written; and why.
    Torn(String),
    /// A whole picture of which it is not known what it was rendered from: another program's, or an earlier version's.
    Unknown {
        /// Columns and rows.
        size: (u32, u32),
    },
    /// A whole frame.
    Whole {
        /// What it tells of itself.
        provenance: Provenance,
        /// Columns and rows.
        size: (u32, u32),
    },
}

impl FoundFrame {
    /// Looks at a file.
    #[must_use]
    pub fn at(path: &Path, format: FrameFormat) -> Self {
        let bytes = match read(path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == ErrorKind::NotFound => return Self::Missing,
            Err(error) => return Self::Torn(error.to_string()),
        };
        Self::of(&bytes, format)
    }

    /// Looks at the bytes of a file.
    #[must_use]
    pub fn of(bytes: &[u8], format: FrameFormat) -> Self {
        let Picture { size, rgb, provenance } = match decode(bytes, format) {
            Ok(picture) => picture,
            Err(reason) => return Self::Torn(reason),
        };
        let Some(Ok(provenance)) = provenance.map(|text| text.parse::<Provenance>()) else {
            return Self::Unknown { size };
        };
        if PixelFingerprint::of(&rgb, size) == provenance.pixels {
            Self::Whole { provenance, size }
        } else {
            Self::Torn("its pixels are not those that were written".to_owned())
        }
    }
}

/// Reads a frame's pixels, whatever it was rendered from.
///
/// # Errors
///
/// If there is no file, or if it is not whole: in words.
pub fn read_frame(path: &Path, format: FrameFormat) -> Result<EncodedFilm, String> {
    let bytes = read(path).map_err(|error| error.to_string())?;
    let Picture { size: (width, height), rgb, .. } = decode(&bytes, format)?;
    EncodedFilm::from_bytes(width, height, &rgb)
        .ok_or_else(|| "its size is not that of its pixels".to_owned())
}

fn decode(bytes: &[u8], format: FrameFormat) -> Result<Picture, String> {
    match format {
        FrameFormat::Png => png_file::decode(&mut Cursor::new(bytes)),
        FrameFormat::Ppm => ppm_file::decode(bytes),
    }
}

/// Returns columns and rows of a frame, from the beginning of its file. `None` if that does not tell.
#[must_use]
pub fn frame_size(path: &Path, format: FrameFormat) -> Option<(u32, u32)> {
    let mut file = BufReader::new(File::open(path).ok()?);
    match format {
        FrameFormat::Png => png_file::size(&mut file),
        FrameFormat::Ppm => ppm_file::size(&mut file),
    }
}

/// Reads a regular file; of others, as pipes, nobody knows whether they end.
fn read(path: &Path) -> io::Result<Vec<u8>> {
    if fs::metadata(path)?.is_file() {
        fs::read(path)
    } else {
        Err(io::Error::other("it is not a regular file"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::{Rgb, Transfer};
    use crate::output::frame_file::encode_pixels;
    use crate::trace::Film;

    const FORMATS: [FrameFormat; 2] = [FrameFormat::Png, FrameFormat::Ppm];

    fn frame(format: FrameFormat, seed: u8) -> Vec<u8> {
        let pixels = (0..35_u8).map(|index| Rgb::splat(f32::from(index.wrapping_mul(seed)) / 255.0));
        let film = Film::from_pixels(7, 5, pixels).encoded(Transfer::Classic);
        let frame = format!("{seed:032x}").parse().unwrap();
        encode_pixels(film.bytes(), (7, 5), format, Some(frame)).unwrap().concat()
    }

    #[test]
    fn whole_frames_are_known() {
        for format in FORMATS {
            let FoundFrame::Whole { provenance, size } = FoundFrame::of(&frame(format, 3), format) else {
                panic!("{format:?} is not whole");
            };
            assert_eq!((size, provenance.frame.to_string()), ((7, 5), format!("{:032x}", 3)));
        }
        for format in FORMATS {
            let film = Film::new(7, 5);
            let bytes = crate::output::encode(&film, Transfer::Srgb, format).unwrap();
            assert_eq!(FoundFrame::of(&bytes, format), FoundFrame::Unknown { size: (7, 5) });
        }
    }

    #[test]
    fn no_torn_frame_is_whole() {
        for format in FORMATS {
            let bytes = frame(format, 3);
            let whole = FoundFrame::of(&bytes, format);
            for end in 0..bytes.len() {
                let cut = FoundFrame::of(&bytes[..end], format);
                assert!(matches!(cut, FoundFrame::Torn(_)), "{format:?} cut at {end}: {cut:?}");
            }
            for place in 0..bytes.len() {
                for bit in 0..8 {
                    let mut flipped = bytes.clone();
                    flipped[place] ^= 1 << bit;
                    let found = FoundFrame::of(&flipped, format);
                    // Another fingerprint is that of another frame.
                    assert_ne!(found, whole, "{format:?} at {place}");
                }
            }
            let longer = [&bytes[..], b"x"].concat();
            assert!(matches!(FoundFrame::of(&longer, format), FoundFrame::Torn(_)));
            let zeros = vec![0; bytes.len()];
            assert!(matches!(FoundFrame::of(&zeros, format), FoundFrame::Torn(_)));
        }
    }

    /// What was written for a frame is not another's, even if the file is whole.
    #[test]
    fn wrong_pixels_under_a_right_fingerprint_are_torn() {
        let (own, other) = (frame(FrameFormat::Ppm, 3), frame(FrameFormat::Ppm, 5));
        let start = own.len() - 105;
        let mixed = [&own[..start], &other[start..]].concat();
        assert!(matches!(FoundFrame::of(&mixed, FrameFormat::Ppm), FoundFrame::Torn(_)));
    }

    #[test]
    fn what_is_no_file_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| FoundFrame::at(&folder.path().join(name), FrameFormat::Png);
        assert_eq!(at("none.png"), FoundFrame::Missing);
        fs::create_dir(folder.path().join("folder.png")).unwrap();
        assert_eq!(at("folder.png"), FoundFrame::Torn("it is not a regular file".to_owned()));
    }
}
