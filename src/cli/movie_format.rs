//! Movie formats, by the extension of the file name.

use std::path::Path;

use rayreel::output::LoopFormat;

/// Encoder and container of a movie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MovieFormat {
    Loop(LoopFormat),
    Ffmpeg {
        /// Container format, as named by ffmpeg.
        container: &'static str,
        /// Arguments for the codec.
        codec: &'static [&'static str],
    },
}

/// H.264 at visually lossless quality. The file plays everywhere, even while it is still loading.
pub(super) const H264: &[&str] = &["-c:v", "libx264", "-crf", "17", "-movflags", "+faststart"];
const VP9: &[&str] = &["-c:v", "libvpx-vp9", "-crf", "20", "-b:v", "0"];

impl MovieFormat {
    /// Returns the encoder for the extension of a file name, or a message that lists the valid ones.
    pub(super) fn of(movie: &Path) -> Result<Self, String> {
        let ending = movie.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        match ending.to_ascii_lowercase().as_str() {
            "gif" => Ok(Self::Loop(LoopFormat::Gif)),
            "apng" => Ok(Self::Loop(LoopFormat::Apng)),
            "mp4" => Ok(Self::Ffmpeg { container: "mp4", codec: H264 }),
            "mov" => Ok(Self::Ffmpeg { container: "mov", codec: H264 }),
            "mkv" => Ok(Self::Ffmpeg { container: "matroska", codec: H264 }),
            "webm" => Ok(Self::Ffmpeg { container: "webm", codec: VP9 }),
            _ => {
                Err("a movie ends in .mp4, .mov, .mkv or .webm, made by ffmpeg, or in .gif or .apng"
                    .to_owned())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_extensions_select_the_movie_encoder() {
        assert_eq!(MovieFormat::of(Path::new("a.GIF")), Ok(MovieFormat::Loop(LoopFormat::Gif)));
        assert_eq!(
            MovieFormat::of(Path::new("a.b.webm")),
            Ok(MovieFormat::Ffmpeg { container: "webm", codec: VP9 })
        );
        assert!(MovieFormat::of(Path::new("mp4")).is_err());
    }
}
