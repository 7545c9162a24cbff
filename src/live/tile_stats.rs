//! Numbers of rays and errors of the tiles of pictures.

use serde::Serialize;

use super::publish::Picture;
use crate::trace::{RayCounts, TILE};

/// The number of rays and the error of each tile of a picture, row by row from the top.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct PictureTiles {
    /// Pixels along a tile's side.
    pub(super) tile: u32,
    /// Tiles in a row. The last one, and those of the last row, may be smaller.
    pub(super) columns: u32,
    /// Camera rays.
    pub(super) camera: Vec<u64>,
    /// Shadow rays.
    pub(super) shadow: Vec<u64>,
    /// Reflected rays.
    pub(super) reflection: Vec<u64>,
    /// Refracted rays.
    pub(super) refraction: Vec<u64>,
    /// RMS errors, in output values: measured, or estimated if the picture has an error target.
    pub(super) error: Option<Vec<f32>>,
    /// True if the errors are measured.
    pub(super) is_measured: bool,
}

impl PictureTiles {
    /// Returns `None` for a coarse picture.
    pub(super) fn of(picture: &Picture) -> Option<Self> {
        let tiles = &picture.tile_stats;
        let count = |rays: fn(&RayCounts) -> u64| tiles.iter().map(|tile| rays(&tile.rays)).collect();
        let measured = picture.measured_errors.as_deref().filter(|errors| errors.len() == tiles.len());
        let estimated = || tiles.iter().map(|tile| tile.error).collect();
        (!tiles.is_empty()).then(|| Self {
            tile: TILE,
            columns: picture.info.width.div_ceil(TILE),
            camera: count(|rays| rays.camera),
            shadow: count(|rays| rays.shadow),
            reflection: count(|rays| rays.reflection),
            refraction: count(|rays| rays.refraction),
            error: measured.map(<[f32]>::to_vec).or_else(estimated),
            is_measured: measured.is_some(),
        })
    }
}
