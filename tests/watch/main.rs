//! Watching files, and the session that keeps a scene on show while they are edited.
//!
//! Editors that are not installed are imitated only.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

use std::time::Duration;

mod command;
mod drafts;
mod editors;
#[cfg(unix)]
#[path = "../signals/ignored.rs"]
mod ignored;
mod ladder;
mod saves;
mod session;
mod watcher;

/// What must happen does so long before, even on a machine that is busy with other things.
const AT_MOST: Duration = Duration::from_secs(60);
/// What must not happen would have by then: several quiet periods, and a look at the files without any hint.
const LONG_ENOUGH: Duration = Duration::from_millis(800);
