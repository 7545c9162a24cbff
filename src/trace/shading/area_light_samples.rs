//! Sample points on area lights, for sixteen shading points at once.

use fearless_simd::prelude::*;

use super::direct::{light_dimension, light_point};
use super::facing_normals::facing_normals;
use crate::trace::intersect::SurfacePacket;
use crate::trace::math::{
    LANES, PixelSamples, SampleKeys, Scaled, Vectors, bits, half_lanes, lanes, scaled_lanes, splat3, subtract,
};
use crate::trace::scene::{LightSource, PreparedLight, on_dome, on_rectangle, on_sphere};

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

    /// Chooses the sequences of light number `index` for shading points in the lanes `active`. `sample_id` returns the pixel of a lane, the
    /// index of its sample, and the index of its ray in the sample's ray tree.
    #[inline(always)]
    pub(crate) fn choose(
        &mut self,
        index: usize,
        light: &PreparedLight,
        active: u32,
        sample_id: impl Fn(usize) -> (PixelSamples, u32, u64),
    ) {
        for lane in lanes(active) {
            let (samples, of_pixel, path) = sample_id(lane);
            self.first[lane] = light_point(light, of_pixel, 0);
            self.keys.set(lane, &samples, light_dimension(index, path));
        }
    }

    /// Computes sample point `sample` of a light for each shading point: [`LightSource::place`], which is defined for all lights, not only
    /// area lights. For a dome, computes the direction to it.
    #[inline(always)]
    pub(super) fn find<S: Simd>(
        &self,
        simd: S,
        source: &LightSource,
        surfaces: &SurfacePacket,
        sample: u32,
        places: &mut Vectors,
    ) {
        let squares = self.keys.pairs(simd, &self.first.map(|first| first.wrapping_add(sample)));
        let points = &surfaces.points;
        let mut escalated = 0;
        for half in 0..2 {
            let square = [squares[0].load(simd, half), squares[1].load(simd, half)];
            match source {
                LightSource::Sphere { center, radius } => {
                    let from_point = subtract(splat3(simd, *center), points.load(simd, half));
                    let Scaled { direction, in_range, .. } = scaled_lanes(simd, from_point);
                    escalated |= surfaces.lanes & half_lanes(half) & !bits(in_range, half);
                    places.store(half, on_sphere(*center, *radius, direction, square));
                }
                LightSource::Rectangle { center, halves } => {
                    places.store(half, on_rectangle(*center, *halves, square));
                }
                LightSource::Dome { .. } => {
                    let normals = facing_normals(simd, surfaces, half);
                    places.store(half, on_dome(normals, square));
                }
                LightSource::Point(place) | LightSource::Spot(place, _) | LightSource::Directional(place) => {
                    places.store(half, splat3(simd, *place));
                }
            }
        }
        for lane in lanes(escalated) {
            let square = [squares[0].get(lane), squares[1].get(lane)];
            places.set(lane, source.place(points.get(lane), square));
        }
    }
}
