//! Sample points of sixteen pixels: [`PixelSamples::pair`] in every lane.

use fearless_simd::{prelude::*, u32x16, u64x8};

use super::lanes::{F64s, LANES, Numbers};
use super::sampling::{Dimension, PixelSamples, ScramblingKeys};

/// Keys that shuffle and scramble a dimension's points, one per lane. All samples of a pixel share them.
#[derive(Clone, Debug)]
pub(crate) struct SampleKeys {
    order: KeyPacket,
    first: KeyPacket,
    second: KeyPacket,
}

/// One key per lane.
#[derive(Clone, Debug)]
struct KeyPacket {
    /// Summands of the digits.
    summands: [u32; LANES],
    /// Factors of the digits, odd numbers.
    factors: [u32; LANES],
}

impl SampleKeys {
    /// Keys of lanes without samples.
    pub(crate) const NONE: Self = {
        let none = KeyPacket { summands: [0; LANES], factors: [1; LANES] };
        Self { order: KeyPacket { ..none }, first: KeyPacket { ..none }, second: KeyPacket { ..none } }
    };

    /// Sets the keys of a lane from a dimension of a pixel.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, samples: &PixelSamples, dimension: Dimension) {
        let ScramblingKeys { order, first, second } = samples.keys(dimension);
        for (packet, key) in [(&mut self.order, order), (&mut self.first, first), (&mut self.second, second)]
        {
            (packet.summands[lane % LANES], packet.factors[lane % LANES]) = (key.summand(), key.factor());
        }
    }

    /// Returns point `indices[lane]` of each lane's sequence of positions in the pixel: two numbers in 0..1.
    #[inline(always)]
    pub(crate) fn positions<S: Simd>(&self, simd: S, indices: &[u32; LANES]) -> [Numbers; 2] {
        let index = u32x16::load_array_ref(simd, indices);
        let digit = u32x16::splat(simd, 0xf);
        let [low, high] = [(index >> 8) & digit, (index >> 12) & digit];
        self.points(simd, index ^ (low << 4) ^ low ^ high)
    }

    /// Returns point `indices[lane]` of each lane's sequence of another dimension: two numbers in 0..1.
    #[inline(always)]
    pub(crate) fn pairs<S: Simd>(&self, simd: S, indices: &[u32; LANES]) -> [Numbers; 2] {
        let digits = reversed(simd, u32x16::load_array_ref(simd, indices));
        self.points(simd, reversed(simd, self.order.scrambled(simd, digits)))
    }

    #[inline(always)]
    fn points<S: Simd>(&self, simd: S, index: u32x16<S>) -> [Numbers; 2] {
        let second = pascal(simd, index);
        [units(simd, self.first.scrambled(simd, index)), units(simd, self.second.scrambled(simd, second))]
    }
}

impl KeyPacket {
    /// Applies Owen scrambling to reversed digits.
    #[inline(always)]
    fn scrambled<S: Simd>(&self, simd: S, digits: u32x16<S>) -> u32x16<S> {
        let digits = digits + u32x16::load_array_ref(simd, &self.summands);
        let digits = folded(folded(digits, 0x6c50_b47c), 0xb82f_1e52);
        let digits = digits * u32x16::load_array_ref(simd, &self.factors);
        folded(folded(digits, 0xc7af_e638), 0x8d22_f6e6)
    }
}

#[inline(always)]
fn folded<S: Simd>(digits: u32x16<S>, even: u32) -> u32x16<S> {
    digits ^ (digits * even)
}

#[inline(always)]
fn pascal<S: Simd>(simd: S, mut digits: u32x16<S>) -> u32x16<S> {
    for (by, kept) in
        [(1, 0x5555_5555), (2, 0x3333_3333), (4, 0x0f0f_0f0f), (8, 0x00ff_00ff), (16, 0x0000_ffff)]
    {
        digits = digits ^ ((digits >> by) & u32x16::splat(simd, kept));
    }
    digits
}

#[inline(always)]
fn reversed<S: Simd>(simd: S, mut digits: u32x16<S>) -> u32x16<S> {
    for (by, kept) in [(1, 0x5555_5555), (2, 0x3333_3333), (4, 0x0f0f_0f0f), (8, 0x00ff_00ff)] {
        let kept = u32x16::splat(simd, kept);
        digits = ((digits >> by) & kept) | ((digits & kept) << by);
    }
    (digits >> 16) | (digits << 16)
}

/// Returns reversed digits as fractions, exactly: an integer in the mantissa bits of 2^52 is added to it.
#[inline(always)]
fn units<S: Simd>(simd: S, digits: u32x16<S>) -> Numbers {
    const WHOLE: f64 = 4_503_599_627_370_496.0;
    let (first, second) = reversed(simd, digits).widen();
    let mut numbers = Numbers::splat(0.0);
    for (half, digits) in [first, second].into_iter().enumerate() {
        let number: F64s<S> = (digits | u64x8::splat(simd, WHOLE.to_bits())).bitcast();
        numbers.store(half, (number - WHOLE) * (1.0 / 4_294_967_296.0));
    }
    numbers
}

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;

    use super::*;
    use crate::trace::math::SimdLevel;

    #[test]
    fn lanes_have_the_numbers_of_their_pixels() {
        for (name, level) in SimdLevel::all() {
            for index in (0..40).chain([1 << 20, 0x8000_0001, u32::MAX]) {
                let (mut keys, mut on_screen) = (SampleKeys::NONE, SampleKeys::NONE);
                let dimension = |lane: u32| match lane % 2 {
                    0 => Dimension::Lens,
                    _ => Dimension::Light { light: lane, path: u64::from(lane) * 7 },
                };
                let indices =
                    std::array::from_fn(|lane| if lane % 5 == 0 { index } else { index ^ 1 << lane });
                let samples = |lane: u32| PixelSamples::new(u64::from(index) * 3, lane * 5, index % 77);
                for (lane, number) in (0..LANES).zip(0..) {
                    keys.set(lane, &samples(number), dimension(number));
                    on_screen.set(lane, &samples(number), Dimension::Pixel);
                }
                let [first, second] = dispatch!(level.level(), simd => keys.pairs(simd, &indices));
                let [x, y] = dispatch!(level.level(), simd => on_screen.positions(simd, &indices));
                for (lane, number) in (0..LANES).zip(0..) {
                    let index = indices[lane];
                    for (dimension, found) in
                        [(dimension(number), [&first, &second]), (Dimension::Pixel, [&x, &y])]
                    {
                        let found = found.map(|numbers| numbers.get(lane));
                        let expected = samples(number).pair(dimension, index);
                        assert_eq!(found, expected, "{name}, {dimension:?}, {index}, {lane}");
                    }
                }
            }
        }
    }
}
