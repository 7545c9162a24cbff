//! Live preview of scenes while they are edited.
//!
//! ```text
//! files -> watcher -> mailbox -> session (reads, renders) -> board -> server -> page
//!                        ^                                               |
//!                        +---------- seek, probe, render well -----------+
//! ```
//!
//! The [`Watcher`] notices that files hold something else. The [`Session`] owns the engine, on a thread of its own; it is
//! asked by commands, and puts up its [`State`] and its pictures where all can see them at any time, so that a page that comes
//! late, or again, sees what the others see. Quick pictures lead up to one that takes long, which is shown while it is made; what
//! is asked in between ends the work at once, and loses nothing of it that is still wanted. The [`Server`] shows all that to a
//! browser on the same machine, and to nobody else.

mod begun;
mod board;
mod director;
mod easel;
mod event;
mod files;
mod guard;
mod handle;
mod ladder;
mod mailbox;
mod making;
mod page;
mod pixel_info;
mod server;
mod session;
mod stage;
mod state;
mod visits;
mod watcher;

pub use event::{Event, Shown};
pub use guard::{HostName, NoHostName};
pub use handle::SessionSettings;
pub use server::Server;
pub use session::Session;
pub use state::Times;
pub use watcher::{QUIET, Watcher, Watching};

// What the server asks of a session, and tests with it: no part of the library's face.
#[doc(hidden)]
pub use {
    board::Picture,
    handle::Handle,
    mailbox::{Answer, Command, Detail, View},
    pixel_info::{PixelInfo, SurfaceInfo},
    state::{Mistakes, PictureInfo, Planned, State},
};
