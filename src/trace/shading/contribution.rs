//! Upper bounds of the contribution of rays to their pixel, used to cut rays of negligible contribution.
//!
//! B(n) bounds the radiance, per channel, along any ray with n bounces left. B(0) is the bound of the background. A ray with more
//! bounces left sees the background, fog, or a surface of some material. The radiance of a surface is its own light plus the radiance
//! along its secondary rays. Its own light is at most its emission and its response to all lights together, and the shares of the
//! secondary rays add up to at most k_r + k_t of its material. So B(n) is the maximum of direct + (k_r + k_t) B(n-1) over all materials. The maximum is
//! taken over materials, not over each term, because the brightest material is seldom the one with the largest k_r + k_t: glass with no
//! light of its own and k_r + k_t of at most 1 does not raise B(n), for any n.
//!
//! Each sample has an [`ErrorBudget`], the light that it may lose. A ray that is cut is charged with its maximum contribution, its
//! throughput times B, so the loss of a sample is at most its budget. The budget is spent bounce by bounce, when all rays of a
//! sample's next bounce are known, on the rays with the smallest maximum contribution. So no part of it is reserved for rays that end
//! by themselves. If it were divided from ray to ray instead, most of it would be lost with rays that leave for the sky, and ten times as
//! many rays would be traced. The stages and the reference path both know a complete bounce before they trace any ray of it, so no cut
//! depends on the order of rays.

use fearless_simd::{f32x16, prelude::*};
use glam::DVec3;

use crate::color::{Rgb, to_f32};
use crate::trace::math::{Bytes, Colors, LANES, WHOLE, bits16};
use crate::trace::scene::{LightSource, PreparedScene, SurfaceMaterial};

/// Upper bounds of the radiance along rays, and of contributions that are negligible.
#[derive(Clone, Debug)]
pub(crate) struct RadianceBound {
    /// B(n) for n = 0, 1, 2, ..., each rounded up to a power of two, so that small changes of a scene do not change it.
    bounds: Vec<Rgb>,
    /// The largest maximum contribution at which the first ray of a sample to be cut is cut; minus infinity if none is cut.
    negligible: f32,
}

impl RadianceBound {
    pub(crate) fn of(scene: &PreparedScene) -> Self {
        let background = scene.miss_radiance_bound().as_dvec3();
        let fog = if scene.fog.density > 0.0 { scene.fog.color } else { Rgb::ZERO };
        let around = background.max(fog.as_dvec3());
        let lights = all_lights(scene);
        let answers: Vec<(DVec3, f64)> = scene
            .surfaces()
            .answers()
            .map(|answer| {
                let scattered = answer.diffuse.as_dvec3() + f64::from(answer.specular);
                let unlit = answer.ambient.as_dvec3() * scene.ambient.as_dvec3() + answer.emission.as_dvec3();
                let direct = unlit + scattered * lights;
                (direct, f64::from(answer.followed))
            })
            .collect();
        let mut beyond = background;
        let mut bounds = vec![rounded_up(beyond)];
        for _ in 0..scene.depth.max(1) {
            let shown = answers.iter().map(|(direct, followed)| direct + beyond * *followed);
            // Clamped to finite numbers, because infinity times zero is NaN.
            beyond = shown.fold(around, DVec3::max).min(DVec3::MAX);
            bounds.push(rounded_up(beyond));
        }
        Self { bounds, negligible: ErrorBudget::new(scene).largest() }
    }

    /// Writes the bytes of all bounds.
    pub(crate) fn write(&self, bytes: &mut Bytes) {
        self.bounds.iter().for_each(|bound| bytes.colors([*bound]));
        bytes.number(self.negligible.into());
    }

    /// Returns the maximum contribution of a ray in any channel.
    pub(crate) fn most(&self, throughput: Rgb, bounces: u32) -> f32 {
        (throughput * self.bound(bounces)).max_element()
    }

    fn bound(&self, bounces: u32) -> Rgb {
        self.bounds.get(bounces as usize).copied().unwrap_or(Rgb::INFINITY)
    }

    /// Computes [`most`](Self::most) for the rays of a packet whose throughput is not zero.
    #[inline(always)]
    pub(crate) fn mosts<S: Simd>(&self, simd: S, throughputs: &Colors, bounces: u32) -> [f32; LANES] {
        let mut mosts = f32x16::splat(simd, 0.0);
        for (throughput, bound) in throughputs.load(simd).into_iter().zip(self.bound(bounces).to_array()) {
            // NaN, an infinite bound times zero throughput, does not compare greater.
            let most = throughput * bound;
            mosts = most.simd_gt(mosts).select(most, mosts);
        }
        *mosts.as_array()
    }

    /// Returns the lanes of rays to cut, for rays of nonzero throughput that are, like their ancestors, alone in the bounce of their
    /// sample. This is the decision of [`ErrorBudget::cut`] with an unspent budget: nothing is charged earlier, because such a ray is the
    /// last of its sample if it is cut.
    #[inline(always)]
    pub(crate) fn negligible<S: Simd>(&self, simd: S, throughputs: &Colors, bounces: u32) -> u32 {
        let mut shows = 0;
        for (throughput, bound) in throughputs.load(simd).into_iter().zip(self.bound(bounces).to_array()) {
            // NaN, an infinite bound times zero throughput, does not compare greater.
            shows |= bits16((throughput * bound).simd_gt(f32x16::splat(simd, self.negligible)));
        }
        !shows & WHOLE
    }
}

/// The light of a sample that may still be lost by cutting rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ErrorBudget {
    /// The total remaining budget.
    rest: f64,
    /// The part of `rest` available to the smallest contributions of bounces that are only partly cut.
    least: f64,
}

impl ErrorBudget {
    /// Share of the cutoff that is spent, slightly below 1: bounds are rounded, and throughputs are rounded twice in each of 1000
    /// bounces.
    const OF_CUTOFF: f64 = 1.0 - 1.0 / 1024.0;
    /// Share of the budget available to partly cut bounces. The remainder is kept for a bounce that fits into the budget
    /// completely.
    const FOR_LEAST: f64 = 0.8;
    /// Share of `least` that one bounce may spend.
    const AT_ONCE: f64 = 0.1;

    pub(crate) fn new(scene: &PreparedScene) -> Self {
        let rest = f64::from(scene.cutoff) * Self::OF_CUTOFF;
        Self { rest, least: rest * Self::FOR_LEAST }
    }

    /// Returns the largest maximum contribution of a ray that is cut, rounded down; minus infinity if none is cut.
    fn largest(&self) -> f32 {
        let rounded = to_f32(self.rest);
        match self.rest {
            rest if rest <= 0.0 => f32::NEG_INFINITY,
            rest if f64::from(rounded) > rest => rounded.next_down(),
            _ => rounded,
        }
    }

    /// Decides which rays of a sample's next bounce are cut, and charges the budget for them. Each ray is given by its maximum
    /// contribution and its index in tracing order. Returns the number of cut rays, which come first in `rays` afterwards.
    pub(crate) fn cut(&mut self, rays: &mut [(f32, usize)]) -> usize {
        if self.rest <= 0.0 {
            return 0;
        }
        let all: f64 = rays.iter().map(|(most, _)| f64::from(*most)).sum();
        // The whole bounce fits into the budget.
        if all <= self.rest {
            self.rest -= all;
            return rays.len();
        }
        let allowed = (self.least * Self::AT_ONCE).min(self.rest);
        // Avoids the sort if no ray fits.
        if !rays.iter().any(|(most, _)| f64::from(*most) <= allowed) {
            return 0;
        }
        rays.sort_unstable_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
        let (mut spent, mut count) = (0.0, 0);
        while let Some((most, _)) = rays.get(count)
            && spent + f64::from(*most) <= allowed
        {
            spent += f64::from(*most);
            count += 1;
        }
        self.rest -= spent;
        self.least -= spent;
        count
    }
}

/// Bounds the radiance, in any channel, of a surface's own light plus a single bounce off it. The bounce is assumed to bring at most the
/// maximum of the background and 1.
pub(crate) fn most_radiance(scene: &PreparedScene, material: &SurfaceMaterial) -> f32 {
    let lights = all_lights(scene);
    let transmitted = material.refraction.map_or(0.0, |refraction| refraction.transmitted);
    let second = material.pattern.as_deref();
    let ambient = second.map_or(material.ambient, |second| material.ambient.max(second.ambient));
    let diffuse = second.map_or(material.diffuse, |second| material.diffuse.max(second.diffuse));
    let own = ambient.as_dvec3() * scene.ambient.as_dvec3()
        + material.emission.as_dvec3()
        + (diffuse.as_dvec3() + f64::from(material.specular)) * lights;
    let followed =
        f64::from(material.reflected + transmitted) * scene.miss_radiance_bound().as_dvec3().max(DVec3::ONE);
    to_f32((own + followed).max_element().min(f64::from(f32::MAX)))
}

/// Returns the sum of the intensities of all lights at their strongest.
fn all_lights(scene: &PreparedScene) -> DVec3 {
    let strongest = scene.lights.iter().map(|light| {
        let nearest = match (&light.falloff, &light.source) {
            (_, LightSource::Directional(_)) | (None, _) => 1.0,
            (Some(falloff), _) => falloff.at(0.0),
        };
        light.intensity.as_dvec3() * nearest
    });
    strongest.sum()
}

/// Rounds up to powers of two. Bounds too large for `f32` become infinite, which is still an upper bound.
fn rounded_up(bound: DVec3) -> Rgb {
    const MANTISSA: u32 = 0x007f_ffff;
    let power = |bound: f32| {
        if bound > 0.0 && bound < f32::MAX / 2.0 && bound.to_bits() & MANTISSA != 0 {
            f32::from_bits((bound.to_bits() & !MANTISSA) + MANTISSA + 1)
        } else {
            bound
        }
    };
    Rgb::from_array(bound.as_vec3().to_array().map(power))
}

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;
    use proptest::prelude::*;

    use super::*;
    use crate::trace::math::SimdLevel;
    use crate::trace::scene::{Geometry, PreparedShape, Refraction, SurfaceMaterial};
    use crate::trace::shapes::Sphere;

    fn scene(materials: Vec<SurfaceMaterial>) -> PreparedScene {
        let mut geometry = Geometry::default();
        for _ in &materials {
            let sphere = Sphere { center: DVec3::ZERO, radius: 1.0 };
            let _ = geometry.push(PreparedShape::Sphere(sphere));
        }
        PreparedScene::new(geometry, materials)
    }

    fn lit(k_a: f32) -> SurfaceMaterial {
        SurfaceMaterial { ambient: Rgb::new(k_a, 0.5 * k_a, 0.0), ..SurfaceMaterial::default() }
    }

    fn glass(k_r: f32, k_t: f32) -> SurfaceMaterial {
        let refraction = Refraction { transmitted: k_t, ior: 1.5, absorption: Rgb::ZERO, fresnel: true };
        SurfaceMaterial { reflected: k_r, refraction: Some(refraction), ..SurfaceMaterial::default() }
    }

    /// The brightest surface and the surface with the largest k_r + k_t differ, and neither adds to the bound of the other.
    #[test]
    fn glass_adds_no_light_of_its_own_however_deep() {
        let mut scene = scene(vec![lit(0.75), glass(0.1, 0.9)]);
        (scene.depth, scene.ambient) = (1000, Rgb::ONE);
        let bounds = |scene: &PreparedScene| RadianceBound::of(scene).bounds;
        assert_eq!(bounds(&scene)[0], Rgb::ZERO, "the background");
        assert!(bounds(&scene)[1..].iter().all(|bound| *bound == Rgb::new(1.0, 0.5, 0.0)));
        // A mirror with light of its own: 0.75 (1 + 1/2 + 1/4 ...) is 1.5, rounded up once.
        let mirror = SurfaceMaterial { reflected: 0.5, ..lit(0.75) };
        let _ = scene.replace_materials([(crate::trace::ShapeId(0), mirror)]);
        assert_eq!(bounds(&scene)[1000], Rgb::new(2.0, 1.0, 0.0));
        // Light that may double at each bounce: 3/4 2^1000, which overflows.
        let _ = scene.replace_materials([(crate::trace::ShapeId(1), glass(1.0, 1.0))]);
        assert_eq!(bounds(&scene)[2], Rgb::new(2.0, 1.0, 0.0));
        assert_eq!(bounds(&scene)[1000], Rgb::new(f32::INFINITY, f32::INFINITY, 0.0));
    }

    #[test]
    fn emission_counts_in_full() {
        let lamp = SurfaceMaterial { emission: Rgb::new(3.0, 0.0, 1.0), ..lit(1.0) };
        let mut scene = scene(vec![lamp.clone(), glass(0.0, 0.5)]);
        scene.ambient = Rgb::ONE;
        assert_eq!(RadianceBound::of(&scene).bounds[1], Rgb::new(4.0, 0.5, 1.0));
        assert_eq!(most_radiance(&scene, &lamp), 4.0);
    }

    proptest! {
        /// Tests throughputs around the limit, infinite bounds, and a cutoff of 0.
        #[test]
        fn lanes_of_chains_are_cut_as_one_by_one(
            cutoff in prop_oneof![Just(0.0_f32), 1e-3..1e-1_f32],
            ambient in prop_oneof![Just(1.0_f32), Just(f32::MAX)],
            shares in prop::collection::vec(prop::array::uniform3(prop_oneof![Just(0.0_f32), 0.99..1.01_f32, 0.0..2.0_f32]), LANES),
            bounces in 0..4_u32,
        ) {
            let mut scene = scene(vec![lit(0.5), glass(1.0, 1.0)]);
            (scene.cutoff, scene.ambient, scene.depth) = (cutoff, Rgb::splat(ambient), 3);
            let radiance_bound = RadianceBound::of(&scene);
            let limit = radiance_bound.negligible.max(f32::MIN_POSITIVE);
            let mut throughputs = Colors::splat(Rgb::ONE);
            for (lane, share) in shares.iter().enumerate() {
                throughputs.set(lane, Rgb::from_array(*share) * limit);
            }
            for (name, level) in SimdLevel::all() {
                let cut = dispatch!(level.level(), simd => radiance_bound.negligible(simd, &throughputs, bounces));
                let mosts = dispatch!(level.level(), simd => radiance_bound.mosts(simd, &throughputs, bounces));
                for lane in (0..LANES).filter(|lane| throughputs.get(*lane) != Rgb::ZERO) {
                    let most = radiance_bound.most(throughputs.get(lane), bounces);
                    prop_assert_eq!(mosts[lane], most, "{}", name);
                    let alone = ErrorBudget::new(&scene).cut(&mut [(most, 0)]) == 1;
                    prop_assert_eq!(cut & (1 << lane) != 0, alone, "{} {}", name, most);
                }
            }
        }

        /// In each bounce the rays with the smallest maximum contributions are cut. The cut contributions add up to less than the
        /// cutoff, and the order of rays does not matter.
        #[test]
        fn budgets_hold_whatever_comes(
            cutoff in 1e-4..1.0_f32,
            bounces in prop::collection::vec(prop::collection::vec(-9.0..1.0_f32, 0..40), 1..20),
        ) {
            let mut scene = scene(Vec::new());
            scene.cutoff = cutoff;
            let (mut budget, mut backwards) = (ErrorBudget::new(&scene), ErrorBudget::new(&scene));
            let mut spent = 0.0;
            for bounce in bounces {
                let most = bounce.iter().map(|digits| libm::exp10f(*digits));
                let mut rays: Vec<(f32, usize)> = most.zip(0..).collect();
                let mut reversed: Vec<(f32, usize)> = rays.iter().rev().copied().collect();
                let count = budget.cut(&mut rays);
                prop_assert_eq!(backwards.cut(&mut reversed), count);
                let sorted = |rays: &[(f32, usize)]| {
                    let mut cut: Vec<usize> = rays[..count].iter().map(|(_, index)| *index).collect();
                    cut.sort_unstable();
                    cut
                };
                prop_assert_eq!(sorted(&rays), sorted(&reversed));
                let least_left = rays[count..].iter().map(|(most, _)| *most).fold(f32::INFINITY, f32::min);
                prop_assert!(rays[..count].iter().all(|(most, _)| *most <= least_left));
                spent += rays[..count].iter().map(|(most, _)| f64::from(*most)).sum::<f64>();
                prop_assert!(spent < f64::from(cutoff));
            }
        }
    }

    #[test]
    fn bounds_are_the_next_powers_of_two() {
        for (bound, power) in [(0.0, 0.0), (1.0, 1.0), (1.000_001, 2.0), (0.3, 0.5), (700.0, 1024.0)] {
            assert_eq!(rounded_up(DVec3::new(bound, 0.0, 8.0)), Rgb::new(power, 0.0, 8.0));
        }
        for bound in [f32::INFINITY, f32::MAX, f32::from_bits(1)] {
            assert!(rounded_up(DVec3::splat(bound.into())).min_element() >= bound);
        }
        assert_eq!(rounded_up(DVec3::splat(1e60)), Rgb::INFINITY);
    }
}
