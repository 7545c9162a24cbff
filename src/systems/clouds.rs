//! Sets clouds to the particles of a moment.

use hecs::{Entity, World};

use super::{Changes, Interrupted};
use crate::components::{Cloud, CloudSource, Name};
use crate::time::Time;

/// A cloud without particles at a moment, as when its file cannot be read.
#[derive(Clone, Debug)]
pub(crate) struct CloudFailure {
    /// The place of the cloud in a scene, and its name.
    pub(crate) cloud: String,
    /// The moment, in seconds.
    pub(crate) seconds: f64,
    pub(crate) message: String,
}

/// Sets every cloud with a source to its particles at `time`, and records the changes.
pub(super) fn update_clouds(world: &mut World, time: Time, changes: &mut Changes) -> Result<(), Interrupted> {
    let mut lacking: Vec<(Entity, Cloud)> = Vec::new();
    let sourced = world.query_mut::<(Entity, &CloudSource, Option<&mut Cloud>, Option<&Name>)>();
    for (entity, source, cloud, name) in sourced {
        let particles = source.particles.at(time).map_err(|message| {
            let name = name.map_or_else(|| "a cloud".to_owned(), |name| format!("the cloud {:?}", name.0));
            let cloud = format!("{}{name}", source.place);
            Interrupted::Cloud(Box::new(CloudFailure { cloud, seconds: time.seconds(), message }))
        })?;
        match cloud {
            Some(cloud) if *cloud == particles => {}
            Some(cloud) => {
                *cloud = particles;
                changes.mark_shape(entity);
            }
            None => lacking.push((entity, particles)),
        }
    }
    for (entity, particles) in lacking {
        // The entity exists: the query above found it.
        let _ = world.insert_one(entity, particles);
        changes.mark_all();
    }
    Ok(())
}
