//! Animated GIF files in builds without the feature `image`: they are not written.

use std::error::Error;
use std::io::Write;
use std::marker::PhantomData;

pub(super) use NoGifWriter as GifWriter;

use crate::trace::EncodedFilm;

const REJECTION: &str = "this build of rayreel has no GIF files: build it with its Cargo feature `image`";

/// The encoder that does not exist.
#[allow(dead_code, reason = "it cannot be made")]
pub(super) struct NoGifWriter<W>(PhantomData<W>);

impl<W: Write> NoGifWriter<W> {
    pub(super) fn new(_out: W) -> Result<Self, Box<dyn Error + Send + Sync>> {
        Err(REJECTION.into())
    }

    pub(super) fn add(
        &mut self,
        _film: &EncodedFilm,
        _hundredths: u16,
    ) -> Result<(), Box<dyn Error + Send + Sync>> {
        Err(REJECTION.into())
    }
}

#[cfg(test)]
mod tests {
    use crate::output::{LoopFormat, LoopWriter};
    use crate::time::FrameRate;

    #[test]
    fn builds_without_gif_name_the_feature() {
        let rate = FrameRate::new(24, 1).unwrap();
        let error = LoopWriter::new(Vec::new(), LoopFormat::Gif, (2, 1), 1, rate).err().unwrap();
        assert!(error.to_string().contains("Cargo feature `image`"), "{error}");
    }
}
