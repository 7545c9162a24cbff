//! Packets of camera rays, each for four by four pixels.

use fearless_simd::prelude::*;
use glam::DVec3;

use super::{PreparedCamera, pinhole};
use crate::trace::math::{
    Dimension, LANES, Numbers, PixelSamples, PixelSampling, SampleKeys, Scaled, Vectors, add, bits, finite3,
    half_lanes, lanes, on_disc, scaled_lanes, splat3,
};
use crate::trace::rays::{PreparedRay, RayPacket, Rays};

/// Side length, in pixels, of the square that a packet's rays pass through.
pub(crate) const SIDE: u32 = 4;

/// The columns and rows of the lanes in the square.
const COLUMN: [u32; LANES] = [0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3];
const ROW: [u32; LANES] = [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3];

/// The pixels of a packet's rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Square {
    /// Column and row, in the picture, of the first pixel: multiples of four.
    pub(crate) first: (u32, u32),
    /// Numbers of columns and rows, up to four.
    pub(crate) size: (u32, u32),
}

impl Square {
    /// Returns the lanes that have a pixel, as a bit mask.
    #[inline(always)]
    pub(crate) fn lanes(&self) -> u32 {
        if self.size == (SIDE, SIDE) {
            return (1 << LANES) - 1;
        }
        (0..LANES).filter(|lane| self.has(*lane)).fold(0, |mask, lane| mask | 1 << lane)
    }

    /// Returns the corners of the area of its samples, by column and row, as if it were full.
    pub(super) fn corners(&self) -> [(f64, f64); 4] {
        let (column, row) = (f64::from(self.first.0) - 0.5, f64::from(self.first.1) - 0.5);
        let side = f64::from(SIDE);
        [(column, row), (column + side, row), (column, row + side), (column + side, row + side)]
    }

    fn has(&self, lane: usize) -> bool {
        COLUMN[lane] < self.size.0 && ROW[lane] < self.size.1
    }

    /// Returns the column and row of the pixel in a lane.
    #[cfg(test)]
    pub(crate) fn pixel(&self, lane: usize) -> (u32, u32) {
        (self.first.0 + COLUMN[lane], self.first.1 + ROW[lane])
    }
}

/// The centres of all pixels, as the sum of a vector per column and a vector per row. The last column and row are repeated beyond the
/// picture's edges.
pub(crate) struct PixelCenters {
    eye: DVec3,
    forward: DVec3,
    is_orthographic: bool,
    /// The vectors of four columns per entry, in the lanes of a packet; `rows` holds the vectors of four rows per entry.
    columns: Vec<Vectors>,
    rows: Vec<Vectors>,
}

impl PixelCenters {
    /// Computes the centres of a camera's pixels.
    pub(crate) fn of(camera: &PreparedCamera) -> Self {
        let column = |i: u32| camera.right * camera.across(f64::from(i.min(camera.columns - 1)));
        let row = |j: u32| camera.up * camera.upwards(f64::from(j.min(camera.rows - 1)));
        let groups = |count: u32| (0..count).step_by(SIDE as usize);
        let spread = |of_lane: &dyn Fn(usize) -> DVec3| {
            let mut lanes = Vectors::splat(DVec3::ZERO);
            (0..LANES).for_each(|lane| lanes.set(lane, of_lane(lane)));
            lanes
        };
        let columns = groups(camera.columns).map(|i| spread(&|lane| column(i + COLUMN[lane]))).collect();
        let rows = groups(camera.rows).map(|j| spread(&|lane| row(j + ROW[lane]))).collect();
        let PreparedCamera { eye, forward, is_orthographic, .. } = *camera;
        Self { eye, forward, is_orthographic, columns, rows }
    }

    /// Stores the rays through the centres of pixels in the lanes, row by row. Each is the [`PreparedCamera::ray`] of its pixel.
    #[inline(always)]
    pub(crate) fn rays<S: Simd>(&self, simd: S, square: &Square, rays: &mut RayPacket) {
        rays.clear();
        if !self.eye.is_finite() {
            return;
        }
        let (i, j) = square.first;
        let (across, upwards) = (&self.columns[(i / SIDE) as usize], &self.rows[(j / SIDE) as usize]);
        // Perspective rays start at the eye, which is finite.
        rays.origins = Vectors::splat(self.eye);
        let (eye, forward) = (splat3(simd, self.eye), splat3(simd, self.forward));
        let active = square.lanes();
        let mut escalated = 0;
        for half in 0..2 {
            let on_screen = add(across.load(simd, half), upwards.load(simd, half));
            let Rays { origin, direction } = pinhole(eye, on_screen, forward, self.is_orthographic);
            let Scaled { direction, mut in_range, .. } = scaled_lanes(simd, direction);
            if self.is_orthographic {
                in_range &= finite3(simd, origin);
                rays.origins.store(half, origin);
            }
            escalated |= active & bits(!in_range, half);
            rays.directions.store(half, direction);
        }
        rays.lanes = active & !escalated;
        for lane in lanes(escalated) {
            let on_screen = (across.get(lane) + upwards.get(lane)).to_array();
            let (eye, forward) = (self.eye.to_array(), self.forward.to_array());
            let Rays { origin, direction } = pinhole(eye, on_screen, forward, self.is_orthographic);
            if let Some(ray) = PreparedRay::new(origin.into(), direction.into()) {
                rays.set(lane, &ray);
            }
        }
    }
}

/// The keys of the sample positions of a packet's pixels, which all samples share.
#[derive(Clone, Debug)]
pub(crate) struct PixelKeys {
    /// The lanes that have a pixel, as a bit mask.
    lanes: u32,
    /// Columns and rows, by lane.
    pixels: [(u32, u32); LANES],
    columns: Numbers,
    rows: Numbers,
    on_screen: SampleKeys,
    on_lens: SampleKeys,
}

impl PixelKeys {
    /// The keys of no pixels.
    pub(crate) const NONE: Self = Self {
        lanes: 0,
        pixels: [(0, 0); LANES],
        columns: Numbers::splat(0.0),
        rows: Numbers::splat(0.0),
        on_screen: SampleKeys::NONE,
        on_lens: SampleKeys::NONE,
    };

    /// Computes the keys of the pixels in some lanes, given by column and row, and their keys on the lens if there is one.
    #[inline(always)]
    pub(crate) fn find(&mut self, seed: u64, (pixels, mask): (&[(u32, u32); LANES], u32), has_lens: bool) {
        (self.lanes, self.pixels) = (mask, *pixels);
        // In all lanes and in short loops, so that compilers vectorize the hashes.
        for (lane, (i, j)) in pixels.iter().enumerate() {
            self.columns.set(lane, f64::from(*i));
            self.rows.set(lane, f64::from(*j));
        }
        for (lane, (i, j)) in pixels.iter().enumerate() {
            self.on_screen.set(lane, &PixelSamples::new(seed, *i, *j), Dimension::Pixel);
        }
        if has_lens {
            for (lane, (i, j)) in pixels.iter().enumerate() {
                self.on_lens.set(lane, &PixelSamples::new(seed, *i, *j), Dimension::Lens);
            }
        }
    }

    /// Selects the lanes that have a pixel, among the lanes passed to [`PixelKeys::find`].
    pub(crate) fn set_lanes(&mut self, lanes: u32) {
        self.lanes = lanes;
    }
}

impl PreparedCamera {
    /// Stores the rays of pixels' samples in the lanes, given a sample index for each lane. Each is the [`PreparedCamera::spread_ray`] of its
    /// pixel.
    #[inline(always)]
    pub(crate) fn sample_rays<S: Simd>(
        &self,
        simd: S,
        sampling: PixelSampling,
        keys: &PixelKeys,
        indices: &[u32; LANES],
        rays: &mut RayPacket,
    ) {
        rays.clear();
        let active = keys.lanes;
        if active == 0 {
            return;
        }
        let on_screen = keys.on_screen.positions(simd, indices);
        let on_lens = self.lens.map(|_| keys.on_lens.pairs(simd, indices));
        let mut escalated = 0;
        for half in 0..2 {
            let column = keys.columns.load(simd, half) + (on_screen[0].load(simd, half) - 0.5);
            let row = keys.rows.load(simd, half) + (on_screen[1].load(simd, half) - 0.5);
            // Not `Option::map`: lanes in its closure might not be inlined, and lose the processor's instructions.
            let mut places = None;
            if let Some([x, y]) = &on_lens {
                places = Some(on_disc([x.load(simd, half), y.load(simd, half)]));
            }
            let Rays { origin, direction } = self.rays_through(column, row, places);
            let Scaled { direction, in_range, .. } = scaled_lanes(simd, direction);
            escalated |= active & half_lanes(half) & !bits(in_range & finite3(simd, origin), half);
            rays.origins.store(half, origin);
            rays.directions.store(half, direction);
        }
        rays.lanes = active & !escalated;
        for lane in lanes(escalated) {
            let (i, j) = keys.pixels[lane];
            if let Some(ray) = self.spread_ray(sampling, i, j, indices[lane]) {
                rays.set(lane, &ray);
            }
        }
    }

    /// Returns the corners of a box around the points that the samples of half of a packet's pixels reach at a signed distance from a point
    /// along an axis. `None` if some do not reach it. The points of one sample for the whole lens, and of all samples for one point of the
    /// lens, are perspective images, so that the corners are outermost.
    pub(crate) fn places_at(
        &self,
        (point, axis, far): (DVec3, usize, f64),
        square: &Square,
        half: usize,
    ) -> Option<[DVec3; 2]> {
        let (column, row) = (f64::from(square.first.0), f64::from(square.first.1));
        let first = if half == 0 { -0.5 } else { 1.5 };
        let [mut low, mut high] = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for (i, j) in [(-0.5, first), (3.5, first), (-0.5, first + 2.0), (3.5, first + 2.0)] {
            for on_lens in [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]] {
                let Rays { origin, direction } = self.rays_through(column + i, row + j, Some(on_lens));
                let (start, towards) = (DVec3::from(origin), DVec3::from(direction));
                let t = (far - (start - point)[axis]) / towards[axis];
                let place = start + towards * t;
                if !(t > 0.0 && towards[axis] * far > 0.0 && place.is_finite()) {
                    return None;
                }
                (low, high) = (low.min(place), high.max(place));
            }
        }
        Some([low, high])
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;

    use super::*;
    use crate::trace::math::SimdLevel;

    #[test]
    fn packets_have_the_rays_of_their_pixels() {
        let eye = DVec3::new(-2.0, 0.3, 1.0);
        let camera = PreparedCamera::new(eye, DVec3::new(1.0, 1.0, 0.2), DVec3::Z, 1.5, (2.0, 1.2), (23, 9));
        let cameras = [
            camera,
            camera.with_lens(0.3, 7.0),
            camera.orthographic(),
            camera.orthographic().with_lens(0.3, 7.0),
            PreparedCamera::new(eye, DVec3::X, DVec3::Y, 1.0, (2.0, 2.0), (1, 1)),
        ];
        for (camera, index) in
            cameras.into_iter().flat_map(|camera| (0..40).map(move |index| (camera, index)))
        {
            let sampling = PixelSampling { samples: 64, seed: 5 };
            let indices = std::array::from_fn(|lane| index + u32::from(lane % 3 == 1));
            let (columns, rows) = camera.resolution();
            for (name, level) in SimdLevel::all() {
                for (i, j) in [(0, 0), (4, 4), (20, 8)] {
                    let size = (columns.saturating_sub(i).min(SIDE), rows.saturating_sub(j).min(SIDE));
                    let square = Square { first: (i, j), size };
                    let (mut rays, mut keys) = (RayPacket::EMPTY, PixelKeys::NONE);
                    let pixels = std::array::from_fn(|lane| square.pixel(lane));
                    keys.find(sampling.seed, (&pixels, square.lanes()), camera.has_lens());
                    dispatch!(level.level(), simd => camera.sample_rays(simd, sampling, &keys, &indices, &mut rays));
                    for (lane, index) in indices.into_iter().enumerate() {
                        let (i, j) = square.pixel(lane);
                        let ray =
                            if square.has(lane) { camera.spread_ray(sampling, i, j, index) } else { None };
                        let found = (rays.lanes & (1 << lane) != 0).then(|| rays.get(lane));
                        assert_eq!(found, ray, "{name}, pixel {i}, {j}, sample {index}");
                    }
                }
            }
        }
    }
}
