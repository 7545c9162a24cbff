//! Numbers of rays in the tiles of pictures.

use serde::Serialize;

use super::publish::Picture;
use crate::trace::{RayCounts, TILE};

/// The number of rays in each tile of a picture, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(super) struct TileRayCounts {
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
}

impl TileRayCounts {
    /// Returns `None` for a coarse picture.
    pub(super) fn of(picture: &Picture) -> Option<Self> {
        let count = |rays: fn(&RayCounts) -> u64| picture.tile_rays.iter().map(rays).collect();
        (!picture.tile_rays.is_empty()).then(|| Self {
            tile: TILE,
            columns: picture.info.width.div_ceil(TILE),
            camera: count(|rays| rays.camera),
            shadow: count(|rays| rays.shadow),
            reflection: count(|rays| rays.reflection),
            refraction: count(|rays| rays.refraction),
        })
    }
}
