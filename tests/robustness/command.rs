//! The command as a process of its own, with limited memory and time.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

/// Limit of the address space, in KiB.
const MEMORY: u64 = 1 << 20;
/// Limit of the processor time of all threads together, in seconds.
const TIME: u64 = 10;
/// Limit of the elapsed time. A waiting process uses no processor time, and a busy machine takes longer.
const PATIENCE: Duration = Duration::from_secs(60);
/// Limit of the output, in bytes, which people must be able to read.
const MESSAGES: u64 = 1 << 16;

/// The largest figures of several runs, with the number of runs and of accepted scenes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Taken {
    pub(crate) runs: u64,
    pub(crate) accepted: u64,
    pub(crate) time: Duration,
    /// Main memory in KiB, as sampled during the run.
    pub(crate) memory: u64,
    /// Bytes of output.
    pub(crate) messages: u64,
}

impl Taken {
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            runs: self.runs + other.runs,
            accepted: self.accepted + other.accepted,
            time: self.time.max(other.time),
            memory: self.memory.max(other.memory),
            messages: self.messages.max(other.messages),
        }
    }
}

/// Runs `rayreel` in a folder. It must succeed or report an error, within the limits.
pub(crate) fn rayreel(folder: &Path, arguments: &[&str]) -> Result<Taken, TestCaseError> {
    let log = folder.join("log");
    let output = File::create(&log).unwrap();
    let limited = format!("ulimit -v {MEMORY}; ulimit -t {TIME}; exec \"$0\" \"$@\"");
    let start = Instant::now();
    let mut child = Command::new("sh")
        .args(["-c", &limited, env!("CARGO_BIN_EXE_rayreel")])
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(output.try_clone().unwrap())
        .stderr(output)
        .spawn()
        .unwrap();
    let mut memory = 0;
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if start.elapsed() > PATIENCE {
            child.kill().unwrap();
        }
        memory = peak(child.id()).unwrap_or(memory);
        thread::sleep(Duration::from_millis(1));
    };
    let message = String::from_utf8_lossy(&fs::read(log).unwrap()).into_owned();
    let end: String = message.chars().rev().take(2000).collect::<Vec<_>>().into_iter().rev().collect();
    prop_assert!(matches!(status.code(), Some(0 | 1)), "{} after {:?}: {}", status, start.elapsed(), end);
    prop_assert!(!message.contains("panicked at"), "{}", end);
    prop_assert!(status.success() || message.contains("error: "), "nothing says what is wrong: {}", end);
    prop_assert!(message.len() as u64 <= MESSAGES, "{} bytes are printed", message.len());
    Ok(Taken {
        runs: 1,
        accepted: u64::from(status.success()),
        time: start.elapsed(),
        memory,
        messages: message.len() as u64,
    })
}

/// Returns the peak memory of a process so far, in KiB, where the system reports it.
fn peak(process: u32) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().trim_end_matches(" kB").parse().ok()
}
