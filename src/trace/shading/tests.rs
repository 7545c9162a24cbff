//! Compares the bits of formulas of light over numbers with those over lanes, at every SIMD level.

use glam::DVec3;
use proptest::prelude::*;

use super::dielectric::{Boundary, incidence, mirrored};
use super::terms::{half_cosine, length, over};
use crate::trace::math::Real;
use crate::trace::math::same_bits::{Formulas, compare};
use crate::trace::scene::{Cone, PreparedFalloff, on_rectangle, on_sphere};

/// Light that arrives along a direction, given by three numbers, at a surface with a normal, from a spot light and area lights.
struct ArrivingLight {
    boundary: Boundary,
    cone: Cone,
    falloff: PreparedFalloff,
}

impl Formulas<8, 20> for ArrivingLight {
    #[inline(always)]
    fn evaluate<R: Real>(&self, [x, y, z, normal_x, normal_y, normal_z, u, v]: [R; 8]) -> [R; 20] {
        let (direction, normal) = ([x, y, z], [normal_x, normal_y, normal_z]);
        let (unit, normal) = (over(direction, length(direction)), over(normal, length(normal)));
        let boundary = Boundary { from: x.of(self.boundary.from), into: x.of(self.boundary.into) };
        let cosine = incidence(unit, normal);
        let (bent, passes) = boundary.refraction(cosine);
        let (zero, one) = (x.of(0.0), x.of(1.0));
        let [refracted_x, refracted_y, refracted_z] = boundary.refracted(unit, normal, cosine, bent);
        let [mirrored_x, mirrored_y, mirrored_z] = mirrored(direction, normal);
        let [disc_x, disc_y, disc_z] = on_sphere(self.cone.axis, self.cone.outer, direction, [u, v]);
        let [panel_x, panel_y, panel_z] = on_rectangle(DVec3::ONE, [self.cone.axis, DVec3::Y], [u, v]);
        [
            cosine,
            R::pick(passes, bent, zero),
            R::pick(passes, one, zero),
            R::pick(passes, boundary.partial_reflectance(cosine, bent), zero),
            R::pick(passes, refracted_x, zero),
            R::pick(passes, refracted_y, zero),
            R::pick(passes, refracted_z, zero),
            mirrored_x,
            mirrored_y,
            mirrored_z,
            half_cosine(normal, direction, [y, z, x]),
            half_cosine(normal, direction, [-x, -y, -z]),
            self.cone.at(u * 2.0 - 1.0),
            self.falloff.at(length(direction)),
            disc_x,
            disc_y,
            disc_z,
            panel_x,
            panel_y,
            panel_z,
        ]
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn formulas_of_lanes_have_the_bits_of_numbers(
        vectors in prop::array::uniform6(prop_oneof![3 => -1.0..1.0_f64, 1 => Just(0.0), 1 => Just(1.0)]),
        square in prop::array::uniform2(prop_oneof![4 => 0.0..1.0_f64, 1 => Just(0.5), 1 => Just(0.75)]),
        indices in prop::array::uniform2(prop_oneof![1.0..2.5_f64, Just(1.0), Just(1.5)]),
        inner in prop_oneof![Just(0.5), 0.5..1.0_f64],
    ) {
        let surface = ArrivingLight {
            boundary: Boundary { from: indices[0], into: indices[1] },
            cone: Cone { axis: DVec3::Z, inner, outer: 0.5 },
            falloff: PreparedFalloff { constant: indices[0], linear: square[0], quadratic: square[1] },
        };
        let [x, y, z, normal_x, normal_y, normal_z] = vectors;
        prop_assume!([x, y, z] != [0.0; 3] && [normal_x, normal_y, normal_z] != [0.0; 3]);
        compare(&surface, [x, y, z, normal_x, normal_y, normal_z, square[0], square[1]])?;
    }
}
