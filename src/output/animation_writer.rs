//! Looping animations: animated PNG, which is lossless, and GIF, which every program supports.

use std::error::Error;
use std::io::Write;

use png::{BitDepth, ColorType, Compression, Filter, SrgbRenderingIntent};

use super::gif_writer::GifWriter;
use crate::time::FrameRate;
use crate::trace::EncodedFilm;

/// The format of a looping animation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoopFormat {
    /// Animated PNG, lossless.
    Apng,
    /// GIF, with a palette of 256 colours per frame, and times in [hundredths of a second](gif_delays).
    Gif,
}

/// An error of encoding an animation.
#[derive(thiserror::Error)]
pub enum LoopError {
    /// The PNG encoder reported an error.
    #[error(transparent)]
    Png(#[from] png::EncodingError),
    /// The GIF encoder reported an error, or the library was built without the feature `image`.
    #[error(transparent)]
    Gif(#[from] Box<dyn Error + Send + Sync>),
    /// A side of the picture is longer than GIF permits.
    #[error("a GIF has at most 65535 columns and rows")]
    TooLarge,
    /// A frame differs in size from the first, or exceeds the number of frames.
    #[error("it is not as large as the first frame, or one too many")]
    AnotherSize,
    /// Fewer frames were added than the animation has.
    #[error("it has {added} of {count} frames")]
    Unfinished {
        /// The number of added frames.
        added: u32,
        /// The number of frames of the animation.
        count: u32,
    },
}

debug_as_message!(LoopError);

/// The encoder of an animation, which writes frame by frame.
pub struct LoopWriter<W: Write> {
    encoder: Encoder<W>,
    size: (u32, u32),
    count: u32,
    added: u32,
}

enum Encoder<W: Write> {
    Apng(Box<png::Writer<W>>),
    Gif { encoder: GifWriter<W>, delays: Vec<u16> },
}

impl<W: Write> LoopWriter<W> {
    /// Begins an animation with the given size and number of frames.
    ///
    /// # Errors
    ///
    /// If the size is too large for the format, or if the file cannot be written.
    pub fn new(
        out: W,
        format: LoopFormat,
        size @ (width, height): (u32, u32),
        count: u32,
        rate: FrameRate,
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
                if width.max(height) > u16::MAX.into() {
                    return Err(LoopError::TooLarge);
                }
                Encoder::Gif { encoder: GifWriter::new(out)?, delays: gif_delays(rate, count) }
            }
        };
        Ok(Self { encoder, size, count, added: 0 })
    }

    /// Adds the next frame. [Omitted](gif_delays) frames are not written.
    ///
    /// # Errors
    ///
    /// If the frame differs in size from the others or exceeds the number of frames, or if the file cannot be written.
    pub fn add(&mut self, film: &EncodedFilm) -> Result<(), LoopError> {
        if (film.width(), film.height()) != self.size || self.added == self.count {
            return Err(LoopError::AnotherSize);
        }
        match &mut self.encoder {
            Encoder::Apng(writer) => writer.write_image_data(film.bytes())?,
            Encoder::Gif { delays, .. } if delays[self.added as usize] == 0 => {}
            Encoder::Gif { encoder, delays } => encoder.add(film, delays[self.added as usize])?,
        }
        self.added += 1;
        Ok(())
    }

    /// Finishes the file. An error in writing the last byte of a GIF is not detected here; with a buffered writer, a flush detects it.
    ///
    /// # Errors
    ///
    /// If frames are missing, or if the file cannot be written.
    pub fn finish(self) -> Result<(), LoopError> {
        let Self { encoder, count, added, .. } = self;
        if added < count {
            return Err(LoopError::Unfinished { added, count });
        }
        if let Encoder::Apng(writer) = encoder {
            writer.finish()?;
        }
        Ok(())
    }
}

/// Returns the duration of a frame in seconds as a ratio of 16-bit integers: exactly if they suffice, otherwise in thousandths.
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

/// Returns the duration of each frame of a GIF in hundredths of a second, and 0 for omitted frames. Players show frames shorter than 2
/// hundredths for 10 hundredths.
///
/// The start of every remaining frame and the total duration are exact to the nearest hundredth.
#[must_use]
pub fn gif_delays(rate: FrameRate, count: u32) -> Vec<u16> {
    const SHORTEST: u64 = 2;
    let (frames, seconds) = rate.parts();
    let start = |index: u32| {
        (200 * u64::from(index) * u64::from(seconds) + u64::from(frames)) / (2 * u64::from(frames))
    };
    let end = start(count);
    let mut delays = vec![0; count as usize];
    let (mut shown, mut since) = (0, 0);
    for index in 1..=count {
        let now = start(index);
        if index == count || (now >= since + SHORTEST && now + SHORTEST <= end) {
            delays[shown as usize] = u16::try_from((now - since).max(SHORTEST)).unwrap_or(u16::MAX);
            (shown, since) = (index, now);
        }
    }
    delays
}

#[cfg(test)]
mod tests {
    use image::AnimationDecoder;
    use image::codecs::png::PngDecoder;

    use super::*;

    fn film(seed: u8) -> EncodedFilm {
        let bytes: Vec<u8> = (0..36_u8).map(|index| index.wrapping_mul(seed)).collect();
        EncodedFilm::from_bytes(4, 3, &bytes).unwrap()
    }

    #[test]
    fn animations_without_all_frames_are_errors() {
        let formats = [LoopFormat::Apng, LoopFormat::Gif];
        for format in formats.into_iter().take(if cfg!(feature = "image") { 2 } else { 1 }) {
            let (mut out, rate) = (Vec::new(), FrameRate::new(24, 1).unwrap());
            let mut writer = LoopWriter::new(&mut out, format, (4, 3), 3, rate).unwrap();
            writer.add(&film(1)).unwrap();
            let error = writer.finish().unwrap_err();
            assert_eq!(error.to_string(), "it has 1 of 3 frames", "{format:?}");
        }
    }

    #[test]
    fn an_animated_png_keeps_every_pixel() {
        let (rate, mut bytes) = (FrameRate::new(30_000, 1001).unwrap(), Vec::new());
        let mut writer = LoopWriter::new(&mut bytes, LoopFormat::Apng, (4, 3), 3, rate).unwrap();
        [1, 3, 7].into_iter().for_each(|seed| writer.add(&film(seed)).unwrap());
        assert!(writer.add(&film(1)).is_err());
        writer.finish().unwrap();
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
    fn png_delays_are_rational_and_not_too_short() {
        assert_eq!(delay(FrameRate::new(24, 1).unwrap()), (1, 24));
        assert_eq!(delay(FrameRate::new(30_000, 1001).unwrap()), (1001, 30_000));
        assert_eq!(delay(FrameRate::new(1_000_000, 41_667).unwrap()), (42, 1000));
    }

    #[test]
    fn gif_frames_start_on_time_and_last_at_least_2_hundredths() {
        for per_second in 24..=240 {
            let rate = FrameRate::new(per_second, 1).unwrap();
            let hundredths = |index: u32| (200 * index + per_second) / (2 * per_second);
            for count in [1, 2, 3, 7, per_second - 1, per_second, per_second + 1, 5 * per_second] {
                let delays = gif_delays(rate, count);
                let what = format!("{count} frames at {per_second} a second: {delays:?}");
                let mut now = 0;
                for (index, delay) in (0..).zip(&delays).filter(|(_, delay)| **delay != 0) {
                    assert_eq!(now, hundredths(index), "{what}");
                    // Only as many frames are omitted as necessary. The last shown frame may replace one more.
                    let most = if now + u32::from(*delay) < hundredths(count) { 3 } else { 5 };
                    assert!((2..=most + 100 / per_second).contains(&u32::from(*delay)), "{what}");
                    now += u32::from(*delay);
                }
                assert_eq!(now, hundredths(count).max(2), "{what}");
                let are_all_shown = delays.iter().all(|delay| *delay != 0);
                assert!(are_all_shown || per_second > 50, "{what}");
            }
        }
    }
}
