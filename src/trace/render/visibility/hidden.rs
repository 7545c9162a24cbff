//! Images of small shapes in mirrors and glass, whose pixels geometry cannot determine.

use glam::DVec3;

use crate::trace::rays::ShapeId;
use crate::trace::scene::{PreparedCamera, PreparedScene, RayClass};
use crate::trace::shading::most_radiance;
use crate::trace::shapes::Bounds;

/// The image of a shape in another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Image {
    /// Approximate area in pixels.
    pub(crate) area: f64,
    /// Upper bound of its radiance in any channel.
    pub(crate) radiance: f32,
    /// Number of images that this one represents.
    pub(crate) count: f64,
}

/// Maximum area of an image. Samples of some pixel hit larger images if they are visible.
const LARGEST: f64 = 64.0;
/// Maximum number of shape pairs examined. Beyond it, some pairs represent others.
const PAIRS: usize = 1 << 16;

/// Returns images, of at most a few pixels, of shapes in mirrors and glass that a picture may show. Their sizes are estimates. A convex
/// mirror of radius R scales the image of a shape at distance D by about R/(2 D). An unbounded mirror shows a shape about as large as the
/// camera sees it directly.
pub(crate) fn hidden_images(scene: &PreparedScene, camera: &PreparedCamera) -> Vec<Image> {
    fn ids(scene: &PreparedScene) -> impl Iterator<Item = ShapeId> {
        scene.unbounded.iter().copied().chain(scene.leaves.ids())
    }
    let sends_on = |id: &ShapeId| scene.material(*id).continues();
    let mirrors: Vec<ShapeId> = ids(scene).filter(sends_on).collect();
    let shown: Vec<(ShapeId, Ball)> = ids(scene.seen_by(RayClass::Secondary))
        .filter_map(|id| Some((id, Ball::around(&scene.geometry().bounds(id)?))))
        .collect();
    let [right, down] = camera.steps().map(DVec3::length);
    // Length in pixels of a unit length at unit distance.
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
                        camera.reduction(mirror.middle),
                        mirror.middle.distance(ball.middle).max(mirror.radius),
                    );
                    ball.radius * (mirror.radius / (2.0 * far)).min(1.0) / near
                }
                None => ball.radius / camera.reduction(ball.middle),
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

/// A ball approximating a shape's bounds.
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
