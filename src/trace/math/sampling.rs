//! Sample points in the unit square as a pure function of pixel, sample index, dimension and seed.
//!
//! Every dimension of every pixel has its own sequence of points: the first two dimensions of Sobol's sequence, with the order of the
//! points shuffled and both coordinates Owen-scrambled. Sobol's two dimensions form a (0,2)-sequence: any 2^m points that start at a
//! multiple of 2^m have exactly one point in each elementary interval, of any shape, of area 2^-m. Shuffling and scrambling keep this
//! property and make the sequences of different dimensions and pixels independent. The error of a mean falls as n^-3/2 for smooth functions
//! and as n^-3/4 across a straight edge; independent points would give n^-1/2.
//!
//! Only positions in the pixel are not shuffled: the instants of an open shutter, which all pixels share, are the third dimension of the
//! same sequence (`render::adaptive::instants`). Its points are taken in an order in which the instants repeat every 256 samples.
//!
//! Scrambling is hash-based (Burley, "Practical Hash-based Owen Scrambling", Journal of Computer Graphics Techniques 9(4), 2020). The hash
//! is Laine and Karras's ("Stratified Sampling for Stochastic Transparency", 2011) with one more keyed step.
//!
//! Points are computed in integer arithmetic with one exact conversion at the end. Disc points use the crate's own sine and cosine. Results
//! are therefore bit-identical on every machine.

use std::f64::consts::FRAC_PI_4;

use super::elementary::sine_and_cosine;
use super::real::Real;

/// Number and seed of the samples of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelSampling {
    /// Samples per pixel, at least 1. A single sample lies at the pixel's centre; several are spread over the pixel, and its colour is
    /// their mean.
    pub samples: u32,
    /// Seed of the sample points. Different seeds give different points of equal quality.
    pub seed: u64,
}

impl Default for PixelSampling {
    fn default() -> Self {
        Self { samples: 1, seed: 0 }
    }
}

impl PixelSampling {
    /// Returns the same number of samples, with a seed that also depends on `numbers`.
    #[must_use]
    pub fn reseeded(self, numbers: [u64; 2]) -> Self {
        Self { seed: numbers.into_iter().fold(self.seed, mixed), ..self }
    }
}

/// Purpose of a sample. Each purpose has an independent sequence: adding or removing one does not change the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dimension {
    /// The position in the pixel.
    Pixel,
    /// The position on the lens.
    Lens,
    /// The position on an area light.
    Light {
        /// Index of the light in document order.
        light: u32,
        /// Index, in the ray tree, of the ray that hit the lit surface. The camera ray has index 1; ray p spawns the reflected ray 2p and
        /// the refracted ray 2p + 1.
        path: u64,
    },
}

impl Dimension {
    #[inline(always)]
    fn hashed_into(self, key: u64) -> u64 {
        match self {
            Self::Pixel => mixed(key, 0),
            Self::Lens => mixed(key, 1),
            Self::Light { light, path } => mixed(mixed(mixed(key, 2), u64::from(light)), path),
        }
    }
}

/// Sample points of one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PixelSamples {
    key: u64,
}

impl PixelSamples {
    /// Returns the sample points of the pixel in column `i` and row `j`.
    #[must_use]
    #[inline(always)]
    pub(crate) fn new(seed: u64, i: u32, j: u32) -> Self {
        Self { key: mixed(mixed(0, seed), u64::from(i) << 32 | u64::from(j)) }
    }

    /// Returns point `index` of a dimension's sequence: two multiples of 2^-32 in 0..1.
    #[must_use]
    pub(crate) fn pair(&self, dimension: Dimension, index: u32) -> [f64; 2] {
        let ScramblingKeys { order, first, second } = self.keys(dimension);
        let index = match dimension {
            Dimension::Pixel => position_index(index),
            Dimension::Lens | Dimension::Light { .. } => order.scrambled(index.reverse_bits()).reverse_bits(),
        };
        // Scrambling takes the digits reversed, with the most significant digit in the lowest bit.
        [unit(first.scrambled(index)), unit(second.scrambled(pascal(index)))]
    }

    /// Returns the keys that shuffle and scramble a dimension's points.
    #[inline(always)]
    pub(super) fn keys(&self, dimension: Dimension) -> ScramblingKeys {
        let key = dimension.hashed_into(self.key);
        ScramblingKeys {
            order: ScrambleKey(key),
            first: ScrambleKey(mixed(key, 1)),
            second: ScrambleKey(mixed(key, 2)),
        }
    }

    /// Returns the first coordinate of the [pair](Self::pair), in 0..1. Any 2^m points that start at a multiple of 2^m have exactly one in
    /// each interval of length 2^-m.
    #[cfg(test)]
    #[must_use]
    pub(crate) fn number(&self, dimension: Dimension, index: u32) -> f64 {
        self.pair(dimension, index)[0]
    }
}

/// Returns the index in Sobol's sequence of the position of a sample. The first eight digits of the third dimension at this index are those
/// at the sample's number modulo 256, for all numbers below 65536.
fn position_index(sample: u32) -> u32 {
    let [low, high] = [8, 12].map(|bits| sample >> bits & 0xf);
    sample ^ low << 4 ^ low ^ high
}

/// Scrambling keys of a dimension: one for the order of its points, one for each coordinate.
pub(super) struct ScramblingKeys {
    pub(super) order: ScrambleKey,
    pub(super) first: ScrambleKey,
    pub(super) second: ScrambleKey,
}

/// Key of a scrambling.
#[derive(Clone, Copy)]
pub(super) struct ScrambleKey(u64);

impl ScrambleKey {
    /// Returns the summand of the digits.
    #[inline(always)]
    pub(super) fn summand(self) -> u32 {
        low(self.0)
    }

    /// Returns the factor of the digits, an odd number.
    #[inline(always)]
    pub(super) fn factor(self) -> u32 {
        high(self.0) | 1
    }

    /// Applies Owen scrambling to reversed digits, with the most significant digit in the lowest bit. A hash of the key and the bits below
    /// each bit decides whether that bit is flipped.
    fn scrambled(self, digits: u32) -> u32 {
        let folded = |digits: u32, even: u32| digits ^ digits.wrapping_mul(even);
        let digits = digits.wrapping_add(self.summand());
        let digits = folded(folded(digits, 0x6c50_b47c), 0xb82f_1e52);
        // With the sum alone, the second digit's flips would depend on the first digit's.
        let digits = digits.wrapping_mul(self.factor());
        folded(folded(digits, 0xc7af_e638), 0x8d22_f6e6)
    }
}

/// Maps the unit square to the unit disc around 0. The map preserves relative areas and neighbourhoods: it is the concentric map of Shirley
/// and Chiu, "A Low Distortion Map Between Disk and Square", Journal of Graphics Tools 2(3), 1997.
#[must_use]
pub(crate) fn disc(square: [f64; 2]) -> [f64; 2] {
    on_disc(square)
}

/// Maps the unit square to the unit disc as [`disc`] does, for scalars or lanes.
#[inline(always)]
pub(crate) fn on_disc<R: Real>([x, y]: [R; 2]) -> [R; 2] {
    let (x, y) = (x * 2.0 - 1.0, y * 2.0 - 1.0);
    // The point lies on a concentric square, whose half side is the larger coordinate.
    let (x_size, y_size) = (x.abs(), y.abs());
    let (half_side, off_axis) = (y_size.if_less(x_size, x, y), y_size.if_less(x_size, y, x));
    let (sine, cosine) = sine_and_cosine(off_axis / half_side * FRAC_PI_4);
    // The angle is undefined at the centre.
    let (zero, size) = (x.of(0.0), half_side.abs());
    let along = zero.if_less(size, half_side * cosine, zero);
    let across = zero.if_less(size, half_side * sine, zero);
    [y_size.if_less(x_size, along, across), y_size.if_less(x_size, across, along)]
}

/// Returns the digits of the second dimension of Sobol's sequence: the digits of the index times Pascal's triangle modulo 2. The triangle
/// is the fifth Kronecker power of its 2 x 2 corner, so that five steps suffice.
fn pascal(index: u32) -> u32 {
    let digits = index ^ (index >> 1 & 0x5555_5555);
    let digits = digits ^ (digits >> 2 & 0x3333_3333);
    let digits = digits ^ (digits >> 4 & 0x0f0f_0f0f);
    let digits = digits ^ (digits >> 8 & 0x00ff_00ff);
    digits ^ (digits >> 16 & 0x0000_ffff)
}

/// Returns reversed digits as a fraction, exactly.
fn unit(reversed_digits: u32) -> f64 {
    f64::from(reversed_digits.reverse_bits()) / 4_294_967_296.0
}

/// Hashes a key and a number with the finalizer of SplitMix64 (Steele, Lea and Flood, 2014), applied to both.
#[inline(always)]
pub(crate) fn mixed(key: u64, number: u64) -> u64 {
    let step = |value: u64| {
        let value = (value ^ value >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let value = (value ^ value >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        value ^ value >> 31
    };
    step(key ^ step(number.wrapping_add(0x9e37_79b9_7f4a_7c15)))
}

/// Returns a random number in 0..1 for a key and a number.
pub(crate) fn uniform(key: u64, number: u64) -> f64 {
    unit(high(mixed(key, number)))
}

#[expect(clippy::cast_possible_truncation, reason = "half of the bits are asked for")]
fn low(key: u64) -> u32 {
    key as u32
}

fn high(key: u64) -> u32 {
    low(key >> 32)
}

#[cfg(test)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "numbers in 0..1 times small ones"
)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    const DIMENSIONS: [Dimension; 4] = [
        Dimension::Pixel,
        Dimension::Lens,
        Dimension::Light { light: 2, path: 1 },
        Dimension::Light { light: 2, path: 3 },
    ];

    #[test]
    fn the_second_dimension_follows_its_direction_numbers() {
        for index in (0..5000).chain([u32::MAX, 0x8000_0000, 0xdead_beef]) {
            let mut direction = 1 << 31;
            let mut expected = 0;
            for bit in 0..32 {
                if index >> bit & 1 == 1 {
                    expected ^= direction;
                }
                direction ^= direction >> 1;
            }
            assert_eq!(pascal(index).reverse_bits(), expected, "{index}");
        }
    }

    #[test]
    fn every_power_of_two_has_one_point_in_each_elementary_interval() {
        for dimension in DIMENSIONS {
            for (seed, i, j) in [(0, 0, 0), (0, 1, 0), (7, 319, 179), (u64::MAX, 32_767, 8191)] {
                let samples = PixelSamples::new(seed, i, j);
                for exponent in 0..=10_u32 {
                    let count = 1_u32 << exponent;
                    for first in [0, count, 5 * count] {
                        for across in 0..=exponent {
                            let (columns, rows) = (1 << across, 1 << (exponent - across));
                            let mut seen = vec![false; count as usize];
                            for index in first..first + count {
                                let [x, y] = samples.pair(dimension, index);
                                let cell = |value: f64, cells: u32| (value * f64::from(cells)) as u32;
                                let interval = cell(y, rows) * columns + cell(x, columns);
                                assert!(!std::mem::replace(&mut seen[interval as usize], true));
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn the_third_dimension_repeats_every_256_samples() {
        let mut numbers = vec![1, 3];
        (2..32)
            .for_each(|bit| numbers.push((2 * numbers[bit - 1]) ^ (4 * numbers[bit - 2]) ^ numbers[bit - 2]));
        let first_digits = |index: u32| {
            let set = (0..32).filter(|bit| index >> bit & 1 == 1);
            set.fold(0_u32, |digits, bit| digits ^ numbers[bit] << (31 - bit)) >> 24
        };
        for sample in 0..65_536 {
            assert_eq!(first_digits(position_index(sample)), first_digits(sample % 256), "{sample}");
        }
    }

    #[test]
    fn positions_at_an_instant_are_spread_evenly() {
        let samples = PixelSamples::new(3, 5, 7);
        for first in [0, 77, 255] {
            for (columns, rows) in [(16.0, 1.0), (4.0, 4.0), (1.0, 16.0)] {
                let mut cells: Vec<u32> = (0..16)
                    .map(|repetition| samples.pair(Dimension::Pixel, first + 256 * repetition))
                    .map(|[x, y]| (y * rows) as u32 * columns as u32 + (x * columns) as u32)
                    .collect();
                cells.sort_unstable();
                assert!(cells.into_iter().eq(0..16), "{first}");
            }
        }
    }

    #[test]
    fn first_points_are_uniform_over_pixels_and_independent_between_dimensions() {
        let count = 256.0 * 256.0;
        let mut cells = [0.0; 64];
        let mut moments = [0.0; 4];
        for j in 0..256 {
            for i in 0..256 {
                let samples = PixelSamples::new(0, i, j);
                let [x, y] = samples.pair(Dimension::Pixel, 0);
                let lens = samples.number(Dimension::Lens, 0);
                let right = PixelSamples::new(0, i + 1, j).number(Dimension::Pixel, 0);
                cells[(y * 8.0) as usize * 8 + (x * 8.0) as usize] += 1.0;
                for (moment, other) in
                    moments.iter_mut().zip([y, lens, right, samples.number(Dimension::Pixel, 1)])
                {
                    *moment += 12.0 * (x - 0.5) * (other - 0.5);
                }
            }
        }
        let expected = count / 64.0;
        let chi_square: f64 = cells.iter().map(|found: &f64| squared(found - expected) / expected).sum();
        assert!((25.0..115.0).contains(&chi_square), "{chi_square} with 63 degrees of freedom");
        let correlations = moments.map(|moment| moment / count);
        for correlation in &correlations[..3] {
            assert!(correlation.abs() < 5.0 / 256.0, "{correlations:?}");
        }
        // The second point lies in the other half.
        assert!((correlations[3] + 0.75).abs() < 5.0 / 256.0, "{correlations:?}");
    }

    #[test]
    fn the_disc_is_covered_evenly() {
        let samples = PixelSamples::new(0, 0, 0);
        let (mut rings, mut sectors) = ([0; 8], [0; 8]);
        for index in 0..8192 {
            let [x, y] = disc(samples.pair(Dimension::Lens, index));
            let square = x * x + y * y;
            assert!(square < 1.0 + 1e-15);
            rings[((8.0 * square) as usize).min(7)] += 1;
            let turn = 0.5 + libm::atan2(y, x) / (4.0 * FRAC_PI_2);
            sectors[((8.0 * turn) as usize).min(7)] += 1;
        }
        for count in rings.into_iter().chain(sectors) {
            assert!((1004..=1044).contains(&count), "{rings:?} {sectors:?}");
        }
        assert_eq!(disc([0.5, 0.5]), [0.0, 0.0]);
        assert_eq!(disc([0.0, 0.5]), [-1.0, 0.0]);
    }

    #[test]
    fn the_points_never_change() {
        let bits = |i, index, dimension| {
            PixelSamples::new(1, i, 3).pair(dimension, index).map(|number| (number * 4_294_967_296.0) as u32)
        };
        let found: Vec<[u32; 2]> = DIMENSIONS
            .into_iter()
            .flat_map(|dimension| {
                [bits(2, 0, dimension), bits(2, 1, dimension), bits(500, 40_000, dimension)]
            })
            .collect();
        assert_eq!(found, FROZEN);
    }

    /// Expected points in units of 2^-32.
    const FROZEN: [[u32; 2]; 12] = [
        [0x85d9_0609, 0xd8f4_0cde],
        [0x79cd_68fa, 0x0766_a676],
        [0xc1bb_21eb, 0x68c5_0bea],
        [0x3928_98e3, 0xd162_4b68],
        [0xabc6_b9b3, 0x79d0_9d22],
        [0xb46e_8adf, 0x4db5_a1be],
        [0xbd68_5a67, 0xf98c_c803],
        [0x63f3_228b, 0x43c9_284a],
        [0x8ff5_8a45, 0x5733_3500],
        [0x54ed_24b3, 0x6182_124e],
        [0x83de_ff61, 0xa185_8257],
        [0xb3d0_a2c5, 0xd029_10ab],
    ];

    fn squared(value: f64) -> f64 {
        value * value
    }

    /// Returns the exponent e of an RMS error that falls as n^e, over n = 4, 16, .. 4096 and many pixels.
    fn convergence(function: impl Fn([f64; 2], f64) -> f64, mean: impl Fn(f64) -> f64) -> f64 {
        const PIXELS: u32 = 400;
        let exponents = [2, 4, 6, 8, 10, 12];
        let errors = exponents.map(|exponent| {
            let count = 1_u32 << exponent;
            let square = |pixel| {
                let samples = PixelSamples::new(5, pixel, 0);
                let parameter = (f64::from(pixel) + 0.5) / f64::from(PIXELS);
                let sum: f64 =
                    (0..count).map(|index| function(samples.pair(Dimension::Pixel, index), parameter)).sum();
                squared(sum / f64::from(count) - mean(parameter))
            };
            0.5 * libm::log2((0..PIXELS).map(square).sum::<f64>() / f64::from(PIXELS))
        });
        // The slope of the least-squares line.
        let x = exponents.map(f64::from);
        let (middle, average) = (7.0, errors.iter().sum::<f64>() / 6.0);
        let rise: f64 = x.iter().zip(errors).map(|(x, error)| (x - middle) * (error - average)).sum();
        rise / x.iter().map(|x| squared(x - middle)).sum::<f64>()
    }

    #[test]
    fn means_of_smooth_functions_converge_as_they_should() {
        // The mean of exp(p x) cos(y) is (exp(p) - 1)/p sin(1).
        let exponent = convergence(
            |[x, y], parameter| libm::exp(parameter * x) * libm::cos(y),
            |parameter| libm::expm1(parameter) / parameter * libm::sin(1.0),
        );
        assert!((-1.7..-1.35).contains(&exponent), "n^{exponent}");
    }

    #[test]
    fn coverage_of_a_half_plane_converges_faster_than_by_chance() {
        // The half-plane is y < p + (x - 1/2)/3; its edge stays in the square for p in 1/6..5/6.
        let height = |parameter: f64| 0.2 + 0.6 * parameter;
        let exponent = convergence(
            |[x, y], parameter| f64::from(u8::from(y < height(parameter) + (x - 0.5) / 3.0)),
            height,
        );
        assert!((-0.9..-0.65).contains(&exponent), "n^{exponent}");
    }
}
