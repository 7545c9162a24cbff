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
//! A picture of several instants is compared instant by instant. The records of a tile cover the rays of all instants, and the differences of all
//! instants are tested against them.
//!
//! Rays of negligible contribution are dropped by bounds on all radiance of the scene. If these bounds differ, only tiles without secondary
//! rays, traced or dropped, are reused.

use std::sync::Arc;

use rayon::prelude::*;

use super::film::Film;
use super::film_overlay::FilmOverlay;
use super::image::RenderedImage;
use crate::color::{Encoding, Linear};
use crate::trace::effects::Effects;
use crate::trace::math::{Bytes, Digest, PixelSampling};
use crate::trace::render_stats::{RenderStats, TreeEnds};
use crate::trace::scene::{PreparedCamera, PreparedScene, ShapeDifferences, ShapeSnapshot};
use crate::trace::shading::RadianceBound;
use crate::trace::stages::{LightRegion, Tile, TileDependencies};

/// A finished picture whose tiles can be reused in later ones: see [`RenderRequest::reuse`](crate::RenderRequest::reuse).
#[derive(Clone, Debug)]
pub struct ReusablePicture<E: Encoding = Linear> {
    encoding: E,
    film: Film<E::Pixel>,
    /// The fraction of each pixel that the scene covers, if the picture has alpha.
    alpha: Option<Film<f32>>,
    instants: Vec<InstantRecord>,
    tiles: Vec<Arc<TileRecord>>,
}

/// All that a picture depends on at one of its instants.
#[derive(Clone, Debug)]
struct InstantRecord {
    /// The digest of everything except the shapes, their materials and the bounds.
    common: Digest,
    /// The digest of the bounds by which secondary rays are dropped.
    radiance_bound: Digest,
    shapes: ShapeSnapshot,
}

/// The dependencies and the costs of a tile.
#[derive(Clone, Debug, Default)]
pub(in crate::trace) struct TileRecord {
    pub(in crate::trace) dependencies: TileDependencies,
    pub(in crate::trace) stats: RenderStats,
}

/// The inputs of a picture at one of its instants.
#[derive(Clone, Copy)]
pub(crate) struct InstantInputs<'a> {
    pub(crate) scene: &'a PreparedScene,
    pub(crate) camera: &'a PreparedCamera,
    pub(crate) sampling: PixelSampling,
    pub(crate) effects: Effects,
    pub(crate) overlay: Option<&'a FilmOverlay>,
}

/// The reuse of tiles in a picture: its inputs, instant by instant, and their differences from those of a former picture.
#[derive(Clone, Debug)]
pub(crate) struct TileReuse<E: Encoding> {
    /// The picture of which tiles are reused. `None` if any tile may differ.
    former: Option<Arc<ReusablePicture<E>>>,
    instants: Vec<InstantRecord>,
    /// The differences at any instant.
    differences: ShapeDifferences,
    /// The lights of all instants.
    lights: Vec<(u32, LightRegion)>,
    /// True if the radiance bounds are the same at all instants.
    has_same_bounds: bool,
}

impl InstantInputs<'_> {
    fn record(&self) -> InstantRecord {
        let Self { scene, camera, sampling: PixelSampling { samples, seed }, effects, overlay } = *self;
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
        InstantRecord { common: bytes.finish(), radiance_bound: bounds.finish(), shapes: scene.snapshot() }
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
    /// Maximum number of shapes, over all instants, of a picture whose tiles are reused. Larger ones were not measured.
    pub(crate) const MOST_SHAPES: usize = 1 << 17;
}

impl<E: Encoding> TileReuse<E> {
    /// Starts the comparison of a picture with a former one. `has_alpha` is true for a picture with an alpha channel.
    pub(crate) fn new(encoding: E, has_alpha: bool, former: Option<&Arc<ReusablePicture<E>>>) -> Self {
        let is_alike = |former: &&Arc<ReusablePicture<E>>| {
            former.encoding == encoding && former.alpha.is_some() == has_alpha
        };
        Self {
            former: former.filter(is_alike).map(Arc::clone),
            instants: Vec::new(),
            differences: ShapeDifferences::default(),
            lights: Vec::new(),
            has_same_bounds: true,
        }
    }

    /// Compares the next instant.
    pub(crate) fn add(&mut self, inputs: &InstantInputs<'_>) {
        let record = inputs.record();
        let differences = self.former.as_ref().and_then(|former| {
            let before =
                former.instants.get(self.instants.len()).filter(|before| before.common == record.common)?;
            self.has_same_bounds &= before.radiance_bound == record.radiance_bound;
            inputs.scene.differences(&before.shapes)
        });
        match differences {
            Some(differences) => self.differences.join(&differences),
            None => self.former = None,
        }
        for light in LightRegion::all(inputs.scene) {
            if !self.lights.contains(&light) {
                self.lights.push(light);
            }
        }
        self.instants.push(record);
    }

    /// Returns the former picture if all of its instants were compared and tiles of it may be the same.
    fn comparable(&self) -> Option<&Arc<ReusablePicture<E>>> {
        self.former.as_ref().filter(|former| former.instants.len() == self.instants.len())
    }

    /// Returns the records of the tiles, in order, whose pixels are those of the former picture; `None` for tiles that may differ.
    pub(super) fn unchanged_tiles(&self) -> Vec<Option<Arc<TileRecord>>> {
        let Some(former) = self.comparable() else { return Vec::new() };
        let differences = self.differences.condensed();
        let is_unchanged = |tile: &TileRecord| {
            (self.has_same_bounds || tile.is_direct())
                && !tile.dependencies.may_be_reached(&differences, &self.lights)
        };
        former.tiles.par_iter().map(|tile| is_unchanged(tile).then(|| Arc::clone(tile))).collect()
    }

    /// Returns the fraction of the tiles that are reused.
    pub(crate) fn share(&self) -> f64 {
        let tiles = self.unchanged_tiles();
        tiles.iter().flatten().count() as f64 / tiles.len().max(1) as f64
    }

    /// Copies a reused tile into a picture.
    pub(super) fn copy_tile(&self, film: &mut Film<E::Pixel>, alpha: Option<&mut Film<f32>>, tile: &Tile) {
        let Some(former) = &self.former else { return };
        film.copy_tile(&former.film, tile);
        if let (Some(alpha), Some(before)) = (alpha, &former.alpha) {
            alpha.copy_tile(before, tile);
        }
    }

    /// Finishes a picture, given the records of all of its tiles.
    pub(super) fn finish(
        self,
        encoding: E,
        image: &RenderedImage<E::Pixel>,
        tiles: Vec<Arc<TileRecord>>,
    ) -> ReusablePicture<E> {
        let (film, alpha) = (image.film.clone(), image.alpha.clone());
        ReusablePicture { encoding, film, alpha, instants: self.instants, tiles }
    }
}

#[cfg(test)]
mod tests;
