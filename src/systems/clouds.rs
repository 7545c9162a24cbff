//! Sets clouds to the particles of a moment.

use hecs::{Entity, World};

use super::{Changes, CloudFailure, Interrupted};
use crate::components::{AtParticle, Cloud, CloudSource, Name, Parent, Transform};
use crate::time::Time;

/// Sets every cloud with a source to its particles at `time`, and records the changes.
pub(super) fn update_clouds(world: &mut World, time: Time, changes: &mut Changes) -> Result<(), Interrupted> {
    let mut lacking: Vec<(Entity, Cloud)> = Vec::new();
    let mut failure = None;
    for (entity, source, cloud) in world.query_mut::<(Entity, &CloudSource, Option<&mut Cloud>)>() {
        let particles = match source.particles.at(time) {
            Ok(particles) => particles,
            Err(message) => {
                failure = Some((entity, message));
                break;
            }
        };
        match cloud {
            Some(cloud) if *cloud == particles => {}
            Some(cloud) => {
                *cloud = particles;
                changes.mark_shape(entity);
            }
            None => lacking.push((entity, particles)),
        }
    }
    if let Some((entity, message)) = failure {
        let cloud = name_of(world, entity);
        return Err(Interrupted::Cloud(Box::new(CloudFailure { cloud, seconds: time.seconds(), message })));
    }
    for (entity, particles) in lacking {
        // The entity exists: the query above found it.
        let _ = world.insert_one(entity, particles);
        changes.mark_all();
    }
    move_riders(world, time, changes)
}

/// Moves the entities that are at particles of clouds.
fn move_riders(world: &mut World, time: Time, changes: &mut Changes) -> Result<(), Interrupted> {
    let riders = world.query_mut::<hecs::With<(Entity, &AtParticle, &Parent), &Transform>>().into_iter();
    let riders: Vec<(Entity, u64, Entity)> =
        riders.map(|(entity, AtParticle(number), Parent(cloud))| (entity, *number, *cloud)).collect();
    for (entity, number, cloud) in riders {
        let position = world.get::<&Cloud>(cloud).ok().and_then(|cloud| cloud.position(number));
        let Some(position) = position.filter(|position| position.is_finite()) else {
            return Err(Interrupted::Cloud(Box::new(CloudFailure {
                cloud: name_of(world, cloud),
                seconds: time.seconds(),
                message: format!("there is no particle {number} to be followed: let the filter keep it"),
            })));
        };
        if let Ok(mut transform) = world.get::<&mut Transform>(entity)
            && transform.translation != position
        {
            transform.translation = position;
            changes.mark_transform(entity);
        }
    }
    Ok(())
}

/// Returns the place and the name of a cloud.
fn name_of(world: &World, cloud: Entity) -> String {
    let place =
        world.get::<&CloudSource>(cloud).map_or_else(|_| String::new(), |source| source.place.to_string());
    match world.get::<&Name>(cloud) {
        Ok(name) => format!("{place}the cloud {:?}", name.0),
        Err(_) => format!("{place}a cloud"),
    }
}
