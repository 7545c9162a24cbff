//! Features of the sky: the sun, the stars, and steep parts of the background, in pixels that no shape covers fully.

use std::f64::consts::PI;

use glam::DVec3;

use super::{BLOCKS, Feature, HALF_BLOCK, MIDDLE, TileFeatures, UNCOVERED, pixels};
use crate::color::to_f32;
use crate::trace::math::LANES;
use crate::trace::scene::{PreparedBackground, PreparedCamera, PreparedScene};
use crate::trace::stages::{PACKETS, Tile};

/// Adds the sun, the stars and steep parts of the background to the features of the pixels near them; with a lens, to all pixels that show the sky.
pub(super) fn add_sky(scene: &PreparedScene, camera: &PreparedCamera, tile: &Tile, found: &mut TileFeatures) {
    if scene.sky.is_empty() && !matches!(scene.background, PreparedBackground::Stops(_)) {
        return;
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
    // What shows within an angle from the direction of a pixel, relative to the middle of the tile.
    let shown = |[x, y]: [f64; 2], angle: f64| {
        let towards = camera.through(f64::from(tile.i) + MIDDLE + x, f64::from(tile.j) + MIDDLE + y);
        let unit = towards / towards.length();
        let detail = scene.background.detail(unit, angle);
        let stars = scene.sky.stars.filter(|stars| stars.may_show(unit, angle));
        (detail, stars, scene.sky.sun.filter(|sun| sun.angle(unit) < sun.radius + angle))
    };
    let around_packet = reach + width.hypot(height) * HALF_BLOCK;
    for packet in 0..PACKETS {
        let (covers, features) = (&found.covers[packet].ids, &mut found.features[packet * LANES..]);
        let is_plain =
            || matches!(shown([BLOCKS.x[packet], BLOCKS.y[packet]], around_packet), (None, None, None));
        if covers.iter().all(|id| *id != UNCOVERED) || is_plain() {
            continue;
        }
        let pixels = pixels(packet);
        for lane in (0..LANES).filter(|lane| covers[*lane] == UNCOVERED) {
            let (detail, stars, sun) = shown([pixels.x[lane], pixels.y[lane]], reach);
            if let Some(detail) = detail {
                let area = detail.height / (height * 2.0 * blur);
                let area = to_f32(area.clamp(f64::from(f32::MIN_POSITIVE), 1.0));
                features[lane].join(Feature { area, radiance: detail.radiance });
            }
            if let Some(stars) = stars {
                let (intensity, radius) = stars.extent();
                features[lane].join(feature(radius, intensity.max_element()));
            }
            if let Some(sun) = sun {
                features[lane].join(feature(sun.radius, sun.intensity.max_element()));
            }
        }
    }
}
