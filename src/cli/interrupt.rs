//! Ctrl-C, and the signals by which terminals and schedulers ask for the same.
//!
//! A signal that was ignored when the program started, as SIGHUP under `nohup`, stays so. Exit codes are as shells have them: 128
//! and the signal's number.

use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use anyhow::Context;

use super::exit::Failure;

/// Whether an interruption has come. It ends the process at once, and so does a second one: no file is ever half-written under
/// its name. A command that ends by itself asks for the first to be [deferred](Interruption::deferred).
#[derive(Debug, Default)]
pub(super) struct Interruption {
    raised: Arc<AtomicBool>,
    /// Whether the next one ends the process.
    ends: Arc<AtomicBool>,
    /// The exit code of the process then.
    code: Arc<AtomicUsize>,
}

impl Interruption {
    /// Starts to listen.
    pub(super) fn listen() -> anyhow::Result<Self> {
        let interruption = Self { ends: Arc::new(true.into()), ..Self::default() };
        interruption.register().context("cannot listen to signals")?;
        Ok(interruption)
    }

    /// Defers the first interruption from now on; it only sets the returned flag.
    pub(super) fn deferred(&self) -> &AtomicBool {
        self.ends.store(false, Ordering::SeqCst);
        &self.raised
    }

    /// Returns the failure of a command that was interrupted.
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
            // The actions happen in this order.
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

/// The time between two looks at the flag of an interruption: short enough that nobody notices, and long enough to cost nothing.
pub(super) const POLL_INTERVAL: Duration = Duration::from_millis(10);

/// Runs a task on a thread of its own, and returns its result. Returns `None` after cancellation; the thread then ends with the process,
/// as one that waits for the reader of a full pipe cannot be stopped.
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

/// Returns whether a signal is ignored, by the will of whoever started the program.
#[cfg(unix)]
#[expect(unsafe_code, reason = "nothing safe tells what happens at a signal without changing it")]
fn is_ignored(signal: std::ffi::c_int) -> bool {
    let mut action = std::mem::MaybeUninit::<libc::sigaction>::zeroed();
    // SAFETY: without a new action, the call changes nothing and writes the present one to where there is room for it; zeros are
    // a valid action, too.
    unsafe {
        libc::sigaction(signal, std::ptr::null(), action.as_mut_ptr()) == 0
            && action.assume_init().sa_sigaction == libc::SIG_IGN
    }
}
