//! A tile's working memory. One per thread, reused from tile to tile.

use std::sync::atomic::AtomicBool;

use crate::color::Rgb;
use crate::trace::Slot;
use crate::trace::branch::TreeRay;
use crate::trace::contribution::Budget;
use crate::trace::effects::Effects;
use crate::trace::exposure::{Effort, RayCounts, TreeEnds};
use crate::trace::moment::Moment;
use crate::trace::scratch::Scratch;

/// Pixels along a tile's side.
pub(in crate::trace) const TILE: u32 = 16;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug)]
pub(in crate::trace) struct Tile {
    /// Leftmost column.
    pub(in crate::trace) i: u32,
    /// Uppermost row.
    pub(in crate::trace) j: u32,
    /// Columns, 1..=TILE.
    pub(in crate::trace) width: u32,
    /// Rows, 1..=TILE.
    pub(in crate::trace) height: u32,
}

impl Tile {
    /// Column and row of a pixel by its index.
    pub(super) fn pixel(&self, index: u32) -> (u32, u32) {
        (self.i + index % self.width, self.j + index / self.width)
    }
}

/// A ray on its way for a pixel.
#[derive(Clone, Debug)]
pub(super) struct QueuedRay {
    pub(super) tree: TreeRay,
    /// Index of the pixel in the tile.
    pub(super) pixel: u32,
    /// Is it mirrored, or refracted?
    pub(super) mirrored: bool,
    /// Is it left out, as it could not show?
    pub(super) cut: bool,
}

/// The queue of the next generation, and what a sample brings to the tile's pixels.
#[derive(Debug)]
pub(in crate::trace) struct TileBuffers<'a> {
    /// The next generation's rays.
    pub(super) next: Vec<QueuedRay>,
    /// Room for the one after it.
    pub(super) spare: Vec<QueuedRay>,
    /// Rays that are not traced any more.
    pub(super) beyond: Vec<QueuedRay>,
    /// How many rays of each pixel are traced.
    pub(super) tree_sizes: Vec<u32>,
    /// What may be left out of each pixel.
    pub(super) budgets: Vec<Budget>,
    /// What each of a pixel's next rays can bring, and its index in the queue.
    pub(super) weighed: Vec<(f32, usize)>,
    pub(super) scratch: Scratch<'a>,
    /// For every light that is on: what hid it from the last point of this tile that asked, if anything did.
    pub(super) last_occluders: Vec<Option<Slot>>,
    /// Row by row.
    pub(super) pixels: Vec<Rgb>,
    pub(super) rays_traced: RayCounts,
    pub(super) trees_ended: TreeEnds,
}

impl<'a> TileBuffers<'a> {
    /// Once `cancelled` is true, whatever is in them will do.
    pub(in crate::trace) fn new(cancelled: &'a AtomicBool) -> Self {
        Self {
            next: Vec::new(),
            spare: Vec::new(),
            beyond: Vec::new(),
            tree_sizes: Vec::new(),
            budgets: Vec::new(),
            weighed: Vec::new(),
            scratch: Scratch::new(cancelled),
            last_occluders: Vec::new(),
            pixels: Vec::new(),
            rays_traced: RayCounts::default(),
            trees_ended: TreeEnds::default(),
        }
    }

    pub(super) fn begin<E: Effects>(&mut self, tile: Tile, moment: &Moment<'_>) {
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
            self.budgets.resize(count, Budget::new(moment.scene));
        }
        self.scratch.nesting.clear();
        if E::LIGHTS {
            self.last_occluders.clear();
            self.last_occluders.resize(moment.lights.len(), None);
        }
    }

    /// What the last sample brought, row by row.
    pub(in crate::trace) fn pixels(&self) -> &[Rgb] {
        &self.pixels
    }

    /// What all samples since the last call took.
    pub(in crate::trace) fn take_effort(&mut self) -> Effort {
        Effort {
            rays: std::mem::take(&mut self.rays_traced),
            ends: std::mem::take(&mut self.trees_ended),
            guards: std::mem::take(&mut self.scratch.guards),
        }
    }
}
