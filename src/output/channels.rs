//! Colour channels of files.

/// The colour channels of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channels {
    /// Red, green and blue, with the background.
    Rgb,
    /// Red, green, blue and alpha, without the background. Colours are premultiplied in OpenEXR and not in PNG, as these formats require.
    Rgba,
}
