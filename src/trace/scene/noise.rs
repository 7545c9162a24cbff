//! Fractal gradient noise in space: a smooth random function, the same on all machines.
//!
//! Gradient noise (Perlin, "Improving Noise", 2002) is 0 at all points of its lattice, which shows as a regular grid of spots, most of all on
//! surfaces along the lattice. Two remedies are used here:
//!
//! - Each lattice point also has a random value, as in value-gradient noise (Peachey, "Building Procedural Textures", in Ebert et al.,
//!   "Texturing and Modeling", 3rd edition 2003, chapter 2). The values are scaled so that the variance at lattice points equals the
//!   variance in the middle between them.
//! - Each octave is turned against the shape's axes and against the octaves before, so that no lattice plane is along a face of a box.
//!
//! Lattice points are hashed by the output function of SplitMix64. All operations are exactly rounded, in one order.

use glam::{DMat3, DVec3};

use crate::trace::math::mixed;

/// The scale of the random values at lattice points, relative to the gradients. A gradient to the middle of an edge of a cube is
/// perpendicular to a face in a third of all cases, so its products with (±1/2, ±1/2, ±1/2) have the mean square 1/2, and the mean of eight
/// of them 1/16. Values between -v and v have the mean square v²/3 at their lattice point and v²/24 in the middle of eight of them. Both sums
/// are equal for v² = 3/14.
const VALUE: f64 = 0.462_910_049_886_275_7;

/// Three times the rotation by 60 degrees about (1, 1, 1), which has integer entries: the sides of the next lattice are along (2, 2, -1),
/// (-1, 2, 2) and (2, -1, 2).
const TURN: DMat3 =
    DMat3::from_cols(DVec3::new(2.0, 2.0, -1.0), DVec3::new(-1.0, 2.0, 2.0), DVec3::new(2.0, -1.0, 2.0));

/// Returns the sum of `octaves` noises, each with half the size and half the amplitude of the one before. The lattice of the first has the
/// side 1. The mean is 0, and the standard deviation about 0.33 for one octave and 0.39 for many. Not a number for points that are not finite.
pub(super) fn fractal(point: DVec3, octaves: u32) -> f64 {
    let (mut point, mut amplitude, mut sum) = (point, 1.0, 0.0);
    for octave in 0..octaves {
        point = TURN * point / 3.0;
        sum += amplitude * noise(point, octave);
        (point, amplitude) = (point * 2.0, amplitude * 0.5);
    }
    sum
}

/// Returns value-gradient noise on the lattice of integers. `seed` selects the random numbers.
fn noise(point: DVec3, seed: u32) -> f64 {
    let floor = point.floor();
    let within = point - floor;
    // Saturates beyond the range of integers, where all points are on the lattice.
    #[expect(clippy::cast_possible_truncation, reason = "the nearest integer is meant")]
    let [x, y, z] = floor.to_array().map(|coordinate| coordinate as i64);
    let corner = |right: bool, up: bool, far: bool| {
        let at = [x.wrapping_add(right.into()), y.wrapping_add(up.into()), z.wrapping_add(far.into())];
        let from = [right, up, far].map(|one| f64::from(u8::from(one)));
        at_corner(lattice_hash(at, seed), within - DVec3::from_array(from))
    };
    let fade = within * within * within * (within * (within * 6.0 - 15.0) + 10.0);
    let blended = |one: f64, other: f64, share: f64| one + (other - one) * share;
    let row = |up, far| blended(corner(false, up, far), corner(true, up, far), fade.x);
    let face = |far| blended(row(false, far), row(true, far), fade.y);
    blended(face(false), face(true), fade.z)
}

/// Returns the contribution of a lattice point at the offset `from` it: its value, and the product with its gradient, a vector to the middle of
/// an edge of a cube.
fn at_corner(hash: u64, from: DVec3) -> f64 {
    const STEP: f64 = 1.0 / (1_u64 << 52) as f64;
    // The highest 53 bits as a number from -1 to 1.
    let value = ((hash >> 11) as f64 * STEP - 1.0) * VALUE;
    let signed = |length: f64, bit: u64| if hash >> bit & 1 == 0 { length } else { -length };
    // The lowest bits select one of the three pairs of axes, with a bias of 2^-9.
    let [first, second] = match (hash & 0x1ff) % 3 {
        0 => [from.x, from.y],
        1 => [from.y, from.z],
        _ => [from.z, from.x],
    };
    value + signed(first, 9) + signed(second, 10)
}

/// Returns a random number for a lattice point.
fn lattice_hash([x, y, z]: [i64; 3], seed: u32) -> u64 {
    /// Odd numbers without a pattern: the fractions of the golden ratio and of the square roots of 2 and 3.
    const FACTORS: [u64; 3] = [0x9e37_79b9_7f4a_7c15, 0x6a09_e667_f3bc_c909, 0xbb67_ae85_84ca_a73b];
    let products = [x, y, z].into_iter().zip(FACTORS);
    let products = products.map(|(number, factor)| number.cast_unsigned().wrapping_mul(factor));
    mixed(products.fold(0, u64::wrapping_add), seed.into())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::trace::math::uniform;

    /// Returns random points between -50 and 50.
    fn points(count: u64) -> impl Iterator<Item = DVec3> {
        let at = |index: u64, axis| 100.0 * uniform(axis, index) - 50.0;
        (0..count).map(move |index| DVec3::new(at(index, 1), at(index, 2), at(index, 3)))
    }

    fn mean_and_deviation(values: impl Iterator<Item = f64>) -> (f64, f64) {
        let values: Vec<f64> = values.collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let squares = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>();
        (mean, (squares / values.len() as f64).sqrt())
    }

    #[test]
    fn noise_has_the_stated_mean_and_deviation() {
        for (octaves, stated) in [(1, 0.33), (2, 0.365), (4, 0.38), (16, 0.386)] {
            let (mean, deviation) = mean_and_deviation(points(100_000).map(|point| fractal(point, octaves)));
            assert!(mean.abs() < 0.01, "{octaves}: {mean}");
            assert!((deviation - stated).abs() < 0.01, "{octaves}: {deviation}");
        }
    }

    /// Checks that the lattice is invisible in the statistics: the deviation is the same on it and in the middle between its points, and on
    /// points of the shape's own lattice. Perlin's noise is 0 at all points of the lattice.
    #[test]
    fn lattice_points_are_like_others() {
        let on_lattice = || points(20_000).map(DVec3::floor);
        let (_, at_points) = mean_and_deviation(on_lattice().map(|point| noise(point, 0)));
        let (_, between) = mean_and_deviation(on_lattice().map(|point| noise(point + 0.5, 0)));
        let (_, anywhere) = mean_and_deviation(points(20_000).map(|point| noise(point, 0)));
        assert!((at_points - between).abs() < 0.01, "{at_points} {between}");
        assert!(at_points > 0.75 * anywhere, "{at_points} {anywhere}");
        for plane in [0.0, 0.25, 0.5] {
            let own = on_lattice().map(|point| fractal(DVec3::new(point.x, plane, point.z), 1));
            let (mean, deviation) = mean_and_deviation(own);
            assert!(mean.abs() < 0.01 && (deviation - anywhere).abs() < 0.04, "{plane}: {mean} {deviation}");
        }
        // Only few points next to each other have nearly the same value.
        let is_flat = |point: &DVec3| (fractal(*point, 1) - fractal(*point + DVec3::X, 1)).abs() < 0.01;
        assert!(on_lattice().filter(is_flat).count() < 1000);
    }

    /// Checks bits, which are the same on all machines.
    #[test]
    fn noise_is_repeatable() {
        let point = DVec3::new(0.3, -0.7, 1.9);
        let bits = [1, 2, 4, 16].map(|octaves| fractal(point, octaves).to_bits());
        assert_eq!(
            bits,
            [0x3fd2_f8a4_4c9d_5798, 0x3fc9_a56d_66d3_8bc1, 0x3fc4_e1bd_7a1f_073e, 0x3fc4_4498_1aa5_b091]
        );
    }

    proptest! {
        #[test]
        fn noise_is_continuous(
            place in prop_oneof![(-9.0..9.0f64, -9.0..9.0, -9.0..9.0), (-2..2, -2..2, -2..2).prop_map(|(x, y, z)| {
                (f64::from(x), f64::from(y), f64::from(z))
            })],
            step in (-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64),
            size in -12..-2i32,
        ) {
            let (place, step) = (DVec3::from(place), DVec3::from(step) * libm::exp10(f64::from(size)));
            for octaves in [1, 5] {
                let change = (fractal(place + step, octaves) - fractal(place, octaves)).abs();
                prop_assert!(change <= 8.0 * f64::from(octaves) * step.length() + 1e-13, "{change} of {step}");
            }
        }

        #[test]
        fn huge_places_have_some_noise(exponent in -300..308i32, octaves in 1..16u32) {
            let place = DVec3::new(1.0, -0.7, 0.3) * libm::exp10(f64::from(exponent));
            let found = fractal(place, octaves);
            prop_assert!(found.abs() < 3.0 || found.is_nan());
            for place in [place / 0.0, place * f64::NAN] {
                prop_assert!(fractal(place, octaves).is_nan());
            }
        }
    }
}
