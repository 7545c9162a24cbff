//! Animated GIF files, with a palette of 256 colours per frame.

use std::collections::HashSet;

use std::error::Error;
use std::io::Write;

use color_quant::NeuQuant;
use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, DynamicImage, Frame, RgbaImage};

use crate::trace::EncodedFilm;

/// The encoder of an endlessly repeated animation.
pub(super) struct GifWriter<W: Write>(GifEncoder<W>);

/// Size of a palette.
const COLORS: usize = 256;

impl<W: Write> GifWriter<W> {
    pub(super) fn new(out: W) -> Result<Self, Box<dyn Error + Send + Sync>> {
        let mut encoder = GifEncoder::new(out);
        encoder.set_repeat(Repeat::Infinite)?;
        Ok(Self(encoder))
    }

    /// Adds a frame that lasts for some hundredths of a second.
    pub(super) fn add(
        &mut self,
        film: &EncodedFilm,
        hundredths: u16,
    ) -> Result<(), Box<dyn Error + Send + Sync>> {
        let delay = Delay::from_numer_denom_ms(10 * u32::from(hundredths), 1);
        let mut picture = DynamicImage::from(film.to_image()).into_rgba8();
        reduce_colors(&mut picture);
        Ok(self.0.encode_frame(Frame::from_parts(picture, 0, 0, delay))?)
    }
}

/// Reduces a picture to the colours of a palette, if it has more. An ordered dither (Bayer, 1973) avoids bands in smooth gradients, and,
/// being the same in each frame, does not flicker.
fn reduce_colors(picture: &mut RgbaImage) {
    /// Speed of colour quantization, from 1, the best and slowest, to 30.
    const SPEED: i32 = 10;
    /// Offsets in 8-bit levels. Their range is about the distance of two palette colours in a sky.
    const OFFSETS: [[i8; 4]; 4] = [[-4, 0, -3, 1], [2, -2, 3, -1], [-3, 1, -4, 0], [3, -1, 2, -2]];
    let mut colors = HashSet::new();
    let fits = picture.pixels().all(|pixel| {
        colors.insert(*pixel);
        colors.len() <= COLORS
    });
    if fits {
        return;
    }
    let palette = NeuQuant::new(SPEED, COLORS, picture);
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        let offset = OFFSETS[y as usize % 4][x as usize % 4];
        for channel in &mut pixel.0[..3] {
            *channel = channel.saturating_add_signed(offset);
        }
        palette.map_pixel(&mut pixel.0);
    }
}

#[cfg(test)]
mod tests {
    use image::AnimationDecoder;
    use image::codecs::gif::GifDecoder;

    use super::*;
    use crate::output::{LoopFormat, LoopWriter};
    use crate::time::FrameRate;

    fn film(seed: u8) -> EncodedFilm {
        let bytes: Vec<u8> = (0..36_u8).map(|index| index.wrapping_mul(seed)).collect();
        EncodedFilm::from_bytes(4, 3, &bytes).unwrap()
    }

    /// Writes a GIF of these films and returns its frames.
    fn frames(per_second: u32, seeds: &[u8]) -> Vec<Frame> {
        let (rate, mut bytes) = (FrameRate::new(per_second, 1).unwrap(), Vec::new());
        let count = u32::try_from(seeds.len()).unwrap();
        let mut writer = LoopWriter::new(&mut bytes, LoopFormat::Gif, (4, 3), count, rate).unwrap();
        seeds.iter().for_each(|seed| writer.add(&film(*seed)).unwrap());
        assert!(writer.add(&film(1)).is_err());
        writer.finish().unwrap();
        GifDecoder::new(std::io::Cursor::new(&bytes)).unwrap().into_frames().collect_frames().unwrap()
    }

    #[test]
    fn a_gif_is_as_long_as_it_should_be() {
        let frames = frames(24, &[1, 3, 7]);
        let delays: Vec<u32> = frames.iter().map(|frame| frame.delay().numer_denom_ms().0).collect();
        assert_eq!(delays, [40, 40, 50]);
        // Twelve colours are few enough for all of them to be kept.
        let first = frames[0].buffer().get_pixel(1, 1).0;
        assert_eq!(first[..3], film(1).bytes()[15..18]);
    }

    /// Checks that a gradient of more colours than a palette has is dithered, so that its equal rows differ, and keeps its means.
    #[test]
    fn gradients_are_dithered() {
        let gradient = |x: u32| {
            let share = f64::from(x) / 512.0;
            [60.0 + 128.0 * share, 90.0 + 160.0 * share * share, 250.0 - 190.0 * share]
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 60 to 250")]
        let color =
            |x, _| image::Rgba([gradient(x)[0] as u8, gradient(x)[1] as u8, gradient(x)[2] as u8, 255]);
        let exact = RgbaImage::from_fn(512, 16, color);
        let mut reduced = exact.clone();
        reduce_colors(&mut reduced);
        assert!(reduced.pixels().collect::<HashSet<_>>().len() <= COLORS);
        let rows: HashSet<Vec<u8>> =
            reduced.rows().map(|row| row.flat_map(|pixel| pixel.0).collect()).collect();
        assert_eq!(rows.len(), 4);
        let mean = |picture: &RgbaImage, left: u32, channel: usize| {
            let block = (0..256).map(|index| picture.get_pixel(left + index % 16, index / 16).0[channel]);
            block.map(f64::from).sum::<f64>() / 256.0
        };
        let blocks = (0..512).step_by(16).flat_map(|left| (0..3).map(move |channel| (left, channel)));
        let squares = blocks.map(|(left, channel)| {
            let difference = mean(&reduced, left, channel) - mean(&exact, left, channel);
            difference * difference
        });
        let error = (squares.sum::<f64>() / 96.0).sqrt();
        assert!(error < 1.0, "{error}");
    }

    #[test]
    fn a_gif_at_60_frames_per_second_lasts_as_long_as_its_timeline() {
        let seeds: Vec<u8> = (0..60).collect();
        let frames = frames(60, &seeds);
        let delays: Vec<u32> = frames.iter().map(|frame| frame.delay().numer_denom_ms().0).collect();
        assert_eq!(delays.iter().sum::<u32>(), 1000);
        assert_eq!(delays[..4], [20, 30, 20, 30]);
        let fourth = frames[3].buffer().get_pixel(1, 1).0;
        assert_eq!(fourth[..3], film(4).bytes()[15..18]);
    }
}
