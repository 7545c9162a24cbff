//! Checker patterns: the layout of squares of two colours.

use glam::{DAffine3, DMat3, DVec3};

use crate::trace::math::scaled;
use crate::trace::shapes::inverse;

/// A grid of squares on a surface, in the shape's local space.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckerPattern {
    forward: DMat3,
    inverse: DMat3,
    translation: DVec3,
    size: f64,
    surface: Checkered,
}

#[derive(Clone, Debug, PartialEq)]
enum Checkered {
    /// The axes of the squares, through the origin.
    Plane([DVec3; 2]),
    /// Half-extents of the box. The squares start at the lower corner of each face.
    Box(DVec3),
}

impl CheckerPattern {
    /// Creates the pattern on a plane through the map's translation. `normal` is the plane's normal before mapping.
    #[must_use]
    pub fn on_plane(map: DAffine3, normal: DVec3, size: f64) -> Self {
        Self::new(map, size, Checkered::Plane(axes_across(normal)))
    }

    /// Creates the pattern on the faces of a box around the map's translation. `half` holds its half-extents before mapping.
    #[must_use]
    pub fn on_box(map: DAffine3, half: DVec3, size: f64) -> Self {
        Self::new(map, size, Checkered::Box(half))
    }

    fn new(map: DAffine3, size: f64, surface: Checkered) -> Self {
        Self {
            forward: map.matrix3,
            inverse: inverse(map.matrix3),
            translation: map.translation,
            size,
            surface,
        }
    }

    /// Passes the numbers that define the pattern to `each`.
    pub(super) fn numbers(&self, mut each: impl FnMut(f64)) {
        let Self { forward, inverse: _, translation, size, surface } = self;
        let mut all = |vector: DVec3| vector.to_array().into_iter().for_each(&mut each);
        [forward.x_axis, forward.y_axis, forward.z_axis, *translation].into_iter().for_each(&mut all);
        match surface {
            Checkered::Plane(axes) => axes.iter().copied().for_each(&mut all),
            Checkered::Box(half) => all(*half),
        }
        each(*size);
    }

    /// Returns whether points of one plane, or of one face of a box, lie in the same square.
    pub(crate) fn holds(&self, points: [DVec3; 4]) -> bool {
        let own = points.map(|point| self.inverse * (point - self.translation));
        let one = |place: &dyn Fn(DVec3) -> f64| {
            let squares = own.map(|point| (place(point) / self.size).floor());
            squares.iter().all(|square| *square == squares[0])
        };
        match &self.surface {
            Checkered::Plane(axes) => axes.iter().all(|axis| one(&|point| point.dot(*axis))),
            Checkered::Box(half) => {
                let least = own.into_iter().fold(DVec3::INFINITY, DVec3::min);
                let across = (own.into_iter().fold(DVec3::NEG_INFINITY, DVec3::max) - least).min_position();
                (0..3).filter(|axis| *axis != across).all(|axis| one(&|point| point[axis] + half[axis]))
            }
        }
    }

    /// Returns whether the point lies on a square of the second colours.
    pub(crate) fn is_second(&self, point: DVec3, normal: DVec3) -> bool {
        let own = self.inverse * (point - self.translation);
        let [x, y] = match &self.surface {
            Checkered::Plane(axes) => axes.map(|axis| own.dot(axis)),
            Checkered::Box(half) => {
                // A face's normal is mapped back by the transpose, up to its length.
                let across = (self.forward.transpose() * normal).abs();
                let from_corner = own + *half;
                if across.x >= across.y && across.x >= across.z {
                    [from_corner.y, from_corner.z]
                } else if across.y >= across.z {
                    [from_corner.x, from_corner.z]
                } else {
                    [from_corner.x, from_corner.y]
                }
            }
        };
        let square = |place: f64| (place / self.size).floor();
        (square(x) + square(y)).rem_euclid(2.0) == 1.0
    }
}

/// Returns the axes of the squares on a plane: unit vectors perpendicular to its normal and to each other.
///
/// If the normal is along one of the coordinate axes, they are the other two. In between they follow the normal continuously, and the sign
/// of the normal does not matter. No axes can follow a normal everywhere (the hairy ball theorem): these spin around (1, 1, 1) and its
/// opposite, which are as far as possible from the coordinate axes, and around no other direction.
///
/// The sum of the coordinate axes' projections onto the plane is the diagonal between the two. Each projection is weighted less the nearer
/// the normal is to its axis, in fourth powers, so that the squares of a plane tilted about one of the axes by up to 20 degrees are aligned
/// with it to a degree.
fn axes_across(normal: DVec3) -> [DVec3; 2] {
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
