//! The shapes and the questions that are asked of them.
//!
//! Every shape answers the same, for a ray `origin + t direction`:
//!
//! - `first_hit`: the smallest `t >= 0` on the surface, with a bound of its error, unless `f64` leaves open whether there is
//!   one. Shapes are closed sets: touching counts. Spheres and boxes are shells that are seen from inside too.
//! - `far_hit`: the ray starts on the surface and goes into the shape; where does it come out?
//! - `crossing`: where its line enters and where it leaves the shape, without any rounding: for what `f64` leaves open, and for
//!   comparisons too close to call.
//! - `exit`: what `far_hit` asks, likewise.
//! - `refined`: from a `t` that is nearly right, one that is right to the last bit of an `f64`, with the point and the outward
//!   unit normal there.
//! - `solved`: the same from a `t` that is so rough that one Newton step would not do.
//! - `surface_on`: the same at a `t` and on a face that are right already, from `crossing` or from `exit`.
//! - `facet`: in which plane is the face that is met at a `t`, if the surface is flat there and it is certain which face that is?
//! - `contains`: is a point inside, as solids go? Behind, of a plane.
//! - `bounds`: a box around it, for shapes that have one.

mod affine;
mod aligned_box;
mod box_image;
mod plane;
mod sphere;

use glam::DVec3;

use super::Root;
use super::algebraic::ExactRoot;

pub use affine::SphereImage;
pub(in crate::trace) use affine::inverse;
pub use aligned_box::AlignedBox;
pub use box_image::BoxImage;
pub use plane::Plane;
pub use sphere::Sphere;

/// What `f64` can say about where a ray meets a shape.
#[derive(Clone, Copy, Debug)]
pub enum Verdict {
    /// It does.
    Hit(Root),
    /// It does not.
    Miss,
    /// Too close to call.
    Open,
}

/// Where a line enters and where it leaves a convex shape.
pub(super) type Crossing = [Meeting; 2];

/// Where a line meets a surface, without any rounding.
#[derive(Clone, Debug)]
pub(super) struct Meeting {
    pub(super) t: ExactRoot,
    pub(super) face: Face,
    pub(super) side: Side,
}

/// The plane of a face: row.p = offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Facet {
    row: DVec3,
    offset: f64,
}

/// From which side a surface is met.
#[derive(Clone, Copy, Debug)]
pub(super) enum Side {
    /// The line enters the shape.
    Entry,
    /// It leaves the shape.
    Exit,
    /// A plane has no inside.
    Either,
}

/// One of a box's six faces. Other shapes have but one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Face {
    axis: usize,
    upper: bool,
}

impl Meeting {
    /// Of a shape with one face.
    fn new(t: ExactRoot, side: Side) -> Self {
        Self { t, face: Face::default(), side }
    }

    /// The same, or at once, where rounding has put the ray's origin beyond it.
    fn ahead(self) -> Self {
        if self.t.sign().is_lt() { Self { t: ExactRoot::ZERO, ..self } } else { self }
    }
}

#[cfg(test)]
impl Verdict {
    /// The `t` for a direction as it was before it became a [`Ray`](super::Ray)'s, if there is one; `exact` has the last word where
    /// the verdict is open.
    fn decided(self, direction: glam::DVec3, exact: impl FnOnce() -> Option<Crossing>) -> Option<f64> {
        match self {
            Self::Hit(root) => {
                let ray = super::Ray::new(glam::DVec3::ZERO, direction)?;
                Some(root.t() * ray.direction().abs().max_element() / direction.abs().max_element())
            }
            Self::Miss => None,
            Self::Open => {
                let first = exact()?.into_iter().find(|meeting| meeting.t.sign().is_ge())?;
                Some(first.t.rounded().rounded())
            }
        }
    }
}
