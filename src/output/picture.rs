//! A picture as stored in a file.

use crate::color::Rgb;

/// A picture as stored in a file.
pub(super) struct StoredPicture {
    /// Width and height in pixels.
    pub(super) size: (u32, u32),
    /// Pixel bytes in the order of the format.
    pub(super) bytes: Vec<u8>,
    /// Text of the provenance field, if there is one.
    pub(super) provenance: Option<String>,
}

/// The channels of a file before conversion to output values.
pub(super) struct FileChannels {
    pub(super) size: (u32, u32),
    pub(super) colors: FileColors,
    pub(super) alpha: Option<Vec<f32>>,
}

/// Colours as stored in a file.
pub(super) enum FileColors {
    /// Output values from 0 to 255, not premultiplied.
    Encoded(Vec<[f64; 3]>),
    /// Linear light, premultiplied.
    Light(Vec<Rgb>),
}
