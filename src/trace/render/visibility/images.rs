//! Images of small shapes in mirrors and glass, and small highlights.
//!
//! A plane, a face of a box or the outside of a sphere shows a point at one place, which geometry finds: such images are features of their
//! pixels, and so are highlights. The pixels of other images are unknown: those in rods and ellipsoids, in glass, through a lens or with an
//! open shutter. Images of several reflections are not searched.

use glam::DVec3;
use rayon::prelude::*;

use super::mirror::{Ball, Mirror, pixel_size};
use super::{Feature, LARGE};
use crate::color::to_f32;
use crate::trace::intersect::Scratch;
use crate::trace::rays::ShapeId;
use crate::trace::scene::{LightSource, PreparedCamera, PreparedLight, PreparedScene};
use crate::trace::shading::{RenderContext, light_terms, most_radiance};

/// The images of small shapes, and the small highlights, that a picture may show.
#[derive(Clone, Debug, Default)]
pub(crate) struct Images {
    /// The features of pixels, by column and row.
    pub(crate) placed: Vec<((u32, u32), Feature)>,
    /// The images whose pixels are unknown.
    pub(crate) hidden: Vec<HiddenImage>,
}

/// The image of a shape in another one, in unknown pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HiddenImage {
    /// Approximate area in pixels.
    pub(crate) area: f64,
    /// Upper bound of its radiance in any channel.
    pub(crate) radiance: f32,
    /// Number of images that this one represents.
    pub(crate) count: f64,
}

/// Maximum area of a hidden image. Samples of some pixel hit larger images if they are visible.
const LARGEST: f64 = 64.0;
/// Maximum number of pairs of shapes examined. Beyond it, some pairs represent others. Also the maximum number of pairs of a shape and a
/// light; beyond it, highlights are not found.
const PAIRS: usize = 1 << 16;

/// Finds images and highlights of at most a few pixels. With an open shutter (`is_open`), all images are hidden, and no highlight is found.
pub(crate) fn images(context: &RenderContext<'_>, is_open: bool) -> Images {
    let RenderContext { scene, secondary, camera, .. } = *context;
    let mirrors: Vec<ShapeId> = ids(scene).filter(|id| scene.material(*id).continues()).collect();
    let shown: Vec<(ShapeId, Ball)> =
        ids(secondary).filter_map(|id| Some((id, Ball::around(&scene.geometry().bounds(id)?)))).collect();
    let stride = (mirrors.len() * shown.len()).div_ceil(PAIRS).max(1);
    let has_places = !is_open && !camera.has_lens() && !camera.is_orthographic();
    // Images that represent others have no place of their own.
    let places = (has_places && stride == 1, stride);
    let of_mirror = |(index, mirror): (usize, &ShapeId)| {
        images_in(context, *mirror, shown.iter().skip(index % stride).step_by(stride), places)
    };
    let mut images = Images::default();
    for Images { placed, hidden } in mirrors.par_iter().enumerate().map(of_mirror).collect::<Vec<_>>() {
        images.placed.extend(placed);
        images.hidden.extend(hidden);
    }
    if has_places {
        add_highlights(context, &mut images.placed);
    }
    images
}

/// Finds the images of shapes in a mirror. Each represents `stride` images; `has_places` is true if places are to be found.
fn images_in<'a>(
    context: &RenderContext<'_>,
    mirror: ShapeId,
    shown: impl Iterator<Item = &'a (ShapeId, Ball)>,
    (has_places, stride): (bool, usize),
) -> Images {
    let RenderContext { scene, secondary, camera, .. } = *context;
    let (eye, material) = (camera.position(), scene.material(mirror));
    let (reflected, transmitted) =
        (material.reflected, material.refraction.map_or(0.0, |refraction| refraction.transmitted));
    let bounds = scene.geometry().bounds(mirror);
    let around = bounds.as_ref().map(Ball::around);
    let faces = if has_places && reflected > 0.0 {
        Mirror::all(scene.geometry().shape(mirror), eye)
    } else {
        Vec::new()
    };
    let (mut images, mut search) = (Images::default(), Scratch::default());
    for (id, ball) in shown.filter(|(id, _)| *id != mirror) {
        let area = mirrored_area(camera, around.as_ref(), ball);
        if !(area > 0.0 && area < LARGEST) {
            continue;
        }
        let radiance = most_radiance(scene, scene.material(*id));
        let mut is_hidden = faces.is_empty() || ball.is_cut_by(&faces, bounds.as_ref());
        for (face, place) in faces.iter().filter_map(|face| Some((face, face.reflect(eye, ball.middle)?))) {
            is_hidden = false;
            let (pixels, area) = place.pixels(camera, place.image(ball.radius));
            // Other shapes may hide some points of the image.
            let mut shows = |point: DVec3| {
                let Some(place) = face.reflect(eye, point) else { return false };
                let Some(ray) = place.ray(point - place.point) else { return false };
                place.is_seen(scene, mirror, eye, &mut search)
                    && secondary.closest(&ray, &mut search).is_some_and(|found| found.hit.id == *id)
            };
            if !pixels.is_empty() && ball.points(place.point).any(&mut shows) {
                let radiance = reflected.min(1.0) * radiance;
                let feature = Feature { area: to_f32(area.min(1.0)), radiance };
                images.placed.extend(pixels.into_iter().map(|pixel| (pixel, feature)));
            }
        }
        let hidden = if is_hidden { reflected } else { 0.0 };
        let share = transmitted + hidden;
        if share > 0.0 {
            let radiance = share.min(1.0) * radiance;
            images.hidden.push(HiddenImage { area, radiance, count: stride as f64 });
        }
    }
    images
}

/// Finds the highlights of lights that are not extended.
fn add_highlights(context: &RenderContext<'_>, placed: &mut Vec<((u32, u32), Feature)>) {
    /// Distance of directional lights: farther than any shape, and near enough for seven digits of the direction.
    const FAR: f64 = 1e9;
    let RenderContext { scene, shadow, camera, effects, .. } = *context;
    let (eye, mut search) = (camera.position(), Scratch::default());
    let place_of = |light: &PreparedLight| match light.source {
        LightSource::Point(place) | LightSource::Spot(place, _) => Some(place),
        LightSource::Directional(towards) => Some(eye + FAR * towards.normalize_or_zero()),
        _ => None,
    };
    let lights = context.lights.iter().filter_map(|(index, light)| Some((*index, light, place_of(light)?)));
    let lights: Vec<(usize, &PreparedLight, DVec3)> = lights.collect();
    let is_glossy = |id: &ShapeId| effects.extras && scene.material(*id).specular > 0.0;
    // All pixels of small shapes have a feature.
    let is_large = |id: &ShapeId| {
        scene.geometry().bounds(*id).is_none_or(|bounds| seen_area(camera, &Ball::around(&bounds)) >= LARGE)
    };
    let shapes = ids(scene).filter(|id| is_glossy(id) && is_large(id)).take(PAIRS + 1);
    let shapes: Vec<ShapeId> = shapes.collect();
    if shapes.len() * lights.len() > PAIRS {
        return;
    }
    for id in shapes {
        let material = scene.material(id);
        let faces = Mirror::all(scene.geometry().shape(id), eye);
        let pairs = lights.iter().flat_map(|light| faces.iter().map(move |face| (light, face)));
        for ((index, light, from), face) in pairs {
            let Some(place) = face.reflect(eye, *from) else { continue };
            let (pixels, area) = place.pixels(camera, place.highlight(material.shininess.into()));
            let Ok(terms) = light_terms(effects, (*index, light), &place.lit(eye, material), 0) else {
                continue;
            };
            if pixels.is_empty() || !place.is_seen(scene, id, eye, &mut search) {
                continue;
            }
            let Some(to_light) = place.ray(terms.to_light) else { continue };
            let except = (light.own_shape, None);
            if !light.casts_shadows || shadow.occluder(&to_light, &terms.limit, except, &mut search).is_none()
            {
                let radiance = terms.contribution().max_element();
                let feature = Feature { area: to_f32(area.min(1.0)), radiance };
                placed.extend(pixels.into_iter().map(|pixel| (pixel, feature)));
            }
        }
    }
}

/// Returns all shapes.
fn ids(scene: &PreparedScene) -> impl Iterator<Item = ShapeId> {
    scene.unbounded.iter().copied().chain(scene.leaves.ids())
}

/// Returns the approximate area in pixels of a ball's image in a mirror around another ball, or in an unbounded one. A convex mirror of
/// radius R scales the image of a shape at distance D by about R/(2 D); an unbounded mirror shows a shape about as large as it is seen
/// directly.
fn mirrored_area(camera: &PreparedCamera, mirror: Option<&Ball>, ball: &Ball) -> f64 {
    let Some(mirror) = mirror else { return seen_area(camera, ball) };
    let far = mirror.middle.distance(ball.middle).max(mirror.radius);
    let radius = ball.radius * (mirror.radius / (2.0 * far)).min(1.0);
    seen_area(camera, &Ball { middle: mirror.middle, radius })
}

/// Returns the approximate area in pixels of a ball.
pub(super) fn seen_area(camera: &PreparedCamera, ball: &Ball) -> f64 {
    let radius = ball.radius / camera.reduction(ball.middle) * camera.distance() / pixel_size(camera);
    std::f64::consts::PI * radius * radius
}
