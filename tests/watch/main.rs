//! Tests of file watching, and of the session that shows a scene while its files are edited.
//!
//! Editors that are not installed are only imitated.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

use std::time::Duration;

mod cache;
mod cache_folder;
mod command;
mod drafts;
mod editors;
mod edits;
mod export;
mod fuzz;
#[cfg(unix)]
#[path = "../signals/ignored.rs"]
mod ignored;
mod levels;
mod reuse;
mod saves;
mod session;
#[path = "../random/splitmix.rs"]
mod splitmix;
mod warnings;
mod watcher;

/// Time limit for expected events, generous enough for a busy machine.
const AT_MOST: Duration = Duration::from_secs(60);
/// Time after which an unexpected event would have occurred: several quiet periods, and a rescan of the files without a notification.
const LONG_ENOUGH: Duration = Duration::from_millis(800);
