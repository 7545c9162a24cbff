//! Pixels of frames in the forms that file formats require.

use std::borrow::Cow;

use rayon::prelude::*;

use super::channels::Channels;
use crate::color::{Rgb, Transfer};
use crate::trace::{EncodedFilm, Film, PassPixel};

/// Pixels of frames in the forms that file formats require.
#[derive(Clone, Debug)]
pub enum FramePixels {
    /// Output bytes, which suffice for PNG with 8 bits per channel and for PPM.
    Encoded(EncodedFilm),
    /// Linear light, which suffices for every format.
    Linear(LinearFrame),
}

/// A frame in linear light.
#[derive(Clone, Debug)]
pub struct LinearFrame {
    /// Linear light; with alpha, it is premultiplied and excludes the background.
    pub film: Film,
    /// Fraction of each pixel that the scene covers; `None` for full coverage.
    pub alpha: Option<Film<f32>>,
    /// Transfer function for formats with output values.
    pub transfer: Transfer,
    /// First hit of each pixel, for formats with passes.
    pub passes: Option<Film<PassPixel>>,
}

impl FramePixels {
    /// Returns the width and height in pixels.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        match self {
            Self::Encoded(film) => (film.width(), film.height()),
            Self::Linear(LinearFrame { film, .. }) => (film.width(), film.height()),
        }
    }

    /// Returns the output bytes.
    pub(super) fn encoded(&self) -> Cow<'_, [u8]> {
        match self {
            Self::Encoded(film) => film.bytes().into(),
            Self::Linear(LinearFrame { film, transfer, .. }) => {
                film.encoded(*transfer).bytes().to_vec().into()
            }
        }
    }

    /// Returns the frame in linear light, if available.
    pub(super) fn linear(&self) -> Option<&LinearFrame> {
        match self {
            Self::Encoded(_) => None,
            Self::Linear(frame) => Some(frame),
        }
    }
}

impl LinearFrame {
    /// Returns the output bytes with alpha, not premultiplied.
    pub(super) fn encoded_with_alpha(&self) -> Vec<u8> {
        let values = self.straight().map(|(color, alpha)| {
            let [red, green, blue] = self.transfer.encode(color);
            let [alpha, ..] = Transfer::Classic.encode(Rgb::splat(alpha));
            [red, green, blue, alpha]
        });
        values.flatten_iter().collect()
    }

    /// Returns the output values as 16-bit big-endian integers. With alpha, they are not premultiplied.
    pub(super) fn encoded_16(&self, channels: Channels) -> Vec<u8> {
        let count = match channels {
            Channels::Rgb => 3,
            Channels::Rgba => 4,
        };
        let values = self.straight().map(|(color, alpha)| {
            let [red, green, blue] = self.transfer.encode_16(color);
            let [alpha, ..] = Transfer::Classic.encode_16(Rgb::splat(alpha));
            [red, green, blue, alpha]
        });
        let bytes = |pixel: [u16; 4]| pixel.into_iter().take(count).flat_map(u16::to_be_bytes);
        values.flat_map_iter(bytes).collect()
    }

    /// Iterates over the alpha of all pixels.
    pub(super) fn alpha(&self) -> impl IndexedParallelIterator<Item = f32> {
        let alpha = self.alpha.as_ref().map(Film::pixels);
        (0..self.film.pixels().len())
            .into_par_iter()
            .map(move |pixel| alpha.map_or(1.0, |alpha| alpha[pixel]))
    }

    /// Iterates over the unpremultiplied colour and the alpha of all pixels.
    fn straight(&self) -> impl IndexedParallelIterator<Item = (Rgb, f32)> {
        let pixels = self.film.pixels().par_iter().zip(self.alpha());
        pixels.map(|(light, alpha)| match alpha {
            0.0 => (Rgb::ZERO, 0.0),
            1.0 => (*light, 1.0),
            _ => ((light.as_dvec3() / f64::from(alpha)).as_vec3(), alpha),
        })
    }
}

impl From<EncodedFilm> for FramePixels {
    fn from(film: EncodedFilm) -> Self {
        Self::Encoded(film)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_formats_store_the_light_of_the_pixel() {
        let light = [Rgb::ZERO, Rgb::new(0.25, 0.125, 0.0), Rgb::new(0.2, 0.4, 1.0), Rgb::splat(0.75)];
        let frame = |alpha| LinearFrame {
            film: Film::from_pixels(4, 1, light.into_iter()),
            alpha,
            transfer: Transfer::Classic,
            passes: None,
        };
        let partly = frame(Some(Film::from_values(4, 1, vec![0.0, 0.5, 1.0, 0.6])));
        let bytes = [0, 0, 0, 0, 128, 64, 0, 128, 51, 102, 255, 255, 255, 255, 255, 153];
        assert_eq!(partly.encoded_with_alpha(), bytes);
        let words = |frame: &LinearFrame, channels| {
            let bytes = frame.encoded_16(channels);
            let (words, _) = bytes.as_chunks::<2>();
            words.iter().map(|word| u16::from_be_bytes(*word)).collect::<Vec<_>>()
        };
        let words_with_alpha = words(&partly, Channels::Rgba);
        assert_eq!(words_with_alpha[..8], [0, 0, 0, 0, 32_768, 16_384, 0, 32_768]);
        assert_eq!(words_with_alpha[8..], [13_107, 26_214, 65_535, 65_535, 65_535, 65_535, 65_535, 39_321]);
        // Without alpha, every pixel is fully covered.
        let opaque = frame(None);
        assert_eq!(opaque.encoded_with_alpha()[4..8], [64, 32, 0, 255]);
        assert_eq!(words(&opaque, Channels::Rgb)[3..6], [16_384, 8192, 0]);
    }
}
