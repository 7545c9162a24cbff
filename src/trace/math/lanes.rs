//! Packets of sixteen lanes, and arithmetic on eight lanes at a time.
//!
//! Every operation applies, in each lane, the operations of its scalar counterpart in the same order. Results are bit-identical for every
//! SIMD width.

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
use fearless_simd::Level;
use fearless_simd::{f32x16, f64x8, mask32x8, mask32x16, mask64x8, prelude::*, u64x8};
use glam::DVec3;

use super::real::times;
use crate::color::Rgb;

/// Number of lanes of a packet.
pub(crate) const LANES: usize = 16;

/// Number of lanes of half a packet: the number of `f64` in the widest SIMD vectors.
pub(crate) const HALF: usize = LANES / 2;

/// Bit mask of all lanes.
pub(crate) const WHOLE: u32 = (1 << LANES) - 1;

/// One `f64` per lane, in half of the lanes.
pub(crate) type F64s<S> = f64x8<S>;

/// One vector per lane, in half of the lanes.
pub(crate) type F64s3<S> = [f64x8<S>; 3];

/// A mask of half of the lanes.
pub(crate) type Mask<S> = mask64x8<S>;

/// One `f64` per lane.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Numbers([[f64; HALF]; 2]);

impl Numbers {
    /// Returns the same number in all lanes.
    pub(crate) const fn splat(number: f64) -> Self {
        Self([[number; HALF]; 2])
    }

    /// Returns one number per lane.
    pub(crate) const fn new(numbers: &[f64; LANES]) -> Self {
        let mut halves = [[0.0; HALF]; 2];
        let mut lane = 0;
        while lane < LANES {
            halves[lane / HALF][lane % HALF] = numbers[lane];
            lane += 1;
        }
        Self(halves)
    }

    /// Returns the number of a lane.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> f64 {
        self.0[lane / HALF % 2][lane % HALF]
    }

    /// Returns the numbers of all lanes.
    #[inline(always)]
    pub(crate) fn to_array(self) -> [f64; LANES] {
        std::array::from_fn(|lane| self.get(lane))
    }

    /// Sets the number of a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, number: f64) {
        self.0[lane / HALF % 2][lane % HALF] = number;
    }

    /// Loads half of the lanes.
    #[inline(always)]
    pub(crate) fn load<S: Simd>(&self, simd: S, half: usize) -> F64s<S> {
        f64x8::load_array_ref(simd, &self.0[half % 2])
    }

    /// Stores half of the lanes.
    #[inline(always)]
    pub(crate) fn store<S: Simd>(&mut self, half: usize, numbers: F64s<S>) {
        numbers.store_array(&mut self.0[half % 2]);
    }

    /// Returns all lanes, rounded to `f32`.
    #[inline(always)]
    pub(crate) fn rounded<S: Simd>(&self, simd: S) -> f32x16<S> {
        self.load(simd, 0).narrow(self.load(simd, 1))
    }
}

/// One vector per lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vectors([Numbers; 3]);

impl Vectors {
    /// Returns the same vector in all lanes.
    pub(crate) const fn splat(vector: DVec3) -> Self {
        Self([Numbers::splat(vector.x), Numbers::splat(vector.y), Numbers::splat(vector.z)])
    }

    /// Returns the vector of a lane.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> DVec3 {
        DVec3::new(self.0[0].get(lane), self.0[1].get(lane), self.0[2].get(lane))
    }

    /// Sets the vector of a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, vector: DVec3) {
        self.0[0].set(lane, vector.x);
        self.0[1].set(lane, vector.y);
        self.0[2].set(lane, vector.z);
    }

    /// Returns one coordinate of all lanes.
    #[inline(always)]
    pub(crate) fn axis(&self, axis: usize) -> &Numbers {
        &self.0[axis]
    }

    /// Returns one coordinate of all lanes, mutably.
    #[inline(always)]
    pub(crate) fn axis_mut(&mut self, axis: usize) -> &mut Numbers {
        &mut self.0[axis]
    }

    /// Loads half of the lanes.
    #[inline(always)]
    pub(crate) fn load<S: Simd>(&self, simd: S, half: usize) -> F64s3<S> {
        [self.0[0].load(simd, half), self.0[1].load(simd, half), self.0[2].load(simd, half)]
    }

    /// Stores half of the lanes.
    #[inline(always)]
    pub(crate) fn store<S: Simd>(&mut self, half: usize, [x, y, z]: F64s3<S>) {
        self.0[0].store(half, x);
        self.0[1].store(half, y);
        self.0[2].store(half, z);
    }
}

/// One colour per lane.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Colors([[f32; LANES]; 3]);

impl Colors {
    /// Returns the same colour in all lanes.
    pub(crate) const fn splat(color: Rgb) -> Self {
        Self([[color.x; LANES], [color.y; LANES], [color.z; LANES]])
    }

    /// Returns the colour of a lane.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Rgb {
        let lane = lane % LANES;
        Rgb::new(self.0[0][lane], self.0[1][lane], self.0[2][lane])
    }

    /// Sets the colour of a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, color: Rgb) {
        let lane = lane % LANES;
        (self.0[0][lane], self.0[1][lane], self.0[2][lane]) = (color.x, color.y, color.z);
    }

    /// Multiplies other colours by these.
    #[inline(always)]
    pub(crate) fn times<S: Simd>(&self, simd: S, others: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
        let [red, green, blue] = self.load(simd);
        [others[0] * red, others[1] * green, others[2] * blue]
    }

    /// Loads all lanes, channel by channel.
    #[inline(always)]
    pub(crate) fn load<S: Simd>(&self, simd: S) -> [f32x16<S>; 3] {
        let [red, green, blue] = &self.0;
        [
            f32x16::load_array_ref(simd, red),
            f32x16::load_array_ref(simd, green),
            f32x16::load_array_ref(simd, blue),
        ]
    }

    /// Stores all lanes, channel by channel.
    #[inline(always)]
    pub(crate) fn store<S: Simd>(&mut self, [red, green, blue]: [f32x16<S>; 3]) {
        red.store_array(&mut self.0[0]);
        green.store_array(&mut self.0[1]);
        blue.store_array(&mut self.0[2]);
    }
}

/// Iterates over the lanes of a bit mask.
#[inline(always)]
pub(crate) fn lanes(mask: u32) -> impl Iterator<Item = usize> {
    set_bits(mask).map(|lane| lane % LANES)
}

/// Returns the bit mask of the lanes where `is` holds.
#[inline(always)]
pub(crate) fn lanes_where(is: impl Fn(usize) -> bool) -> u32 {
    (0..LANES).fold(0, |mask, lane| mask | u32::from(is(lane)) << lane)
}

/// Iterates over the indices of the set bits.
#[inline(always)]
pub(crate) fn set_bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = (mask != 0).then(|| mask.trailing_zeros() as usize);
        mask &= mask.wrapping_sub(1);
        bit
    })
}

/// Returns the bit mask of one half of the lanes.
#[inline(always)]
pub(crate) const fn half_lanes(half: usize) -> u32 {
    0xff << (half * HALF)
}

/// Extracts the bits of one half of the lanes into the lowest bits.
#[inline(always)]
pub(crate) fn half_of(mask: u32, half: usize) -> u32 {
    mask >> (half * HALF) & 0xff
}

/// Converts the mask of one half of the lanes to bits of the whole packet.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "eight lanes")]
pub(crate) fn bits<S: Simd>(mask: Mask<S>, half: usize) -> u32 {
    (mask.to_bitmask() as u32) << (half * HALF)
}

/// Converts one half of a bit mask to a mask.
#[inline(always)]
pub(crate) fn mask<S: Simd>(simd: S, bits: u32, half: usize) -> Mask<S> {
    mask64x8::from_bitmask(simd, half_of(bits, half).into())
}

/// Converts a bit mask to a mask of all lanes.
#[inline(always)]
pub(crate) fn mask16<S: Simd>(simd: S, bits: u32) -> mask32x16<S> {
    mask32x16::from_bitmask(simd, bits.into())
}

/// Converts a mask of all lanes to a bit mask.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "sixteen lanes")]
pub(crate) fn bits16<S: Simd>(mask: mask32x16<S>) -> u32 {
    mask.to_bitmask() as u32
}

/// Converts a mask of eight lanes to a bit mask.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "eight lanes")]
pub(crate) fn bits8<S: Simd>(mask: mask32x8<S>) -> u32 {
    mask.to_bitmask() as u32
}

#[inline(always)]
pub(crate) fn splat<S: Simd>(simd: S, number: f64) -> F64s<S> {
    f64x8::splat(simd, number)
}

#[inline(always)]
pub(crate) fn splat3<S: Simd>(simd: S, vector: DVec3) -> F64s3<S> {
    [splat(simd, vector.x), splat(simd, vector.y), splat(simd, vector.z)]
}

/// Scaled directions, one per lane.
#[derive(Clone, Copy)]
pub(crate) struct Scaled<S: Simd> {
    pub(crate) direction: F64s3<S>,
    /// Reciprocal of the power of two that the direction was multiplied by.
    pub(crate) length: F64s<S>,
    /// Lanes with a valid result. The other lanes have numbers so large or so small that the scalar function must handle them.
    pub(crate) in_range: Mask<S>,
}

/// Scales the direction of each lane as [`scaled`](super::scaled) does.
#[inline(always)]
pub(crate) fn scaled_lanes<S: Simd>(simd: S, direction: F64s3<S>) -> Scaled<S> {
    /// 2^-400, 2^100 and 2^-900. Between the first two no direction is lifted, and components of at least the last stay normal.
    const SMALLEST: f64 = f64::from_bits((1023 - 400) << 52);
    const LARGEST: f64 = f64::from_bits((1023 + 100) << 52);
    const NORMAL: f64 = f64::from_bits((1023 - 900) << 52);
    let [x, y, z] = [direction[0].abs(), direction[1].abs(), direction[2].abs()];
    let longest = x.max(y).max(z);
    // A NaN makes the sum NaN, and the comparison false.
    let within = longest.simd_ge(splat(simd, SMALLEST)) & (x + y + z).simd_lt(splat(simd, LARGEST));
    let in_range = within & none_below(simd, [x, y, z], NORMAL);
    let exponent: u64x8<S> = longest.bitcast();
    let exponent = exponent & u64x8::splat(simd, 0x7ff << 52);
    let scale: F64s<S> = (u64x8::splat(simd, 2046 << 52) - exponent).bitcast();
    Scaled { direction: times(direction, scale), length: exponent.bitcast(), in_range }
}

/// Returns whether `mul_sub` is fused, that is, rounded once.
#[inline(always)]
pub(super) fn fuses<S: Simd>(simd: S) -> bool {
    match simd.level() {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Level::Avx2(_) | Level::Avx512(_) => true,
        _ => false,
    }
}

/// Smallest and largest moderate magnitude: 2^-400 and 2^400.
pub(super) const LEAST: f64 = f64::from_bits((1023 - 400) << 52);
pub(super) const MOST: f64 = f64::from_bits((1023 + 400) << 52);

/// Returns the lanes whose coordinates are all finite.
#[inline(always)]
pub(crate) fn finite3<S: Simd>(simd: S, [x, y, z]: F64s3<S>) -> Mask<S> {
    let infinity = splat(simd, f64::INFINITY);
    x.abs().simd_lt(infinity) & y.abs().simd_lt(infinity) & z.abs().simd_lt(infinity)
}

/// Returns the lanes where each of three magnitudes is zero or at least `least`.
#[inline(always)]
pub(super) fn none_below<S: Simd>(simd: S, [x, y, z]: F64s3<S>, least: f64) -> Mask<S> {
    let (least, zero) = (splat(simd, least), splat(simd, 0.0));
    let all = x.min(y).min(z).simd_ge(least);
    if all.all_true() {
        return all;
    }
    (x.simd_ge(least) | x.simd_eq(zero))
        & (y.simd_ge(least) | y.simd_eq(zero))
        & (z.simd_ge(least) | z.simd_eq(zero))
}

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;
    use proptest::prelude::*;

    use super::*;
    use crate::trace::math::{Double, SimdLevel, moderate, scaled};

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        /// Covers all exponents of the coordinates.
        #[test]
        fn directions_are_scaled_as_one_by_one(
            exponents in prop::array::uniform3(-1074..1024_i32),
            mantissas in prop::array::uniform3(-2.0..2.0_f64),
            near in any::<bool>(),
        ) {
            let exponents = if near { exponents.map(|exponent| exponent / 64) } else { exponents };
            let coordinate = |axis: usize| libm::ldexp(mantissas[axis], exponents[axis]);
            let direction = DVec3::new(coordinate(0), coordinate(1), coordinate(2));
            for (name, level) in SimdLevel::all() {
                let (mut found, mut lengths) = (Vectors::splat(direction), Numbers::splat(0.0));
                let in_range = dispatch!(level.level(), simd => {
                    let Scaled { direction, length, in_range } = scaled_lanes(simd, found.load(simd, 0));
                    found.store(0, direction);
                    lengths.store(0, length);
                    in_range.any_true()
                });
                if in_range {
                    prop_assert_eq!(scaled(direction), Some((found.get(0), lengths.get(0).recip())), "{}", name);
                }
            }
        }

        /// Covers all moderate exponents, with fused and unfused products.
        #[test]
        fn products_have_the_scalar_errors(exponents in prop::array::uniform2(-400..400_i32), mantissas in prop::array::uniform2(1.0..2.0_f64)) {
            let [a, b] = [0, 1].map(|index: usize| libm::ldexp(mantissas[index], exponents[index].min(399)));
            for (name, level) in SimdLevel::all() {
                let (mut product, mut error) = (Numbers::splat(0.0), Numbers::splat(0.0));
                dispatch!(level.level(), simd => {
                    assert!(moderate(splat(simd, a)).all_true() && moderate(splat(simd, b)).all_true());
                    let Double { high, low } = Double::product(splat(simd, a), splat(simd, -b));
                    product.store(0, high);
                    error.store(0, low);
                });
                let scalar = Double::product(a, -b);
                prop_assert_eq!((product.get(3), error.get(3)), (scalar.rounded(), scalar.rest()), "{}", name);
            }
        }
    }
}
