//! Writes films to files: frame files, and sheets of many frames.
//!
//! Files are whole or absent: each is written under a temporary name beside its place, and renamed when every byte is on the
//! disk.

mod frame_file;
mod label;
mod sequence;
mod sheet;
mod whole_file;
mod writer;

pub use frame_file::{FrameFormat, WriteError, encode, encode_quickly, write, write_bytes, write_new};
pub use sequence::Sequence;
pub use sheet::{Sheet, SheetTooLarge};
pub use whole_file::{folder_of, remove_leftovers};
pub use writer::{FrameWriter, WrittenFrame};
