//! Many entities on many threads.

use rayon::prelude::*;

/// Entities that one thread takes at once.
pub(super) const BATCH: u32 = 1024;

/// Goes through batches of `count` entities, on the current rayon pool's threads if they are worth waking. The results are in
/// the batches' order.
pub(super) fn in_batches<B: Send, R: Send>(
    count: u32,
    batches: impl Iterator<Item = B>,
    run: impl Fn(B) -> R + Send + Sync,
) -> Vec<R> {
    if count <= 2 * BATCH {
        return batches.map(run).collect();
    }
    let batches: Vec<B> = batches.collect();
    batches.into_par_iter().map(run).collect()
}
