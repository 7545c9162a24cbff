//! Features of the sky: the sun, the stars, and steep parts of the background, in pixels that no shape covers fully.

use std::f64::consts::PI;

use glam::DVec3;

use super::{Feature, TileFeatures, UNCOVERED};
use crate::color::to_f32;
use crate::trace::math::LANES;
use crate::trace::scene::{PreparedBackground, PreparedCamera, PreparedScene};
use crate::trace::stages::{TILE_PIXELS, Tile};

/// Adds the sun, the stars and steep parts of the background to the features of the pixels near them; with a lens, to all pixels that show the sky.
pub(super) fn add_sky(
    scene: &PreparedScene,
    camera: &PreparedCamera,
    tile: &Tile,
    mut found: TileFeatures,
) -> TileFeatures {
    if scene.sky.is_empty() && !matches!(scene.background, PreparedBackground::Stops(_)) {
        return found;
    }
    let sizes = camera.steps().map(DVec3::length);
    // Pixels near the edges of the picture are narrower than those in its middle.
    let [width, height] = sizes.map(|size| size / camera.distance());
    let blur = camera.confusion([0.0, 0.0], sizes[0].min(sizes[1])).max(0.5);
    // A quarter of the disc holds most of the light of a star.
    let feature = |radius: f64, radiance: f32| {
        let area = PI * radius * radius / 4.0 / (width * height * 4.0 * blur * blur);
        Feature { area: to_f32(area.clamp(f64::from(f32::MIN_POSITIVE), 1.0)), radiance }
    };
    let reach = if camera.has_lens() { f64::INFINITY } else { width.hypot(height) };
    for (pixel, index) in (0..).zip(0..TILE_PIXELS) {
        if found.covers[index / LANES].ids[index % LANES] != UNCOVERED {
            continue;
        }
        let (column, row) = tile.pixel(pixel);
        let towards = camera.through(f64::from(column), f64::from(row));
        let unit = towards / towards.length();
        if let Some(detail) = scene.background.detail(unit, reach) {
            let area = detail.height / (height * 2.0 * blur);
            let area = to_f32(area.clamp(f64::from(f32::MIN_POSITIVE), 1.0));
            found.features[index].join(Feature { area, radiance: detail.radiance });
        }
        if let Some(stars) = scene.sky.stars.filter(|stars| stars.may_show(unit, reach)) {
            let (intensity, radius) = stars.extent();
            found.features[index].join(feature(radius, intensity.max_element()));
        }
        if let Some(sun) = scene.sky.sun.filter(|sun| sun.angle(unit) < sun.radius + reach) {
            found.features[index].join(feature(sun.radius, sun.intensity.max_element()));
        }
    }
    found
}
