//! Shapes and their ray queries.
//!
//! Every shape supports these queries, for a ray `origin + t direction`:
//!
//! - `intersect`: the smallest `t >= 0` on the surface with its error bound, a miss, or ambiguous if `f64` cannot decide. Shapes are closed
//!   sets: touching counts as a hit. Spheres, boxes and rods are shells, which are also hit from inside.
//! - `exit`: the exit of a ray that starts on the surface and enters the shape.
//! - `cross_exactly`: the entry and the exit of the ray's line, without rounding. It resolves ambiguous intersections and comparisons that
//!   are too close.
//! - `exit_exactly`: the result of `exit`, without rounding.
//! - `refine`: a `t` accurate to the last bit of an `f64`, computed from an approximate `t`, with the point and the outward unit normal.
//! - `solve`: the same, from a `t` too rough for a single Newton step.
//! - `surface_point`: the same, at an accurate `t` and face from `cross_exactly` or `exit_exactly`.
//! - `facet`: the plane of the face that is hit at a `t`, if the surface is flat there and the face is certain.
//! - `contains`: whether a point is strictly inside the solid; for a plane, strictly behind it.
//! - `bounds`: the bounding box, for shapes that have one.
//! - `equation`: the numbers of the textbook's equation, for explanations.

mod affine_map;
mod aligned_box;
mod bounds;
mod box_image;
mod end_planes;
mod equation;
mod exact_rod;
mod intersection;
mod plane;
mod rod;
mod rod_core;
mod rod_image;
mod slabs;
mod sphere;
mod sphere_image;
#[cfg(test)]
mod tests;

pub(crate) use affine_map::inverse;
pub use aligned_box::AlignedBox;
pub(crate) use aligned_box::refine_box;
pub use bounds::Bounds;
pub(crate) use bounds::CompactBounds;
pub use box_image::BoxImage;
pub(crate) use equation::EquationLine;
pub use equation::{Equation, Interval, RodEnds};
pub(crate) use intersection::{ExactHit, Face, Intersections, Refined, Side};
pub(crate) use intersection::{Intersection, RefinedHit};
pub use plane::Plane;
pub(crate) use plane::refine_plane;
pub use rod::Rod;
pub use rod_image::RodImage;
pub(crate) use slabs::SLOWEST;
pub use sphere::Sphere;
pub(crate) use sphere::refine_sphere;
pub use sphere_image::SphereImage;
