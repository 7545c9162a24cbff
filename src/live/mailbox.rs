//! What a session is asked to do.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::spot::Spot;

/// What a session can be asked.
#[derive(Debug)]
pub enum Command {
    /// Files hold something else: read them again.
    Reload,
    /// Something to see.
    View(View),
    /// What a pixel of the film sees, column and row.
    Probe((u32, u32), Answer),
    /// Come to an end.
    Stop,
}

/// What to see.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum View {
    /// Show a frame; beyond the last, the last.
    Seek {
        /// From 0.
        frame: u32,
        /// Is it one of many that follow each other? Then one picture must do, the full one only if there is time for it.
        #[serde(default)]
        playing: bool,
    },
    /// How good the pictures are from now on.
    Detail(Detail),
    /// The current frame at full quality, once.
    Finish,
    /// What each effect of the current frame costs.
    Measure,
}

/// How good a picture is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Detail {
    /// As it is rendered to a file.
    #[default]
    Full,
    /// One sample a pixel.
    Draft,
    /// Half the width and the height, and one sample a pixel.
    Half,
}

/// Takes an answer.
pub struct Answer(pub Box<dyn FnOnce(Option<Spot>) + Send>);

impl fmt::Debug for Answer {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Answer")
    }
}

/// Commands on their way to the session.
#[derive(Debug, Default)]
pub(super) struct Mailbox {
    commands: Mutex<Vec<Command>>,
    posted: Condvar,
    /// Is anything in it that the work in hand must make way for?
    waiting: AtomicBool,
    /// Is it more than the next of many pictures in a row?
    pressing: AtomicBool,
}

/// How long to wait for commands.
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

    /// All commands since the last time, in order.
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

    /// Takes back the commands to read the files, for somebody who is about to do so; were there any?
    pub(super) fn take_reload(&self) -> bool {
        let mut commands = self.commands.lock().unwrap_or_else(PoisonError::into_inner);
        let count = commands.len();
        commands.retain(|command| !matches!(command, Command::Reload));
        commands.len() < count
    }

    /// Becomes true when a command arrives.
    pub(super) fn waiting(&self) -> &AtomicBool {
        &self.waiting
    }

    /// Becomes true when a command arrives that is not the next of many pictures in a row.
    pub(super) fn pressing(&self) -> &AtomicBool {
        &self.pressing
    }

    /// Does something that makes way for commands and, so long after it calls what it is given, also for the rest of the work:
    /// then [`waiting`](Self::waiting) is true without any. Says whether it came to that.
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
