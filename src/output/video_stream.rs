//! Streams of uncompressed frames for other programs: `rayreel render SCENE --out - | ffmpeg -i - ...`

use std::io::{self, Write};

use crate::time::FrameRate;
use crate::trace::EncodedFilm;

/// The format of a stream of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VideoFormat {
    /// YUV4MPEG2: a header with the size and rate of frames, followed by the frames. Y'CbCr by ITU-R BT.709, 8 bits, limited range,
    /// without chroma subsampling (4:4:4).
    Y4m,
    /// Red, green and blue of successive pixels, without headers.
    Raw,
}

/// A stream of frames of one size.
#[derive(Debug)]
pub struct VideoStream<W> {
    out: W,
    format: VideoFormat,
    rate: FrameRate,
    /// True if a frame has been written.
    is_begun: bool,
}

impl<W: Write> VideoStream<W> {
    /// Creates a stream that writes to `out`.
    pub fn new(out: W, format: VideoFormat, rate: FrameRate) -> Self {
        Self { out, format, rate, is_begun: false }
    }

    /// Writes a complete frame and flushes the stream.
    ///
    /// # Errors
    ///
    /// If the reader has closed the stream, or writing fails.
    pub fn add(&mut self, film: &EncodedFilm) -> io::Result<()> {
        let is_first = !std::mem::replace(&mut self.is_begun, true);
        match self.format {
            VideoFormat::Raw => self.out.write_all(film.bytes())?,
            VideoFormat::Y4m => {
                if is_first {
                    let ((width, height), (frames, seconds)) =
                        ((film.width(), film.height()), self.rate.parts());
                    writeln!(
                        self.out,
                        "YUV4MPEG2 W{width} H{height} F{frames}:{seconds} Ip A1:1 C444 XCOLORRANGE=LIMITED"
                    )?;
                }
                self.out.write_all(b"FRAME\n")?;
                self.out.write_all(&planes(film))?;
            }
        }
        self.out.flush()
    }
}

/// Returns the Y', Cb and Cr planes of all pixels, one after the other.
fn planes(film: &EncodedFilm) -> Vec<u8> {
    let colors: Vec<[u8; 3]> = film.pixels().iter().map(|pixel| luma_and_chroma(*pixel)).collect();
    (0..3).flat_map(|plane| colors.iter().map(move |color| color[plane])).collect()
}

/// Converts red, green and blue to Y', Cb and Cr: ITU-R BT.709-6, sections 3.2 to 3.4 and, for the levels, 4.2 and 4.6.
fn luma_and_chroma(rgb: [u8; 3]) -> [u8; 3] {
    let [red, green, blue] = rgb.map(|channel| f64::from(channel) / 255.0);
    let luma = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
    let (from_blue, from_red) = ((blue - luma) / 1.8556, (red - luma) / 1.5748);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 16 to 240")]
    let level = |value: f64| (value + 0.5).floor() as u8;
    [level(219.0 * luma + 16.0), level(224.0 * from_blue + 128.0), level(224.0 * from_red + 128.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn video_levels_match_the_recommendation() {
        for (rgb, levels) in [
            ([0, 0, 0], [16, 128, 128]),
            ([255, 255, 255], [235, 128, 128]),
            ([255, 0, 0], [63, 102, 240]),
            ([0, 255, 0], [173, 42, 26]),
            ([0, 0, 255], [32, 240, 118]),
        ] {
            assert_eq!(luma_and_chroma(rgb), levels, "{rgb:?}");
        }
    }

    #[test]
    fn a_stream_has_a_header_and_whole_frames() {
        let film = EncodedFilm::from_bytes(2, 1, &[0, 0, 0, 255, 255, 255]).unwrap();
        let stream = |format| {
            let mut out = Vec::new();
            let mut stream = VideoStream::new(&mut out, format, FrameRate::new(30_000, 1001).unwrap());
            stream.add(&film).unwrap();
            stream.add(&film).unwrap();
            out
        };
        assert_eq!(stream(VideoFormat::Raw), [film.bytes(), film.bytes()].concat());
        let frame = b"FRAME\n\x10\xeb\x80\x80\x80\x80";
        let header = b"YUV4MPEG2 W2 H1 F30000:1001 Ip A1:1 C444 XCOLORRANGE=LIMITED\n";
        assert_eq!(stream(VideoFormat::Y4m), [&header[..], frame, frame].concat());
    }
}
