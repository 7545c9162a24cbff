//! Places at which planes, faces of boxes and convex spheres reflect a point to the eye, and the extents of what they show there.

use glam::{DAffine3, DVec3};

use super::LARGE;
use crate::color::Rgb;
use crate::trace::intersect::Scratch;
use crate::trace::rays::{PreparedRay, ShapeId};
use crate::trace::scene::{PreparedCamera, PreparedScene, ShapeRef, SurfaceMaterial};
use crate::trace::shading::{SampleId, ShadingPoint};
use crate::trace::shapes::{AlignedBox, Bounds, Sphere};

/// A surface that reflects each point to an eye at one place.
pub(super) enum Mirror {
    Plane { point: DVec3, normal: DVec3 },
    Sphere { center: DVec3, radius: f64 },
}

impl Mirror {
    /// Returns the mirrors that a shape has for an eye: none for rods and ellipsoids, whose reflection is not that simple, and for the inside
    /// of a shape.
    pub(super) fn all(shape: ShapeRef<'_>, eye: DVec3) -> Vec<Self> {
        match shape {
            ShapeRef::Plane(plane) => vec![Self::Plane { point: plane.point(), normal: plane.unit_normal() }],
            ShapeRef::Sphere(&Sphere { center, radius }) if eye.distance(center) > radius => {
                vec![Self::Sphere { center, radius }]
            }
            ShapeRef::AlignedBox(AlignedBox { min, max }) => {
                let half = (*max - *min) / 2.0;
                faces(&DAffine3::from_translation(*min + half), half, eye)
            }
            ShapeRef::BoxImage(image) => faces(image.forward(), image.half(), eye),
            _ => Vec::new(),
        }
    }

    /// Finds where the surface reflects a place to the eye; `None` if it does not.
    pub(super) fn reflect(&self, eye: DVec3, place: DVec3) -> Option<SpecularPoint> {
        let (point, normal, curvature) = match *self {
            Self::Plane { point, normal } => {
                let heights = [eye, place].map(|place| normal.dot(place - point));
                let [foot, other] = [eye - heights[0] * normal, place - heights[1] * normal];
                (foot.lerp(other, heights[0] / (heights[0] + heights[1])), normal * heights[0].signum(), 0.0)
            }
            Self::Sphere { center, radius } => {
                let normal = specular_normal([eye - center, place - center], radius)?;
                (center + radius * normal, normal, 1.0 / radius)
            }
        };
        let [near, far] = [eye, place].map(|place| place.distance(point));
        let cosine = normal.dot(eye - point) / near;
        (cosine > 0.0 && normal.dot(place - point) > 0.0).then_some(SpecularPoint {
            point,
            normal,
            near,
            far,
            cosine,
            curvature,
        })
    }
}

/// Returns the faces, turned to the eye, of the image of a box around the origin.
fn faces(forward: &DAffine3, half: DVec3, eye: DVec3) -> Vec<Mirror> {
    let back = forward.matrix3.inverse().transpose();
    let sides = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
    let face = |side: DVec3| {
        let (point, normal) = (forward.transform_point3(side * half), (back * side).normalize());
        (normal.dot(eye - point) > 0.0).then_some(Mirror::Plane { point, normal })
    };
    sides.filter_map(face).collect()
}

/// Returns the normal of a sphere around the origin where it reflects one place to the other. `None` if no point is seen from both. By
/// bisection of the arc between the places, on which the length of the path has one minimum.
fn specular_normal(places: [DVec3; 2], radius: f64) -> Option<DVec3> {
    /// The error is far below a pixel: 2^-24 of the arc.
    const HALVINGS: usize = 24;
    let [mut first, mut second] = places.map(DVec3::normalize);
    let mut normal = first;
    for _ in 0..HALVINGS {
        normal = (first + second).normalize();
        let directions = places.map(|place| (place - radius * normal).normalize());
        let slope = (second - first).dot(directions[0] + directions[1]);
        match directions.map(|direction| normal.dot(direction) > 0.0) {
            [false, false] => return None,
            [true, is_second_seen] if slope > 0.0 || !is_second_seen => first = normal,
            _ => second = normal,
        }
    }
    normal.is_finite().then_some(normal)
}

/// Keeps rays off the surface, and distinguishes surfaces, relative to the distance from the eye.
const OFF: f64 = 1e-6;

/// The place of a surface that reflects a point to the eye.
pub(super) struct SpecularPoint {
    pub(super) point: DVec3,
    normal: DVec3,
    /// Distances from the eye and to the reflected point.
    near: f64,
    far: f64,
    /// Cosine of the angle of incidence.
    cosine: f64,
    /// Inverse radius of the surface.
    curvature: f64,
}

impl SpecularPoint {
    /// Returns half the extents of a ball's image across and along the plane of incidence, as angles seen from the eye.
    pub(super) fn image(&self, radius: f64) -> [f64; 2] {
        let Self { near, far, cosine, curvature, .. } = *self;
        // Coddington's equations for a mirror of this curvature.
        [2.0 * curvature * cosine, 2.0 * curvature / cosine].map(|power| {
            let behind = 1.0 / (1.0 / far + power);
            radius * behind / (far * (near + behind))
        })
    }

    /// Returns half the extents of a highlight, like those of an image: up to where (N.H)^shininess is 1/e.
    pub(super) fn highlight(&self, shininess: f64) -> [f64; 2] {
        let Self { near, far, cosine, curvature, .. } = *self;
        // cos(a)^n is about exp(-n a²/2). Along the surface, N turns by the curvature, and H by the mean turn of both directions.
        let (angle, turn) = ((2.0 / shininess).sqrt(), 0.5 / near + 0.5 / far);
        [angle / (curvature + turn / cosine) / near, angle / (curvature + turn * cosine) * cosine / near]
    }

    /// Returns the pixels in which something of these extents shows, by column and row, and its area in pixels. Large things have none.
    pub(super) fn pixels(&self, camera: &PreparedCamera, extents: [f64; 2]) -> (Vec<(u32, u32)>, f64) {
        let depth = camera.depth_of(self.point);
        let direction = (self.point - camera.position()) * (camera.distance() / depth);
        let from_first = direction - camera.through(0.0, 0.0);
        let [column, row] = camera.steps().map(|step| from_first.dot(step) / step.length_squared());
        // Away from the middle of the picture, angles cover more pixels, at most by the square of the distance on the screen.
        let pixels = direction.length_squared() / camera.distance() / pixel_size(camera);
        let [across, along] = extents.map(|extent| extent * pixels);
        let area = std::f64::consts::PI * across * along;
        if !(depth > 0.0 && area < LARGE) {
            return (Vec::new(), area);
        }
        let reach = across.max(along);
        let near = |place: f64, count: u32| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "clamped to the film"
            )]
            let index = |place: f64| (place + 0.5).floor().clamp(0.0, count.into()) as u32;
            index(place - reach)..index(place + reach + 1.0)
        };
        let (columns, rows) = camera.resolution();
        let columns = near(column, columns);
        let in_row = |row: u32| columns.clone().map(move |column| (column, row));
        (near(row, rows).flat_map(in_row).collect(), area)
    }

    /// Returns whether the eye sees this place of a shape.
    pub(super) fn is_seen(
        &self,
        scene: &PreparedScene,
        id: ShapeId,
        eye: DVec3,
        search: &mut Scratch<'_>,
    ) -> bool {
        // Most places in the plane of a box's face are beside the face.
        let is_beside =
            |Bounds { min, max }| self.point.distance(self.point.clamp(min, max)) > 2.0 * OFF * self.near;
        if scene.geometry().bounds(id).is_some_and(is_beside) {
            return false;
        }
        let Some(ray) = PreparedRay::new(eye, self.point - eye) else { return false };
        let hit = scene.closest(&ray, search).map(|found| found.hit);
        let is_here = |t: f64| ray.at(t).distance(self.point) < OFF * self.near;
        hit.is_some_and(|hit| hit.id == id && is_here(hit.root.t()))
    }

    /// Returns the ray from just above the surface in a direction.
    pub(super) fn ray(&self, direction: DVec3) -> Option<PreparedRay> {
        PreparedRay::new(self.point + OFF * self.near * self.normal, direction)
    }

    /// Returns the point as one to be lit.
    pub(super) fn lit<'a>(&self, eye: DVec3, material: &'a SurfaceMaterial) -> ShadingPoint<'a> {
        ShadingPoint {
            arriving: self.point - eye,
            path: 0,
            point: self.point,
            material,
            diffuse: material.diffuse,
            ambient: Rgb::ZERO,
            sample_id: SampleId { seed: 0, pixel: (0, 0), sample: 0 },
            normal: self.normal,
        }
    }
}

/// Returns the smaller side of a pixel on the screen.
pub(super) fn pixel_size(camera: &PreparedCamera) -> f64 {
    let [right, down] = camera.steps().map(DVec3::length);
    right.min(down)
}

/// A ball approximating a shape's bounds.
pub(super) struct Ball {
    pub(super) middle: DVec3,
    pub(super) radius: f64,
}

impl Ball {
    pub(super) fn around(bounds: &Bounds) -> Self {
        let size = bounds.max - bounds.min;
        Self { middle: bounds.min.midpoint(bounds.max), radius: size.element_sum() / 6.0 }
    }

    /// Returns whether a mirror cuts the ball, so that parts of it may be seen in the mirror even if its centre is behind the mirror.
    pub(super) fn is_cut_by(&self, faces: &[Mirror], bounds: Option<&Bounds>) -> bool {
        let is_cut_by = |face: &Mirror| match *face {
            Mirror::Plane { point, normal } => normal.dot(self.middle - point).abs() < self.radius,
            Mirror::Sphere { .. } => false,
        };
        match bounds {
            Some(Bounds { min, max }) => self.middle.distance(self.middle.clamp(*min, *max)) < self.radius,
            None => faces.iter().any(is_cut_by),
        }
    }

    /// Returns the centre, and points near the outline as seen from a place.
    pub(super) fn points(&self, from: DVec3) -> impl Iterator<Item = DVec3> {
        /// Keeps the points inside, relative to the radius.
        const WITHIN: f64 = 0.9;
        let (middle, reach) = (self.middle, WITHIN * self.radius);
        let (right, up) = (middle - from).normalize().any_orthonormal_pair();
        [DVec3::ZERO, right, up, -right, -up].into_iter().map(move |way| middle + reach * way)
    }
}
