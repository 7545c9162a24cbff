//! A tile's working memory: what stages leave for the next ones. One per thread, reused from tile to tile.

use std::sync::atomic::AtomicBool;

use glam::DVec3;

use super::answers::AnswerPacket;
use super::generation::{Generation, UntracedRay};
use super::spread_tile::SpreadTile;
use super::tile::{PACKETS, TileLanes};
use super::trees::Trees;
use super::wave::Wave;
use crate::color::Rgb;
use crate::trace::effort::{Effort, RayCounts, StageCounts, TreeEnds};
use crate::trace::light::{Budget, LightPlaces, LightScratch, ProposalPacket, RenderContext};
use crate::trace::math::{Colors, Vectors};
use crate::trace::packet::{Candidates, PacketScratch};
use crate::trace::query::{HitPacket, Scratch, SurfacePacket};
use crate::trace::rays::ShapeId;

/// What a tile's rays, generation by generation, leave from stage to stage.
#[derive(Debug)]
pub(crate) struct TileBuffers<'a> {
    /// The rays that go through the stages now.
    pub(super) wave: Wave,
    /// By packet of the wave: what each ray meets first.
    pub(super) hits: Box<[HitPacket; PACKETS]>,
    /// The surface points that light, a medium or a mirror asks for.
    pub(super) surfaces: Box<[SurfacePacket; PACKETS]>,
    /// How the surfaces there answer light.
    pub(super) answers: Box<[AnswerPacket; PACKETS]>,
    /// The light at the far end of each ray, towards its origin.
    pub(super) radiance: Box<[Colors; PACKETS]>,
    /// What a sample of one light adds at surface points.
    pub(super) proposals: Box<[ProposalPacket; PACKETS]>,
    /// From where on an extended light each surface point is lit.
    pub(super) light_places: Box<[LightPlaces; PACKETS]>,
    /// What an extended light adds at each surface point, summed over its samples.
    pub(super) light_sums: Box<[Vectors; PACKETS]>,
    /// What may stand between a light and the surface points.
    pub(super) candidates: Candidates,
    /// Whether that is known, of the light at hand.
    pub(super) listed: bool,
    /// For every light that is on: what hid it from the last point of this tile that asked, if anything did.
    pub(super) last_occluders: Vec<Option<ShapeId>>,
    /// For every light that is on: whether too many shapes of this tile may hide it for lists of them.
    pub(super) crowded_lights: Vec<bool>,
    /// What the rays of this generation send on.
    pub(super) next: Generation,
    /// The rays of this generation, of which the wave is a part.
    pub(super) current: Generation,
    /// Rays that are not traced any more.
    pub(super) beyond: Vec<UntracedRay>,
    /// What is known of samples whose rays may branch.
    pub(super) trees: Trees,
    /// What is the same for all samples of the tile of camera rays that was traced last.
    pub(super) spread: SpreadTile,
    pub(super) scratch: LightScratch<'a>,
    pub(super) packet_scratch: PacketScratch,
    /// By packet of the camera rays: what has come to their pixels.
    pub(super) pixels: Box<[Colors; PACKETS]>,
    /// The pixels that the scene covers, if anybody asks.
    pub(super) covered: Option<TileLanes>,
    pub(super) rays_traced: RayCounts,
    pub(super) trees_ended: TreeEnds,
    pub(super) entered: StageCounts,
}

impl<'a> TileBuffers<'a> {
    /// Makes empty buffers. Once `cancelled` is true, whatever is in them will do.
    pub(crate) fn new(cancelled: &'a AtomicBool) -> Self {
        Self {
            wave: Wave::new(),
            hits: Box::new([const { HitPacket::EMPTY }; PACKETS]),
            surfaces: Box::new([const { SurfacePacket::EMPTY }; PACKETS]),
            answers: Box::new([const { AnswerPacket::EMPTY }; PACKETS]),
            radiance: Box::new([Colors::splat(Rgb::ZERO); PACKETS]),
            proposals: Box::new([const { ProposalPacket::EMPTY }; PACKETS]),
            light_places: Box::new([const { LightPlaces::NONE }; PACKETS]),
            light_sums: Box::new([Vectors::splat(DVec3::ZERO); PACKETS]),
            candidates: Candidates::default(),
            listed: false,
            last_occluders: Vec::new(),
            crowded_lights: Vec::new(),
            next: Generation::default(),
            current: Generation::default(),
            beyond: Vec::new(),
            trees: Trees::default(),
            spread: SpreadTile::default(),
            scratch: LightScratch::new(cancelled),
            packet_scratch: PacketScratch::default(),
            pixels: Box::new([Colors::splat(Rgb::ZERO); PACKETS]),
            covered: None,
            rays_traced: RayCounts::default(),
            trees_ended: TreeEnds::default(),
            entered: StageCounts::default(),
        }
    }

    /// Makes ready for a sample of a tile, and clears what one that was cancelled left.
    pub(super) fn begin(&mut self, context: &RenderContext<'_>) {
        self.wave.count = 0;
        self.pixels.fill(Colors::splat(Rgb::ZERO));
        self.covered = self.covered.map(|_| TileLanes::NONE);
        if context.effects.mirrors() {
            self.next.clear();
            self.beyond.clear();
        }
        if context.branches() {
            self.trees.begin(Budget::new(context.scene));
        }
        self.scratch.media.clear();
        self.scratch.search.ties.clear();
        if context.effects.lights() {
            self.last_occluders.clear();
            self.last_occluders.resize(context.lights.len(), None);
            self.crowded_lights.clear();
            self.crowded_lights.resize(context.lights.len(), false);
        }
    }

    /// Returns whether nobody waits for the sample any more: stages then leave it as it is.
    #[inline(always)]
    pub(super) fn is_cancelled(&self) -> bool {
        self.scratch.search.is_cancelled()
    }

    /// Has samples tell which pixels the scene covers, or not.
    pub(crate) fn ask_for_coverage(&mut self, asked: bool) {
        self.covered = asked.then_some(TileLanes::NONE);
    }

    /// Returns the memory of searches.
    pub(crate) fn search(&mut self) -> &mut Scratch<'a> {
        &mut self.scratch.search
    }

    /// What the last sample brought, packet by packet of the camera rays.
    pub(crate) fn pixels(&self) -> &[Colors; PACKETS] {
        &self.pixels
    }

    /// The pixels that the scene covers in the last sample, if that was asked for: those whose camera rays meet something, or lose light
    /// on their way.
    pub(crate) fn covered(&self) -> TileLanes {
        self.covered.unwrap_or(TileLanes::NONE)
    }

    /// What all samples since the last call took.
    pub(crate) fn take_effort(&mut self) -> Effort {
        Effort {
            rays: std::mem::take(&mut self.rays_traced),
            ends: std::mem::take(&mut self.trees_ended),
            stages: std::mem::take(&mut self.entered),
            escalations: std::mem::take(&mut self.scratch.search.escalations),
        }
    }
}
