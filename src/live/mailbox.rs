//! The commands to a session.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::pixel_info::PixelInfo;

/// A command to a session.
#[derive(Debug)]
pub enum Command {
    /// Reads the files again, as they have changed.
    Reload,
    /// Changes what is shown.
    View(View),
    /// Tells what a pixel of the film, given by column and row, shows.
    Probe((u32, u32), Answer),
    /// Ends the session.
    Stop,
}

/// A change of what is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum View {
    /// Shows a frame; the last one for indices beyond it.
    Seek {
        /// The index, from 0.
        frame: u32,
        /// Whether it is one of many that follow each other, so that one picture must do: the full one only if there is time for
        /// it.
        #[serde(default)]
        playing: bool,
    },
    /// Sets the quality of pictures from now on.
    Detail(Detail),
    /// Shows the current frame at full quality, once.
    Finish,
    /// Measures the cost of each effect of the current frame.
    Measure,
}

/// The quality of pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Detail {
    /// The same as rendered to a file.
    #[default]
    Full,
    /// One sample a pixel.
    Draft,
    /// Half the width and the height, and one sample a pixel.
    Half,
}

/// Receives an answer.
pub struct Answer(pub Box<dyn FnOnce(Option<PixelInfo>) + Send>);

impl fmt::Debug for Answer {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Answer")
    }
}

/// The commands on their way to the session.
#[derive(Debug, Default)]
pub(super) struct Mailbox {
    commands: Mutex<Vec<Command>>,
    posted: Condvar,
    /// Whether there is a command that the current work must give way to.
    waiting: AtomicBool,
    /// Whether there is one other than the next of many pictures in a row.
    pressing: AtomicBool,
}

/// The time to wait for commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Patience {
    None,
    Until(Instant),
    Endless,
}

impl Mailbox {
    pub(super) fn post(&self, command: Command) {
        let mut commands = self.commands.lock().unwrap_or_else(PoisonError::into_inner);
        let is_pressing = !matches!(command, Command::View(View::Seek { playing: true, .. }));
        commands.push(command);
        self.waiting.store(true, Ordering::Relaxed);
        self.pressing.fetch_or(is_pressing, Ordering::Relaxed);
        self.posted.notify_one();
    }

    /// Waits for commands within `patience`; returns all since the last call, in order.
    pub(super) fn take(&self, patience: Patience) -> Vec<Command> {
        let mut commands = self.commands.lock().unwrap_or_else(PoisonError::into_inner);
        while commands.is_empty() {
            commands = match patience {
                Patience::None => break,
                Patience::Endless => self.posted.wait(commands).unwrap_or_else(PoisonError::into_inner),
                Patience::Until(end) => {
                    let rest = end.saturating_duration_since(Instant::now());
                    if rest.is_zero() {
                        break;
                    }
                    self.posted.wait_timeout(commands, rest).unwrap_or_else(PoisonError::into_inner).0
                }
            };
        }
        self.waiting.store(false, Ordering::Relaxed);
        self.pressing.store(false, Ordering::Relaxed);
        std::mem::take(&mut commands)
    }

    /// Takes back pending commands to read the files, for a caller who is about to do so; returns whether there were any.
    pub(super) fn take_reload(&self) -> bool {
        let mut commands = self.commands.lock().unwrap_or_else(PoisonError::into_inner);
        let count = commands.len();
        commands.retain(|command| !matches!(command, Command::Reload));
        commands.len() < count
    }

    /// Returns the flag that becomes true when a command arrives.
    pub(super) fn waiting(&self) -> &AtomicBool {
        &self.waiting
    }

    /// Returns the flag that becomes true when a command arrives other than the next of many pictures in a row.
    pub(super) fn pressing(&self) -> &AtomicBool {
        &self.pressing
    }

    /// Runs work that gives way to commands and, once `deadline` has passed since it called the function it is given, also to the
    /// rest of the session: [`waiting`](Self::waiting) is then true without a command. Returns the result, and whether the
    /// deadline passed.
    pub(super) fn within<T>(
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
                        self.waiting.store(true, Ordering::Relaxed);
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
