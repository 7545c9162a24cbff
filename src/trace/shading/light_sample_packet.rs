//! Sixteen shading points, and the contributions of a light there, before occlusion.

use glam::DVec3;

use super::area_light_samples::AreaLightSamples;
use super::direct::{LightSample, ShadowSegment};
use super::path_packet::PathPacket;
use crate::color::Rgb;
use crate::trace::intersect::{HitPacket, SurfacePacket};
use crate::trace::math::{Colors, Numbers, Vectors};
use crate::trace::rays::{RayPacket, ShadowLimit};
use crate::trace::scene::{LightSource, PreparedLight};

/// Shading points, lane by lane.
pub(crate) struct ShadingPacket<'a> {
    /// Rays that hit the points.
    pub(crate) rays: &'a RayPacket,
    /// Path states of the rays.
    pub(crate) paths: &'a PathPacket,
    pub(crate) hits: &'a HitPacket,
    pub(crate) surfaces: &'a SurfacePacket,
    /// Diffuse colours at the points.
    pub(crate) diffuse: &'a Colors,
    /// Colours in ambient light at the points, if it is occluded.
    pub(crate) ambient: &'a Colors,
    /// Sample sequences on area lights.
    pub(crate) places: &'a AreaLightSamples,
    /// Lanes whose materials have highlights.
    pub(crate) shiny: u32,
    /// Lanes whose materials are transparent.
    pub(crate) transparent: u32,
}

/// Contributions of a light before occlusion, lane by lane.
#[derive(Clone, Debug)]
pub(crate) struct LightSamplePacket {
    /// Lanes with a contribution.
    pub(crate) lanes: u32,
    /// Lanes, among `lanes`, that need a shadow ray.
    pub(crate) needs_shadow_ray: u32,
    /// Lanes in which light arrives from the other side, through the transparent medium behind the surface.
    pub(crate) from_behind: u32,
    /// The unoccluded contributions.
    pub(crate) colors: Colors,
    /// Shadow rays, in the lanes `needs_shadow_ray`. Directions are also valid in all other lanes whose contribution was computed by packet
    /// operations.
    pub(crate) rays: RayPacket,
    /// The light's `t` along the rays.
    pub(crate) limits: Numbers,
    /// Sample points on the light, if it is an area light.
    pub(super) places: Vectors,
}

impl LightSamplePacket {
    /// A packet without contributions.
    pub(crate) const EMPTY: Self = Self {
        lanes: 0,
        needs_shadow_ray: 0,
        from_behind: 0,
        colors: Colors::splat(Rgb::ZERO),
        rays: RayPacket::EMPTY,
        limits: Numbers::splat(0.0),
        places: Vectors::splat(DVec3::ZERO),
    };

    /// Returns the direction to the light and its end, in a lane that has a direction.
    #[inline]
    pub(crate) fn segment(&self, light: &PreparedLight, lane: usize) -> ShadowSegment {
        let limit = match light.source {
            LightSource::Point(place) | LightSource::Spot(place, _) => {
                ShadowLimit::new(self.limits.get(lane), place)
            }
            LightSource::Directional(_) => ShadowLimit::NONE,
            LightSource::Sphere { .. } | LightSource::Rectangle { .. } | LightSource::Dome { .. } => {
                ShadowLimit::new(self.limits.get(lane), self.places.get(lane))
            }
        };
        let from_behind = self.from_behind & (1 << lane) != 0;
        ShadowSegment { direction: self.rays.directions.get(lane), limit, from_behind }
    }

    /// Drops the occluded lanes.
    #[inline]
    pub(crate) fn drop_occluded(&mut self, occluded: u32) {
        self.lanes &= !occluded;
        self.rays.keep(!occluded);
    }

    /// Makes the shadow rays leave their surfaces.
    #[inline(always)]
    pub(super) fn leave(&mut self, surfaces: &SurfacePacket) {
        self.rays.lanes = self.needs_shadow_ray;
        self.rays.left = surfaces.first_equals;
        self.rays.departing = self.needs_shadow_ray;
        self.rays.outward = surfaces.from_outside ^ self.from_behind;
        // Tied shapes that the rays also leave are handled when the rays are traced one by one.
        self.rays.tied = surfaces.tied & self.needs_shadow_ray;
    }

    /// Puts a light sample into an empty lane.
    pub(super) fn set(&mut self, lane: usize, light_sample: &LightSample) {
        let bit = 1 << lane;
        self.lanes |= bit;
        self.colors.set(lane, light_sample.color);
        if let Some(ShadowSegment { direction, limit, from_behind }) = light_sample.shadow {
            self.needs_shadow_ray |= bit;
            self.rays.directions.set(lane, direction);
            self.limits.set(lane, limit.t());
            self.places.set(lane, limit.place());
            if from_behind {
                self.from_behind |= bit;
            }
        }
    }
}
