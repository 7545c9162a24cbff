//! The shapes and the questions that are asked of them.
//!
//! Every shape answers the same, for a ray `origin + t direction`:
//!
//! - `first_hit`: the smallest `t >= 0` on the surface, with a bound of its error, unless `f64` leaves open whether there is
//!   one. Shapes are closed sets: touching counts. Spheres and boxes are shells that are seen from inside too.
//! - `exact_hit`: the same with a hundred bits, for what `first_hit` leaves open and for comparisons too close to call; box
//!   edges exactly.
//! - `refined`: from a `t` that is nearly right, one that is right to the last bit of an `f64`, with the point and the outward
//!   unit normal there.
//! - `far_hit`: the ray starts on the surface and goes into the shape; where does it come out?
//! - `exact_far_hit`: the same with a hundred bits, for comparisons too close to call.
//! - `solved`: the same from a `t` that is so rough that one Newton step would not do.
//! - `surface_at`: the same at a `t` that is right already, from `exact_hit` or, as `far` says, from `far_hit`.
//! - `contains`: is a point inside, as solids go? Behind, of a plane.
//! - `bounds`: a box around it, for shapes that have one.

mod affine;
mod aligned_box;
mod plane;
mod sphere;

use super::Root;

pub(in crate::trace) use affine::inverse;
pub use affine::{BoxImage, SphereImage};
pub use aligned_box::AlignedBox;
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

#[cfg(test)]
impl Verdict {
    /// The `t` for a direction as it was before it became a [`Ray`](super::Ray)'s, if there is one; `exact` has the last word where
    /// the verdict is open.
    fn decided(
        self,
        direction: glam::DVec3,
        exact: impl FnOnce() -> Option<super::exact::Double>,
    ) -> Option<f64> {
        match self {
            Self::Hit(root) => {
                let ray = super::Ray::new(glam::DVec3::ZERO, direction)?;
                Some(root.t() * ray.direction().abs().max_element() / direction.abs().max_element())
            }
            Self::Miss => None,
            Self::Open => exact().map(super::exact::Double::rounded),
        }
    }
}
