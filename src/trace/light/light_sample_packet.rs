//! What is known of sixteen surface points that are lit, and what a light adds there if it comes through.

use fearless_simd::prelude::*;
use glam::DVec3;

use super::area_light_samples::AreaLightSamples;
use super::direct::{LightSample, WayToLight};
use super::path_packet::PathPacket;
use crate::color::Rgb;
use crate::trace::math::{Colors, F64s3, Numbers, Vectors, mask, select3};
use crate::trace::query::{HitPacket, SurfacePacket};
use crate::trace::rays::{RayPacket, ShadowLimit};
use crate::trace::scene::{Light, LightSource};

/// Surface points to be lit, lane by lane.
pub(crate) struct ShadingPacket<'a> {
    /// The rays that found them.
    pub(crate) rays: &'a RayPacket,
    /// What those carry.
    pub(crate) paths: &'a PathPacket,
    pub(crate) hits: &'a HitPacket,
    pub(crate) surfaces: &'a SurfacePacket,
    /// The diffuse colours there.
    pub(crate) diffuse: &'a Colors,
    /// From where on a light with a size they are lit.
    pub(crate) places: &'a AreaLightSamples,
    /// Lanes whose materials have highlights.
    pub(crate) shiny: u32,
    /// Lanes whose materials are clear.
    pub(crate) clear: u32,
}

/// What a light adds, lane by lane, if it comes through.
#[derive(Clone, Debug)]
pub(crate) struct LightSamplePacket {
    /// Lanes to which something is added.
    pub(crate) lanes: u32,
    /// Of these, lanes of which it has to be asked first what stands in the way.
    pub(crate) asking: u32,
    /// Lanes to which light comes from the other side, through the clear medium behind the surface.
    pub(crate) from_behind: u32,
    /// What is added where nothing is in the way.
    pub(crate) colors: Colors,
    /// From the points to the light, where it has to be asked what stands in the way; also their directions wherever the operations of
    /// lanes found what is added.
    pub(crate) rays: RayPacket,
    /// How many times as far it is.
    pub(crate) limits: Numbers,
    /// Where it is, if it has a size.
    pub(super) places: Vectors,
}

impl LightSamplePacket {
    /// Of nothing.
    pub(crate) const EMPTY: Self = Self {
        lanes: 0,
        asking: 0,
        from_behind: 0,
        colors: Colors::splat(Rgb::ZERO),
        rays: RayPacket::EMPTY,
        limits: Numbers::splat(0.0),
        places: Vectors::splat(DVec3::ZERO),
    };

    /// Returns the way to the light in a lane that has one.
    #[inline]
    pub(crate) fn way(&self, light: &Light, lane: usize) -> WayToLight {
        let limit = match light.source {
            LightSource::Point(place) | LightSource::Spot(place, _) => {
                ShadowLimit::new(self.limits.get(lane), place)
            }
            LightSource::Directional(_) => ShadowLimit::NONE,
            LightSource::Sphere { .. } | LightSource::Rectangle { .. } => {
                ShadowLimit::new(self.limits.get(lane), self.places.get(lane))
            }
        };
        let from_behind = self.from_behind & (1 << lane) != 0;
        WayToLight { direction: self.rays.directions.get(lane), limit, from_behind }
    }

    /// Drops what is hidden.
    #[inline]
    pub(crate) fn drop_hidden(&mut self, hidden: u32) {
        self.lanes &= !hidden;
        self.rays.keep(!hidden);
    }

    /// Lets the rays of lanes that ask leave the surfaces.
    #[inline(always)]
    pub(super) fn leave(&mut self, surfaces: &SurfacePacket) {
        self.rays.lanes = self.asking;
        self.rays.left = surfaces.first_equals;
        self.rays.departing = self.asking;
        self.rays.outward = surfaces.from_outside ^ self.from_behind;
        // Which others they leave besides is left to who follows them one by one.
        self.rays.tied = surfaces.tied & self.asking;
    }

    /// Puts a proposal into a lane that has none.
    pub(super) fn set(&mut self, lane: usize, proposal: &LightSample) {
        let bit = 1 << lane;
        self.lanes |= bit;
        self.colors.set(lane, proposal.color);
        if let Some(WayToLight { direction, limit, from_behind }) = proposal.shadow {
            self.asking |= bit;
            self.rays.directions.set(lane, direction);
            self.limits.set(lane, limit.t());
            self.places.set(lane, limit.place());
            if from_behind {
                self.from_behind |= bit;
            }
        }
    }
}

/// The normal on the side that the ray came from.
pub(super) fn facing_normal(surfaces: &SurfacePacket, lane: usize) -> DVec3 {
    let normal = surfaces.normals.get(lane);
    if surfaces.from_outside & (1 << lane) != 0 { normal } else { -normal }
}

/// The same in half of the lanes.
#[inline(always)]
pub(super) fn facing_normals<S: Simd>(simd: S, surfaces: &SurfacePacket, half: usize) -> F64s3<S> {
    let normal = surfaces.normals.load(simd, half);
    let outside = mask(simd, surfaces.from_outside, half);
    select3(outside, normal, [-normal[0], -normal[1], -normal[2]])
}
