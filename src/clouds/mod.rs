//! Particles of data files as clouds: which of them are shown, where they are at a moment, how large and of which colour.
//!
//! ```text
//! moment -> FrameTimes -> frames of the file -> DataFile (reads, reads ahead) -> FrameColumns (one frame, or between two)
//!     FrameColumns -> ParticleFilter -> positions, sizes, colours -> components::Cloud
//! ```

mod columns;
mod data_file;
mod elements;
mod error;
mod file_source;
mod filter;
mod mapping;
mod palette;
mod frame_times;

pub use data_file::DataFile;
pub use error::{CloudError, CloudPart};
pub use file_source::{CloudSettings, FileParticles};
pub use filter::ParticleFilter;
pub use mapping::{ColorBy, ScaleBy};
pub use palette::{CATEGORIES, ColorMap};
pub use frame_times::{Between, End, FrameTimes};
