//! Sample points on area lights, for sixteen shading points at once.

use fearless_simd::prelude::*;

use super::direct::{light_dimension, light_point};
use crate::trace::math::{
    F64s3, LANES, PixelSamples, SampleKeys, Scaled, Vectors, add, bits, dot, half_lanes, lanes, on_disc,
    pick3, scaled_lanes, splat, splat3, subtract, times,
};
use crate::trace::scene::{LightSource, PreparedLight};

/// The sequences of sample points on an area light, one per lane.
#[derive(Clone, Debug)]
pub(crate) struct AreaLightSamples {
    keys: SampleKeys,
    /// Index of the first sample point in each lane.
    first: [u32; LANES],
}

impl AreaLightSamples {
    /// Sequences for no shading points.
    pub(crate) const NONE: Self = Self { keys: SampleKeys::NONE, first: [0; LANES] };

    /// Chooses the sequences of light number `index` for shading points in the lanes `asked`. `asker` returns the pixel of a lane, the
    /// index of its sample, and the index of its ray in the sample's ray tree.
    #[inline(always)]
    pub(crate) fn choose(
        &mut self,
        (index, light): (usize, &PreparedLight),
        asked: u32,
        asker: impl Fn(usize) -> (PixelSamples, u32, u64),
    ) {
        for lane in lanes(asked) {
            let (samples, of_pixel, path) = asker(lane);
            self.first[lane] = light_point(light, of_pixel, 0);
            self.keys.set(lane, &samples, light_dimension(index, path));
        }
    }

    /// Computes sample point `sample` of a light for each shading point in some lanes: [`LightSource::place`], which is defined for all
    /// lights, not only area lights.
    #[inline(always)]
    pub(super) fn find<S: Simd>(
        &self,
        simd: S,
        source: &LightSource,
        points: &Vectors,
        (asked, sample): (u32, u32),
        places: &mut Vectors,
    ) {
        let squares = self.keys.pairs(simd, &self.first.map(|first| first.wrapping_add(sample)));
        let mut unusual = 0;
        for half in 0..2 {
            let square = [squares[0].load(simd, half), squares[1].load(simd, half)];
            match source {
                LightSource::Sphere { center, radius } => {
                    let center = splat3(simd, *center);
                    let Scaled { direction, usual, .. } =
                        scaled_lanes(simd, subtract(center, points.load(simd, half)));
                    unusual |= asked & half_lanes(half) & !bits(usual, half);
                    let [x, y] = on_disc(square);
                    let (right, up) = across(simd, normalized(simd, direction));
                    let place = add(center, times(right, x * *radius));
                    places.store(half, add(place, times(up, y * *radius)));
                }
                LightSource::Rectangle { center, halves: [right, up] } => {
                    let [x, y] = [square[0] * 2.0 - 1.0, square[1] * 2.0 - 1.0];
                    let place = add(splat3(simd, *center), times(splat3(simd, *right), x));
                    places.store(half, add(place, times(splat3(simd, *up), y)));
                }
                LightSource::Point(place) | LightSource::Spot(place, _) | LightSource::Directional(place) => {
                    places.store(half, splat3(simd, *place));
                }
            }
        }
        for lane in lanes(unusual) {
            let square = [squares[0].get(lane), squares[1].get(lane)];
            places.set(lane, source.place(points.get(lane), square));
        }
    }
}

#[inline(always)]
fn normalized<S: Simd>(simd: S, vector: F64s3<S>) -> F64s3<S> {
    times(vector, splat(simd, 1.0) / dot(vector, vector).sqrt())
}

/// Returns two unit vectors that are perpendicular to a third one and to each other, as [`LightSource::place`] chooses them.
#[inline(always)]
fn across<S: Simd>(simd: S, forward: F64s3<S>) -> (F64s3<S>, F64s3<S>) {
    let [x, y, z] = [forward[0].abs(), forward[1].abs(), forward[2].abs()];
    let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
    let (along_x, along_y) = (x.simd_le(y) & x.simd_le(z), y.simd_le(z));
    let other = pick3(along_y, [zero, one, zero], [zero, zero, one]);
    let axis = pick3(along_x, [one, zero, zero], other);
    let right = normalized(simd, cross(axis, forward));
    (right, cross(forward, right))
}

#[inline(always)]
fn cross<S: Simd>(a: F64s3<S>, b: F64s3<S>) -> F64s3<S> {
    [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]]
}
