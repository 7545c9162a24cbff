//! What all samples of a tile's pixels have in common.

use super::tile::{PACKETS, Tile};
use crate::trace::light::RenderContext;
use crate::trace::packet::LensCandidates;
use crate::trace::query::Scratch;
use crate::trace::scene::{Precision, SpreadKeys};

/// What is the same for all samples of a tile's pixels, where those have several.
#[derive(Debug)]
pub(super) struct SpreadTile {
    /// For which tile that is known.
    known: Option<Tile>,
    /// By packet: where samples lie.
    pub(super) keys: Box<[SpreadKeys; PACKETS]>,
    /// What they may meet, if there is a lens.
    pub(super) candidates: LensCandidates,
}

impl Default for SpreadTile {
    fn default() -> Self {
        let keys = Box::new([const { SpreadKeys::NONE }; PACKETS]);
        Self { known: None, keys, candidates: LensCandidates::default() }
    }
}

impl SpreadTile {
    /// Finds that of a tile, unless it is known.
    pub(super) fn find(&mut self, context: &RenderContext<'_>, tile: Tile, search: &mut Scratch<'_>) {
        if self.known.replace(tile) == Some(tile) {
            return;
        }
        let (seed, has_lens) = (context.sampling.seed, context.camera.has_lens());
        let squares = std::array::from_fn(|packet| tile.square(packet));
        for (keys, square) in self.keys.iter_mut().zip(&squares) {
            if let Some(square) = square {
                keys.find(seed, square, has_lens);
            }
        }
        if has_lens && context.scene.precision == Precision::Guaranteed {
            self.candidates.find(context.scene, context.camera, &squares, search);
        }
    }
}
