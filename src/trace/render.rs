//! The fast path: tiles over all threads.

use std::ops::AddAssign;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::geometry::{Leaves, with_leaves};
use super::stages::{TILE, Tile, TileBuffers, render_sample};
use super::{Camera, Film, Guards, PreparedScene, Sampling};
use crate::color::Rgb;

/// What a picture took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Rays.
    pub rays: RayCounts,
    /// How often arithmetic had to be helped.
    pub guards: Guards,
}

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
pub fn render(
    scene: &PreparedScene,
    camera: &Camera,
    sampling: Sampling,
    cancelled: &AtomicBool,
) -> Option<(Film, Effort)> {
    with_leaves!(scene, leaves => render_with(scene, leaves, camera, sampling, cancelled))
}

fn render_with(
    scene: &PreparedScene,
    leaves: &impl Leaves,
    camera: &Camera,
    sampling: Sampling,
    cancelled: &AtomicBool,
) -> Option<(Film, Effort)> {
    let (columns, rows) = camera.resolution();
    let tiles: Vec<Tile> = (0..rows)
        .step_by(TILE as usize)
        .flat_map(|j| (0..columns).step_by(TILE as usize).map(move |i| (i, j)))
        .map(|(i, j)| Tile { i, j, width: TILE.min(columns - i), height: TILE.min(rows - j) })
        .collect();
    let finished: Option<Vec<(Vec<Rgb>, Effort)>> = tiles
        .par_iter()
        .map_init(TileBuffers::default, |buffers, tile| {
            buffers.begin(*tile);
            for sample in 0..sampling.samples {
                if cancelled.load(Ordering::Relaxed) {
                    return None;
                }
                render_sample(scene, leaves, camera, sampling, (*tile, sample), buffers);
            }
            buffers.finish(sampling.samples);
            let rays = std::mem::take(&mut buffers.counts);
            let guards = std::mem::take(&mut buffers.scratch.guards);
            Some((buffers.pixels.clone(), Effort { rays, guards }))
        })
        .collect();

    let mut film = Film::new(columns, rows);
    let mut effort = Effort::default();
    for (tile, (pixels, tile_effort)) in tiles.iter().zip(finished?) {
        for (row, pixels) in (tile.j..).zip(pixels.chunks(tile.width as usize)) {
            effort.guards.overflowed += film.store(tile.i, row, pixels);
        }
        effort.rays += tile_effort.rays;
        effort.guards += tile_effort.guards;
    }
    Some((film, effort))
}
