//! The queue of commands to a session.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::pixel_info::PixelInfo;

/// A command to a session.
#[derive(Debug)]
pub enum SessionCommand {
    /// Reads the files again after a change.
    Reload,
    /// Changes the view.
    ViewChange(ViewChange),
    /// Describes a pixel of the film, given by column and row.
    Probe((u32, u32), ProbeReply),
    /// Ends the session.
    Stop,
}

/// A change of the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ViewChange {
    /// Shows a frame. Indices beyond the last frame show the last frame.
    Seek {
        /// Index of the frame, from 0.
        frame: u32,
        /// True for a frame of playback, which has a single picture: the full one only if there is time for it.
        #[serde(default)]
        playing: bool,
    },
    /// Sets the quality of subsequent pictures.
    Detail(Detail),
    /// Shows the current frame at full quality once.
    Finish,
    /// Measures the cost of each effect of the current frame.
    Measure,
}

/// The quality of pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Detail {
    /// Identical to a picture rendered to a file.
    #[default]
    Full,
    /// One sample per pixel.
    Draft,
    /// Half the width and height, with one sample per pixel.
    Half,
}

/// A callback that receives the result of a probe.
pub struct ProbeReply(pub Box<dyn FnOnce(Option<PixelInfo>) + Send>);

impl fmt::Debug for ProbeReply {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Answer")
    }
}

/// The queue of pending commands.
#[derive(Debug, Default)]
pub(super) struct CommandQueue {
    commands: Mutex<Vec<SessionCommand>>,
    posted: Condvar,
    /// True if a pending command interrupts the current work.
    interrupt: AtomicBool,
    /// True if a command other than the next frame of playback is pending.
    urgent: AtomicBool,
}

/// The time to wait for commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WaitMode {
    None,
    Until(Instant),
    Endless,
}

impl CommandQueue {
    pub(super) fn send(&self, command: SessionCommand) {
        let mut commands = self.commands.lock().unwrap_or_else(PoisonError::into_inner);
        let is_pressing =
            !matches!(command, SessionCommand::ViewChange(ViewChange::Seek { playing: true, .. }));
        commands.push(command);
        self.interrupt.store(true, Ordering::Relaxed);
        self.urgent.fetch_or(is_pressing, Ordering::Relaxed);
        self.posted.notify_one();
    }

    /// Waits for commands within `wait_mode`. Returns all commands since the last call, in order.
    pub(super) fn take(&self, wait_mode: WaitMode) -> Vec<SessionCommand> {
        let mut commands = self.commands.lock().unwrap_or_else(PoisonError::into_inner);
        while commands.is_empty() {
            commands = match wait_mode {
                WaitMode::None => break,
                WaitMode::Endless => self.posted.wait(commands).unwrap_or_else(PoisonError::into_inner),
                WaitMode::Until(end) => {
                    let rest = end.saturating_duration_since(Instant::now());
                    if rest.is_zero() {
                        break;
                    }
                    self.posted.wait_timeout(commands, rest).unwrap_or_else(PoisonError::into_inner).0
                }
            };
        }
        self.interrupt.store(false, Ordering::Relaxed);
        self.urgent.store(false, Ordering::Relaxed);
        std::mem::take(&mut commands)
    }

    /// Removes pending commands to read the files, for a caller that is about to read them. Returns whether there were any.
    pub(super) fn take_reload(&self) -> bool {
        let mut commands = self.commands.lock().unwrap_or_else(PoisonError::into_inner);
        let count = commands.len();
        commands.retain(|command| !matches!(command, SessionCommand::Reload));
        commands.len() < count
    }

    /// Returns the flag that becomes true when a command arrives.
    pub(super) fn interrupt(&self) -> &AtomicBool {
        &self.interrupt
    }

    /// Returns the flag that becomes true when a command other than the next frame of playback arrives.
    pub(super) fn urgent(&self) -> &AtomicBool {
        &self.urgent
    }

    /// Runs `work`, which can be interrupted by commands and by `deadline`. The deadline counts from the first call of the function
    /// passed to `work`; when it passes, [`interrupt`](Self::waiting) becomes true without a command. Returns the result, and whether the
    /// deadline passed.
    pub(super) fn with_deadline<T>(
        &self,
        deadline: Option<Duration>,
        work: impl FnOnce(&(dyn Fn() + Sync)) -> T,
    ) -> (T, bool) {
        let Some(deadline) = deadline else { return (work(&|| ()), false) };
        let (begun, done, late) = (OnceLock::new(), AtomicBool::new(false), AtomicBool::new(false));
        let result = thread::scope(|scope| {
            let clock = scope.spawn(|| {
                while !done.load(Ordering::Acquire) {
                    let Some(begun) = begun.get() else {
                        thread::park();
                        continue;
                    };
                    let rest = deadline.saturating_sub(Instant::elapsed(begun));
                    if rest.is_zero() {
                        late.store(true, Ordering::Relaxed);
                        self.interrupt.store(true, Ordering::Relaxed);
                        return;
                    }
                    thread::park_timeout(rest);
                }
            });
            let result = work(&|| {
                if begun.set(Instant::now()).is_ok() {
                    clock.thread().unpark();
                }
            });
            done.store(true, Ordering::Release);
            clock.thread().unpark();
            result
        });
        (result, late.into_inner())
    }
}
