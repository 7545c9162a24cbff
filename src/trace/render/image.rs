//! Rendered images: the film of a frame with its other channels.

use super::film::Film;
use super::passes::PassPixel;
use crate::color::Rgb;

/// A rendered image: the pixels of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderedImage<Pixel = Rgb> {
    /// The mean radiance over all samples of each pixel. In an image with alpha, samples that are not covered count as 0: light is
    /// premultiplied, so that over a picture b the composite is `film + (1 - alpha) b`, pixel by pixel, in linear light (Porter and Duff,
    /// "Compositing Digital Images", SIGGRAPH 1984, section 3).
    pub film: Film<Pixel>,
    /// The share of covered samples in each pixel, from 0 to 1, if it was requested. A sample is covered if its camera ray hits a shape, or
    /// passes through fog or an absorbing medium. The background in mirrors and behind glass counts as covered.
    pub alpha: Option<Film<f32>>,
    /// The first hit of the ray through the centre of each pixel, if it was requested. The scene is at the moment or, while the shutter is
    /// open, at the frame's first instant.
    pub passes: Option<Film<PassPixel>>,
    /// The number of samples of each pixel, if it was requested. `None` if all pixels have the same number, that is, without an
    /// [error target](crate::components::Sampling::max_error).
    pub sample_counts: Option<Film<u32>>,
}
