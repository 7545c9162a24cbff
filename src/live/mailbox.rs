//! What a session is asked to do.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};

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
}

impl Mailbox {
    pub(super) fn post(&self, command: Command) {
        let mut commands = self.commands.lock().unwrap_or_else(PoisonError::into_inner);
        commands.push(command);
        self.waiting.store(true, Ordering::Relaxed);
        self.posted.notify_one();
    }

    /// All commands since the last time, in order. With `patience` there is at least one.
    pub(super) fn take(&self, patience: bool) -> Vec<Command> {
        let commands = self.commands.lock().unwrap_or_else(PoisonError::into_inner);
        let mut commands = self
            .posted
            .wait_while(commands, |commands| patience && commands.is_empty())
            .unwrap_or_else(PoisonError::into_inner);
        self.waiting.store(false, Ordering::Relaxed);
        std::mem::take(&mut commands)
    }

    /// Becomes true when a command arrives.
    pub(super) fn waiting(&self) -> &AtomicBool {
        &self.waiting
    }
}
