//! Ctrl-C and the termination signals of terminals and schedulers.
//!
//! A signal that was ignored when the program started, such as SIGHUP under `nohup`, stays ignored. Exit codes follow the convention of
//! shells: 128 plus the signal number.

use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use anyhow::Context;

use super::exit::Failure;

/// State of interruptions. By default, an interruption ends the process at once. A command that shuts down by itself
/// [defers](Interruption::deferred) the first interruption; a second one still ends the process. Ending it is always safe: no file is ever
/// half-written under its final name.
#[derive(Debug, Default)]
pub(super) struct Interruption {
    raised: Arc<AtomicBool>,
    /// True if the next interruption ends the process.
    ends: Arc<AtomicBool>,
    /// Exit code of the process after an interruption.
    code: Arc<AtomicUsize>,
}

impl Interruption {
    /// Installs the signal handlers.
    pub(super) fn listen() -> anyhow::Result<Self> {
        let interruption = Self { ends: Arc::new(true.into()), ..Self::default() };
        interruption.register().context("cannot listen to signals")?;
        Ok(interruption)
    }

    /// Defers the first interruption from now on: it only sets the returned flag.
    pub(super) fn deferred(&self) -> &AtomicBool {
        self.ends.store(false, Ordering::SeqCst);
        &self.raised
    }

    /// Returns the failure of an interrupted command.
    pub(super) fn failure(&self) -> Failure {
        Failure::Interrupted(u8::try_from(self.code.load(Ordering::SeqCst)).unwrap_or(u8::MAX))
    }

    #[cfg(unix)]
    fn register(&self) -> std::io::Result<()> {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
        use signal_hook::flag;
        for (signal, code) in [(SIGHUP, 129), (SIGINT, 130), (SIGTERM, 143)] {
            if is_ignored(signal) {
                continue;
            }
            // Actions run in the order of registration.
            flag::register_conditional_shutdown(signal, code, Arc::clone(&self.ends))?;
            flag::register_usize(signal, Arc::clone(&self.code), code.unsigned_abs() as usize)?;
            flag::register(signal, Arc::clone(&self.ends))?;
            flag::register(signal, Arc::clone(&self.raised))?;
        }
        Ok(())
    }

    #[cfg(not(unix))]
    fn register(&self) -> Result<(), ctrlc::Error> {
        const CODE: u8 = 130;
        let (raised, ends) = (Arc::clone(&self.raised), Arc::clone(&self.ends));
        self.code.store(CODE.into(), Ordering::SeqCst);
        ctrlc::set_handler(move || {
            if ends.swap(true, Ordering::SeqCst) {
                std::process::exit(CODE.into());
            }
            raised.store(true, Ordering::SeqCst);
        })
    }
}

/// Time between two checks of the interruption flag: short enough to be imperceptible, long enough to cost nothing.
pub(super) const POLL_INTERVAL: Duration = Duration::from_millis(10);

/// Runs a task on its own thread and returns its result. Returns `None` on cancellation; the thread then ends with the process, because a
/// thread that is blocked on a full pipe cannot be stopped.
pub(super) fn unless_cancelled<T: Send + 'static>(
    cancelled: &AtomicBool,
    task: impl FnOnce() -> T + Send + 'static,
) -> Option<T> {
    let (sender, receiver) = channel();
    let thread = thread::spawn(move || sender.send(task()));
    loop {
        match receiver.recv_timeout(POLL_INTERVAL) {
            Ok(result) => return Some(result),
            Err(RecvTimeoutError::Timeout) if cancelled.load(Ordering::Relaxed) => return None,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => match thread.join() {
                Err(panic) => resume_unwind(panic),
                Ok(_) => return None,
            },
        }
    }
}

/// Returns whether a signal is ignored, as inherited from the parent process.
#[cfg(unix)]
#[expect(unsafe_code, reason = "nothing safe tells what happens at a signal without changing it")]
fn is_ignored(signal: std::ffi::c_int) -> bool {
    let mut action = std::mem::MaybeUninit::<libc::sigaction>::zeroed();
    // SAFETY: with a null pointer as the new action, the call changes nothing and writes the current action to `action`, which has
    // room for it. A zeroed `sigaction` is valid as well.
    unsafe {
        libc::sigaction(signal, std::ptr::null(), action.as_mut_ptr()) == 0
            && action.assume_init().sa_sigaction == libc::SIG_IGN
    }
}
