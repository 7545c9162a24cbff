//! Conversion of films to the `image` crate, for its formats and operations.

use image::RgbImage;

use crate::color::Transfer;
use crate::trace::{EncodedFilm, Film};

impl Film {
    /// Returns the picture with the output bytes of all pixels, for the formats and operations of the `image` crate.
    ///
    /// Frame files are written by [`write`](crate::output::write), which marks their colours as sRGB, and keeps 16 bits per channel or
    /// linear light where the format does.
    ///
    /// ```
    /// use rayreel::color::{Rgb, Transfer};
    /// use rayreel::Film;
    ///
    /// # let folder = tempfile::tempdir()?;
    /// # let file = folder.path().join("black_and_white.png");
    /// let film = Film::from_pixels(2, 1, [Rgb::ZERO, Rgb::ONE].into_iter());
    /// film.to_image(Transfer::Srgb).save(&file)?;
    /// assert_eq!(image::open(&file)?.to_rgb8().into_raw(), [0, 0, 0, 255, 255, 255]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn to_image(&self, transfer: Transfer) -> RgbImage {
        self.encoded(transfer).to_image()
    }
}

impl EncodedFilm {
    /// Returns the picture with these bytes.
    #[must_use]
    pub fn to_image(&self) -> RgbImage {
        RgbImage::from_raw(self.width(), self.height(), self.bytes().to_vec())
            .expect("a film has three bytes per pixel")
    }
}
