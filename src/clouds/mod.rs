//! Particles of data files as clouds: which of them are shown, where they are at a moment, how large and of which colour.
//!
//! ```text
//! moment -> FrameTiming -> frames of the file -> TrajectoryFile (reads, reads ahead) -> FrameColumns (one frame, or between two)
//!     FrameColumns -> ParticleFilter -> positions, sizes, colours, bonds, images -> components::Cloud
//! ```

mod bonds;
mod cell;
mod columns;
mod elements;
mod error;
mod file_source;
mod filter;
mod frame_timing;
mod legend;
mod mapping;
mod palette;
mod trajectory_file;

pub use bonds::BondSettings;
pub use elements::is_element;
pub use error::{CloudError, CloudPart};
pub use file_source::{CloudContent, CloudSettings, FileParticles};
pub use filter::ParticleFilter;
pub use frame_timing::{Between, End, FrameTiming};
pub use mapping::{ColorBy, ScaleBy};
pub use palette::{CATEGORIES, ColorMap};
pub use trajectory_file::TrajectoryFile;
