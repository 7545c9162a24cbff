//! The working memory of a tile: the data that stages pass on. There is one per thread, reused from tile to tile.

use std::sync::atomic::AtomicBool;

use glam::DVec3;

use super::dependencies::{DependencyRecorder, TileDependencies};
use super::material_flags::MaterialFlags;
use super::ray_queue::{RayQueue, UntracedRay};
use super::tile::{PACKETS, TileLanes};
use super::tile_sampler::TileSampler;
use super::trees::Trees;
use super::wavefront::Wavefront;
use crate::color::Rgb;
use crate::trace::intersect::{Candidates, HitPacket, Naive, PacketScratch, SurfacePacket};
use crate::trace::math::{Colors, Vectors};
use crate::trace::rays::ShapeId;
use crate::trace::render_stats::{RayCounts, RenderStats, StageCounts, TreeEnds};
use crate::trace::shading::{AreaLightSamples, ErrorBudget, LightSamplePacket, LightScratch, RenderContext};

/// The data that stages pass on while they trace the rays of a tile, bounce by bounce.
#[derive(Debug)]
pub(crate) struct TileBuffers<'a> {
    /// The wavefront being processed.
    pub(super) wavefront: Wavefront,
    /// The closest hits, by packet of the wavefront.
    pub(super) hits: Box<[HitPacket; PACKETS]>,
    /// The surface points, where lighting, a medium or secondary rays need them.
    pub(super) surfaces: Box<[SurfacePacket; PACKETS]>,
    /// The material properties at the hits.
    pub(super) material_flags: Box<[MaterialFlags; PACKETS]>,
    /// The radiance from the far end of each ray towards its origin.
    pub(super) radiance: Box<[Colors; PACKETS]>,
    /// The contribution of one light sample at each surface point.
    pub(super) light_samples: Box<[LightSamplePacket; PACKETS]>,
    /// The sample points on an area light for each surface point.
    pub(super) area_light_samples: Box<[AreaLightSamples; PACKETS]>,
    /// The contribution of an area light at each surface point, summed over its samples.
    pub(super) light_sums: Box<[Vectors; PACKETS]>,
    /// The possible occluders between a light and the surface points.
    pub(super) candidates: Candidates,
    /// True if `candidates` are valid for the current light.
    pub(super) listed: bool,
    /// By enabled light: a recent occluder in this tile, if any. It is tested first.
    pub(super) last_occluders: Vec<Option<ShapeId>>,
    /// By enabled light: true if this tile has too many possible occluders for candidate lists.
    pub(super) overflowed_lights: Vec<bool>,
    /// The secondary rays spawned at this bounce.
    pub(super) next: RayQueue,
    /// The rays of the current bounce. The wavefront is a part of them.
    pub(super) current: RayQueue,
    /// The rays that are not traced further.
    pub(super) beyond: Vec<UntracedRay>,
    /// The state of samples whose paths can branch.
    pub(super) trees: Trees,
    /// The data that all sample batches of the last tile of camera rays share.
    pub(super) tile_sampler: TileSampler,
    pub(super) scratch: LightScratch<'a>,
    pub(super) packet_scratch: PacketScratch,
    /// By packet of the camera rays: the radiance accumulated in each slot.
    pub(super) pixels: Box<[Colors; PACKETS]>,
    /// The slots that the scene covers, if recording is enabled.
    pub(super) covered: Option<TileLanes>,
    /// The recorder of the dependencies of pixels, if recording is enabled.
    pub(super) recorder: Option<DependencyRecorder>,
    pub(super) rays_traced: RayCounts,
    pub(super) trees_ended: TreeEnds,
    pub(super) stage_runs: StageCounts,
}

impl<'a> TileBuffers<'a> {
    /// Creates empty buffers. Once `cancelled` is true, their contents are unspecified.
    pub(crate) fn new(cancelled: &'a AtomicBool, naive: Option<&'a Naive>) -> Self {
        Self {
            wavefront: Wavefront::new(),
            hits: Box::new([const { HitPacket::EMPTY }; PACKETS]),
            surfaces: Box::new([const { SurfacePacket::EMPTY }; PACKETS]),
            material_flags: Box::new([const { MaterialFlags::EMPTY }; PACKETS]),
            radiance: Box::new([Colors::splat(Rgb::ZERO); PACKETS]),
            light_samples: Box::new([const { LightSamplePacket::EMPTY }; PACKETS]),
            area_light_samples: Box::new([const { AreaLightSamples::NONE }; PACKETS]),
            light_sums: Box::new([Vectors::splat(DVec3::ZERO); PACKETS]),
            candidates: Candidates::default(),
            listed: false,
            last_occluders: Vec::new(),
            overflowed_lights: Vec::new(),
            next: RayQueue::default(),
            current: RayQueue::default(),
            beyond: Vec::new(),
            trees: Trees::default(),
            tile_sampler: TileSampler::default(),
            scratch: LightScratch::new(cancelled, naive),
            packet_scratch: PacketScratch::default(),
            pixels: Box::new([Colors::splat(Rgb::ZERO); PACKETS]),
            covered: None,
            recorder: None,
            rays_traced: RayCounts::default(),
            trees_ended: TreeEnds::default(),
            stage_runs: StageCounts::default(),
        }
    }

    /// Prepares the buffers for samples in `packets` packets of a tile. Discards the data of cancelled samples.
    pub(super) fn begin(&mut self, context: &RenderContext<'_>, packets: usize) {
        self.wavefront.count = 0;
        self.pixels[..packets].fill(Colors::splat(Rgb::ZERO));
        self.covered = self.covered.map(|_| TileLanes::NONE);
        if let Some(recorder) = &mut self.recorder {
            recorder.begin_sample();
        }
        if context.effects.mirrors() {
            self.next.clear();
            self.beyond.clear();
        }
        if context.branches() {
            self.trees.begin(ErrorBudget::new(context.scene));
        }
        self.scratch.media.clear();
        self.scratch.search.ties.clear();
        if context.effects.lights() {
            self.last_occluders.clear();
            self.last_occluders.resize(context.lights.len(), None);
            self.overflowed_lights.clear();
            self.overflowed_lights.resize(context.lights.len(), false);
        }
    }

    /// Returns whether the sample was cancelled. Stages then return early, with incomplete results.
    #[inline(always)]
    pub(super) fn is_cancelled(&self) -> bool {
        self.scratch.search.is_cancelled()
    }

    /// Enables or disables recording of the slots that the scene covers.
    pub(crate) fn record_coverage(&mut self, record: bool) {
        self.covered = record.then_some(TileLanes::NONE);
    }

    /// Enables or disables recording of the dependencies of pixels.
    pub(crate) fn record_dependencies(&mut self, record: bool) {
        if self.recorder.is_some() != record {
            self.recorder = record.then(DependencyRecorder::default);
        }
    }

    /// Moves the recorded dependencies to those of a tile.
    pub(crate) fn move_dependencies(&mut self, tile: &mut TileDependencies) {
        if let Some(recorder) = &mut self.recorder {
            recorder.move_to(tile);
        }
    }

    /// Returns the radiance of the last sample, by packet of the camera rays.
    pub(crate) fn pixels(&self) -> &[Colors; PACKETS] {
        &self.pixels
    }

    /// Returns the slots that the scene covers in the last sample, if recording is enabled: those whose camera rays hit a shape or lose light
    /// on their way.
    pub(crate) fn covered(&self) -> TileLanes {
        self.covered.unwrap_or(TileLanes::NONE)
    }

    /// Returns the statistics of all samples since the last call, and resets them.
    pub(crate) fn take_stats(&mut self) -> RenderStats {
        RenderStats {
            rays: std::mem::take(&mut self.rays_traced),
            ends: std::mem::take(&mut self.trees_ended),
            stages: std::mem::take(&mut self.stage_runs),
            escalations: std::mem::take(&mut self.scratch.search.intersector.escalations),
        }
    }
}
