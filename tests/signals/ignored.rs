//! Signals that were ignored when the tests started, as shells do for background processes.

/// Returns true if a signal was ignored.
pub(crate) fn is_ignored_here(number: u32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask =
        status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (number - 1) & 1 == 1)
}

/// Returns the signal that ends processes started here, and its exit code: SIGINT, as for Ctrl-C, or SIGTERM if SIGINT is ignored.
pub(crate) fn interruption() -> (&'static str, i32) {
    if is_ignored_here(2) { ("TERM", 143) } else { ("INT", 130) }
}
