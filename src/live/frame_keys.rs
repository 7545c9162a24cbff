//! The keys by which values are set by hand at a frame.

use std::path::PathBuf;

use hecs::{Entity, World};

use crate::components::{Animated, Name, Property};
use crate::engine::Engine;
use crate::scene::WrittenTracks;

/// The path of a list of keys, and a time of the keys in seconds.
pub(super) type KeyPlace = (String, f64);

/// The keys of a frame of a scene in files.
pub(super) struct FrameKeys<'a> {
    files: &'a [PathBuf],
    /// The moment of the frame, and the time until the next one, in seconds.
    seconds: f64,
    interval: f64,
}

impl<'a> FrameKeys<'a> {
    pub(super) fn new(engine: &Engine, frame: u32, files: &'a [PathBuf]) -> Self {
        let rate = engine.timeline.rate;
        Self { files, seconds: rate.time_of(frame).seconds(), interval: 1.0 / rate.per_second() }
    }

    /// Returns the key of a property of an entity; `None` without a track. `noun` names the entity in errors, as in `this camera`.
    ///
    /// # Errors
    ///
    /// If the property is animated by something other than keys in the scene file, or the frame cannot have a key.
    pub(super) fn place(
        &self,
        world: &World,
        entity: Entity,
        property: Property,
        noun: &str,
    ) -> Result<Option<KeyPlace>, String> {
        let animated = world.get::<&Animated>(entity).ok();
        if !animated.is_some_and(|animated| animated.0.iter().any(|channel| channel.property == property)) {
            return Ok(None);
        }
        let (name, channel) = (name_of(world, entity), property.name());
        let tracks = WrittenTracks::of(self.files).tracks;
        let track = tracks.iter().find(|track| track.target == name && track.channel == channel).ok_or_else(|| {
            format!(
                "the {channel} of {noun} is not animated by keys in the scene file: move it where it is written, or replace its \
                 track by `Keys`"
            )
        })?;
        track.key_time(self.seconds, self.interval).map(|time| Some((track.path.clone(), time)))
    }
}

/// Returns the name of an entity; empty for one without a name.
pub(super) fn name_of(world: &World, entity: Entity) -> String {
    world.get::<&Name>(entity).map(|name| name.0.clone()).unwrap_or_default()
}
