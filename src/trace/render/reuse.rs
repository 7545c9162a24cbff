//! Reuse of the tiles of a former picture that no difference between two scenes can reach.
//!
//! While a picture is traced, each tile records the regions that its rays and their shadow rays pass through, and the materials at which they
//! end ([`TileDependencies`]). The next picture compares the shapes of its scene with a copy of the former ones, by content. A tile whose
//! records meet no shape that differs keeps its pixels; all others are traced.
//!
//! # Proof
//!
//! By induction over the bounces of a sample. Its camera ray is the same, since all inputs but the shapes are compared as a digest. Let a ray
//! be the same in both scenes. Every shape that may be its closest hit, coincide there, contain its origin or its end or, between a lit end
//! and a light, occlude, be crossed by or contain the shadow ray, has a point of its bounds within rounding of one of the recorded segments.
//! No shape that differs has one, before or after. So the hit, its ties, its media and its shadow rays are decided among shapes that are the
//! same and in the same order, and so is the material at the end. The light and the rays of the next bounce are therefore the same.
//!
//! Rays of negligible contribution are dropped by bounds on all radiance of the scene. If these bounds differ, only tiles without secondary
//! rays, traced or dropped, are reused.

use std::sync::Arc;

use rayon::prelude::*;

use super::film::Film;
use super::film_overlay::FilmOverlay;
use crate::color::{Encoding, Linear};
use crate::trace::effects::Effects;
use crate::trace::math::{Bytes, Digest, PixelSampling};
use crate::trace::render_stats::{RenderStats, TreeEnds};
use crate::trace::scene::{PreparedCamera, PreparedScene, ShapeSnapshot};
use crate::trace::shading::RadianceBound;
use crate::trace::stages::{LightRegion, Tile, TileDependencies};

/// A finished picture whose tiles can be reused in later ones: see [`RenderRequest::reuse`](crate::RenderRequest::reuse).
#[derive(Clone, Debug)]
pub struct ReusablePicture<E: Encoding = Linear> {
    encoding: E,
    film: Film<E::Pixel>,
    inputs: InputDigests,
    shapes: ShapeSnapshot,
    tiles: Vec<TileRecord>,
}

/// The digests of everything that pixels depend on, except the shapes and their materials.
#[derive(Clone, Copy, Debug, PartialEq)]
struct InputDigests {
    /// The inputs of all pixels.
    common: Digest,
    /// The bounds by which secondary rays are dropped.
    radiance_bound: Digest,
}

/// The dependencies and the costs of a tile.
#[derive(Clone, Debug, Default)]
pub(in crate::trace) struct TileRecord {
    pub(in crate::trace) dependencies: TileDependencies,
    pub(in crate::trace) stats: RenderStats,
}

/// The inputs of a picture of a single instant.
#[derive(Clone, Copy)]
pub(crate) struct PictureInputs<'a> {
    pub(crate) scene: &'a PreparedScene,
    pub(crate) camera: &'a PreparedCamera,
    pub(crate) sampling: PixelSampling,
    pub(crate) effects: Effects,
}

/// The reuse of tiles in a picture that is being rendered.
#[derive(Clone, Debug)]
pub(super) struct TileReuse<E: Encoding> {
    /// The picture of which tiles are reused, if any are.
    former: Option<Arc<ReusablePicture<E>>>,
    inputs: InputDigests,
    shapes: ShapeSnapshot,
}

impl PictureInputs<'_> {
    fn digests(&self, overlay: Option<&FilmOverlay>) -> InputDigests {
        let Self { scene, camera, sampling: PixelSampling { samples, seed }, effects } = *self;
        let mut bytes = Bytes::default();
        bytes.count(samples);
        bytes.count(if samples > 1 || scene.samples_light() { seed } else { 0 });
        // Pixels do not depend on the effects, but the numbers of rays do.
        bytes.count(effects.lighting as u64);
        bytes.count(effects.paths as u64);
        bytes.count(effects.extras);
        camera.write(&mut bytes);
        scene.write_surroundings(&mut bytes);
        if let Some(overlay) = overlay {
            overlay.write(&mut bytes);
        }
        let mut bounds = Bytes::default();
        RadianceBound::of(scene).write(&mut bounds);
        InputDigests { common: bytes.finish(), radiance_bound: bounds.finish() }
    }
}

impl TileRecord {
    /// Returns whether no secondary rays were spawned.
    fn is_direct(&self) -> bool {
        let RenderStats { rays, ends, .. } = self.stats;
        rays.reflection == 0 && rays.refraction == 0 && ends == TreeEnds::default()
    }
}

impl<E: Encoding> ReusablePicture<E> {
    /// Maximum number of shapes of a scene whose pictures are reused. Larger scenes were not measured.
    pub(crate) const MOST_SHAPES: usize = 1 << 17;

    /// Returns, tile by tile, whether the pixels are the same in a picture with these inputs. `None` if any of them may differ.
    fn unchanged_tiles(&self, inputs: &InputDigests, scene: &PreparedScene) -> Option<Vec<bool>> {
        let comparable = self.inputs.common == inputs.common;
        let differences = comparable.then(|| scene.differences(&self.shapes)).flatten()?;
        let (lights, same_bounds) =
            (LightRegion::all(scene), self.inputs.radiance_bound == inputs.radiance_bound);
        let is_unchanged = |tile: &TileRecord| {
            (same_bounds || tile.is_direct()) && !tile.dependencies.may_be_reached(&differences, &lights)
        };
        Some(self.tiles.par_iter().map(is_unchanged).collect())
    }

    /// Returns the share of the tiles that a picture with these inputs would reuse.
    pub(crate) fn reusable_share(&self, inputs: &PictureInputs<'_>, overlay: Option<&FilmOverlay>) -> f64 {
        let unchanged = self.unchanged_tiles(&inputs.digests(overlay), inputs.scene).unwrap_or_default();
        let count = unchanged.iter().filter(|is_unchanged| **is_unchanged).count();
        count as f64 / self.tiles.len().max(1) as f64
    }
}

impl<E: Encoding> TileReuse<E> {
    /// Starts a picture. Also returns the records of the tiles that it reuses, tile by tile.
    pub(super) fn new(
        encoding: E,
        former: Option<&Arc<ReusablePicture<E>>>,
        inputs: &PictureInputs<'_>,
        overlay: Option<&FilmOverlay>,
    ) -> (Self, Vec<Option<TileRecord>>) {
        let digests = inputs.digests(overlay);
        let former = former.filter(|former| former.encoding == encoding);
        let found = former.and_then(|former| Some((former, former.unchanged_tiles(&digests, inputs.scene)?)));
        let records = found.as_ref().map_or_else(Vec::new, |(former, unchanged)| {
            let tiles = former.tiles.iter().zip(unchanged);
            tiles.map(|(record, is_unchanged)| is_unchanged.then(|| record.clone())).collect()
        });
        let former = found.map(|(former, _)| Arc::clone(former));
        (Self { former, inputs: digests, shapes: inputs.scene.snapshot() }, records)
    }

    /// Copies a reused tile into a film.
    pub(super) fn copy_tile(&self, film: &mut Film<E::Pixel>, tile: &Tile) {
        if let Some(former) = &self.former {
            film.copy_tile(&former.film, tile);
        }
    }

    /// Finishes a picture, given its film and the records of all of its tiles.
    pub(super) fn finish(
        self,
        encoding: E,
        film: Film<E::Pixel>,
        tiles: Vec<TileRecord>,
    ) -> ReusablePicture<E> {
        let Self { inputs, shapes, .. } = self;
        ReusablePicture { encoding, film, inputs, shapes, tiles }
    }
}

#[cfg(test)]
mod tests;
