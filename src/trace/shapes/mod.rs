//! The shapes and the questions that are asked of them.
//!
//! Every shape answers the same, for a ray `origin + t direction`:
//!
//! - `first_hit`: the smallest `t >= 0` on the surface, with a bound of its error; the verdict is right. Shapes are closed
//!   sets: touching counts. Spheres and boxes are shells that are seen from inside too.
//! - `exact_hit`: the same with a hundred bits, for what `first_hit` leaves open and for comparisons too close to call.
//! - `polished`: a `t` that is right to the last bit of an `f64`, from one that is nearly right.
//! - `far_hit`: the ray starts on the surface and goes into the shape; where does it come out?
//! - `surface_at`: the point at a `t` that `first_hit` or, as `far` says, `far_hit` gave, and the outward unit normal there.
//! - `bounds`: a box around it, for shapes that have one.

mod affine;
mod aligned_box;
mod plane;
mod sphere;

pub use affine::{BoxImage, SphereImage};
pub use aligned_box::AlignedBox;
pub use plane::Plane;
pub use sphere::Sphere;
