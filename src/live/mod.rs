//! Live preview of scenes during editing.
//!
//! ```text
//! files -> watcher -> commands -> worker (reads, picks jobs) -> renderer (runs them) -> publish -> server -> page
//!                        ^                                                                           |
//!                        +---------------------- seek, probe, quality -------------------------------+
//! ```
//!
//! | file | holds |
//! |---|---|
//! | `session` | the thread's start and end, and the handle for other threads |
//! | `watcher` | detection of changed file contents |
//! | `commands` | the queue of commands, which interrupt the work |
//! | `worker` | the choice of the next job |
//! | `scene_files` | reading of the files, and mistakes in them |
//! | `renderer` | the engine; coarse pictures, the requested one, and the full one |
//! | `progressive` | levels and times of the pictures before and during a picture that takes long |
//! | `jobs` | the kinds of work, and their results |
//! | `cache`, `cache_folder` | finished pictures, for playback and for edits that are undone, and for the next session |
//! | `measure`, `pixel_info`, `ray_info` | costs of effects, the error curve, single pixels and their rays |
//! | `path_info` | the path of the camera over the frames of its shot |
//! | `outline` | the list of the scene's parts, and their values |
//! | `placement` | the outline of an entity in the picture, and the values that a move of it changes |
//! | `editor` | the command that opens a file in an editor |
//! | `edits`, `camera_view`, `frame_keys` | values, views and keys that are changed on the page, and written into the files |
//! | `controls` | values of a program that are changed on the page |
//! | `export` | rendering of films into files |
//! | `tile_stats` | numbers of rays and errors of the tiles of pictures |
//! | `warnings` | warnings about the scene and its full pictures |
//! | `publish`, `state` | pictures, the state and events, readable at any time |
//! | `server`, `page` | the HTTP server for browsers on the same machine, and its page |
//!
//! All pages show the published state, whenever they were opened. Coarse pictures precede a picture that takes long, which is also shown
//! while it is unfinished. A new command interrupts the work at once and discards only results that are no longer
//! needed.

mod cache;
mod cache_folder;
mod camera_view;
mod commands;
mod controls;
mod editor;
mod edits;
mod export;
mod frame_keys;
mod jobs;
mod measure;
mod outline;
mod path_info;
mod pixel_info;
mod placement;
mod progressive;
mod publish;
mod ray_info;
mod renderer;
mod scene_files;
mod server;
mod session;
mod state;
mod tile_stats;
mod warnings;
mod watcher;
mod worker;

pub use controls::InvalidControl;
pub use editor::{EditorCommand, NoEditorCommand};
pub use publish::{Event, Shown};
pub use server::{HostName, NoHostName, Server};
pub use session::{DEFAULT_CACHE, Handle, Session, SessionSettings};
pub use state::{Mistakes, PictureInfo, Times};
pub use warnings::{PictureWarning, PictureWarnings};
pub use watcher::{QUIET_PERIOD, Watcher, Watching};

// Used by the server and by tests; not part of the public API.
#[doc(hidden)]
pub use {
    camera_view::CameraView,
    commands::{Detail, LookView, Reply, SceneEdit, SessionCommand, ViewChange},
    edits::{EditState, LastChange},
    export::{ExportEnd, ExportRequest, ExportState},
    outline::{AnimatedField, OutlineRequest, OutlineRow, PartInfo, PartSection},
    path_info::{PathInfo, PathRequest, PathSample},
    pixel_info::{PixelInfo, SurfaceInfo},
    placement::{MovedValue, Placement, RoundPart, Silhouette},
    publish::Picture,
    ray_info::{RayRow, RayTreeInfo},
    state::{CachedFrames, EditedPart, Planned, State},
};
