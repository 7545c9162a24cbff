//! Finds lights that reach nothing that the camera can see.

use glam::DVec3;

use super::Preparation;
use crate::color::Rgb;
use crate::systems::{Consequence, Fault, FaultCause};
use crate::trace::{Bounds, Cone, LightSource, PreparedLight, PreparedScene, RayVisibility, ShapeId};

/// The maximum number of shapes to check. In larger scenes only planes and very large shapes are checked.
const MOST: usize = 4096;

/// 2^-30, more than the error of a computed position relative to its coordinates.
const ROUNDING: f64 = f64::from_bits((1023 - 30) << 52);

impl Preparation {
    /// Returns the faults of lights that are on and certainly light no surface that the camera can see.
    pub(super) fn idle_lights(&self) -> impl Iterator<Item = Fault> {
        let walls = self.possible_walls();
        let lights = self.scene.lights.iter().zip(&self.lights);
        lights.filter(|(light, _)| light.intensity != Rgb::ZERO).filter_map(move |(light, entity)| {
            let cause = match light.source {
                LightSource::Spot(apex, cone) if self.is_outside(apex, &cone) => FaultCause::OutsideCone,
                _ if light.casts_shadows && self.is_separated(light, &walls) => FaultCause::Separated,
                _ => return None,
            };
            Some(Fault { entity: *entity, consequence: Consequence::ReachesNothing, cause })
        })
    }

    /// Returns whether all shapes are certainly outside a cone.
    fn is_outside(&self, apex: DVec3, cone: &Cone) -> bool {
        let geometry = self.scene.geometry();
        let half = libm::acos(cone.outer) + ROUNDING;
        // A plane is reached by a cone that opens towards it, at more than a quarter turn from the normal that points to the apex.
        let reaches_plane = |id: &ShapeId| {
            let plane = geometry.plane(*id)?;
            let height = (apex - plane.point()).dot(plane.normal());
            let down = -plane.normal() * height.signum();
            Some(cone.axis.angle_between(down) - half < std::f64::consts::FRAC_PI_2)
        };
        let reaches_ball = |bounds: &Bounds| {
            let (way, radius) = (bounds.center() - apex, 0.5 * (bounds.max - bounds.min).length());
            let distance = way.length();
            distance <= radius || cone.axis.angle_between(way) <= half + libm::asin(radius / distance)
        };
        !geometry.is_empty()
            && geometry.len() <= MOST
            && !geometry.ids().any(|id| match (reaches_plane(&id), geometry.bounds(id)) {
                (Some(reaches), _) => reaches,
                (None, bounds) => bounds.as_ref().is_none_or(reaches_ball),
            })
    }

    /// Returns the opaque shapes that may separate a light from the eye, with their bounds. Shapes that some class of rays
    /// does not see are left out: they do not separate a light from the eye.
    fn possible_walls(&self) -> Vec<(ShapeId, Option<Bounds>)> {
        let scene = &self.scene;
        let is_opaque = |id: &ShapeId| {
            scene.surfaces().transparent.binary_search_by_key(&id.0, |other| other.0).is_err()
                && scene.geometry().visibility(*id) == RayVisibility::ALL
        };
        let wall = |id| (id, scene.geometry().bounds(id));
        match scene.geometry().len() <= MOST {
            true => scene.geometry().ids().filter(is_opaque).map(wall).collect(),
            false => scene.unbounded.iter().copied().filter(is_opaque).map(wall).collect(),
        }
    }

    /// Returns whether an opaque surface separates a light from the eye: a plane, or a sphere or box around one of them. The light then
    /// reaches neither the eye's side of the surface nor anything that the eye can see.
    fn is_separated(&self, light: &PreparedLight, walls: &[(ShapeId, Option<Bounds>)]) -> bool {
        let (scene, (eye, reach)) = (&self.scene, self.camera.eye());
        let seen_from = Region::around(eye, DVec3::splat(reach));
        let shines_from = match light.source {
            LightSource::Point(place) | LightSource::Spot(place, _) => Region::around(place, DVec3::ZERO),
            // A point so far away that only surfaces nearly parallel to the light are missed.
            LightSource::Directional(towards) => {
                let away = 1e9 * (1.0 + eye.abs().max_element());
                Region::around(eye + towards.normalize_or_zero() * away, DVec3::ZERO)
            }
            LightSource::Sphere { .. } | LightSource::Rectangle { .. } => {
                let Some((center, half)) = light.source.extent() else { return false };
                Region::around(center, half)
            }
            LightSource::Dome { .. } => return false,
        };
        walls.iter().any(|(id, bounds)| {
            // Exact tests are slow, and most shapes are around neither.
            bounds.is_none_or(|bounds| shines_from.meets(&bounds) || seen_from.meets(&bounds))
                && light.own_shape != Some(*id)
                && shines_from
                    .is_inside(scene, *id)
                    .zip(seen_from.is_inside(scene, *id))
                    .is_some_and(|(light, eye)| light != eye)
        })
    }
}

/// A box in which a light or an eye is.
struct Region {
    bounds: Bounds,
    /// True if it is a point, but for rounding.
    is_point: bool,
}

impl Region {
    fn around(center: DVec3, half: DVec3) -> Self {
        let rounding = center.abs() * ROUNDING;
        Self { bounds: Bounds::around(center, half + rounding), is_point: half == DVec3::ZERO }
    }

    /// Returns whether the region overlaps a box.
    fn meets(&self, bounds: &Bounds) -> bool {
        bounds.min.cmple(self.bounds.max).all() && bounds.max.cmpge(self.bounds.min).all()
    }

    /// Returns whether the region is inside a shape or outside. `None` if it may be partly inside.
    fn is_inside(&self, scene: &PreparedScene, id: ShapeId) -> Option<bool> {
        let Bounds { min, max } = self.bounds;
        let corner = |index: u32| {
            let upper = [0, 1, 2].map(|axis| index >> axis & 1 == 1);
            DVec3::select(glam::BVec3::from_array(upper), max, min)
        };
        let inside = (0..8).filter(|index| scene.geometry().contains(id, corner(*index))).count();
        // Shapes are convex, and so is the space in front of a plane.
        let is_apart = || match scene.geometry().bounds(id) {
            Some(bounds) => self.is_point || !self.meets(&bounds),
            None => scene.geometry().plane(id).is_some(),
        };
        match inside {
            8 => Some(true),
            0 if is_apart() => Some(false),
            _ => None,
        }
    }
}
