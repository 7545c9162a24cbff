//! Rays that leave a surface found by another ray.
//!
//! They start at a rounded point. Because of the rounding, they must neither hit the surface that they leave, nor miss nearby surfaces.

use std::fmt;

use glam::DVec3;

use rayreel::trace::{CastHit, CastRay, PreparedScene, SurfacePoint};

use super::exact::{Exact, Exact3, Shape, along, length, magnitude, rounded, vector};
use super::primary::{distance_error, is_rounded, scene, unit_in_last_place};

/// Results of the rays of a category.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) rays: usize,
    pub(crate) wrong: usize,
    pub(crate) examples: Vec<String>,
}

impl Tally {
    /// Counts a ray, and records a wrong result.
    pub(crate) fn ask(&mut self, right: bool, what: impl FnOnce() -> String) {
        self.rays += 1;
        if !right {
            self.wrong += 1;
            if self.examples.len() < 3 {
                self.examples.push(what());
            }
        }
    }
}

/// A scene with the exact numbers of its shapes.
pub(crate) struct World {
    pub(crate) shapes: Vec<Shape>,
    scene: PreparedScene,
}

/// A surface, and the ray that hit it.
#[derive(Clone)]
pub(crate) struct Found {
    pub(crate) arrived: CastRay,
    pub(crate) surface: CastHit,
}

impl fmt::Debug for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (from, along) = (self.arrived.origin(), self.arrived.direction());
        let (slot, far) = (self.slot(), if self.surface.hit.far { " far" } else { "" });
        let SurfacePoint { point, normal, .. } = &*self.surface;
        write!(f, "[{from:?} + t {along:?} finds {slot}{far} at {point:?}, normal {normal:?}]")
    }
}

impl Found {
    pub(crate) fn slot(&self) -> usize {
        self.surface.hit.id.index()
    }

    /// Returns the cosine of the angle between the ray and the normal.
    fn steepness(&self) -> f64 {
        let direction = self.arrived.direction();
        (direction.dot(self.surface.normal) / direction.length()).abs()
    }

    /// Returns the largest shift of the point by rounding to nearest.
    pub(crate) fn shift(&self) -> DVec3 {
        DVec3::from_array(self.surface.point.to_array().map(|part| 0.5 * unit_in_last_place(part)))
    }
}

impl World {
    pub(crate) fn new(shapes: Vec<Shape>) -> Self {
        let scene = scene(&shapes);
        Self { shapes, scene }
    }

    fn found(&self, arrived: CastRay) -> Option<Found> {
        self.scene.cast(&arrived).map(|surface| Found { arrived, surface })
    }

    pub(crate) fn cast(&self, origin: DVec3, direction: DVec3) -> Option<Found> {
        self.found(CastRay::new(origin, direction)?)
    }

    /// Returns the hit of a ray that leaves the surface in this direction.
    pub(crate) fn leave(&self, from: &Found, direction: DVec3) -> Option<Found> {
        self.found(from.surface.leave_towards(direction)?)
    }

    /// Returns the hit of a ray that continues straight on.
    pub(crate) fn go_on(&self, from: &Found) -> Option<Found> {
        self.leave(from, from.arrived.direction())
    }

    /// Returns true if the point is the exact intersection, rounded once.
    pub(crate) fn is_rounded(&self, found: &Found) -> bool {
        self.exact_point(found)
            .is_some_and(|point| is_rounded(found.surface.point, &point, found.arrived.origin()))
    }

    /// Returns the exact point at which a ray that leaves no surface hits the shape.
    pub(crate) fn exact_point(&self, found: &Found) -> Option<Exact3> {
        let (origin, direction) = (vector(found.arrived.origin()), vector(found.arrived.direction()));
        let answer = self.shapes[found.slot()].met_from(&origin, &direction);
        Some(along(&origin, &direction, answer.first()?))
    }

    /// Returns true if the ray hits another shape at the exact distance from its rounded origin, and if a ray from the exact origin hits it
    /// at a similar distance.
    pub(crate) fn is_met_right(&self, from: &Found, found: &Found) -> bool {
        let direction = vector(found.arrived.direction());
        let shape = &self.shapes[found.slot()];
        let Some(t) = shape.met_by(found.arrived.origin(), found.arrived.direction()).first().cloned() else {
            return false;
        };
        let stretch = length(&direction);
        let expected = &t * &stretch;
        if distance_error(&found.arrived, &found.surface, &expected) > 2.0 {
            return false;
        }
        let steepness = found.steepness();
        let Some(ideal) = self.exact_point(from).filter(|_| steepness > 1e-3) else {
            return true;
        };
        // Along the second surface's normal, the origin moves by no more than its shift. A factor of two allows for the surface's
        // curvature.
        let bound = 2.0 * from.shift().length() / steepness;
        shape
            .met_from(&ideal, &direction)
            .first()
            .is_some_and(|t| rounded(&magnitude(&(t * &stretch - &expected))) <= bound)
    }

    /// Returns true if a ray that starts on the shape and points inwards leaves it at the exact point. If rounding has put the origin
    /// outside the shape, the ray leaves it at once, or where the ray is nearest to the centre of a round shape.
    pub(crate) fn is_met_from_inside(&self, found: &Found) -> bool {
        let direction = found.arrived.direction();
        let answer = self.shapes[found.slot()].met_by(found.arrived.origin(), direction);
        let Some((_, far)) = answer.line else { return found.surface.point.is_finite() };
        let far = if far < Exact::ZERO { Exact::ZERO } else { far };
        let expected = far * length(&vector(direction));
        distance_error(&found.arrived, &found.surface, &expected) <= 2.0
    }
}
