//! Outlines of a scene's shapes.

use glam::{DMat3, DVec3};

use crate::components::{Order, Shape, WorldTransform};
use crate::engine::Engine;

/// Maximum number of shapes drawn.
const MOST: usize = 400;

/// The outline of a shape in world space.
pub enum OutlinedShape {
    /// The image of the unit ball under a linear map, around a centre.
    Ball { center: DVec3, image: DMat3 },
    /// Eight corners. Two corners share an edge if their indices differ in one bit.
    Box([DVec3; 8]),
    /// A rod: circles around the ends of its axis, each with the two half-diameters of its ring, and the radius of a capsule's ends.
    Rod { ends: [DVec3; 2], halves: [DVec3; 2], ball: Option<DMat3> },
    /// A plane through a point, with a unit normal.
    Plane { point: DVec3, normal: DVec3 },
}

/// Returns the outlines of the first shapes in document order.
pub fn outlined_shapes(engine: &Engine) -> Vec<OutlinedShape> {
    let mut query = engine.world().query::<(&Order, &Shape, &WorldTransform)>();
    let mut found: Vec<_> = query.iter().collect();
    found.sort_by_key(|(order, ..)| **order);
    found
        .into_iter()
        .take(MOST)
        .filter_map(|(_, shape, transform)| OutlinedShape::of(*shape, transform))
        .collect()
}

impl OutlinedShape {
    /// Returns the outline of a shape; `None` if it has no size or no finite place.
    pub fn of(shape: Shape, transform: &WorldTransform) -> Option<Self> {
        let affine = transform.affine;
        let center = affine.translation;
        let outline = match shape {
            Shape::Sphere { radius } => Self::Ball { center, image: affine.matrix3 * radius },
            Shape::Box { size } => Self::Box(std::array::from_fn(|index| {
                let side = |bit: usize| if index >> bit & 1 == 0 { -0.5 } else { 0.5 };
                affine.transform_point3(size * DVec3::new(side(0), side(1), side(2)))
            })),
            Shape::Cylinder { radius, from, to } | Shape::Capsule { radius, from, to } => {
                let (one, other) = (to - from).try_normalize()?.any_orthonormal_pair();
                Self::Rod {
                    ends: [from, to].map(|end| affine.transform_point3(end)),
                    halves: [one, other].map(|half| affine.transform_vector3(half * radius)),
                    ball: matches!(shape, Shape::Capsule { .. }).then(|| affine.matrix3 * radius),
                }
            }
            Shape::Plane { normal } => {
                let normal = affine.matrix3.inverse().transpose() * normal;
                Self::Plane { point: center, normal: normal.try_normalize()? }
            }
        };
        affine.is_finite().then_some(outline)
    }

    /// Returns the centre and the radius of the outline, or `None` for planes, which are unbounded.
    pub fn extent(&self) -> Option<(DVec3, f64)> {
        match self {
            Self::Ball { center, image } => Some((
                *center,
                [image.x_axis, image.y_axis, image.z_axis].map(DVec3::length).into_iter().fold(0.0, f64::max),
            )),
            Self::Box(corners) => {
                let middle = 0.5 * (corners[0] + corners[7]);
                Some((middle, corners.iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max)))
            }
            Self::Rod { ends: [from, to], halves, ball } => {
                let round = ball.map_or([DVec3::ZERO; 3], |ball| [ball.x_axis, ball.y_axis, ball.z_axis]);
                let reach = halves.iter().chain(&round).map(|half| half.length()).fold(0.0, f64::max);
                Some((0.5 * (*from + *to), 0.5 * from.distance(*to) + reach))
            }
            Self::Plane { .. } => None,
        }
    }
}
