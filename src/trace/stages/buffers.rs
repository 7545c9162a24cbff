//! A tile's working memory: what stages leave for the next ones. One per thread, reused from tile to tile.

use std::sync::atomic::AtomicBool;

use glam::DVec3;

use crate::color::Rgb;
use crate::trace::effects::Effects;
use crate::trace::effort::{Effort, RayCounts, StageCounts, TreeEnds};
use crate::trace::light::{Budget, LightScratch, Proposal, RenderContext, TreeRay};
use crate::trace::query::{ClosestHit, SurfacePoint};
use crate::trace::rays::ShapeId;

/// Pixels along a tile's side.
pub(crate) const TILE: u32 = 16;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tile {
    /// Leftmost column.
    pub(crate) i: u32,
    /// Uppermost row.
    pub(crate) j: u32,
    /// Columns, 1..=TILE.
    pub(crate) width: u32,
    /// Rows, 1..=TILE.
    pub(crate) height: u32,
}

impl Tile {
    /// Column and row of a pixel by its index.
    pub(crate) fn pixel(&self, index: u32) -> (u32, u32) {
        (self.i + index % self.width, self.j + index / self.width)
    }
}

/// A ray on its way for a pixel.
#[derive(Clone, Debug)]
pub(crate) struct QueuedRay {
    pub(crate) tree: TreeRay,
    /// Index of the pixel in the tile.
    pub(crate) pixel: u32,
    /// Whether it is mirrored; else it is refracted.
    pub(crate) mirrored: bool,
    /// Whether it is left out, as it could not show.
    pub(crate) cut: bool,
}

/// A surface point that a ray of the wave found, to be lit.
#[derive(Clone, Debug)]
pub(crate) struct LitSurface {
    /// Index of the ray in the wave.
    pub(crate) ray: u32,
    pub(crate) point: SurfacePoint,
    /// The diffuse colour there.
    pub(crate) diffuse: Rgb,
    /// The unit normal on the side that the ray came from.
    pub(crate) normal: DVec3,
}

/// What a tile's rays, generation by generation, leave from stage to stage.
#[derive(Debug)]
pub(crate) struct TileBuffers<'a> {
    /// The rays of this generation, pixel by pixel.
    pub(crate) wave: Vec<QueuedRay>,
    /// What each ray of the wave meets first.
    pub(crate) hits: Vec<Option<ClosestHit>>,
    /// The surface points that light, a medium or a mirror asks for, in the order of the wave.
    pub(crate) surfaces: Vec<LitSurface>,
    /// The light at the far end of each ray of the wave, towards its origin.
    pub(crate) radiance: Vec<Rgb>,
    /// How far that is.
    pub(crate) lengths: Vec<f64>,
    /// What a sample of one light adds at surface points, by their indices.
    pub(crate) proposals: Vec<(u32, Proposal)>,
    /// What an extended light adds at each surface point, summed over its samples.
    pub(crate) sums: Vec<DVec3>,
    /// For every light that is on: what hid it from the last point of this tile that asked, if anything did.
    pub(crate) last_occluders: Vec<Option<ShapeId>>,
    /// The next generation's rays.
    pub(crate) next: Vec<QueuedRay>,
    /// Rays that are not traced any more.
    pub(crate) beyond: Vec<QueuedRay>,
    /// How many rays of each pixel are traced.
    pub(crate) tree_sizes: Vec<u32>,
    /// What may be left out of each pixel.
    pub(crate) budgets: Vec<Budget>,
    /// What each of a pixel's next rays can bring, and its index in the queue.
    pub(crate) weighed: Vec<(f32, usize)>,
    pub(crate) scratch: LightScratch<'a>,
    /// Row by row.
    pub(crate) pixels: Vec<Rgb>,
    pub(crate) rays_traced: RayCounts,
    pub(crate) trees_ended: TreeEnds,
    pub(crate) entered: StageCounts,
}

impl<'a> TileBuffers<'a> {
    /// Once `cancelled` is true, whatever is in them will do.
    pub(crate) fn new(cancelled: &'a AtomicBool) -> Self {
        Self {
            wave: Vec::new(),
            hits: Vec::new(),
            surfaces: Vec::new(),
            radiance: Vec::new(),
            lengths: Vec::new(),
            proposals: Vec::new(),
            sums: Vec::new(),
            last_occluders: Vec::new(),
            next: Vec::new(),
            beyond: Vec::new(),
            tree_sizes: Vec::new(),
            budgets: Vec::new(),
            weighed: Vec::new(),
            scratch: LightScratch::new(cancelled),
            pixels: Vec::new(),
            rays_traced: RayCounts::default(),
            trees_ended: TreeEnds::default(),
            entered: StageCounts::default(),
        }
    }

    /// Makes ready for a sample of a tile; one that was ended may have left something.
    pub(crate) fn begin<E: Effects>(&mut self, tile: Tile, context: &RenderContext<'_>) {
        let count = (tile.width * tile.height) as usize;
        self.wave.clear();
        self.pixels.clear();
        self.pixels.resize(count, Rgb::ZERO);
        if E::MIRRORS {
            self.next.clear();
            self.beyond.clear();
            self.tree_sizes.clear();
            self.tree_sizes.resize(count, 1);
            self.budgets.clear();
            self.budgets.resize(count, Budget::new(context.scene));
        }
        self.scratch.media.clear();
        if E::LIGHTS {
            self.last_occluders.clear();
            self.last_occluders.resize(context.lights.len(), None);
        }
    }

    /// Once nobody waits for the sample any more, stages leave it as it is.
    #[inline(always)]
    pub(crate) fn is_cancelled(&self) -> bool {
        self.scratch.search.is_cancelled()
    }

    /// What the last sample brought, row by row.
    pub(crate) fn pixels(&self) -> &[Rgb] {
        &self.pixels
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
