//! Animated GIF files, with a palette of 256 colours per frame.

use std::error::Error;
use std::io::Write;

use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, DynamicImage, Frame};

use crate::trace::EncodedFilm;

/// The encoder of an endlessly repeated animation.
pub(super) struct GifWriter<W: Write>(GifEncoder<W>);

impl<W: Write> GifWriter<W> {
    pub(super) fn new(out: W) -> Result<Self, Box<dyn Error + Send + Sync>> {
        /// Speed of colour quantization, from 1, the best and slowest, to 30.
        const SPEED: i32 = 10;
        let mut encoder = GifEncoder::new_with_speed(out, SPEED);
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
        let picture = DynamicImage::from(film.to_image()).into_rgba8();
        Ok(self.0.encode_frame(Frame::from_parts(picture, 0, 0, delay))?)
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
