//! OpenEXR files in builds without the feature `exr`: they are neither written nor read.

use std::io::BufRead;

use super::channels::Channels;
use super::frame_pixels::LinearFrame;
use super::picture::{FileChannels, StoredPicture};
use crate::trace::{FrameFingerprint, Passes};

const REJECTION: &str = "this build of rayreel has no OpenEXR files: build it with its Cargo feature `exr`";

pub(super) fn encode(
    _frame: &LinearFrame,
    _channels: Channels,
    _passes: Passes,
    _fingerprint: Option<FrameFingerprint>,
) -> Result<Vec<u8>, String> {
    Err(REJECTION.to_owned())
}

pub(super) fn size(_file: impl BufRead) -> Option<(u32, u32)> {
    None
}

pub(super) fn decode(_bytes: &[u8], _channels: Channels, _passes: Passes) -> Result<StoredPicture, String> {
    Err(REJECTION.to_owned())
}

pub(super) fn channels(_bytes: &[u8]) -> Result<FileChannels, String> {
    Err(REJECTION.to_owned())
}

#[cfg(test)]
mod tests {
    use crate::color::Transfer;
    use crate::output::{Channels, FrameFormat, encode};
    use crate::trace::{Film, Passes};

    #[test]
    fn builds_without_exr_name_the_feature() {
        let format = FrameFormat::Exr(Channels::Rgb, Passes::default());
        let error = encode(&Film::new(2, 1), Transfer::Srgb, format).unwrap_err();
        assert!(error.to_string().contains("Cargo feature `exr`"), "{error}");
    }
}
