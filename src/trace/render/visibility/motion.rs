//! The motion of shapes on the screen, from instant to instant of an open shutter.
//!
//! A shape may skip pixels between two instants: it shows in them, but not at either instant. This happens to large shapes, too: a ball that
//! moves by its diameter skips pixels at the rim of its path.

use std::f64::consts::PI;

use glam::{DVec2, DVec3, DVec4, UVec2, Vec2, Vec2Swizzles, Vec4, Vec4Swizzles};
use rayon::prelude::*;

use super::outline::{Outline, TileRays};
use super::{WIDEST, confusion, tile_rays};
use crate::color::to_f32;
use crate::trace::rays::ShapeId;
use crate::trace::scene::{PreparedCamera, PreparedScene, ShapeRef};
use crate::trace::shapes::Bounds;
use crate::trace::stages::{TILE, Tile};

/// The longest step of a wide shape, in pixels. An upright square that moves along its diagonal skips triangles with legs of 1.4 pixels; a
/// pixel fits if they are 2 pixels long. The margin is for sharper corners.
const STEP: f64 = 2.0;

/// The motion of all shapes from instant to instant.
#[derive(Clone, Debug)]
pub(crate) struct MotionTracker {
    resolution: (u32, u32),
    /// The boxes around the images of all shapes at the last instant.
    before: Option<Vec<Vec4>>,
    /// The largest number of [steps](Self::steps) between two instants, by tile.
    steps: Vec<u32>,
}

impl MotionTracker {
    /// Creates the tracker of a film with some columns and rows.
    pub(crate) fn new(resolution: (u32, u32)) -> Self {
        Self { resolution, before: None, steps: vec![1; Tile::all(resolution).count()] }
    }

    /// Returns, for each tile, the number of equal steps into which each interval between two instants must be divided so that no shape skips
    /// any of its pixels.
    pub(crate) fn steps(&self) -> &[u32] {
        &self.steps
    }

    /// Adds the next instant.
    pub(crate) fn add(&mut self, scene: &PreparedScene, camera: &PreparedCamera) {
        let geometry = scene.geometry();
        let film = UVec2::from(self.resolution).as_vec2() / 2.0;
        // Displacements beyond the film do not matter, and are large near the plane of the eye.
        let around = (film + 1.0).xyxy();
        let box_of = |id: &ShapeId| {
            let bounds = geometry.bounds(*id)?;
            let blur = if camera.has_lens() { confusion(scene, camera, *id) } else { 0.0 };
            let margin = 1.0 + to_f32(blur.min(WIDEST));
            let outwards = Vec4::new(-margin, -margin, margin, margin);
            Some((screen_box(camera, &bounds)? + outwards).clamp(-around, around))
        };
        let ids: Vec<ShapeId> = geometry.ids().collect();
        let now: Vec<Vec4> = ids.par_iter().map(|id| box_of(id).unwrap_or(Vec4::NAN)).collect();
        let rays = Tile::all(self.resolution).next().and_then(|tile| tile_rays(camera, &tile));
        if let (Some(before), Some(rays)) = (&self.before, rays) {
            let fast = |(id, (before, now)): (&ShapeId, (&Vec4, &Vec4))| {
                let displacement = *now - *before;
                // The exposure begins before the first instant, and ends after the last.
                let (start, end) = (*before - displacement, *now + displacement);
                let (least, most) = (start.min(end).xy(), start.max(end).zw());
                let crosses_film = least.cmplt(film).all() && most.cmpgt(-film).all();
                let steps = if crosses_film { steps_of(geometry.shape(*id), &rays, displacement) } else { 1 };
                (steps > 1).then_some((steps, [least + film, most + film]))
            };
            let fast: Vec<(u32, [Vec2; 2])> =
                ids.par_iter().zip(before.par_iter().zip(&now)).filter_map(fast).collect();
            fast.into_iter().for_each(|(steps, path)| self.divide(path, steps));
        }
        self.before = Some(now);
    }

    /// Divides the intervals into at least some number of steps in the tiles of a shape's path, given the box around it in pixels.
    fn divide(&mut self, path: [Vec2; 2], steps: u32) {
        let (columns, rows) = self.resolution;
        let across = columns.div_ceil(TILE);
        let [first, last] = path.map(|corner| {
            let place = corner.as_uvec2().min(UVec2::new(columns - 1, rows - 1)) / TILE;
            [place.x, place.y].map(|place| place as usize)
        });
        for row in first[1]..=last[1] {
            let tiles = &mut self.steps[row * across as usize..];
            tiles[first[0]..=last[0]].iter_mut().for_each(|most| *most = steps.max(*most));
        }
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

/// Returns the number of steps into which a shape's motion must be divided, given the displacement of the box around its image.
fn steps_of(shape: ShapeRef<'_>, rays: &TileRays, displacement: Vec4) -> u32 {
    let distance = f64::from(displacement.xy().length().max(displacement.zw().length()));
    if distance.is_nan() || distance <= 1.0 {
        return 1;
    }
    let Ok(Some(outline)) = Outline::of(shape, rays) else { return 1 };
    // The outline's area is at most the width of a shape that is longer than a pixel.
    let width = outline.area.min(2.0 * (outline.area / PI).sqrt());
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
    let steps = (distance / (1.0 + 0.5 * width).min(STEP)).ceil() as u32;
    steps
}
