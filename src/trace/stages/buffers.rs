//! A tile's working memory. One per thread, reused from tile to tile.

use std::sync::atomic::AtomicBool;

use crate::color::Rgb;
use crate::trace::effects::Effects;
use crate::trace::effort::{Effort, RayCounts, TreeEnds};
use crate::trace::light::{Budget, LightScratch, RenderContext, TreeRay};
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

/// The queue of the next generation, and what a sample brings to the tile's pixels.
#[derive(Debug)]
pub(crate) struct TileBuffers<'a> {
    /// The next generation's rays.
    pub(crate) next: Vec<QueuedRay>,
    /// Room for the one after it.
    pub(crate) spare: Vec<QueuedRay>,
    /// Rays that are not traced any more.
    pub(crate) beyond: Vec<QueuedRay>,
    /// How many rays of each pixel are traced.
    pub(crate) tree_sizes: Vec<u32>,
    /// What may be left out of each pixel.
    pub(crate) budgets: Vec<Budget>,
    /// What each of a pixel's next rays can bring, and its index in the queue.
    pub(crate) weighed: Vec<(f32, usize)>,
    pub(crate) scratch: LightScratch<'a>,
    /// For every light that is on: what hid it from the last point of this tile that asked, if anything did.
    pub(crate) last_occluders: Vec<Option<ShapeId>>,
    /// Row by row.
    pub(crate) pixels: Vec<Rgb>,
    pub(crate) rays_traced: RayCounts,
    pub(crate) trees_ended: TreeEnds,
}

impl<'a> TileBuffers<'a> {
    /// Once `cancelled` is true, whatever is in them will do.
    pub(crate) fn new(cancelled: &'a AtomicBool) -> Self {
        Self {
            next: Vec::new(),
            spare: Vec::new(),
            beyond: Vec::new(),
            tree_sizes: Vec::new(),
            budgets: Vec::new(),
            weighed: Vec::new(),
            scratch: LightScratch::new(cancelled),
            last_occluders: Vec::new(),
            pixels: Vec::new(),
            rays_traced: RayCounts::default(),
            trees_ended: TreeEnds::default(),
        }
    }

    pub(crate) fn begin<E: Effects>(&mut self, tile: Tile, context: &RenderContext<'_>) {
        let count = (tile.width * tile.height) as usize;
        self.pixels.resize(count, Rgb::ZERO);
        if E::MIRRORS {
            // A sample that was ended may have left some.
            self.next.clear();
            self.beyond.clear();
            self.pixels.fill(Rgb::ZERO);
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

    /// What the last sample brought, row by row.
    pub(crate) fn pixels(&self) -> &[Rgb] {
        &self.pixels
    }

    /// What all samples since the last call took.
    pub(crate) fn take_effort(&mut self) -> Effort {
        Effort {
            rays: std::mem::take(&mut self.rays_traced),
            ends: std::mem::take(&mut self.trees_ended),
            escalations: std::mem::take(&mut self.scratch.search.escalations),
        }
    }
}
