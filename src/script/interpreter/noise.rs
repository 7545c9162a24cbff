//! Stateless randomness: pure functions of their arguments and a seed.

use rhai::{Dynamic, Engine, FLOAT};

use super::maths::argument;
use super::result::finite;

/// Mixes the bits of a number by the finalizer of SplitMix64 (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators",
/// 2014).
fn mixed(mut bits: u64) -> u64 {
    bits = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

/// Hashes numbers. Equal numbers have equal hashes, including 0 and -0.
fn hash<const COUNT: usize>(seed: u64, numbers: [FLOAT; COUNT]) -> u64 {
    numbers.into_iter().fold(mixed(seed ^ COUNT as u64), |key, number| mixed(key ^ (number + 0.0).to_bits()))
}

/// Returns a uniformly distributed number in [0, 1).
#[expect(clippy::cast_precision_loss, reason = "53 bits are exact")]
fn random<const COUNT: usize>(seed: u64, numbers: [FLOAT; COUNT]) -> FLOAT {
    (hash(seed, numbers) >> 11) as FLOAT / (1_u64 << 53) as FLOAT
}

/// Computes gradient noise in [-1, 1] that is 0 at integers (Perlin, "Improving Noise", SIGGRAPH 2002). Its first two derivatives are
/// continuous. In N dimensions, gradients of length 1 give at most sqrt(N) / 2; the sum is divided by this bound.
fn noise<const COUNT: usize>(
    seed: u64,
    at: [FLOAT; COUNT],
    gradient: fn(u64, [FLOAT; COUNT]) -> FLOAT,
) -> FLOAT {
    let cell = at.map(libm::floor);
    let inside: [FLOAT; COUNT] = std::array::from_fn(|axis| at[axis] - cell[axis]);
    let fade = inside.map(|u| u * u * u * (u * (6.0 * u - 15.0) + 10.0));
    let corner = |corner: usize| {
        let upper = |axis: usize| corner >> axis & 1 == 1;
        let offset: [FLOAT; COUNT] = std::array::from_fn(|axis| if upper(axis) { 1.0 } else { 0.0 });
        let key = hash(
            seed ^ 0x006e_6f69_7365,
            std::array::from_fn::<_, COUNT, _>(|axis| cell[axis] + offset[axis]),
        );
        let weight: FLOAT =
            (0..COUNT).map(|axis| if upper(axis) { fade[axis] } else { 1.0 - fade[axis] }).product();
        weight * gradient(key, std::array::from_fn(|axis| inside[axis] - offset[axis]))
    };
    let sum: FLOAT = (0..1 << COUNT).map(corner).sum();
    (sum * 2.0 / libm::sqrt(COUNT as FLOAT)).clamp(-1.0, 1.0)
}

/// Returns the product of an offset with a gradient in [-1, 1].
#[expect(clippy::cast_precision_loss, reason = "53 bits are exact")]
fn slope(key: u64, [x]: [FLOAT; 1]) -> FLOAT {
    ((key >> 11) as FLOAT / (1_u64 << 52) as FLOAT - 1.0) * x
}

/// Returns the dot product of an offset with one of eight directions.
fn in_plane(key: u64, [x, y]: [FLOAT; 2]) -> FLOAT {
    use std::f64::consts::FRAC_1_SQRT_2 as HALF;
    match key >> 61 {
        0 => x,
        1 => -x,
        2 => y,
        3 => -y,
        4 => HALF * (x + y),
        5 => HALF * (x - y),
        6 => HALF * (y - x),
        _ => -HALF * (x + y),
    }
}

/// Returns the dot product of an offset with one of the twelve directions from the centre of a cube to the midpoints of its edges.
fn in_space(key: u64, [x, y, z]: [FLOAT; 3]) -> FLOAT {
    let (a, b) = match key % 3 {
        0 => (x, y),
        1 => (y, z),
        _ => (z, x),
    };
    let signed = |bit: u32, value: FLOAT| if key >> bit & 1 == 1 { -value } else { value };
    std::f64::consts::FRAC_1_SQRT_2 * (signed(63, a) + signed(62, b))
}

pub(super) fn register(engine: &mut Engine, seed: u64) {
    let random_argument = |value: &Dynamic| argument("random", value);
    engine.register_fn("random", move |i: Dynamic| finite(random(seed, [random_argument(&i)?])));
    engine.register_fn("random", move |i: Dynamic, j: Dynamic| {
        finite(random(seed, [random_argument(&i)?, random_argument(&j)?]))
    });
    engine.register_fn("random", move |i: Dynamic, j: Dynamic, k: Dynamic| {
        finite(random(seed, [random_argument(&i)?, random_argument(&j)?, random_argument(&k)?]))
    });
    let noise_argument = |value: &Dynamic| argument("noise", value);
    engine.register_fn("noise", move |x: Dynamic| finite(noise(seed, [noise_argument(&x)?], slope)));
    engine.register_fn("noise", move |x: Dynamic, y: Dynamic| {
        finite(noise(seed, [noise_argument(&x)?, noise_argument(&y)?], in_plane))
    });
    engine.register_fn("noise", move |x: Dynamic, y: Dynamic, z: Dynamic| {
        finite(noise(seed, [noise_argument(&x)?, noise_argument(&y)?, noise_argument(&z)?], in_space))
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Evaluates the three kinds of noise along a line that meets no symmetry of the grid.
    fn along(seed: u64, s: FLOAT) -> [FLOAT; 3] {
        [
            noise(seed, [s], slope),
            noise(seed, [s, 0.618 * s + 0.3], in_plane),
            noise(seed, [s, 0.618 * s + 0.3, 0.414 * s + 0.7], in_space),
        ]
    }

    #[test]
    fn noise_uses_its_range_with_zero_mean() {
        for kind in 0..3 {
            let values: Vec<FLOAT> = (0..200_000).map(|i| along(7, f64::from(i) * 0.0371)[kind]).collect();
            assert!(values.iter().all(|value| value.abs() <= 1.0));
            let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
            assert!(largest > 0.7, "{kind}: {largest}");
            let mean = values.iter().sum::<FLOAT>() / 200_000.0;
            assert!(mean.abs() < 0.02, "{kind}: {mean}");
        }
    }

    #[test]
    fn the_bound_is_reached_nowhere_but_in_the_middle_of_a_cell() {
        // The largest possible sum of weights times distances, reached if all gradients point to the sample point.
        for (x, y, z) in (0..=20).flat_map(|x| (0..=20).flat_map(move |y| (0..=20).map(move |z| (x, y, z)))) {
            let at = [x, y, z].map(|part| f64::from(part) / 20.0);
            let fade = at.map(|u| u * u * u * (u * (6.0 * u - 15.0) + 10.0));
            let sum: FLOAT = (0..8)
                .map(|corner| {
                    let upper = |axis: usize| corner >> axis & 1 == 1;
                    let weight: FLOAT =
                        (0..3).map(|axis| if upper(axis) { fade[axis] } else { 1.0 - fade[axis] }).product();
                    let square: FLOAT = (0..3)
                        .map(|axis| at[axis] - if upper(axis) { 1.0 } else { 0.0 })
                        .map(|d| d * d)
                        .sum();
                    weight * square.sqrt()
                })
                .sum();
            assert!(sum <= 0.75_f64.sqrt() + 1e-15, "{at:?}: {sum}");
        }
    }

    #[test]
    fn noise_and_its_slope_are_continuous() {
        const STEP: FLOAT = 1e-5;
        for kind in 0..3 {
            let slope = |s: FLOAT| (along(3, s + STEP)[kind] - along(3, s)[kind]) / STEP;
            for i in 0..20_000 {
                let s = f64::from(i) * 5e-4 - 5.0;
                assert!((slope(s + STEP) - slope(s)).abs() < 1e-2, "{kind} at {s}");
            }
        }
    }

    #[test]
    fn noise_does_not_repeat_at_the_periods_of_tables() {
        for kind in 0..3 {
            for period in [16, 64, 256, 1024, 65536] {
                let same = (0..500)
                    .filter(|i| {
                        let s = f64::from(*i) * 0.37;
                        let moved = match kind {
                            0 => noise(1, [s + f64::from(period)], slope),
                            1 => noise(1, [s + f64::from(period), 0.5], in_plane),
                            _ => noise(1, [s + f64::from(period), 0.5, 0.25], in_space),
                        };
                        let here = match kind {
                            0 => noise(1, [s], slope),
                            1 => noise(1, [s, 0.5], in_plane),
                            _ => noise(1, [s, 0.5, 0.25], in_space),
                        };
                        (moved - here).abs() < 1e-9
                    })
                    .count();
                assert!(same < 20, "{kind}, {period}: {same}");
            }
        }
    }

    #[test]
    fn noise_is_finite_everywhere_and_random_is_even() {
        for huge in [1e15, -1e18, 1e300, -0.0, 1e-300] {
            assert!(noise(0, [huge, 0.3, -huge], in_space).is_finite());
        }
        let values: Vec<FLOAT> = (0..10_000).map(|i| random(5, [f64::from(i)])).collect();
        assert!(values.iter().all(|value| (0.0..1.0).contains(value)));
        let in_part =
            |part: u32| values.iter().filter(|value| (**value * 10.0).floor() == f64::from(part)).count();
        assert!((0..10).all(|part| (900..1100).contains(&in_part(part))));
        assert_eq!(random(5, [0.0]), random(5, [-0.0]));
        assert_ne!(random(5, [1.0, 2.0]), random(5, [2.0, 1.0]));
        assert_ne!(random(5, [1.0]), random(6, [1.0]));
    }
}
