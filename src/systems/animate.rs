//! Writes what motions say about a moment.

use hecs::{Entity, World};

use super::Changes;
use super::batches::{BATCH, in_batches};
use super::property::{Parts, PartsQuery, declare};
use crate::components::Animated;
use crate::time::Time;

type Moving<'a> = (Entity, &'a Animated, PartsQuery<'a>);

/// Sets every animated value to what its motion says about `time`, and records what really changed.
///
/// A channel whose value the entity lacks, or whose motion is of another kind than its value, does nothing. Many entities
/// are shared out among the current rayon pool's threads; the record does not depend on how.
pub fn animate(world: &mut World, time: Time, changes: &mut Changes) {
    let seconds = time.seconds();
    let (count, moving) = (world.len(), world.query_mut::<Moving<'_>>().into_iter_batched(BATCH));
    let written = in_batches(count, moving, |batch| {
        let mut changes = Changes::default();
        for (entity, animated, parts) in batch {
            let mut parts = Parts::new(parts);
            for channel in &animated.0 {
                let differs =
                    channel.motion.at(seconds).is_some_and(|value| parts.set(channel.property, value));
                if differs {
                    declare(channel.property, entity, &mut changes);
                }
            }
        }
        changes
    });
    for batch in &written {
        changes.merge(batch);
    }
}
