//! Outlines of the things around the camera's path.

use glam::{DMat3, DVec3};

use rayreel::Engine;
use rayreel::components::{Order, Shape, WorldTransform};

/// The most things that are drawn.
const MOST: usize = 400;

/// An outline in space.
pub(super) enum Thing {
    /// The image of the unit ball about a centre.
    Ball { center: DVec3, image: DMat3 },
    /// Eight corners; those whose indices differ in one bit share an edge.
    Box([DVec3; 8]),
    /// Through a point, across a unit vector.
    Plane { point: DVec3, normal: DVec3 },
}

/// Returns the first things in the scene's order.
pub(super) fn all(engine: &Engine) -> Vec<Thing> {
    let mut query = engine.world().query::<(&Order, &Shape, &WorldTransform)>();
    let mut found: Vec<_> = query.iter().collect();
    found.sort_by_key(|(order, ..)| **order);
    found.into_iter().take(MOST).filter_map(|(_, shape, transform)| Thing::of(*shape, transform)).collect()
}

impl Thing {
    fn of(shape: Shape, transform: &WorldTransform) -> Option<Self> {
        let affine = transform.affine;
        let center = affine.translation;
        let thing = match shape {
            Shape::Sphere { radius } => Self::Ball { center, image: affine.matrix3 * radius },
            Shape::Box { size } => Self::Box(std::array::from_fn(|index| {
                let side = |bit: usize| if index >> bit & 1 == 0 { -0.5 } else { 0.5 };
                affine.transform_point3(size * DVec3::new(side(0), side(1), side(2)))
            })),
            Shape::Plane { normal } => {
                let normal = affine.matrix3.inverse().transpose() * normal;
                Self::Plane { point: center, normal: normal.try_normalize()? }
            }
        };
        affine.is_finite().then_some(thing)
    }

    /// Returns its middle and its radius about that; planes have no end.
    pub(super) fn extent(&self) -> Option<(DVec3, f64)> {
        match self {
            Self::Ball { center, image } => Some((
                *center,
                [image.x_axis, image.y_axis, image.z_axis].map(DVec3::length).into_iter().fold(0.0, f64::max),
            )),
            Self::Box(corners) => {
                let middle = 0.5 * (corners[0] + corners[7]);
                Some((middle, corners.iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max)))
            }
            Self::Plane { .. } => None,
        }
    }
}
