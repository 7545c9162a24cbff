//! The equations by which textbooks intersect a ray with a shape.
//!
//! They explain hits. Hits themselves come from the robust formulas of the shapes, which have no need of the equations' numbers.

use glam::DVec3;

use super::exact_rod::{ExactRod, SideEquation};
use super::intersection::ExactCrossing;
use super::slabs::ExactSlab;
use super::{AlignedBox, BoxImage, Plane, Rod, RodImage, Sphere, SphereImage};
use crate::trace::math::{Double, Exact, Exact3, ExactRoot};

/// The equation of the intersections of a ray's line with a shape, for the unit direction of the ray, so that every `t` is a distance.
///
/// The numbers are computed in exact arithmetic, or in twice the working precision where a square root occurs, and are then rounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Equation {
    /// A t^2 + B t + C = 0, of a sphere or, in the space in which it is a sphere, of an ellipsoid.
    Quadratic {
        /// dir', the direction in that space, not a unit vector; `None` for a sphere.
        direction: Option<DVec3>,
        /// P0 - Pc.
        from_center: DVec3,
        /// A = dir'.dir', and 1 for a sphere.
        a: f64,
        /// B = 2 dir.(P0 - Pc).
        b: f64,
        /// C = (P0 - Pc).(P0 - Pc) - r^2.
        c: f64,
        /// D = B^2 - 4 A C.
        discriminant: f64,
        /// Both roots, the lesser one first; `None` if D is negative.
        roots: Option<[f64; 2]>,
    },
    /// t = (Q0 - P0).N / dir.N, of a plane with the unit normal N.
    Linear {
        /// (Q0 - P0).N.
        numerator: f64,
        /// dir.N.
        denominator: f64,
        /// The root; `None` for a line that is parallel to the plane.
        root: Option<f64>,
    },
    /// The intersection of the intervals in which the line is between two opposite faces of a box.
    Slabs {
        /// The intervals, along the box's own axes.
        intervals: [Interval; 3],
        /// The intersection of the intervals; `None` if it is empty.
        roots: Option<[f64; 2]>,
    },
    /// The equation of a rod's side, A t^2 + B t + C = 0, and the intervals in which the line is within its ends. With the unit vector a
    /// along the axis: A = |dir x a|^2, B = 2 ((P0 - Pc) x a).(dir x a), C = |(P0 - Pc) x a|^2 - r^2.
    Rod {
        /// dir', the direction in the space before the map, not a unit vector; `None` for a rod without one.
        direction: Option<DVec3>,
        /// P0 - Pc, where Pc is the start of the axis.
        from_start: DVec3,
        /// The unit vector a.
        axis: DVec3,
        /// The coefficient A; 0 for a line along the axis.
        a: f64,
        /// The coefficient B.
        b: f64,
        /// The coefficient C.
        c: f64,
        /// D = B^2 - 4 A C.
        discriminant: f64,
        /// Within the side, endless at both ends.
        side: Interval,
        /// The ends.
        ends: RodEnds,
        /// The part of the line within the rod; `None` if it is empty.
        roots: Option<[f64; 2]>,
    },
}

/// The ends of a rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RodEnds {
    /// The two planes of a cylinder's ends: the part of the line between them.
    Flat(Interval),
    /// The spheres at the start and the stop of a capsule's axis: the parts of the line within them.
    Round([Interval; 2]),
}

/// The part of a line between two parallel planes, or within the side or the spheres of a rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Interval {
    /// From the entry to the exit.
    Between([f64; 2]),
    /// The whole line: it is parallel to the planes, or to the axis, and within or on them.
    All,
    /// No part of the line.
    Nothing,
}

impl Equation {
    /// Returns the roots in ascending order.
    #[must_use]
    pub fn roots(&self) -> Vec<f64> {
        match self {
            Self::Quadratic { roots, .. } | Self::Slabs { roots, .. } | Self::Rod { roots, .. } => {
                roots.iter().flatten().copied().collect()
            }
            Self::Linear { root, .. } => root.iter().copied().collect(),
        }
    }
}

/// The direction of a ray, with its length.
pub(crate) struct EquationLine {
    origin: DVec3,
    direction: Exact3,
    squared_length: Exact,
    length: Double,
}

impl EquationLine {
    pub(crate) fn new(origin: DVec3, direction: DVec3) -> Self {
        let direction = Exact3::from(direction);
        let squared_length = direction.dot(&direction);
        let length = squared_length.rounded().sqrt();
        Self { origin, direction, squared_length, length }
    }

    /// Returns the distance at which the ray parameter is `t`.
    fn distance(&self, t: Double) -> f64 {
        (t * self.length).rounded()
    }

    /// Returns the equation for a sphere, in a space whose vectors are multiplied by `factor`.
    fn quadratic(
        &self,
        (to_center, way): (&Exact3, &Exact3),
        radius: &Exact,
        factor: &Exact,
        is_ellipsoid: bool,
    ) -> Equation {
        let square = factor * factor;
        let (a, b) = (way.dot(way), to_center.dot(way));
        let c = &to_center.dot(to_center) - &(radius * radius);
        let discriminant = &(&b * &b) - &(&a * &c);
        let roots = super::sphere::roots(to_center, way, radius);
        let from_center =
            DVec3::from_array(std::array::from_fn(|axis| 0.0 - to_center.0[axis].over(factor).rounded()));
        let direction = || std::array::from_fn(|axis| (way.0[axis].over(factor) / self.length).rounded());
        Equation::Quadratic {
            direction: is_ellipsoid.then(|| DVec3::from_array(direction())),
            from_center,
            a: a.over(&(&square * &self.squared_length)).rounded(),
            b: 0.0 + (b.over(&square) * -2.0 / self.length).rounded(),
            c: c.over(&square).rounded(),
            discriminant: 4.0 * discriminant.over(&(&(&square * &square) * &self.squared_length)).rounded(),
            roots: roots.map(|roots| roots.map(|root| self.distance(root.t.rounded()))),
        }
    }

    fn distances(&self, crossing: ExactCrossing) -> [f64; 2] {
        crossing.map(|meeting| self.distance(meeting.t.rounded()))
    }

    fn interval(&self, slab: &ExactSlab) -> Interval {
        match slab.speed.sign() {
            sign if sign.is_ne() => Interval::Between(self.distances(slab.meetings(0))),
            _ if slab.low.sign().is_gt() || slab.high.sign().is_lt() => Interval::Nothing,
            _ => Interval::All,
        }
    }

    fn slabs(&self, slabs: &[ExactSlab; 3]) -> Equation {
        let crossing = super::slabs::cross_exactly(slabs);
        Equation::Slabs {
            intervals: slabs.each_ref().map(|slab| self.interval(slab)),
            roots: crossing.map(|crossing| self.distances(crossing)),
        }
    }

    /// Returns the equation for a rod, whose own vectors are multiplied by a factor. `planes` is the slab of a cylinder.
    fn rod(&self, rod: &ExactRod, planes: Option<ExactSlab>, is_image: bool) -> Equation {
        let SideEquation { a, b, c } = rod.side_equation();
        let (factor, squared_axis) = (&rod.factor, rod.squared_length());
        let square = &(factor * factor) * &squared_axis;
        let discriminant = &(&b * &b) - &(&a * &c);
        let side = match (a.sign().is_eq(), ExactRoot::of_quadratic(&a, &b, &c)) {
            (true, _) if c.sign().is_gt() => Interval::Nothing,
            (true, _) => Interval::All,
            (false, None) => Interval::Nothing,
            (false, Some(roots)) => Interval::Between(roots.map(|root| self.distance(root.rounded()))),
        };
        let ends = match &planes {
            Some(slab) => RodEnds::Flat(self.interval(slab)),
            None => RodEnds::Round(rod.balls().map(|crossing| match crossing {
                Some(crossing) => Interval::Between(self.distances(crossing)),
                None => Interval::Nothing,
            })),
        };
        let vector = |vector: &Exact3, by: &dyn Fn(&Exact) -> Double| {
            DVec3::from_array(vector.0.each_ref().map(|part| 0.0 + by(part).rounded()))
        };
        let length = squared_axis.rounded().sqrt();
        Equation::Rod {
            direction: is_image.then(|| vector(&rod.direction, &|part| part.over(factor) / self.length)),
            from_start: vector(&rod.origin, &|part| part.over(factor)),
            axis: vector(&rod.stop, &|part| part.rounded() / length),
            a: a.over(&(&square * &self.squared_length)).rounded(),
            b: 0.0 + (b.over(&square) * -2.0 / self.length).rounded(),
            c: c.over(&square).rounded(),
            discriminant: 4.0 * discriminant.over(&(&(&square * &square) * &self.squared_length)).rounded(),
            side,
            ends,
            roots: rod.cross(planes).map(|crossing| self.distances(crossing)),
        }
    }
}

impl Sphere {
    pub(crate) fn equation(&self, line: &EquationLine) -> Equation {
        let to_center = &Exact3::from(self.center) - &line.origin.into();
        line.quadratic((&to_center, &line.direction), &self.radius.into(), &1.0.into(), false)
    }
}

impl SphereImage {
    pub(crate) fn equation(&self, line: &EquationLine) -> Equation {
        let (to_center, way, determinant) = self.exactly_back(line.origin, &line.direction);
        let radius = &determinant * &self.radius().into();
        line.quadratic((&to_center, &way), &radius, &determinant, true)
    }
}

impl Plane {
    pub(crate) fn equation(&self, line: &EquationLine) -> Equation {
        let normal = Exact3::from(self.normal());
        let length = normal.dot(&normal).rounded().sqrt();
        let height = normal.dot(&(&Exact3::from(self.point()) - &line.origin.into()));
        let speed = normal.dot(&line.direction);
        let crossing = self.cross_exactly(line.origin, &line.direction);
        Equation::Linear {
            numerator: (height.rounded() / length).rounded(),
            denominator: (speed.rounded() / (length * line.length)).rounded(),
            root: crossing.map(|[meeting, _]| line.distance(meeting.t.rounded())),
        }
    }
}

impl AlignedBox {
    pub(crate) fn equation(&self, line: &EquationLine) -> Equation {
        line.slabs(&self.exact_slabs(line.origin, &line.direction))
    }
}

impl BoxImage {
    pub(crate) fn equation(&self, line: &EquationLine) -> Equation {
        line.slabs(&self.exact_slabs(line.origin, &line.direction))
    }
}

impl Rod {
    pub(crate) fn equation(&self, line: &EquationLine) -> Equation {
        let rod = self.exact(line.origin, line.direction.clone());
        line.rod(&rod, self.exact_slab(line.origin, &line.direction), false)
    }
}

impl RodImage {
    pub(crate) fn equation(&self, line: &EquationLine) -> Equation {
        let rod = self.exact(line.origin, &line.direction);
        line.rod(&rod, self.exact_slab(line.origin, &line.direction), true)
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DQuat};

    use super::*;

    fn line(origin: [f64; 3], direction: [f64; 3]) -> EquationLine {
        EquationLine::new(origin.into(), direction.into())
    }

    #[test]
    fn sphere_of_the_worked_example() {
        let sphere = Sphere { center: DVec3::new(3.0, 3.0, 1.0), radius: 2.0 };
        let equation = sphere.equation(&line([0.0, -2.0, 0.0], [1.0, 2.0, 1.0]));
        let Equation::Quadratic { direction, from_center, a, b, c, discriminant, roots } = equation else {
            panic!()
        };
        assert_eq!(direction, None);
        let root_of_6 = 6.0_f64.sqrt();
        assert_eq!((from_center, a, c), (DVec3::new(-3.0, -5.0, -1.0), 1.0, 31.0));
        // D = 784/6 - 124 = 20/3.
        assert!((b + 28.0 / root_of_6).abs() < 2e-15 && (discriminant - 20.0 / 3.0).abs() < 1e-15);
        let expected = [-1.0, 1.0].map(|sign| (28.0 / root_of_6 + sign * (20.0_f64 / 3.0).sqrt()) / 2.0);
        for (root, expected) in roots.unwrap().into_iter().zip(expected) {
            assert!((root - expected).abs() < 2e-15, "{root} {expected}");
        }
        assert!(sphere.equation(&line([0.0, 9.0, 0.0], [1.0, 0.0, 0.0])).roots().is_empty());
    }

    #[test]
    fn ellipsoids_and_spheres_have_equal_roots_where_they_are_equal() {
        let (center, radius) = (DVec3::new(1.0, 2.0, 3.0), 1.5);
        let map = DAffine3::from_scale_rotation_translation(DVec3::splat(3.0), DQuat::IDENTITY, center);
        let (sphere, image) = (Sphere { center, radius }, SphereImage::new(map, radius / 3.0));
        let line = line([0.1, 0.2, 0.3], [0.9, 2.1, 2.2]);
        let Equation::Quadratic { roots, discriminant, .. } = sphere.equation(&line) else { panic!() };
        let found = image.equation(&line);
        let Equation::Quadratic {
            direction: Some(direction),
            from_center,
            roots: own,
            a,
            b,
            discriminant: own_discriminant,
            ..
        } = found
        else {
            panic!()
        };
        // The numbers are those of one space, although the direction is not a unit vector there.
        assert!(
            (a - direction.dot(direction)).abs() < 1e-16
                && (b - 2.0 * direction.dot(from_center)).abs() < 1e-15
        );
        assert_eq!(own, roots);
        // All lengths are a third.
        assert!((a - 1.0 / 9.0).abs() < 1e-16 && (own_discriminant * 81.0 - discriminant).abs() < 1e-13);
    }

    #[test]
    fn planes_divide_height_by_speed() {
        let plane = Plane::new(DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.0, 5.0, 0.0)).unwrap();
        assert_eq!(
            plane.equation(&line([0.0, 3.0, 0.0], [3.0, -4.0, 0.0])),
            Equation::Linear { numerator: -2.0, denominator: -0.8, root: Some(2.5) }
        );
        let parallel = plane.equation(&line([0.0, 3.0, 0.0], [1.0, 0.0, 0.0]));
        assert_eq!(parallel, Equation::Linear { numerator: -2.0, denominator: 0.0, root: None });
    }

    #[test]
    fn rods_intersect_their_sides_with_their_ends() {
        let (from, to) = (DVec3::ZERO, DVec3::new(0.0, 2.0, 0.0));
        let through = line([-3.0, 1.0, 0.0], [4.0, 3.0, 0.0]);
        let cylinder = Rod::cylinder(from, to, 1.0).unwrap().equation(&through);
        let Equation::Rod { direction, from_start, axis, a, b, c, discriminant, side, ends, roots } =
            cylinder
        else {
            panic!("{cylinder:?}")
        };
        assert_eq!((direction, from_start, axis), (None, DVec3::new(-3.0, 1.0, 0.0), DVec3::Y));
        assert!((a - 0.64).abs() < 1e-16 && (b + 4.8).abs() < 1e-15 && c == 8.0, "{a} {b} {c}");
        assert!((discriminant - 2.56).abs() < 1e-15);
        assert_eq!((side, roots), (Interval::Between([2.5, 5.0]), None));
        assert_eq!(ends, RodEnds::Flat(Interval::Between([-5.0 / 3.0, 5.0 / 3.0])));
        let along = Rod::capsule(from, to, 1.0).unwrap().equation(&line([0.6, 9.0, 0.0], [0.0, -5.0, 0.0]));
        let Equation::Rod { a, side, ends, roots, .. } = along else { panic!("{along:?}") };
        let ball = |least: f64, most: f64| Interval::Between([least, most]);
        assert_eq!((a, side, roots), (0.0, Interval::All, Some([6.2, 9.8])));
        assert_eq!(ends, RodEnds::Round([ball(8.2, 9.8), ball(6.2, 7.8)]));
        // The image under a mirroring map has the same roots.
        let map = DAffine3::from_scale(DVec3::new(-1.0, 0.5, 1.0));
        let image = RodImage::cylinder(map, DVec3::new(0.0, 4.0, 0.0), 1.0).unwrap();
        let across = line([-3.0, 1.0, 0.0], [4.0, 1.0, 0.0]);
        let whole = Rod::cylinder(from, to, 1.0).unwrap().equation(&across);
        assert_eq!(image.equation(&across).roots(), whole.roots());
    }

    #[test]
    fn boxes_intersect_three_intervals() {
        let shape = AlignedBox { min: DVec3::NEG_ONE, max: DVec3::ONE };
        let found = shape.equation(&line([-2.0, 2.0, 1.0], [4.0, -3.0, 0.0]));
        let Equation::Slabs { intervals: [x, y, z], roots } = found else { panic!("{found:?}") };
        assert_eq!((x, z), (Interval::Between([1.25, 3.75]), Interval::All));
        assert_eq!(y, Interval::Between([5.0 / 3.0, 5.0]));
        assert_eq!(roots, Some([5.0 / 3.0, 3.75]));
        let outside = shape.equation(&line([-2.0, 2.0, 1.5], [4.0, -3.0, 0.0]));
        let Equation::Slabs { intervals: [.., z], roots } = outside else { panic!("{outside:?}") };
        assert_eq!((z, roots), (Interval::Nothing, None));
        // The image of the box under the identity has the same numbers.
        let image = BoxImage::new(DAffine3::IDENTITY, DVec3::ONE).unwrap();
        assert_eq!(image.equation(&line([-2.0, 2.0, 1.0], [4.0, -3.0, 0.0])), found);
    }
}
