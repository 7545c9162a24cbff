//! Live preview of scenes during editing.
//!
//! ```text
//! files -> watcher -> commands -> session (reads, renders) -> published -> server -> page
//!                        ^                                               |
//!                        +---------- seek, probe, quality ---------------+
//! ```
//!
//! The [`Watcher`] detects changes of file contents. The [`Session`] owns the engine and runs on a separate thread. It processes
//! commands, and publishes its state and pictures, which can be read at any time, so that a page opened late or again shows the
//! same as all others. Coarse pictures precede a picture that takes long, which is also shown while it is unfinished. A new command
//! interrupts the work at once and discards only results that are no longer needed. The [`Server`] makes all this available to browsers
//! on the same machine only.

mod commands;
mod event;
mod files;
mod guard;
mod handle;
mod in_progress;
mod page;
mod pixel_info;
mod presenter;
mod preview_level;
mod preview_scene;
mod progress_observer;
mod published;
mod refresh_timer;
mod renderer;
mod server;
mod session;
mod state;
mod watcher;
mod worker;

pub use event::{Event, Shown};
pub use guard::{HostName, NoHostName};
pub use handle::{Handle, SessionSettings};
pub use server::Server;
pub use session::Session;
pub use state::{Mistakes, PictureInfo, Times};
pub use watcher::{QUIET, Watcher, Watching};

// Used by the server and by tests; not part of the public API.
#[doc(hidden)]
pub use {
    commands::{Detail, ProbeReply, SessionCommand, ViewChange},
    pixel_info::{PixelInfo, SurfaceInfo},
    published::Picture,
    state::{Planned, State},
};
