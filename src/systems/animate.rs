//! Evaluates motions at a moment.

use hecs::{Entity, World};

use super::Changes;
use super::batches::{BATCH, in_batches};
use super::property::declare;
use super::property_access::{Parts, PartsQuery};
use crate::components::Animated;
use crate::time::Time;

type Moving<'a> = (Entity, &'a Animated, PartsQuery<'a>);

/// Sets every animated value to the value of its motion at `time`, and records the changes.
///
/// A channel has no effect if the entity does not have the value, or if the motion is of another kind than the value. Many entities are
/// distributed over the threads of the current rayon pool; the recorded changes do not depend on the distribution.
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
                    declare(channel.property, entity, parts.camera.is_some(), &mut changes);
                }
            }
        }
        changes
    });
    for batch in &written {
        changes.merge(batch);
    }
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec3};

    use super::*;
    use crate::animation::{Easing, Key, Track, Value};
    use crate::components::{Channel, Motion, Property, Transform};
    use crate::systems::{propagate, value};

    fn ramp(from: f64, to: f64) -> Track<DVec3> {
        let key = |time, value| Key { time, value: DVec3::splat(value), easing: Easing::Linear };
        Track::new(vec![key(0.0, from), key(1.0, to)]).unwrap()
    }

    /// Returns a world with enough entities for several batches, in two archetypes; every third entity does not move.
    fn crowd() -> World {
        let mut world = World::new();
        for index in 0..5000 {
            let to = if index % 3 == 0 { 0.0 } else { f64::from(index) };
            let animated = Animated(vec![Channel::new(Property::Translation, ramp(0.0, to))]);
            let entity = world.spawn((Transform::IDENTITY, animated));
            if index % 2 == 0 {
                world.insert_one(entity, index).unwrap();
            }
        }
        propagate(&mut world, &Changes::all());
        world
    }

    #[test]
    fn threads_do_not_change_values_or_reads() {
        let run = |threads| {
            let mut world = crowd();
            let mut changes = Changes::default();
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let moved = pool.install(|| {
                animate(&mut world, Time::from_ratio(1, 2).unwrap(), &mut changes);
                propagate(&mut world, &changes)
            });
            let values: Vec<_> = world
                .query_mut::<(Entity, &Transform, &crate::components::WorldTransform)>()
                .into_iter()
                .map(|(entity, transform, derived)| (entity, *transform, *derived))
                .collect();
            (moved, values)
        };
        let (moved, values) = run(1);
        let halfway =
            |entity: &Entity| if entity.id().is_multiple_of(3) { 0.0 } else { 0.5 * f64::from(entity.id()) };
        assert_eq!(moved.len(), 5000 - 5000_usize.div_ceil(3));
        for (entity, transform, derived) in &values {
            assert_eq!(transform.translation, DVec3::splat(halfway(entity)));
            assert_eq!(derived.affine.translation, transform.translation);
        }
        for threads in [2, 3] {
            assert_eq!(run(threads), (moved.clone(), values.clone()));
        }
    }

    #[test]
    fn motions_of_other_kinds_and_missing_components_do_nothing() {
        let mut world = World::new();
        let channels = vec![
            Channel::new(Property::Rotation, ramp(1.0, 2.0)),
            Channel::new(Property::Ka, ramp(1.0, 2.0)),
        ];
        let entity = world.spawn((Transform::IDENTITY, Animated(channels)));
        let mut changes = Changes::default();
        animate(&mut world, Time::ZERO, &mut changes);
        assert!(changes.transforms().is_empty() && changes.materials().is_empty());
        assert_eq!(value(&world, entity, Property::Rotation), Some(Value::Rotation(DQuat::IDENTITY)));
        assert_eq!(value(&world, entity, Property::Ka), None);
    }

    #[test]
    fn motions_have_values_of_their_kind() {
        let motion = Motion::from(ramp(1.0, 3.0));
        assert_eq!(motion.at(0.5), Some(Value::Vector(DVec3::splat(2.0))));
        assert_eq!(motion.at(0.5).map(Value::kind), Some(Property::Translation.kind()));
    }
}
