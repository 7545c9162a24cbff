//! The axes of patterns on planes.

use glam::DVec3;

use crate::trace::math::scaled;

/// Returns the axes of a pattern on a plane: unit vectors perpendicular to its normal and to each other.
///
/// If the normal is along one of the coordinate axes, they are the other two. In between they follow the normal continuously, and the sign
/// of the normal does not matter. No axes can follow a normal everywhere (the hairy ball theorem): these spin around (1, 1, 1) and its
/// opposite, which are as far as possible from the coordinate axes, and around no other direction.
///
/// The sum of the coordinate axes' projections onto the plane is the diagonal between the two. Each projection is weighted less the nearer
/// the normal is to its axis, in fourth powers, so that the squares of a plane tilted about one of the axes by up to 20 degrees are aligned
/// with it to a degree.
pub(super) fn axes_across(normal: DVec3) -> [DVec3; 2] {
    /// Maximum length of a zero sum of three vectors after rounding.
    const NONE: f64 = 16.0 * f64::EPSILON;
    let normal = scaled(normal).map_or(DVec3::Y, |(normal, _)| normal / normal.dot(normal).sqrt());
    let fourth = normal * normal * normal * normal;
    let along = fourth / fourth.element_sum();
    let shown = |axis: DVec3| {
        let shown = axis - normal * normal.dot(axis);
        shown.normalize_or_zero() * (1.0 - along.dot(axis))
    };
    let all = shown(DVec3::X) + shown(DVec3::Y) + shown(DVec3::Z);
    let diagonal = if all.length() > NONE { all } else { shown(DVec3::X) };
    let across = normal.cross(diagonal);
    [(diagonal + across).normalize(), (diagonal - across).normalize()]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Generates numbers of all magnitudes up to 1, so that normals come near to all axes and to all planes between two of them.
    fn component() -> impl Strategy<Value = f64> {
        let tiny = (-1.0..1.0, -17..0).prop_map(|(number, digits)| number * libm::exp10(f64::from(digits)));
        prop_oneof![Just(0.0), Just(1.0), Just(-1.0), tiny, -1.0..1.0]
    }

    fn normal() -> impl Strategy<Value = DVec3> {
        let triple = (component(), component(), component());
        let normal = triple.prop_map(|(x, y, z)| DVec3::new(x, y, z).normalize_or_zero());
        normal.prop_filter("no direction", |normal| normal.is_normalized())
    }

    /// Returns the distance of a normal from the nearest direction around which the axes spin.
    fn distance_to_singular(normal: DVec3) -> f64 {
        let singular = DVec3::ONE.normalize();
        (normal - singular).length().min((normal + singular).length())
    }

    #[test]
    fn normals_along_an_axis_have_squares_along_the_other_two() {
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        for length in [1e-60, 1.0, 3.0, 49.0, 1e60] {
            for (normal, axes) in [(x, [z, y]), (y, [x, z]), (z, [y, x])] {
                let [first, second] = axes;
                assert_eq!(axes_across(normal * length), axes);
                assert_eq!(axes_across(-normal * length), [second, first], "the same squares");
            }
        }
    }

    #[test]
    fn axes_there_are_even_where_they_have_no_place_to_go() {
        for normal in [DVec3::ONE, -DVec3::ONE, DVec3::new(1.0, 1.0, 1.0 + 1e-15)] {
            let [first, second] = axes_across(normal);
            assert!(first.is_normalized() && second.is_normalized() && first.dot(second).abs() < 1e-2);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn neighbouring_normals_have_neighbouring_axes(normal in normal(), towards in normal(), step in -12.0..-2.0) {
            let distance = distance_to_singular(normal);
            prop_assume!(distance > 1e-3);
            let step = libm::exp10(step) * distance;
            let neighbour = (normal + towards * step).normalize();
            let axes = axes_across(normal).into_iter().zip(axes_across(neighbour));
            for (one, other) in axes {
                let moved = (one - other).length();
                prop_assert!(moved <= 5.0 * step / distance + 1e-12, "{moved} for {step} at {distance}");
            }
        }

        #[test]
        fn axes_are_across_the_normal_and_each_other_whichever_way_it_points(normal in normal()) {
            prop_assume!(distance_to_singular(normal) > 1e-6);
            let [first, second] = axes_across(normal);
            prop_assert!(first.is_normalized() && second.is_normalized());
            for (one, other) in [(first, second), (first, normal), (second, normal)] {
                prop_assert!(one.dot(other).abs() < 1e-9);
            }
            prop_assert_eq!(axes_across(-normal), [second, first]);
        }

        #[test]
        fn planes_tilted_a_little_about_an_axis_have_squares_along_it(
            degrees in -20.0..20.0_f64,
            about in 0..3_usize,
            turn in 1..3_usize,
        ) {
            let axes = [DVec3::X, DVec3::Y, DVec3::Z];
            let [about, up, aside] = [about, (about + turn) % 3, (about + 2 * turn) % 3].map(|index| axes[index]);
            let (sine, cosine) = libm::sincos(degrees.to_radians());
            let own = axes_across(up * cosine + aside * sine);
            let most = own.map(|own| own.dot(about).abs()).into_iter().fold(0.0, f64::max);
            prop_assert!(most > libm::cos(1.1_f64.to_radians()), "{most}");
        }
    }
}
