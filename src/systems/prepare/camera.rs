//! The active camera of a moment.

use glam::DVec3;
use hecs::{Component, Entity, World};

use super::settings::{first, first_entity};
use super::{RenderSettings, Viewpoint};
use crate::components::{
    Camera, FilmSettings, FocusOn, Follow, LookAt, Projection, Sampling, Shots, Space, View, WorldTransform,
};
use crate::time::Time;
use crate::trace;

/// Returns the prepared active camera of the frame at `moment`, seen from a viewpoint if there is one.
pub(super) fn prepared_camera(
    world: &World,
    film: FilmSettings,
    moment: Time,
    viewpoint: Option<Viewpoint>,
) -> trace::PreparedCamera {
    let entity = active_camera_entity(world, moment);
    let camera = component::<Camera>(world, entity).unwrap_or_default();
    let CameraPose { eye, view, up, .. } = match viewpoint {
        Some(Viewpoint { position, target, up }) => {
            CameraPose { eye: position, view: target - position, up, looks_at_point: true }
        }
        None => pose(world, entity, &camera),
    };
    // The centres of the first and the last pixel lie on the edges of the screen, so the screen spans one pixel pitch less than there are
    // pixels.
    let gaps = |pixels: u32| f64::from(pixels.saturating_sub(1).max(1));
    let (across, down) = (gaps(film.width), gaps(film.height));
    let square = |pitch: f64| (pitch * across, pitch * down);
    let pitch = |angle: f64, pixels: u32| 2.0 * libm::tan(0.5 * angle) / f64::from(pixels);
    let (distance, size) = match camera.projection {
        Projection::Screen { distance, width, height } => {
            (distance, (width.unwrap_or(height / down * across), height))
        }
        Projection::FieldOfView { vertical } => (1.0, square(pitch(vertical, film.height))),
        Projection::HorizontalFieldOfView { horizontal } => (1.0, square(pitch(horizontal, film.width))),
        Projection::Orthographic { height } => (1.0, square(height / f64::from(film.height))),
    };
    let resolution = (film.width, film.height);
    let mut prepared = trace::PreparedCamera::new(eye, view, up, distance, size, resolution);
    if first::<Space>(world) == Space::RightHanded {
        prepared = prepared.right_handed();
    }
    if let Projection::Orthographic { .. } = camera.projection {
        prepared = prepared.orthographic();
    }
    let prepared = prepared.rolled(camera.roll);
    camera.lens.map_or(prepared, |lens| {
        let focused = position_of(world, component::<FocusOn>(world, entity).map(|FocusOn(entity)| entity));
        let depth = focused.map(|point| prepared.depth_of(point));
        let depth = depth.filter(|depth| *depth > 0.0 && depth.is_finite());
        prepared.with_lens(lens.aperture, depth.unwrap_or(lens.focus))
    })
}

/// Returns the prepared active camera of the frame at `moment`, whatever the viewpoint. The world must be at that moment.
#[cfg(feature = "live")]
pub(crate) fn scene_camera(world: &World, film: FilmSettings, moment: Time) -> trace::PreparedCamera {
    prepared_camera(world, film, moment, None)
}

/// The active camera of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActiveCamera {
    /// The entity with the camera.
    pub entity: Entity,
    /// The position of its target in the world, if it looks at a point.
    pub target: Option<DVec3>,
    /// The position of its eye in the world.
    pub position: DVec3,
    /// The direction of its view in the world, of any length.
    pub view: DVec3,
    /// The direction that is up in its image, in the world.
    pub up: DVec3,
}

/// Returns the active camera of the frame at `moment`. The world must be at that moment. `None` in a world without cameras.
#[must_use]
pub fn active_camera(world: &World, moment: Time) -> Option<ActiveCamera> {
    let entity = active_camera_entity(world, moment)?;
    let camera = component::<Camera>(world, Some(entity))?;
    let CameraPose { eye, view, up, looks_at_point } = pose(world, Some(entity), &camera);
    Some(ActiveCamera { entity, target: looks_at_point.then_some(eye + view), position: eye, view, up })
}

/// Returns the entity whose camera is active in the frame at `moment`: the camera of the shot, or else the first camera in document order.
pub(super) fn active_camera_entity(world: &World, moment: Time) -> Option<Entity> {
    let shots = first::<Shots>(world).0;
    let started = shots.partition_point(|shot| shot.start <= moment.seconds());
    let shot = shots.get(started.saturating_sub(1)).map(|shot| shot.camera);
    shot.filter(|camera| world.satisfies::<&Camera>(*camera)).or_else(|| first_entity::<Camera>(world))
}

/// Returns the position of an entity in the world.
pub(super) fn position_of(world: &World, entity: Option<Entity>) -> Option<DVec3> {
    component::<WorldTransform>(world, entity).map(|transform| transform.affine.translation)
}

fn component<T: Component + Copy>(world: &World, entity: Option<Entity>) -> Option<T> {
    world.get::<&T>(entity?).ok().map(|component| *component)
}

/// The pose of a camera in the world.
struct CameraPose {
    eye: DVec3,
    view: DVec3,
    up: DVec3,
    looks_at_point: bool,
}

fn pose(world: &World, entity: Option<Entity>, camera: &Camera) -> CameraPose {
    let followed = position_of(world, component::<Follow>(world, entity).map(|Follow(entity)| entity));
    let looked_at = position_of(world, component::<LookAt>(world, entity).map(|LookAt(entity)| entity));
    let outer = component::<WorldTransform>(world, entity).map(|transform| transform.affine);
    let direction = |own: DVec3| outer.map_or(own, |outer| outer.transform_vector3(own));
    let own_eye = outer.map_or(camera.position, |outer| outer.transform_point3(camera.position));
    let eye = followed.map_or(own_eye, |followed| own_eye + followed);
    let view = match (looked_at, camera.view) {
        (Some(point), _) => point - eye,
        // Eye and target are translated together, so their difference is the transformed difference of the untranslated points.
        (None, View::Target(target)) => direction(target - camera.position),
        (None, View::Direction(own)) => direction(own),
    };
    let looks_at_point = looked_at.is_some() || matches!(camera.view, View::Target(_));
    CameraPose { eye, view, up: direction(camera.up), looks_at_point }
}

/// The exposure of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shutter {
    /// A single instant: the camera has no shutter.
    None,
    /// A single instant: the number of instants is 1, or pixels have one sample.
    OneInstant,
    /// Open for a fraction of the frame interval, with this number of instants, more than one.
    Open(f64, u32),
}

/// The exposure of all frames, read from the world.
#[derive(Clone, Debug)]
pub(crate) struct Shutters {
    /// The start of each shot in seconds, ascending, and the fraction of the frame interval during which its shutter is open; 0 without a
    /// shutter.
    shots: Vec<(f64, f64)>,
    /// The open fraction of the shutter if there are no shots.
    single: f64,
    sampling: Sampling,
}

impl Shutters {
    #[must_use]
    pub(crate) fn of(world: &World) -> Self {
        let camera = |entity| component::<Camera>(world, entity).unwrap_or_default();
        let open =
            |entity| camera(entity).shutter.filter(|open| *open > 0.0).map_or(0.0, |open| open.min(1.0));
        let shots = first::<Shots>(world).0;
        Self {
            shots: shots.iter().map(|shot| (shot.start, open(Some(shot.camera)))).collect(),
            single: open(first_entity::<Camera>(world)),
            sampling: first(world),
        }
    }

    /// Returns the exposure of the frame at `moment`, with the sampling as overridden by `settings`.
    #[must_use]
    pub(crate) fn at(&self, moment: Time, settings: &RenderSettings) -> Shutter {
        let started = self.shots.partition_point(|(start, _)| *start <= moment.seconds());
        let open = self.shots.get(started.saturating_sub(1)).map_or(self.single, |(_, open)| *open);
        let Sampling { samples, instants, .. } = settings.sampling(self.sampling);
        match instants.min(samples) {
            _ if open == 0.0 => Shutter::None,
            1 => Shutter::OneInstant,
            instants => Shutter::Open(open, instants),
        }
    }
}
