//! Pictures that move by themselves, over and over: animated PNG, which keeps every pixel, and GIF, which every program shows.

use std::io::Write;

use gif::Repeat;
use png::{BitDepth, ColorType, Compression, Filter, SrgbRenderingIntent};

use crate::time::FrameRate;
use crate::trace::EncodedFilm;

/// The format of a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoopFormat {
    /// Lossless.
    Apng,
    /// 256 colours a frame, of its own, and hundredths of a second.
    Gif,
}

/// The reason why a loop could not be encoded.
#[derive(Debug, thiserror::Error)]
pub enum LoopError {
    /// By the encoder of PNG.
    #[error(transparent)]
    Png(#[from] png::EncodingError),
    /// By the encoder of GIF.
    #[error(transparent)]
    Gif(#[from] gif::EncodingError),
    /// A side of the picture is longer than GIF can say.
    #[error("a GIF has at most 65535 columns and rows")]
    TooLarge,
    /// A frame that is not as large as the first, or one too many.
    #[error("it is not as large as the first frame, or one too many")]
    AnotherSize,
}

/// Writes a loop, frame after frame.
pub struct LoopWriter<W: Write> {
    encoder: Encoder<W>,
    size: (u32, u32),
    rate: FrameRate,
    count: u32,
    written: u32,
}

enum Encoder<W: Write> {
    Apng(Box<png::Writer<W>>),
    Gif(gif::Encoder<W>),
}

impl<W: Write> LoopWriter<W> {
    /// Begins a loop of so many frames, of this size.
    ///
    /// # Errors
    ///
    /// If the size is too large for the format, or if the file cannot be written.
    pub fn new(
        out: W,
        format: LoopFormat,
        size @ (width, height): (u32, u32),
        (count, rate): (u32, FrameRate),
    ) -> Result<Self, LoopError> {
        let encoder = match format {
            LoopFormat::Apng => {
                let mut encoder = png::Encoder::new(out, width, height);
                encoder.set_color(ColorType::Rgb);
                encoder.set_depth(BitDepth::Eight);
                encoder.set_compression(Compression::Balanced);
                encoder.set_filter(Filter::Adaptive);
                encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
                encoder.set_animated(count.max(1), 0)?;
                let (numerator, denominator) = delay(rate);
                encoder.set_frame_delay(numerator, denominator)?;
                Encoder::Apng(Box::new(encoder.write_header()?))
            }
            LoopFormat::Gif => {
                let (width, height) = gif_size(size).ok_or(LoopError::TooLarge)?;
                let mut encoder = gif::Encoder::new(out, width, height, &[])?;
                encoder.set_repeat(Repeat::Infinite)?;
                Encoder::Gif(encoder)
            }
        };
        Ok(Self { encoder, size, rate, count, written: 0 })
    }

    /// Adds the next frame.
    ///
    /// # Errors
    ///
    /// If it is not as large as the others or one too many, or if the file cannot be written.
    pub fn add(&mut self, film: &EncodedFilm) -> Result<(), LoopError> {
        if (film.width(), film.height()) != self.size || self.written == self.count {
            return Err(LoopError::AnotherSize);
        }
        match &mut self.encoder {
            Encoder::Apng(writer) => writer.write_image_data(film.bytes())?,
            Encoder::Gif(encoder) => {
                /// From 1, the best and slowest, to 30.
                const SPEED: i32 = 10;
                let (width, height) = gif_size(self.size).ok_or(LoopError::TooLarge)?;
                let mut frame = gif::Frame::from_rgb_speed(width, height, film.bytes(), SPEED);
                frame.delay = hundredths(self.rate, self.written);
                encoder.write_frame(&frame)?;
            }
        }
        self.written += 1;
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    ///
    /// If frames are missing, or if the file cannot be written.
    pub fn finish(self) -> Result<(), LoopError> {
        match self.encoder {
            Encoder::Apng(writer) => writer.finish()?,
            Encoder::Gif(encoder) => drop(encoder.into_inner()?),
        }
        Ok(())
    }
}

fn gif_size((width, height): (u32, u32)) -> Option<(u16, u16)> {
    Some((width.try_into().ok()?, height.try_into().ok()?))
}

/// Returns the time of a frame in seconds, as a ratio of numbers of 16 bits: exactly, where they suffice, and else in thousandths.
fn delay(rate: FrameRate) -> (u16, u16) {
    let (frames, seconds) = rate.parts();
    match (u16::try_from(seconds), u16::try_from(frames)) {
        (Ok(seconds), Ok(frames)) => (seconds, frames),
        _ => {
            let thousandths = (2000 * u64::from(seconds)).div_ceil(2 * u64::from(frames));
            (thousandths.clamp(1, u16::MAX.into()).try_into().unwrap_or(u16::MAX), 1000)
        }
    }
}

/// Returns the time of a frame in hundredths of a second, so that all of them are as long together as they should be.
fn hundredths(rate: FrameRate, index: u32) -> u16 {
    let (frames, seconds) = rate.parts();
    let until = |index: u64| (200 * index * u64::from(seconds) + u64::from(frames)) / (2 * u64::from(frames));
    let index = u64::from(index);
    u16::try_from(until(index + 1) - until(index)).unwrap_or(u16::MAX)
}

#[cfg(test)]
mod tests {
    use image::AnimationDecoder;
    use image::codecs::gif::GifDecoder;
    use image::codecs::png::PngDecoder;

    use super::*;

    fn film(seed: u8) -> EncodedFilm {
        let bytes: Vec<u8> = (0..36_u8).map(|index| index.wrapping_mul(seed)).collect();
        EncodedFilm::from_bytes(4, 3, &bytes).unwrap()
    }

    fn written(format: LoopFormat, rate: FrameRate) -> Vec<u8> {
        let mut out = Vec::new();
        let mut writer = LoopWriter::new(&mut out, format, (4, 3), (3, rate)).unwrap();
        for seed in [1, 3, 7] {
            writer.add(&film(seed)).unwrap();
        }
        assert!(writer.add(&film(1)).is_err());
        writer.finish().unwrap();
        out
    }

    #[test]
    fn an_animated_png_keeps_every_pixel() {
        let bytes = written(LoopFormat::Apng, FrameRate::new(30_000, 1001).unwrap());
        let decoder = PngDecoder::new(std::io::Cursor::new(&bytes)).unwrap().apng().unwrap();
        let frames = decoder.into_frames().collect_frames().unwrap();
        assert_eq!(frames.len(), 3);
        for (frame, seed) in frames.iter().zip([1, 3, 7]) {
            let pixels: Vec<u8> =
                frame.buffer().pixels().flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
            assert_eq!(pixels, film(seed).bytes());
            let (numerator, denominator) = frame.delay().numer_denom_ms();
            assert!((f64::from(numerator) / f64::from(denominator) - 1001.0 / 30.0).abs() < 0.01);
        }
    }

    #[test]
    fn a_gif_is_as_long_as_it_should_be() {
        let bytes = written(LoopFormat::Gif, FrameRate::new(24, 1).unwrap());
        let frames =
            GifDecoder::new(std::io::Cursor::new(&bytes)).unwrap().into_frames().collect_frames().unwrap();
        let delays: Vec<u32> = frames.iter().map(|frame| frame.delay().numer_denom_ms().0).collect();
        assert_eq!(delays, [40, 40, 50]);
        // Twelve colours are few enough for all of them to be kept.
        let first = frames[0].buffer().get_pixel(1, 1).0;
        assert_eq!(first[..3], film(1).bytes()[15..18]);
    }

    #[test]
    fn frames_are_not_shorter_than_can_be_said() {
        assert_eq!(delay(FrameRate::new(24, 1).unwrap()), (1, 24));
        assert_eq!(delay(FrameRate::new(30_000, 1001).unwrap()), (1001, 30_000));
        assert_eq!(delay(FrameRate::new(1_000_000, 41_667).unwrap()), (42, 1000));
        let all: u32 =
            (0..24).map(|index| u32::from(hundredths(FrameRate::new(24, 1).unwrap(), index))).sum();
        assert_eq!(all, 100);
    }
}
