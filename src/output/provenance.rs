//! Provenance of frame files: fingerprints of the picture and of its pixels.

use std::fmt;
use std::str::FromStr;

use crate::trace::FrameFingerprint;

/// The provenance stored in a frame file.
///
/// The text form is `1 FRAME PIXELS`, where the first number is the version of the text, and the others are 32 hexadecimal digits each.
/// It is stored under [`KEYWORD`](Provenance::KEYWORD): in PNG as a `tEXt` chunk, in PPM and Radiance HDR as a comment, in OpenEXR as
/// an attribute, and in PFM after the pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Provenance {
    /// Fingerprint of all that was rendered.
    pub frame: FrameFingerprint,
    /// Fingerprint of the resulting pixels.
    pub pixels: PixelFingerprint,
}

/// A fingerprint of a picture's pixel bytes and of its width and height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PixelFingerprint(u128);

impl Provenance {
    /// The keyword under which files store the provenance.
    pub(super) const KEYWORD: &str = "rayreel";
    const VERSION: &str = "1";
}

impl PixelFingerprint {
    /// Returns the fingerprint of the pixel bytes of a picture and of its width and height. The bytes of 8-bit formats are red, green and
    /// blue of each pixel, row by row from the top.
    #[must_use]
    pub(super) fn of(rgb: &[u8], (width, height): (u32, u32)) -> Self {
        let mut hasher = blake3::Hasher::new();
        hasher.update(&width.to_le_bytes());
        hasher.update(&height.to_le_bytes());
        hasher.update(rgb);
        let mut first = [0; 16];
        hasher.finalize_xof().fill(&mut first);
        Self(u128::from_be_bytes(first))
    }
}

impl fmt::Display for Provenance {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} {} {:032x}", Self::VERSION, self.frame, self.pixels.0)
    }
}

/// The error for a string that is not a [`Provenance`] of this version.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("it is not known what this frame was rendered from")]
pub(crate) struct NoProvenance;

impl FromStr for Provenance {
    type Err = NoProvenance;

    fn from_str(text: &str) -> Result<Self, NoProvenance> {
        let parts: Vec<&str> = text.split(' ').collect();
        let [Self::VERSION, frame, pixels] = parts[..] else { return Err(NoProvenance) };
        let frame = frame.parse().map_err(|_| NoProvenance)?;
        // Both fingerprints have the same text form.
        let _: FrameFingerprint = pixels.parse().map_err(|_| NoProvenance)?;
        let pixels = u128::from_str_radix(pixels, 16).map_err(|_| NoProvenance)?;
        Ok(Self { frame, pixels: PixelFingerprint(pixels) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: &str = "00112233445566778899aabbccddeeff";

    #[test]
    fn provenance_texts_round_trip() {
        let provenance = Provenance {
            frame: FRAME.parse().unwrap(),
            pixels: PixelFingerprint::of(&[1, 2, 3, 4, 5, 6], (2, 1)),
        };
        assert_eq!(provenance.to_string().parse(), Ok(provenance));
        for text in ["", "1", &format!("2 {FRAME} {FRAME}"), &format!("1 {FRAME} +{}", &FRAME[1..])] {
            assert_eq!(text.parse::<Provenance>(), Err(NoProvenance), "{text}");
        }
    }

    #[test]
    fn pixel_fingerprint_depends_on_the_width() {
        let pixels = [7; 12];
        assert_ne!(PixelFingerprint::of(&pixels, (4, 1)), PixelFingerprint::of(&pixels, (2, 2)));
        assert_ne!(PixelFingerprint::of(&pixels, (4, 1)), PixelFingerprint::of(&[8; 12], (4, 1)));
    }
}
