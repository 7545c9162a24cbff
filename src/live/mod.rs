//! Live preview of scenes while they are edited.
//!
//! ```text
//! files -> watcher -> mailbox -> session (reads, renders) -> board -> server -> page
//!                        ^                                               |
//!                        +---------- seek, probe, quality ---------------+
//! ```
//!
//! The [`Watcher`] notices that the contents of files have changed. The [`Session`] owns the engine, on a thread of its own. It takes
//! commands, and posts its state and its pictures on a board that can be read at any time, so that a page that is opened late,
//! or again, sees what the others see. Quick pictures lead up to one that takes long, which is shown while it is rendered; a new
//! command interrupts the work at once, and discards only what is no longer wanted. The [`Server`] shows all that to browsers on the
//! same machine, and to nobody else.

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
mod onlooker;
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
pub use handle::{Handle, SessionSettings};
pub use server::Server;
pub use session::Session;
pub use state::{Mistakes, PictureInfo, Times};
pub use watcher::{QUIET, Watcher, Watching};

// What the server asks of a session, and tests with it: no part of the library's face.
#[doc(hidden)]
pub use {
    board::Picture,
    mailbox::{Answer, Command, Detail, View},
    pixel_info::{PixelInfo, SurfaceInfo},
    state::{Planned, State},
};
