//! The channels of light in a file.

/// What a file says of each pixel's light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channels {
    /// Red, green and blue, with the background.
    Rgb,
    /// Red, green, blue and alpha, without the background. In OpenEXR light is premultiplied, in PNG it is not, as these formats want it.
    Rgba,
}
