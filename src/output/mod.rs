//! Output of films: frame files, contact sheets, movies, and video streams.
//!
//! Files are complete or absent: each is written under a temporary name in the same folder, and renamed once every byte is on the disk.
//! Each frame file contains fingerprints of its picture and of its pixels, so that existing files can be compared with the expected ones.

mod animation_writer;
mod atomic_file;
mod channels;
#[cfg_attr(not(feature = "exr"), path = "no_exr_file.rs")]
mod exr_file;
mod found_frame;
mod frame_file;
mod frame_pixels;
#[cfg_attr(not(feature = "image"), path = "no_gif_writer.rs")]
mod gif_writer;
#[cfg_attr(not(feature = "image"), path = "no_hdr_file.rs")]
mod hdr_file;
#[cfg(feature = "image")]
mod image_conversion;
mod label;
mod movie_format;
mod movie_writer;
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
mod writer;

pub use animation_writer::{LoopError, LoopFormat, LoopWriter, gif_delays};
pub use atomic_file::{PartialFile, folder_of, remove_leftovers};
pub use channels::Channels;
pub use found_frame::{FoundFrame, frame_size, read_frame};
#[cfg(feature = "live")]
pub(crate) use found_frame::{decode_png, read_complete};
#[cfg(feature = "live")]
pub(crate) use frame_file::write_frame;
pub use frame_file::{
    EncodeError, FrameFormat, WriteError, encode, encode_quickly, write, write_bytes, write_new,
};
pub use frame_pixels::{FramePixels, LinearFrame};
pub use movie_format::{FfmpegFormat, MovieFormat, UnknownMovieFormat};
pub(crate) use movie_writer::movie_format;
pub use movie_writer::{MovieError, MovieWriter, check_movie, write_movie};
pub use picture_file::PictureFile;
pub use sequence::{FrameNames, InvalidPattern, Sequence};
pub use sheet::{Sheet, SheetTooLarge};
pub use video_stream::{VideoFormat, VideoStream};
pub use writer::{FrameWriter, WrittenFrame};
