//! Films to files.
//!
//! A frame file is whole or absent: it is written under a temporary name beside its place, and renamed when every byte is
//! on the disk.

mod frame_file;
mod sequence;
mod writer;

pub use frame_file::{FrameFormat, WriteError, encode, write};
pub use sequence::Sequence;
pub use writer::{FrameWriter, Written};
