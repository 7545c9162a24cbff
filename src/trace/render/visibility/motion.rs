//! The motion of shapes on the screen, from instant to instant of an open shutter.
//!
//! Between the images of a shape at two instants, there may be pixels that the shape crosses unnoticed, however large it is: a ball that moves by
//! its diameter leaves out those at the rim of its path.

use std::f64::consts::PI;

use glam::{DVec2, DVec3, DVec4, Vec2Swizzles, Vec4, Vec4Swizzles};
use rayon::prelude::*;

use super::outline::{Outline, TileRays};
use super::tile_rays;
use crate::trace::rays::ShapeId;
use crate::trace::scene::{PreparedCamera, PreparedScene, ShapeRef};
use crate::trace::shapes::Bounds;
use crate::trace::stages::Tile;

/// The longest step of a wide shape, in pixels. An upright square that moves along its diagonal leaves out triangles with legs of 1.4 pixels;
/// a pixel needs legs of 2. The rest is for sharper corners.
const STEP: f64 = 2.0;

/// The motion of all shapes from instant to instant.
#[derive(Clone, Debug, Default)]
pub(crate) struct MotionTracker {
    /// The boxes around the images of all shapes at the last instant.
    before: Option<Vec<Vec4>>,
    /// The most steps that a shape needs between two instants.
    steps: u32,
}

impl MotionTracker {
    /// Returns the number of equal steps into which all ways must be divided so that the images of no shape leave out a pixel.
    pub(crate) fn steps(&self) -> u32 {
        self.steps.max(1)
    }

    /// Adds the next instant.
    pub(crate) fn add(&mut self, scene: &PreparedScene, camera: &PreparedCamera) {
        let geometry = scene.geometry();
        let (columns, rows) = camera.resolution();
        let film = DVec2::new(columns.into(), rows.into()).as_vec2() / 2.0;
        // Beyond the film, motions do not matter. Near the plane of the eye, they are long.
        let around = (film + 1.0).xyxy();
        let box_of = |id: &ShapeId| {
            let bounds = geometry.bounds(*id)?;
            Some(screen_box(camera, &bounds)?.clamp(-around, around))
        };
        let ids: Vec<ShapeId> = geometry.ids().collect();
        let now: Vec<Vec4> = ids.par_iter().map(|id| box_of(id).unwrap_or(Vec4::NAN)).collect();
        let rays = Tile::all(camera.resolution()).next().and_then(|tile| tile_rays(camera, &tile));
        if let (Some(before), Some(rays)) = (&self.before, rays) {
            let steps = |(id, (before, now)): (&ShapeId, (&Vec4, &Vec4))| {
                let (least, most) = (before.min(*now).xy(), before.max(*now).zw());
                let crosses_film = least.cmplt(film).all() && most.cmpgt(-film).all();
                if crosses_film { steps_of(geometry.shape(*id), &rays, *now - *before) } else { 1 }
            };
            let steps = ids.par_iter().zip(before.par_iter().zip(&now)).map(steps).max();
            self.steps = self.steps.max(steps.unwrap_or(1));
        }
        self.before = Some(now);
    }
}

/// Returns the box around the image of a shape: its least and its greatest column and row, from the middle of the film. `None` unless all of
/// it is before the eye.
fn screen_box(camera: &PreparedCamera, Bounds { min, max }: &Bounds) -> Option<Vec4> {
    let steps = camera.steps().map(|step| step / step.length_squared());
    let (mut least, mut most) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for corner in 0..8 {
        let axis = |axis: usize| if corner >> axis & 1 == 1 { max[axis] } else { min[axis] };
        let point = DVec3::new(axis(0), axis(1), axis(2));
        let depth = camera.depth_of(point);
        if depth.is_nan() || depth <= 0.0 {
            return None;
        }
        let on_screen = (point - camera.position()) * (camera.distance() / depth);
        let place = DVec2::from(steps.map(|step| on_screen.dot(step)));
        (least, most) = (least.min(place), most.max(place));
    }
    Some(DVec4::new(least.x, least.y, most.x, most.y).as_vec4())
}

/// Returns the number of steps into which the way of a shape must be divided, given the motion of the box around its image.
fn steps_of(shape: ShapeRef<'_>, rays: &TileRays, moved: Vec4) -> u32 {
    let way = f64::from(moved.xy().length().max(moved.zw().length()));
    if way.is_nan() || way <= 1.0 {
        return 1;
    }
    let Ok(Some(outline)) = Outline::of(shape, rays) else { return 1 };
    // The outline's area is at most the width of a shape that is longer than a pixel.
    let width = outline.area.min(2.0 * (outline.area / PI).sqrt());
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
    let steps = (way / (1.0 + 0.5 * width).min(STEP)).ceil() as u32;
    steps
}
