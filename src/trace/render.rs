//! The fast path: tiles over all threads.

use std::ops::AddAssign;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::stages::{TILE, Tile, TileBuffers, render_tile};
use super::{Camera, Film, PreparedScene};
use crate::color::Rgb;

/// How many rays were traced, by what for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the camera.
    pub camera: u64,
    /// From surfaces to lights.
    pub shadow: u64,
    /// From mirrors.
    pub reflection: u64,
}

impl RayCounts {
    /// All of them.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.camera + self.shadow + self.reflection
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.camera += other.camera;
        self.shadow += other.shadow;
        self.reflection += other.reflection;
    }
}

/// Makes the picture on the current rayon pool's threads. The bits do not depend on how many there are.
///
/// `None` if `cancelled` became true before the picture was whole.
#[must_use]
pub fn render(scene: &PreparedScene, camera: &Camera, cancelled: &AtomicBool) -> Option<(Film, RayCounts)> {
    let (columns, rows) = camera.resolution();
    let tiles: Vec<Tile> = (0..rows)
        .step_by(TILE as usize)
        .flat_map(|j| (0..columns).step_by(TILE as usize).map(move |i| (i, j)))
        .map(|(i, j)| Tile { i, j, width: TILE.min(columns - i), height: TILE.min(rows - j) })
        .collect();
    let finished: Option<Vec<(Vec<Rgb>, RayCounts)>> = tiles
        .par_iter()
        .map_init(TileBuffers::default, |buffers, tile| {
            if cancelled.load(Ordering::Relaxed) {
                return None;
            }
            buffers.counts = RayCounts::default();
            render_tile(scene, camera, *tile, buffers);
            Some((buffers.pixels.clone(), buffers.counts))
        })
        .collect();

    let mut film = Film::new(columns, rows);
    let mut counts = RayCounts::default();
    for (tile, (pixels, tile_counts)) in tiles.iter().zip(finished?) {
        for (row, pixels) in (tile.j..).zip(pixels.chunks(tile.width as usize)) {
            film.store(tile.i, row, pixels);
        }
        counts += tile_counts;
    }
    Some((film, counts))
}
