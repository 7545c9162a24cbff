//! Boxes along the world's axes.

use glam::DVec3;

use crate::trace::Bounds;

/// An axis-aligned box in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignedBox {
    /// Smallest coordinates.
    pub min: DVec3,
    /// Largest coordinates, greater than `min` in each.
    pub max: DVec3,
}

/// The `t` at which a ray enters and leaves a box, and through which axis' face it enters.
#[derive(Clone, Copy)]
struct Crossing {
    entry: f64,
    exit: f64,
    entry_axis: usize,
}

impl AlignedBox {
    /// The smallest `t >= 0` on the box.
    #[must_use]
    #[inline]
    pub fn first_hit(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let Crossing { entry, exit, .. } = self.crossing(origin, direction);
        if entry > exit || exit < 0.0 {
            return None;
        }
        // Adding zero makes a negative zero positive.
        Some(if entry >= 0.0 { entry } else { exit } + 0.0)
    }

    /// Intersects the three slabs (Kay and Kajiya, "Ray Tracing Complex Scenes", 1986), closed ones: a ray in a face
    /// touches it. A direction component of zero is an interval test.
    #[inline]
    fn crossing(&self, origin: DVec3, direction: DVec3) -> Crossing {
        let mut crossing = Crossing { entry: f64::NEG_INFINITY, exit: f64::INFINITY, entry_axis: 0 };
        for axis in 0..3 {
            let (o, d) = (origin[axis], direction[axis]);
            if d == 0.0 {
                if o < self.min[axis] || o > self.max[axis] {
                    crossing.entry = f64::INFINITY;
                }
                continue;
            }
            let (at_min, at_max) = ((self.min[axis] - o) / d, (self.max[axis] - o) / d);
            let (near, far) = if d > 0.0 { (at_min, at_max) } else { (at_max, at_min) };
            if near > crossing.entry {
                (crossing.entry, crossing.entry_axis) = (near, axis);
            }
            if far < crossing.exit {
                crossing.exit = far;
            }
        }
        crossing
    }

    /// Where a ray that starts on the box and goes inwards comes out: only faces ahead count. From an edge it may come out
    /// at once, by the other face.
    #[must_use]
    pub fn far_hit(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let (exit, _) = self.exit(origin, direction);
        exit.is_finite().then_some(exit.max(0.0))
    }

    /// The nearest face ahead, and its axis.
    fn exit(&self, origin: DVec3, direction: DVec3) -> (f64, usize) {
        let mut nearest = (f64::INFINITY, 0);
        for axis in 0..3 {
            let d = direction[axis];
            if d != 0.0 {
                let face = if d > 0.0 { self.max[axis] } else { self.min[axis] };
                let t = (face - origin[axis]) / d;
                if t < nearest.0 {
                    nearest = (t, axis);
                }
            }
        }
        nearest
    }

    /// The point at `t`, with the coordinate of the face it is on, and that face's outward normal. `far` says that `t` is
    /// from [`AlignedBox::far_hit`].
    #[must_use]
    pub fn surface_at(&self, origin: DVec3, direction: DVec3, t: f64, far: bool) -> (DVec3, DVec3) {
        let crossing = self.crossing(origin, direction);
        let enters = !far && crossing.entry == t;
        let axis = if enters { crossing.entry_axis } else { self.exit(origin, direction).1 };
        // Going up one enters by the lower face and leaves by the upper.
        let upper = (direction[axis] > 0.0) != enters;
        let mut point = (origin + direction * t).clamp(self.min, self.max);
        point[axis] = if upper { self.max[axis] } else { self.min[axis] };
        let mut normal = DVec3::ZERO;
        normal[axis] = if upper { 1.0 } else { -1.0 };
        (point, normal)
    }

    /// A box around it.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        Bounds { min: self.min, max: self.max }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: AlignedBox = AlignedBox { min: DVec3::NEG_ONE, max: DVec3::ONE };

    #[test]
    fn from_outside_inside_and_behind() {
        assert_eq!(UNIT.first_hit(DVec3::new(0.0, 0.0, -3.0), DVec3::Z), Some(2.0));
        assert_eq!(UNIT.first_hit(DVec3::ZERO, DVec3::new(1.0, 0.5, 0.0)), Some(1.0));
        assert_eq!(UNIT.first_hit(DVec3::new(0.0, 0.0, 3.0), DVec3::Z), None);
        assert_eq!(UNIT.first_hit(DVec3::new(1.5, 0.0, -3.0), DVec3::Z), None);
    }

    #[test]
    fn faces_edges_and_corners_are_part_of_it() {
        assert_eq!(UNIT.first_hit(DVec3::new(1.0, 0.0, -3.0), DVec3::Z), Some(2.0), "along a face");
        assert_eq!(UNIT.first_hit(DVec3::new(1.0, -1.0, -3.0), DVec3::Z), Some(2.0), "along an edge");
        assert_eq!(UNIT.first_hit(DVec3::new(3.0, 1.0, 1.0), DVec3::NEG_X), Some(2.0), "along another");
        assert_eq!(
            UNIT.first_hit(DVec3::new(2.0, 0.0, 1.0), DVec3::new(-1.0, 1.0, 0.0)),
            Some(1.0),
            "a corner"
        );
        assert_eq!(UNIT.first_hit(DVec3::new(1.0, 0.0, 0.0), DVec3::X), Some(0.0), "the origin on it");
        assert_eq!(
            UNIT.first_hit(DVec3::new(0.0, 0.0, -3.0), DVec3::new(-0.0, -0.0, 1.0)),
            Some(2.0),
            "signed zeros"
        );
    }

    #[test]
    fn hits_are_put_onto_their_face() {
        let (origin, direction) = (DVec3::new(0.3, 0.1, -3.7), DVec3::new(0.05, 0.13, 1.0));
        let t = UNIT.first_hit(origin, direction).unwrap();
        let (point, normal) = UNIT.surface_at(origin, direction, t, false);
        assert_eq!((point.z, normal), (-1.0, DVec3::NEG_Z));
        let t = UNIT.first_hit(DVec3::ZERO, DVec3::new(0.2, -1.0, 0.0)).unwrap();
        let (point, normal) = UNIT.surface_at(DVec3::ZERO, DVec3::new(0.2, -1.0, 0.0), t, false);
        assert_eq!(
            (point, normal),
            (DVec3::new(0.2, -1.0, 0.0), DVec3::NEG_Y),
            "outward also when seen from inside"
        );
    }

    #[test]
    fn a_ray_into_the_box_comes_out_once() {
        assert_eq!(UNIT.far_hit(DVec3::new(0.0, 0.0, -1.0), DVec3::Z), Some(2.0));
        // From an edge it comes out at once, by the other face.
        let (origin, direction) = (DVec3::new(0.0, 1.0, -1.0), DVec3::new(0.0, 1.0, 1.0));
        assert_eq!(UNIT.far_hit(origin, direction), Some(0.0));
        assert_eq!(UNIT.surface_at(origin, direction, 0.0, true), (origin, DVec3::Y));
    }
}
