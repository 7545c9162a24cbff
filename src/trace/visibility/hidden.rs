//! Images of small things in mirrors and glass: geometry does not know in which pixels they are.

use glam::DVec3;

use crate::trace::light::most_radiance;
use crate::trace::rays::ShapeId;
use crate::trace::scene::{Camera, PreparedScene};
use crate::trace::shapes::Bounds;

/// The image of a shape in another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Image {
    /// About how many pixels it covers.
    pub(crate) area: f64,
    /// A bound of its radiance, in any channel.
    pub(crate) radiance: f32,
    /// The number of images that it stands for.
    pub(crate) count: f64,
}

/// Larger images are met by samples of some pixel, if they are to be seen at all.
const LARGEST: f64 = 64.0;
/// More pairs of shapes are not looked at one by one: some stand for others.
const PAIRS: usize = 1 << 16;

/// Returns the images that a picture may show of shapes in mirrors and glass that are at most a few pixels large. They are estimates: a convex
/// mirror of radius R makes an image of about R/(2 D) of the size of what is D away from it, and any other one an image as large as it would
/// look as far away as the light's path is long.
pub(crate) fn hidden_images(scene: &PreparedScene, camera: &Camera) -> Vec<Image> {
    let ids = || scene.beside.iter().copied().chain(scene.leaves.ids());
    let sends_on = |id: &ShapeId| scene.material(*id).continues();
    let mirrors: Vec<ShapeId> = ids().filter(sends_on).collect();
    let shown: Vec<(ShapeId, Ball)> =
        ids().filter_map(|id| Some((id, Ball::around(&scene.geometry().bounds(id)?)))).collect();
    let [right, down] = camera.steps().map(DVec3::length);
    // Pixels of a length of 1 at a distance of 1.
    let pixels = camera.distance() / right.min(down);
    let stride = (mirrors.len() * shown.len()).div_ceil(PAIRS).max(1);
    let mut images = Vec::new();
    for (index, mirror) in mirrors.iter().enumerate() {
        let material = scene.material(*mirror);
        let share = material.reflected + material.refraction.map_or(0.0, |refraction| refraction.transmitted);
        let around = scene.geometry().bounds(*mirror).map(|bounds| Ball::around(&bounds));
        for (id, ball) in shown.iter().skip(index % stride).step_by(stride).filter(|(id, _)| id != mirror) {
            let radius = match &around {
                Some(mirror) => {
                    let (near, far) = (
                        mirror.middle.distance(camera.position()),
                        mirror.middle.distance(ball.middle).max(mirror.radius),
                    );
                    ball.radius * (mirror.radius / (2.0 * far)).min(1.0) / near
                }
                None => ball.radius / ball.middle.distance(camera.position()),
            };
            let area = std::f64::consts::PI * (pixels * radius) * (pixels * radius);
            if area > 0.0 && area < LARGEST {
                let radiance = share.min(1.0) * most_radiance(scene, scene.material(*id));
                images.push(Image { area, radiance, count: stride as f64 });
            }
        }
    }
    images
}

/// A ball in the bounds of a shape.
struct Ball {
    middle: DVec3,
    radius: f64,
}

impl Ball {
    fn around(bounds: &Bounds) -> Self {
        let size = bounds.max - bounds.min;
        Self { middle: bounds.min.midpoint(bounds.max), radius: size.element_sum() / 6.0 }
    }
}
