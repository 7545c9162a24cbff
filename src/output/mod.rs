//! Writes films to files: frame files, sheets of many frames, loops that play by themselves, and streams of video.
//!
//! Files are whole or absent: each is written under a temporary name beside its place, and renamed when every byte is on the
//! disk. Each frame file says which picture it is and which pixels it has, so that what is there can be told from what should be.

mod channels;
mod exr_file;
mod found_frame;
mod frame_file;
mod frame_pixels;
mod label;
mod loops;
mod pfm_file;
mod picture;
mod picture_file;
mod png_file;
mod portable_map;
mod ppm_file;
mod provenance;
mod sequence;
mod sheet;
mod video_stream;
mod whole_file;
mod writer;

pub use channels::Channels;
pub use found_frame::{FoundFrame, frame_size, read_frame};
pub use frame_file::{
    EncodeError, FrameFormat, WriteError, encode, encode_quickly, write, write_bytes, write_new,
};
pub use frame_pixels::{FramePixels, LinearFrame};
pub use loops::{LoopError, LoopFormat, LoopWriter, gif_delays};
pub use picture_file::PictureFile;
pub use provenance::{NoProvenance, PixelFingerprint, Provenance};
pub use sequence::{FrameNames, NotAPattern, Sequence};
pub use sheet::{Sheet, SheetTooLarge};
pub use video_stream::{VideoFormat, VideoStream};
pub use whole_file::{PartialFile, folder_of, remove_leftovers};
pub use writer::{FrameWriter, WrittenFrame};
