//! A frame's pixels, as formats want them.

use std::borrow::Cow;

use rayon::prelude::*;

use crate::color::Transfer;
use crate::trace::{EncodedFilm, Film, PassPixel};

/// A frame's pixels, as formats want them.
#[derive(Clone, Debug)]
pub enum FramePixels {
    /// Output bytes: enough for PNG with 8 bits a channel and for PPM.
    Encoded(EncodedFilm),
    /// Linear light, from which every format can be made.
    Linear(LinearFrame),
}

/// A frame in linear light.
#[derive(Clone, Debug)]
pub struct LinearFrame {
    /// The light.
    pub film: Film,
    /// How it becomes output values, in formats that have those.
    pub transfer: Transfer,
    /// What each pixel meets first, row by row from the top, if a format with passes is to be made of it; or else empty.
    pub passes: Vec<PassPixel>,
}

impl FramePixels {
    /// Returns the number of columns and rows.
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

    /// Returns the frame in linear light, if it is known.
    pub(super) fn linear(&self) -> Option<&LinearFrame> {
        match self {
            Self::Encoded(_) => None,
            Self::Linear(frame) => Some(frame),
        }
    }
}

impl LinearFrame {
    /// Returns the output values in 16 bits, the more significant byte first.
    pub(super) fn encoded_16(&self) -> Vec<u8> {
        let values = self.film.pixels().par_iter().map(|pixel| self.transfer.encode_16(*pixel));
        values.flat_map_iter(|pixel| pixel.into_iter().flat_map(u16::to_be_bytes)).collect()
    }
}

impl From<EncodedFilm> for FramePixels {
    fn from(film: EncodedFilm) -> Self {
        Self::Encoded(film)
    }
}
