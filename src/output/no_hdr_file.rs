//! Radiance HDR files in builds without the feature `image`: they are neither written nor read.

use std::error::Error;
use std::io::BufRead;

use super::picture::{FileChannels, StoredPicture};
use super::provenance::Provenance;
use crate::trace::Film;

pub(super) const SIGNATURE: &[u8] = b"";

const REJECTION: &str =
    "this build of rayreel has no Radiance HDR files: build it with its Cargo feature `image`";

pub(super) fn body(_film: &Film) -> Result<Vec<u8>, Box<dyn Error + Send + Sync>> {
    Err(REJECTION.into())
}

pub(super) fn comment(_provenance: Option<&Provenance>) -> String {
    String::new()
}

pub(super) fn size(_file: impl BufRead) -> Option<(u32, u32)> {
    None
}

pub(super) fn decode(_bytes: &[u8]) -> Result<StoredPicture, String> {
    Err(REJECTION.to_owned())
}

pub(super) fn channels(_bytes: &[u8]) -> Result<FileChannels, String> {
    Err(REJECTION.to_owned())
}

#[cfg(test)]
mod tests {
    use crate::color::Transfer;
    use crate::output::{FrameFormat, encode};
    use crate::trace::Film;

    #[test]
    fn builds_without_hdr_name_the_feature() {
        let error = encode(&Film::new(2, 1), Transfer::Srgb, FrameFormat::Hdr).unwrap_err();
        assert!(error.to_string().contains("Cargo feature `image`"), "{error}");
    }
}
