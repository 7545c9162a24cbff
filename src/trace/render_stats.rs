//! Render statistics.

use std::ops::AddAssign;

use crate::trace::intersect::Escalations;

/// The statistics of rendering a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RenderStats {
    /// The rays traced.
    pub rays: RayCounts,
    /// The rays spawned but not traced.
    pub ends: TreeEnds,
    /// The number of runs of each stage.
    pub(crate) stages: StageCounts,
    /// The escalations beyond `f64` arithmetic.
    pub escalations: Escalations,
}

/// The number of runs of each stage: 0 if no effect needs it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct StageCounts {
    pub(crate) camera_rays: u64,
    pub(crate) closest_hits: u64,
    pub(crate) coverage: u64,
    pub(crate) surfaces: u64,
    pub(crate) direct_light: u64,
    pub(crate) shadows: u64,
    pub(crate) dependencies: u64,
    pub(crate) add_to_pixels: u64,
    pub(crate) next_rays: u64,
}

/// The number of rays traced, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// Camera rays.
    pub camera: u64,
    /// Shadow rays, from surfaces to lights.
    pub shadow: u64,
    /// Reflected rays, from mirrors and from the surfaces of transparent media.
    pub reflection: u64,
    /// Rays refracted at the surfaces of transparent media.
    pub refraction: u64,
}

/// The statistics of a tile of 16 by 16 pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TileStats {
    /// The rays traced. Each camera ray is a sample of a pixel.
    pub rays: RayCounts,
    /// The estimated RMS error of the tile's pixels, in output values, if the picture has an error target.
    pub error: Option<f32>,
}

/// The number of rays that surfaces spawned but that were not traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TreeEnds {
    /// Rays beyond the last bounce, or beyond the maximum number of rays of a sample.
    pub depth: u64,
    /// Those of them whose contribution would be half of their radiance or more, in some channel.
    pub strong: u64,
    /// Rays whose contribution is negligible.
    pub cutoff: u64,
}

impl RayCounts {
    /// Returns the total number of rays.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.camera + self.shadow + self.reflection + self.refraction
    }

    /// Counts secondary rays, all of them reflected or all refracted.
    pub(crate) fn add_secondary(&mut self, mirrored: bool, count: u32) {
        *(if mirrored { &mut self.reflection } else { &mut self.refraction }) += u64::from(count);
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.camera += other.camera;
        self.shadow += other.shadow;
        self.reflection += other.reflection;
        self.refraction += other.refraction;
    }
}

impl AddAssign for TreeEnds {
    fn add_assign(&mut self, other: Self) {
        self.depth += other.depth;
        self.strong += other.strong;
        self.cutoff += other.cutoff;
    }
}

impl AddAssign for StageCounts {
    fn add_assign(&mut self, other: Self) {
        self.camera_rays += other.camera_rays;
        self.closest_hits += other.closest_hits;
        self.coverage += other.coverage;
        self.surfaces += other.surfaces;
        self.direct_light += other.direct_light;
        self.shadows += other.shadows;
        self.dependencies += other.dependencies;
        self.add_to_pixels += other.add_to_pixels;
        self.next_rays += other.next_rays;
    }
}

impl AddAssign for RenderStats {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.ends += other.ends;
        self.stages += other.stages;
        self.escalations += other.escalations;
    }
}
