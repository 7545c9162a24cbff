//! A picture as it is in a file.

use crate::color::Rgb;

/// A picture as it is in a file.
pub(super) struct Picture {
    /// Columns and rows.
    pub(super) size: (u32, u32),
    /// The bytes of its pixels, in the order of its format.
    pub(super) bytes: Vec<u8>,
    /// What stands where the provenance should.
    pub(super) provenance: Option<String>,
}

/// Channels of a file, before they are made output values.
pub(super) struct FileChannels {
    pub(super) size: (u32, u32),
    pub(super) colors: FileColors,
    pub(super) alpha: Option<Vec<f32>>,
}

/// Colours as files have them.
pub(super) enum FileColors {
    /// Output values from 0 to 255, not premultiplied.
    Encoded(Vec<[f64; 3]>),
    /// Linear light, premultiplied.
    Light(Vec<Rgb>),
}
