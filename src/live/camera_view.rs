//! Description of the camera, for views that are set by hand.

use glam::DVec3;
use serde::Serialize;

use crate::components::{Animated, Camera, Channel, LookAt, Name, Property, Space, View};
use crate::engine::{Engine, EngineError, Ray};
use crate::systems::active_camera;
use crate::time::Time;

/// Distance of the point about which a view turns if nothing is in front of the camera, in scene units.
const DEFAULT_DISTANCE: f64 = 10.0;

/// The camera of a frame, in the camera's own space.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CameraView {
    /// The path of the camera in the scene, such as `camera` or `cameras.side`.
    pub path: String,
    /// Position of the eye.
    pub position: [f64; 3],
    /// The target or, for a camera with a direction, the visible point in the middle.
    pub target: [f64; 3],
    /// True if the camera has a direction in place of a target.
    pub has_direction: bool,
    /// The direction that is up in the image.
    pub up: [f64; 3],
    /// True in right-handed space, in which the image is not mirrored.
    pub right_handed: bool,
}

impl CameraView {
    /// Describes the camera of a moment. `None` in a world without cameras, and for a camera that is animated or looks at an entity.
    /// `is_single` is true if the scene has a `camera` in place of `cameras`.
    pub(super) fn of(engine: &mut Engine, time: Time, is_single: bool) -> Result<Option<Self>, EngineError> {
        engine.seek(time)?;
        let world = engine.world();
        let Some(active) = active_camera(world, time) else { return Ok(None) };
        let moves = |channel: &Channel| {
            matches!(channel.property, Property::Position | Property::Target | Property::View)
        };
        let is_animated =
            world.get::<&Animated>(active.entity).is_ok_and(|animated| animated.0.iter().any(moves));
        if is_animated || world.get::<&LookAt>(active.entity).is_ok() {
            return Ok(None);
        }
        let Ok(camera) = world.get::<&Camera>(active.entity).map(|camera| *camera) else { return Ok(None) };
        let name = world.get::<&Name>(active.entity).map(|name| name.0.clone()).unwrap_or_default();
        let path = if is_single { "camera".to_owned() } else { format!("cameras.\"{name}\"") };
        let right_handed = world.query::<&Space>().iter().any(|space| *space == Space::RightHanded);
        let target = match camera.view {
            View::Target(target) => target,
            View::Direction(direction) => {
                let hit = engine.cast(Ray { origin: camera.position, direction });
                let distance = hit.map_or(DEFAULT_DISTANCE, |hit| hit.point.distance(camera.position));
                camera.position + distance * direction.normalize_or(DVec3::Z)
            }
        };
        Ok(Some(Self {
            path,
            position: camera.position.to_array(),
            target: target.to_array(),
            has_direction: matches!(camera.view, View::Direction(_)),
            up: camera.up.to_array(),
            right_handed,
        }))
    }
}
