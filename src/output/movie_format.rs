//! Movie formats, by the extension of the file name.

use std::path::Path;

use super::LoopFormat;

/// The format of a movie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MovieFormat {
    /// A looping animation.
    Loop(LoopFormat),
    /// A movie encoded by ffmpeg.
    Ffmpeg(FfmpegFormat),
}

/// The format of a movie that ffmpeg encodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FfmpegFormat {
    /// H.264 in an MP4 file.
    Mp4,
    /// H.264 in a `QuickTime` file.
    Mov,
    /// H.264 in a Matroska file.
    Mkv,
    /// VP9 in a `WebM` file.
    Webm,
}

/// The error for a file name whose extension is not that of a movie.
#[derive(Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a movie ends in .mp4, .mov, .mkv or .webm, made by ffmpeg, or in .gif or .apng")]
pub struct UnknownMovieFormat;

debug_as_message!(UnknownMovieFormat);

/// H.264 at visually lossless quality. The file plays everywhere, even while it is still loading.
const H264: &[&str] = &["-c:v", "libx264", "-crf", "17", "-movflags", "+faststart"];
const VP9: &[&str] = &["-c:v", "libvpx-vp9", "-crf", "20", "-b:v", "0"];

impl MovieFormat {
    /// Returns the format for the extension of a file name.
    ///
    /// # Errors
    ///
    /// If the extension is not that of a movie. The error lists the valid ones.
    pub fn of(movie: &Path) -> Result<Self, UnknownMovieFormat> {
        let ending = movie.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        match ending.to_ascii_lowercase().as_str() {
            "gif" => Ok(Self::Loop(LoopFormat::Gif)),
            "apng" => Ok(Self::Loop(LoopFormat::Apng)),
            "mp4" => Ok(Self::Ffmpeg(FfmpegFormat::Mp4)),
            "mov" => Ok(Self::Ffmpeg(FfmpegFormat::Mov)),
            "mkv" => Ok(Self::Ffmpeg(FfmpegFormat::Mkv)),
            "webm" => Ok(Self::Ffmpeg(FfmpegFormat::Webm)),
            _ => Err(UnknownMovieFormat),
        }
    }

    /// Returns the size of a movie of frames of this size: the pixel format of ffmpeg's movies requires even sides, so that the last column
    /// or row is repeated.
    #[must_use]
    pub fn size(self, (width, height): (u32, u32)) -> (u32, u32) {
        match self {
            Self::Loop(_) => (width, height),
            Self::Ffmpeg(_) => even((width, height)),
        }
    }
}

/// Rounds both sides up to even numbers.
pub(super) fn even((width, height): (u32, u32)) -> (u32, u32) {
    (width.next_multiple_of(2), height.next_multiple_of(2))
}

impl FfmpegFormat {
    /// Returns ffmpeg's name of the container.
    pub(super) fn container(self) -> &'static str {
        match self {
            Self::Mp4 => "mp4",
            Self::Mov => "mov",
            Self::Mkv => "matroska",
            Self::Webm => "webm",
        }
    }

    /// Returns ffmpeg's arguments for the codec.
    pub(super) fn codec(self) -> &'static [&'static str] {
        match self {
            Self::Mp4 | Self::Mov | Self::Mkv => H264,
            Self::Webm => VP9,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_extensions_select_the_movie_encoder() {
        assert_eq!(MovieFormat::of(Path::new("a.GIF")), Ok(MovieFormat::Loop(LoopFormat::Gif)));
        assert_eq!(MovieFormat::of(Path::new("a.b.webm")), Ok(MovieFormat::Ffmpeg(FfmpegFormat::Webm)));
        assert_eq!([FfmpegFormat::Webm, FfmpegFormat::Mkv].map(FfmpegFormat::codec), [VP9, H264]);
        assert_eq!(MovieFormat::of(Path::new("mp4")), Err(UnknownMovieFormat));
    }
}
