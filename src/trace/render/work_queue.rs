//! A queue of work that threads take in shares, so that no thread waits for another at the end.
//!
//! After Polychronopoulos and Kuck, "Guided Self-Scheduling" (1987): each request gets a share of the remaining items. Shares are long at
//! first, which keeps neighbouring items together, and single items at the end.

use std::sync::{Mutex, PoisonError};

/// Items shared by several threads.
#[derive(Debug)]
pub(in crate::trace) struct WorkQueue<I> {
    items: Mutex<RemainingItems<I>>,
    threads: usize,
}

#[derive(Debug)]
struct RemainingItems<I> {
    rest: I,
    /// The number of remaining items.
    count: usize,
}

impl<I: Iterator> WorkQueue<I> {
    /// Creates a queue of `count` items for `threads` threads, at least one.
    pub(in crate::trace) fn new(items: I, count: usize, threads: usize) -> Self {
        Self { items: Mutex::new(RemainingItems { rest: items, count }), threads }
    }

    /// Appends the next share to `list`. Returns `false` if nothing is left.
    pub(in crate::trace) fn take_share(&self, list: &mut Vec<I::Item>) -> bool {
        /// The number of shares into which each thread's part of the remaining items is divided.
        const SHARES: usize = 4;
        const LONGEST: usize = 16;
        let mut items = self.items.lock().unwrap_or_else(PoisonError::into_inner);
        let length = items.count.div_ceil(self.threads * SHARES).min(LONGEST);
        items.count -= length;
        list.extend(items.rest.by_ref().take(length));
        length > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_item_is_taken_once_and_shares_get_shorter() {
        let queue = WorkQueue::new(0..1000, 1000, 3);
        let (mut all, mut lengths) = (Vec::new(), Vec::new());
        loop {
            let before = all.len();
            if !queue.take_share(&mut all) {
                break;
            }
            lengths.push(all.len() - before);
        }
        assert_eq!(all, (0..1000).collect::<Vec<_>>());
        assert!(lengths.is_sorted_by(|one, next| one >= next), "{lengths:?}");
        assert_eq!((lengths[0], lengths.last()), (16, Some(&1)));
    }
}
