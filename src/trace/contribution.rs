//! How much a ray can still add to a pixel, so that rays are not followed which cannot show.
//!
//! B(n) bounds the radiance, in any channel, along any ray with n generations left: B(0) is the background's; a ray with more
//! sees the background, or fog, or a surface whose own light is at most what all lights together can make of the most
//! reflecting material, plus what its continuations bring, whose shares add up to at most k_r + k_t. A ray whose throughput times
//! B is within its error budget is cut. A ray's budget is shared among its continuations, so that what is cut in a pixel adds
//! up to no more than the first budget, and no cut depends on what was cut elsewhere.

use super::{LightSource, PreparedScene};
use crate::color::Rgb;

/// B(n) for n = 0, 1, 2 ..
#[derive(Clone, Debug)]
pub(super) struct Brightest(Vec<f32>);

impl Brightest {
    /// Room for the rounding of some hundred operations in `f32`.
    const SLACK: f32 = 1.0001;

    pub(super) fn of(scene: &PreparedScene) -> Self {
        let surfaces = scene.surfaces();
        let background = scene.background.brightest();
        let direct = surfaces.ambient * scene.ambient.max_element()
            + (surfaces.diffuse + surfaces.specular) * all_lights(scene);
        let around =
            background.max(if scene.fog.density > 0.0 { scene.fog.color.max_element() } else { 0.0 });
        let mut bounds = vec![rounded_up(background)];
        for _ in 0..scene.depth.max(1) {
            let beyond = bounds.last().copied().unwrap_or(background);
            bounds.push(rounded_up(around.max(direct + surfaces.followed * beyond) * Self::SLACK));
        }
        Self(bounds)
    }

    /// B(n).
    pub(super) fn with_left(&self, generations: u32) -> f32 {
        self.0.get(generations as usize).copied().unwrap_or(f32::INFINITY)
    }

    /// Is all that a ray can bring within its budget?
    pub(super) fn is_negligible(&self, throughput: Rgb, generations: u32, budget: f32) -> bool {
        budget > 0.0 && throughput.max_element() * self.with_left(generations) <= budget
    }
}

/// The intensities of all lights where they are strongest.
fn all_lights(scene: &PreparedScene) -> f32 {
    let strongest = scene.lights.iter().map(|light| {
        let nearest = match (&light.falloff, &light.source) {
            (_, LightSource::Towards(_)) | (None, _) => 1.0,
            (Some(falloff), _) => falloff.at(0.0),
        };
        f64::from(light.intensity.max_element()) * nearest
    });
    #[expect(
        clippy::cast_possible_truncation,
        reason = "what is too large for f32 becomes infinite, which bounds it too"
    )]
    let sum = strongest.sum::<f64>() as f32;
    sum
}

/// The next power of two, so that small changes of a scene do not move the bound.
fn rounded_up(bound: f32) -> f32 {
    const MANTISSA: u32 = 0x007f_ffff;
    if bound > 0.0 && bound < f32::MAX / 2.0 && bound.to_bits() & MANTISSA != 0 {
        f32::from_bits((bound.to_bits() & !MANTISSA) + MANTISSA + 1)
    } else {
        bound
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_the_next_powers_of_two() {
        for (bound, power) in [(0.0, 0.0), (1.0, 1.0), (1.000_001, 2.0), (0.3, 0.5), (700.0, 1024.0)] {
            assert_eq!(rounded_up(bound), power);
        }
        assert_eq!(rounded_up(f32::INFINITY), f32::INFINITY);
        assert!(rounded_up(f32::MAX) >= f32::MAX);
        assert!(rounded_up(f32::from_bits(1)) >= f32::from_bits(1));
    }
}
