//! Description of the camera, for views that are set by hand.

use std::path::PathBuf;

use glam::DVec3;
use hecs::{Entity, World};
use serde::Serialize;

use super::frame_keys::{FrameKeys, KeyPlace, name_of};
use crate::components::{Camera, Follow, LookAt, Name, Parent, Projection, Property, Space, View};
use crate::engine::{Engine, Ray};
use crate::scene::written_value;
use crate::systems::active_camera;

/// Distance of the point about which a view turns if nothing is in front of the camera, in scene units.
const DEFAULT_DISTANCE: f64 = 10.0;

/// The camera of a frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CameraView {
    /// The path of the camera in the scene, such as `camera` or `cameras.side`.
    pub path: String,
    /// The reason why another view is only looked from and not written; `None` for a camera that can be moved.
    pub look: Option<String>,
    /// Position of the eye.
    pub position: [f64; 3],
    /// The target or, for a camera with a direction, the visible point in the middle.
    pub target: [f64; 3],
    /// True if the camera has a direction in place of a target.
    pub has_direction: bool,
    /// The key of another position: the path of its list of keys, and its time in seconds of the keys. `None` without a track.
    pub position_key: Option<KeyPlace>,
    /// The key of another target or direction.
    pub target_key: Option<KeyPlace>,
    /// The direction that is up in the image.
    pub up: [f64; 3],
    /// Rotation about the view direction in radians.
    pub roll: f64,
    /// True in right-handed space, in which the image is not mirrored.
    pub right_handed: bool,
    /// True if rays are parallel.
    pub is_orthographic: bool,
    /// Width and height of a pixel, in scene units, at distance 1 along the view or, if rays are parallel, at any distance.
    pub pixel_size: [f64; 2],
}

impl CameraView {
    /// Describes the camera of a frame of a scene in files, or the view that is looked from. Returns the reason why there is no camera.
    pub(super) fn of(engine: &mut Engine, frame: u32, files: &[PathBuf]) -> Result<Self, String> {
        let time = engine.timeline.time_of(frame);
        engine.seek(time).map_err(|error| error.to_string())?;
        let world = engine.world();
        let missing = "the scene has no camera: write `camera: ()` in the file to move it here";
        let active = active_camera(world, time).ok_or(missing)?;
        let camera = world.get::<&Camera>(active.entity).map(|camera| *camera).map_err(|_| missing)?;
        let viewpoint = engine.settings.view;
        let keys = keys_of(world, active.entity, &camera, &FrameKeys::new(engine, frame, files));
        let look = match (&keys, viewpoint) {
            (Err(reason), _) => Some(reason.clone()),
            (Ok(_), Some(_)) => Some("this view is only looked from: reset it to move the camera".to_owned()),
            (Ok(_), None) => None,
        };
        let has_direction = look.is_none() && matches!(camera.view, View::Direction(_));
        let name = name_of(world, active.entity);
        let is_single = written_value(&["camera".to_owned()], files).is_some();
        let (position, up) = viewpoint.map_or((active.position, active.up), |view| (view.position, view.up));
        let own_target = || {
            let hit = engine.cast(Ray { origin: active.position, direction: active.view });
            let distance = hit.map_or(DEFAULT_DISTANCE, |hit| hit.point.distance(active.position));
            active.position + distance * active.view.normalize_or(DVec3::Z)
        };
        let target = viewpoint.map(|view| view.target).or(active.target).unwrap_or_else(own_target);
        let prepared = engine.prepared().ok_or(missing)?.camera();
        let [position_key, target_key] = keys.unwrap_or_default();
        Ok(Self {
            path: if is_single { "camera".to_owned() } else { format!("cameras.\"{name}\"") },
            look,
            position: position.to_array(),
            target: target.to_array(),
            has_direction,
            position_key,
            target_key,
            up: up.to_array(),
            roll: camera.roll,
            right_handed: world.query::<&Space>().iter().any(|space| *space == Space::RightHanded),
            is_orthographic: matches!(camera.projection, Projection::Orthographic { .. }),
            pixel_size: prepared.pixel_size(),
        })
    }
}

/// Returns the keys of another position, and of another target or direction, at a frame. Returns the reason why the camera cannot be moved by
/// hand.
fn keys_of(
    world: &World,
    entity: Entity,
    camera: &Camera,
    keys: &FrameKeys<'_>,
) -> Result<[Option<KeyPlace>; 2], String> {
    if let Some((field, other)) = tie(world, entity) {
        return Err(format!(
            "`{field}` ties this camera to {other}: replace it in the file by a position and a target of its own to move the \
             view here"
        ));
    }
    let target = if matches!(camera.view, View::Direction(_)) { Property::View } else { Property::Target };
    let key = |property| keys.place(world, entity, property, "this camera");
    Ok([key(Property::Position)?, key(target)?])
}

/// Returns the field that ties a camera to another entity, and the entity's name.
fn tie(world: &World, camera: Entity) -> Option<(&'static str, String)> {
    let looks = world.get::<&LookAt>(camera).map(|tie| ("look_at", tie.0));
    let follows = || world.get::<&Follow>(camera).map(|tie| ("follow", tie.0));
    let rides = || world.get::<&Parent>(camera).map(|tie| ("parent", tie.0));
    let (field, other) = looks.or_else(|_| follows()).or_else(|_| rides()).ok()?;
    let name =
        world.get::<&Name>(other).map_or_else(|_| "an entity".to_owned(), |name| format!("`{}`", name.0));
    Some((field, name))
}
