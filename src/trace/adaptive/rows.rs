//! Numbers of all pixels.

use rayon::prelude::*;

/// So many numbers of every pixel: row by row, and in a row first all first ones.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows<const COUNT: usize> {
    width: usize,
    numbers: Vec<f32>,
}

impl<const COUNT: usize> Rows<COUNT> {
    /// Makes them those of so many pixels, which may be anything.
    pub(super) fn resize(&mut self, (width, height): (usize, usize)) {
        self.width = width;
        self.numbers.resize(COUNT * width * height, 0.0);
    }

    /// Returns a row.
    pub(super) fn row(&self, row: usize) -> [&[f32]; COUNT] {
        let length = COUNT * self.width;
        parts(&self.numbers[row * length..][..length])
    }

    /// Goes through a row and those beside it.
    pub(super) fn around(&self, row: usize) -> impl Iterator<Item = [&[f32]; COUNT]> {
        let length = COUNT * self.width;
        let range = row.saturating_sub(1) * length..self.numbers.len().min((row + 2) * length);
        self.numbers[range].chunks_exact(length).map(parts)
    }

    /// Goes through bands of so many rows over all threads; the last may have fewer.
    pub(super) fn par_bands_mut(
        &mut self,
        rows: usize,
    ) -> impl IndexedParallelIterator<Item = Vec<[&mut [f32]; COUNT]>> {
        let width = self.width;
        let bands = self.numbers.par_chunks_mut(COUNT * width * rows);
        bands.map(move |band| band.chunks_exact_mut(COUNT * width).map(|row| parts_mut(row, width)).collect())
    }

    /// Goes through all rows over all threads.
    pub(super) fn par_iter_mut(&mut self) -> impl IndexedParallelIterator<Item = [&mut [f32]; COUNT]> {
        let width = self.width;
        self.numbers.par_chunks_exact_mut(COUNT * width).map(move |row| parts_mut(row, width))
    }
}

/// Divides numbers in equal parts.
fn parts<const COUNT: usize>(numbers: &[f32]) -> [&[f32]; COUNT] {
    let length = numbers.len() / COUNT;
    std::array::from_fn(|part| &numbers[part * length..][..length])
}

/// The same, to be changed.
pub(super) fn parts_mut<const COUNT: usize>(numbers: &mut [f32], length: usize) -> [&mut [f32]; COUNT] {
    let mut parts = numbers.chunks_exact_mut(length);
    std::array::from_fn(|_| parts.next().unwrap_or_default())
}
