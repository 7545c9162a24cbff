//! Files of particles, read frame by frame.
//!
//! A [`Trajectory`] is a file with an index of its frames; a [`Snapshot`] holds the particles of one frame in columns. This module has no
//! scenes and no timeline: which frame is shown at which moment, and how, is decided elsewhere.
//!
//! ```
//! use rayreel::trajectory::Trajectory;
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("water.xyz");
//! std::fs::write(&path, "3\nwater, time = 0.5\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n")?;
//!
//! let trajectory = Trajectory::open(&path, None)?;
//! let snapshot = trajectory.read(0)?;
//! assert_eq!((snapshot.count, snapshot.time), (3, Some(0.5)));
//! assert_eq!(snapshot.positions()?[0], [0.0, 0.96, -0.24]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Formats of text share a cursor over lines; CSV, XYZ and LAMMPS also the parser of tables, and NPY and NPZ the reader of arrays:
//!
//! ```text
//! DataFile (bytes, decompressed) -> FrameReader::index    finds the frames, once
//!                                -> FrameReader::read     bytes of a frame -> Snapshot, for each frame
//! ```

mod column_names;
mod comment;
mod compression;
mod csv_file;
mod data_file;
#[cfg_attr(not(feature = "trajectories"), path = "no_decompress.rs")]
mod decompress;
mod element;
mod error;
mod format;
mod frame_reader;
mod frame_span;
mod lammps;
mod npy;
mod npz;
mod numpy;
mod open_file;
mod pdb;
mod pdb_record;
mod reader;
mod snapshot;
mod strided;
mod table;
mod text;
mod xtc;
mod xtc_coordinates;
mod xyz;
mod zip;

pub use error::{DataFault, DataPlace, TrajectoryError};
pub use format::Format;
pub use reader::Trajectory;
pub use snapshot::{Cell, Column, ColumnError, Snapshot, Values};
