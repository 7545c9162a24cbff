//! Convex hulls of rays, tested against boxes.
//!
//! All rays of a hull go from a box A of origins to a box B of ends or, if they hit nothing, in a direction from a box B of directions. The points on
//! them lie in the boxes (1 - s) A + s B with 0 <= s <= 1, or A + s B with s >= 0. Whether any of these meets a box C is a matter of six linear
//! inequalities for s.
//!
//! # Rounding errors
//!
//! Boxes are stored rounded outwards by 2^-21 of each side: more than the rounding of an `f64` to `f32` (2^-24), than three `f32` roundings of
//! a direction over its largest component (3 2^-24), and than what `f64` has lost before in proportion to a side. What `f64` loses by
//! cancellation in o + t d is at most 2^-51 (|o| + |t d|) at the end, and in proportion before it.
//!
//! Let E be the largest coordinate of the origins and of the box. A shape accepts rays that miss its bounds by at most 2^-26 of the distance
//! to it, which is at most 2 E: by 2^-25 E (`Frame::SLACK` in `bvh` has the reasons). The test is in `f64`: a start is off by at most 2^-51
//! of the coordinates in it, a rise by 2^-53 of itself, and a quotient by 2^-51 of itself.
//!
//! Let s be the parameter of the point that is nearest to such a hit. With a slack of 2^-22 E, every inequality holds there with at least
//! (2^-22 - 2^-25 - 2^-48) E to spare: the exact bound on s is farther from it than 2^-23 E / |rise|. The computed bound differs from the
//! exact one by less than 2^-48 E / |rise|, since a start that decides is at most 2 E and the slack. So s lies between the computed bounds.
//! Ends behind the box do not enter E: they move the hull near the box only in proportion.
//!
//! Sides that are not finite are stored as infinite ones, and comparisons are written so that a NaN disables an inequality.

use crate::color::Rgb;
use crate::trace::scene::{LightSource, PreparedLight, PreparedScene};
use crate::trace::shading::RenderContext;
use crate::trace::shapes::{Bounds, CompactBounds};

/// 2^-22, relative to the largest coordinate of origins and boxes.
const SLACK: f64 = 1.0 / 4_194_304.0;

/// The hull of some rays, and of the shadow rays from their ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RayHull {
    /// A box around the origins.
    pub(super) from: CompactBounds,
    /// A box around the ends or, for endless rays, around the directions, each scaled to a largest component of about 1.
    pub(super) to: CompactBounds,
    /// The lights to which shadow rays are traced from the ends, as a bit mask: see [`light_bit`].
    pub(super) lights: u32,
    /// True for rays that hit nothing.
    pub(super) is_endless: bool,
}

/// The region from which a light's shadow rays come, as seen from lit points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LightRegion {
    /// A box around all points of the light.
    Position(CompactBounds),
    /// The direction to the light.
    Direction(CompactBounds),
    /// A sphere of this radius around each lit point.
    Dome(f64),
}

/// Returns the bit of light number `index` in masks; the last bit stands for all lights from the 31st on.
pub(super) fn light_bit(index: usize) -> u32 {
    const _: () = assert!(RenderContext::DOME == usize::MAX);
    1 << index.wrapping_add(1).min(31)
}

impl RayHull {
    pub(super) const EMPTY: Self =
        Self { from: CompactBounds::EMPTY, to: CompactBounds::EMPTY, lights: 0, is_endless: false };

    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.from.is_empty()
    }

    /// Extends the hull to contain another one that is as endless.
    #[inline]
    pub(super) fn join(&mut self, other: &Self) {
        self.from.join(&other.from);
        self.to.join(&other.to);
        self.lights |= other.lights;
        self.is_endless |= other.is_endless;
    }

    /// Returns whether a ray of the hull, or a shadow ray from its end, may meet a box. `false` only if none can.
    pub(super) fn may_intersect(&self, bounds: &Bounds, lights: &[(u32, LightRegion)]) -> bool {
        let may_be_shadowed =
            |(bit, light): &(u32, LightRegion)| self.lights & bit != 0 && light.may_pass(&self.to, bounds);
        meets(&self.from, &self.to, self.is_endless, bounds)
            || self.lights != 0 && lights.iter().any(may_be_shadowed)
    }
}

impl LightRegion {
    /// Returns the regions of all lights that may be occluded, each with its bit.
    pub(crate) fn all(scene: &PreparedScene) -> Vec<(u32, Self)> {
        let lights = scene.lights.iter().copied().enumerate();
        let lights = lights.filter(|(_, light)| light.intensity != Rgb::ZERO && light.casts_shadows);
        let dome = scene.dome().map(|dome| (RenderContext::DOME, dome));
        dome.into_iter().chain(lights).map(|(index, light)| (light_bit(index), Self::of(&light))).collect()
    }

    fn of(light: &PreparedLight) -> Self {
        let around = |min, max| CompactBounds::around(Bounds { min, max });
        match light.source {
            LightSource::Point(place) | LightSource::Spot(place, _) => Self::Position(around(place, place)),
            LightSource::Directional(towards) => {
                let towards = towards / towards.abs().max_element();
                Self::Direction(around(towards, towards))
            }
            LightSource::Dome { radius } => Self::Dome(radius),
            LightSource::Sphere { .. } | LightSource::Rectangle { .. } => {
                let (middle, reach) = light.source.extent().unwrap_or_default();
                Self::Position(around(middle - reach, middle + reach))
            }
        }
    }

    /// Returns whether a shadow ray from a point in a box may meet another box.
    fn may_pass(&self, lit: &CompactBounds, bounds: &Bounds) -> bool {
        match self {
            Self::Position(light) => meets(lit, light, false, bounds),
            Self::Direction(towards) => meets(lit, towards, true, bounds),
            Self::Dome(radius) => {
                let reach = radius + SLACK * (lit.largest() + radius).max(bounds.largest());
                (0..3).all(|axis| {
                    let (low, high) = (f64::from(lit.min[axis]) - reach, f64::from(lit.max[axis]) + reach);
                    // Not a number is not beyond.
                    let is_beyond = low > bounds.max[axis] || high < bounds.min[axis];
                    !is_beyond
                })
            }
        }
    }
}

/// Returns whether (1 - s) a + s b, 0 <= s <= 1, or if endless a + s b, s >= 0, may lie in a box, for any points a and b of two boxes.
fn meets(from: &CompactBounds, to: &CompactBounds, is_endless: bool, bounds: &Bounds) -> bool {
    let slack = SLACK * from.largest().max(bounds.largest());
    let (mut least, mut most) = (0.0_f64, if is_endless { f64::INFINITY } else { 1.0 });
    for axis in 0..3 {
        let [low, high] = [from.min[axis], from.max[axis]].map(f64::from);
        let [to_low, to_high] = [to.min[axis], to.max[axis]].map(f64::from);
        let [rise_low, rise_high] =
            if is_endless { [to_low, to_high] } else { [to_low - low, to_high - high] };
        // The lower side must get below the upper side of the box, and the upper side above its lower side: start + s rise <= 0.
        let inequalities =
            [(low - bounds.max[axis] - slack, rise_low), (bounds.min[axis] - high - slack, -rise_high)];
        for (start, rise) in inequalities {
            if start > 0.0 {
                if rise >= 0.0 {
                    return false;
                }
                // `max` and `min` ignore NaN.
                least = least.max(start / -rise);
            } else if rise > 0.0 {
                most = most.min(start / -rise);
            }
        }
    }
    least <= most
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;

    fn at(point: DVec3) -> CompactBounds {
        CompactBounds::around(Bounds { min: point, max: point })
    }

    fn joined(points: impl Iterator<Item = DVec3>) -> CompactBounds {
        let mut joined = CompactBounds::EMPTY;
        points.for_each(|point| joined.join(&at(point)));
        joined
    }

    fn vector() -> impl Strategy<Value = DVec3> {
        let number = prop_oneof![-1.0..1.0, Just(0.0), (-1.0..1.0).prop_map(|number: f64| number * 1e-9)];
        prop::array::uniform3(number).prop_map(DVec3::from_array)
    }

    #[test]
    fn boxes_beside_a_hull_are_not_met() {
        let (from, to) = (joined([DVec3::ZERO, DVec3::Y].into_iter()), at(DVec3::new(4.0, 0.5, 0.0)));
        let small = |x: f64, y: f64| {
            let middle = DVec3::new(x, y, 0.0);
            Bounds { min: middle - 0.01, max: middle + 0.01 }
        };
        let meets = |place: Bounds, is_endless| meets(&from, &to, is_endless, &place);
        assert!(meets(small(2.0, 0.5), false) && meets(small(0.0, 0.9), false));
        assert!(!meets(small(2.0, 0.9), false) && !meets(small(2.0, 0.1), false));
        assert!(!meets(small(4.1, 0.5), false) && !meets(small(-0.1, 0.5), false));
        // Towards a direction, the hull is a half cylinder.
        assert!(
            meets(small(40.0, 5.2), true) && !meets(small(40.0, 6.2), true) && !meets(small(-1.0, 0.5), true)
        );
        let dome = LightRegion::Dome(1.0);
        assert!(dome.may_pass(&from, &small(0.0, 1.9)) && !dome.may_pass(&from, &small(0.0, 2.1)));
    }

    #[test]
    fn whatever_is_not_finite_is_met() {
        let finite = Bounds { min: DVec3::ONE, max: DVec3::splat(2.0) };
        for wrong in [f64::INFINITY, f64::NAN, 1e300] {
            let place = Bounds { min: DVec3::splat(-wrong), max: DVec3::splat(wrong) };
            for is_endless in [false, true] {
                assert!(meets(&CompactBounds::around(place), &at(DVec3::X), is_endless, &finite), "{wrong}");
                assert!(
                    meets(&at(DVec3::ZERO), &CompactBounds::around(place), is_endless, &finite),
                    "{wrong}"
                );
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn points_near_rays_are_met(
            rays in prop::collection::vec((vector(), vector()), 1..4),
            (which, share, shift) in (0..4_usize, 0.0..=1.0, vector()),
            (is_endless, unit, offset) in (any::<bool>(), prop_oneof![Just(1e-20), Just(1.0), Just(300.0), Just(1e9)], vector()),
        ) {
            let ray = |(origin, end): &(DVec3, DVec3)| {
                let (origin, end) = ((*origin + offset) * unit, (*end + offset) * unit);
                // For endless rays, the direction over its largest component.
                let direction = end - origin;
                let direction = direction / direction.abs().max_element();
                let is_ray = !is_endless || direction.is_finite();
                is_ray.then_some((origin, if is_endless { direction } else { end }))
            };
            let rays: Vec<(DVec3, DVec3)> = rays.iter().filter_map(ray).collect();
            prop_assume!(!rays.is_empty());
            let (origin, to) = rays[which % rays.len()];
            let point = if is_endless { origin + to * (share * 10.0 * unit) } else { origin.lerp(to, share) };
            let largest = rays.iter().fold(point.abs().max_element(), |largest, (origin, _)| largest.max(origin.abs().max_element()));
            let near = point + shift * (largest / f64::from(1 << 25));
            let (from, to) = (joined(rays.iter().map(|ray| ray.0)), joined(rays.iter().map(|ray| ray.1)));
            prop_assert!(meets(&from, &to, is_endless, &Bounds { min: near, max: near }), "{from:?} {to:?} {near}");
            let hull = RayHull { from: at(DVec3::ZERO), to: from, lights: 2, is_endless: false };
            let light = if is_endless { LightRegion::Direction(to) } else { LightRegion::Position(to) };
            let bounds = Bounds { min: near, max: near };
            prop_assert!(hull.may_intersect(&bounds, &[(2, light)]));
        }
    }
}
