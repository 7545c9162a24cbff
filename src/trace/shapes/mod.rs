//! The shapes and the questions that are asked of them.
//!
//! Every shape answers the same, for a ray `origin + t direction`:
//!
//! - `intersect`: the smallest `t >= 0` on the surface, with a bound of its error, unless `f64` leaves open whether there is
//!   one. Shapes are closed sets: touching counts. Spheres and boxes are shells that are seen from inside too.
//! - `exit`: where a ray comes out that starts on the surface and goes into the shape.
//! - `cross_exactly`: where its line enters and where it leaves the shape, without any rounding: for what `f64` leaves open, and for
//!   comparisons too close to call.
//! - `exit_exactly`: what `exit` asks, likewise.
//! - `refine`: from a `t` that is nearly right, one that is right to the last bit of an `f64`, with the point and the outward
//!   unit normal there.
//! - `solve`: the same from a `t` that is so rough that one Newton step would not do.
//! - `surface_point`: the same at a `t` and on a face that are right already, from `cross_exactly` or from `exit_exactly`.
//! - `facet`: the plane of the face that is met at a `t`, if the surface is flat there and it is certain which face that is.
//! - `contains`: is a point inside, as solids go? Behind, of a plane.
//! - `bounds`: a box around it, for shapes that have one.

mod aligned_box;
mod bounds;
mod box_image;
mod intersection;
mod plane;
mod sphere;
mod sphere_image;

pub use aligned_box::AlignedBox;
pub(crate) use aligned_box::SLOWEST;
pub use bounds::Bounds;
pub use box_image::BoxImage;
pub(crate) use intersection::{ExactHit, Face, Side, Verdict};
pub use intersection::{Intersection, RefinedHit};
pub use plane::Plane;
pub(crate) use plane::{only_root, stepped_to_plane};
pub use sphere::Sphere;
pub(crate) use sphere::{RefinedStep, U, far_root, first_root, newton_step, sphere_step, stepped, unit};
pub use sphere_image::SphereImage;
pub(crate) use sphere_image::inverse;
