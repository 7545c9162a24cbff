//! What a picture took.

use std::ops::AddAssign;

use super::query::Escalations;

/// What a picture took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Rays.
    pub rays: RayCounts,
    /// What ended trees of rays before they ended by themselves.
    pub ends: TreeEnds,
    /// How often stages were entered.
    pub(crate) stages: StageCounts,
    /// How often arithmetic had to be helped.
    pub escalations: Escalations,
}

/// How often each stage was entered: never, where no effect needs it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct StageCounts {
    pub(crate) camera_rays: u64,
    pub(crate) closest_hits: u64,
    pub(crate) coverage: u64,
    pub(crate) surfaces: u64,
    pub(crate) direct_light: u64,
    pub(crate) shadows: u64,
    pub(crate) sums: u64,
    pub(crate) next_rays: u64,
}

/// How many rays were traced, by what for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the camera.
    pub camera: u64,
    /// From surfaces to lights.
    pub shadow: u64,
    /// From mirrors, and by reflection at the surfaces of clear media.
    pub reflection: u64,
    /// Through the surfaces of clear media.
    pub refraction: u64,
}

/// How many rays were not traced, though a surface sent them on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TreeEnds {
    /// They were beyond the last generation, or beyond the most rays that a sample may have.
    pub depth: u64,
    /// They could not have brought enough light to show.
    pub cutoff: u64,
}

impl RayCounts {
    /// All of them.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.camera + self.shadow + self.reflection + self.refraction
    }

    /// Counts rays that surfaces send on, all of them mirrored or all refracted.
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
        self.sums += other.sums;
        self.next_rays += other.next_rays;
    }
}

impl AddAssign for Effort {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.ends += other.ends;
        self.stages += other.stages;
        self.escalations += other.escalations;
    }
}
