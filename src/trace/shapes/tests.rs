//! Compares the bits of the shapes' formulas over numbers with those over lanes, at every SIMD level.

use glam::{DAffine3, DMat3, DVec3};
use proptest::prelude::*;

use super::*;
use crate::trace::math::Real;
use crate::trace::math::same_bits::{Formulas, compare};
use crate::trace::rays::Rays;

/// The generic formulas of a shape.
trait ShapeFormulas {
    fn intersections<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>>;
    fn exits<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>>;
    fn refined<R: Real>(&self, rays: &Rays<R>, t: R) -> Refined<R>;

    /// Returns the numbers of an intersection, an exit and a refined hit.
    #[inline(always)]
    fn found<R: Real>(&self, rays: &Rays<R>, t: R) -> [R; 17] {
        let (zero, one) = (t.of(0.0), t.of(1.0));
        let mut found = [zero; 17];
        for (index, intersections) in [self.intersections(rays), self.exits(rays)].into_iter().enumerate() {
            if let Some(Intersections { root, hit, undecided }) = intersections {
                found[4 * index] = R::pick(hit, root.t(), zero);
                found[4 * index + 1] = R::pick(hit, root.error(), zero);
                found[4 * index + 2] = R::pick(hit, one, zero);
                found[4 * index + 3] = R::pick(undecided, one, zero);
            }
        }
        let Refined { t, point, normal, found: refined } = self.refined(rays, t);
        let numbers = [t.high, t.low, point[0], point[1], point[2], normal[0], normal[1], normal[2], one];
        for (index, number) in numbers.into_iter().enumerate() {
            found[8 + index] = R::pick(refined, number, zero);
        }
        found
    }
}

impl ShapeFormulas for Sphere {
    #[inline(always)]
    fn intersections<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>> {
        let [x, y, z] = rays.direction;
        self.intersections(rays, x.of(1.0) / (x * x + y * y + z * z))
    }

    #[inline(always)]
    fn exits<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>> {
        Some(self.exits(rays))
    }

    #[inline(always)]
    fn refined<R: Real>(&self, rays: &Rays<R>, t: R) -> Refined<R> {
        let [x, y, z] = self.center.to_array();
        refine_sphere([t.of(x), t.of(y), t.of(z)], t.of(self.radius), rays, t)
    }
}

impl ShapeFormulas for Plane {
    #[inline(always)]
    fn intersections<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>> {
        Some(self.intersections(rays))
    }

    #[inline(always)]
    fn exits<R: Real>(&self, _rays: &Rays<R>) -> Option<Intersections<R>> {
        None
    }

    #[inline(always)]
    fn refined<R: Real>(&self, rays: &Rays<R>, t: R) -> Refined<R> {
        let [point, normal, unit] = [self.point(), self.normal(), self.unit_normal()]
            .map(|vector| vector.to_array().map(|number| t.of(number)));
        refine_plane(point, normal, unit, rays, t)
    }
}

impl ShapeFormulas for AlignedBox {
    #[inline(always)]
    fn intersections<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>> {
        let [x, y, z] = rays.direction;
        let one = x.of(1.0);
        Some(self.intersections(rays.origin, [one / x, one / y, one / z]))
    }

    #[inline(always)]
    fn exits<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>> {
        Some(self.exits(rays))
    }

    #[inline(always)]
    fn refined<R: Real>(&self, rays: &Rays<R>, t: R) -> Refined<R> {
        let [min, max] = [self.min, self.max].map(|corner| corner.to_array().map(|number| t.of(number)));
        refine_box(min, max, rays, t)
    }
}

impl ShapeFormulas for SphereImage {
    #[inline(always)]
    fn intersections<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>> {
        self.intersections(rays)
    }

    #[inline(always)]
    fn exits<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>> {
        Some(self.exits(rays))
    }

    #[inline(always)]
    fn refined<R: Real>(&self, rays: &Rays<R>, t: R) -> Refined<R> {
        self.refined(rays, t)
    }
}

impl ShapeFormulas for BoxImage {
    #[inline(always)]
    fn intersections<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>> {
        Some(self.intersections(rays))
    }

    #[inline(always)]
    fn exits<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>> {
        Some(self.exits(rays))
    }

    #[inline(always)]
    fn refined<R: Real>(&self, rays: &Rays<R>, t: R) -> Refined<R> {
        let [x, y, z] = rays.direction;
        let inside = (x + y).greater(z);
        self.refined(rays, t, inside)
    }
}

impl ShapeFormulas for Rod {
    #[inline(always)]
    fn intersections<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>> {
        self.intersections(rays)
    }

    #[inline(always)]
    fn exits<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>> {
        Some(self.exits(rays))
    }

    #[inline(always)]
    fn refined<R: Real>(&self, rays: &Rays<R>, t: R) -> Refined<R> {
        let [x, y, z] = rays.direction;
        let inside = (x + y).greater(z);
        self.refined(rays, t, inside)
    }
}

impl ShapeFormulas for RodImage {
    #[inline(always)]
    fn intersections<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>> {
        self.intersections(rays)
    }

    #[inline(always)]
    fn exits<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>> {
        Some(self.exits(rays))
    }

    #[inline(always)]
    fn refined<R: Real>(&self, rays: &Rays<R>, t: R) -> Refined<R> {
        let [x, y, z] = rays.direction;
        let inside = (x + y).greater(z);
        self.refined(rays, t, inside)
    }
}

/// The numbers of a shape for a ray, given by origin and direction, and a `t`.
struct Queries<S>(S);

impl<S: ShapeFormulas> Formulas<7, 17> for Queries<S> {
    #[inline(always)]
    fn evaluate<R: Real>(&self, [x, y, z, along_x, along_y, along_z, t]: [R; 7]) -> [R; 17] {
        self.0.found(&Rays { origin: [x, y, z], direction: [along_x, along_y, along_z] }, t)
    }
}

/// Coordinates that often coincide, so that rays run along faces and through edges and start on surfaces.
fn coordinate() -> impl Strategy<Value = f64> {
    let nudge = prop_oneof![Just(0.0), -1e-15..1e-15, -1e-9..1e-9, -1e-4..1e-4];
    prop_oneof![
        3 => (-4..=4).prop_map(f64::from),
        2 => -4.0..4.0,
        1 => (-4..=4, nudge).prop_map(|(whole, off)| f64::from(whole) + off),
    ]
}

fn vector() -> impl Strategy<Value = DVec3> {
    (coordinate(), coordinate(), coordinate()).prop_map(DVec3::from)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn formulas_of_lanes_have_the_bits_of_numbers(
        place in vector(), size in prop_oneof![Just(1.0), Just(2.0), 0.1..3.0], angle in prop_oneof![Just(0.0), 0.0..3.0],
        origin in vector(), direction in vector().prop_filter("no direction", |direction| *direction != DVec3::ZERO),
        t in prop_oneof![coordinate(), Just(1.0)], aimed in any::<bool>(),
    ) {
        let direction = if aimed && place != origin { place + DVec3::new(0.0, size, 0.0) - origin } else { direction };
        prop_assume!(direction != DVec3::ZERO);
        let map = DAffine3 {
            matrix3: DMat3::from_rotation_y(angle) * DMat3::from_diagonal(DVec3::new(1.0, size, 1.0)),
            translation: place,
        };
        let ([x, y, z], [along_x, along_y, along_z]) = (origin.to_array(), direction.to_array());
        let numbers = [x, y, z, along_x, along_y, along_z, t];
        compare(&Queries(Sphere { center: place, radius: size }), numbers)?;
        compare(&Queries(SphereImage::new(map, 1.0)), numbers)?;
        if let Some(image) = BoxImage::new(map, DVec3::ONE) {
            compare(&Queries(image), numbers)?;
        }
        if let Some(plane) = Plane::new(place, DVec3::new(angle, size, 1.0)) {
            compare(&Queries(plane), numbers)?;
        }
        let stop = place + DVec3::new(0.0, size, angle);
        for rod in [Rod::cylinder(place, stop, 1.0), Rod::capsule(place, stop, 1.0)].into_iter().flatten() {
            compare(&Queries(rod), numbers)?;
        }
        for image in [RodImage::cylinder(map, stop, 1.0), RodImage::capsule(map, stop, 1.0)].into_iter().flatten() {
            compare(&Queries(image), numbers)?;
        }
        if direction.abs().min_element() > SLOWEST {
            compare(&Queries(AlignedBox { min: place, max: place + size }), numbers)?;
        }
    }
}
