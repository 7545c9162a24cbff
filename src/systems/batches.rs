//! Distributes entities over threads in batches.

use rayon::prelude::*;

/// The number of entities in a batch.
pub(super) const BATCH: u32 = 1024;

/// Processes `count` entities in batches, on the threads of the current rayon pool if there are more than two full batches. The results are
/// in the order of the batches.
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
