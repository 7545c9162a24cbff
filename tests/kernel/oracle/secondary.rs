//! Rays that leave a surface which another ray has found.
//!
//! They start at a point that is rounded, and must neither meet what they leave by that rounding nor pass by what is close.

use std::fmt;

use glam::DVec3;

use rayreel::trace::{CastHit, CastRay, PreparedScene, SurfacePoint};

use super::exact::{Exact, Exact3, Shape, along, length, magnitude, rounded, vector};
use super::primary::{distance_error, is_rounded, scene, unit_in_last_place};

/// What a category's rays have come to.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) rays: usize,
    pub(crate) wrong: usize,
    pub(crate) examples: Vec<String>,
}

impl Tally {
    /// Counts a ray, and whether what it did is right.
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

/// A surface, and the ray that found it.
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

    /// How steeply the ray meets the surface: the cosine of its angle with the normal.
    fn steepness(&self) -> f64 {
        let direction = self.arrived.direction();
        (direction.dot(self.surface.normal) / direction.length()).abs()
    }

    /// The farthest that rounding to the nearest numbers can have moved the point.
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

    /// What a ray meets that leaves the surface in this direction.
    pub(crate) fn leave(&self, from: &Found, direction: DVec3) -> Option<Found> {
        self.found(from.surface.leave_towards(direction)?)
    }

    /// What a ray meets that goes on as it came.
    pub(crate) fn go_on(&self, from: &Found) -> Option<Found> {
        self.leave(from, from.arrived.direction())
    }

    /// Is this the point where the ray met the shape, rounded once?
    pub(crate) fn is_rounded(&self, found: &Found) -> bool {
        self.exact_point(found)
            .is_some_and(|point| is_rounded(found.surface.point, &point, found.arrived.origin()))
    }

    /// Where exactly a ray that leaves nothing met the shape.
    pub(crate) fn exact_point(&self, found: &Found) -> Option<Exact3> {
        let (origin, direction) = (vector(found.arrived.origin()), vector(found.arrived.direction()));
        let answer = self.shapes[found.slot()].met_from(&origin, &direction);
        Some(along(&origin, &direction, answer.first()?))
    }

    /// Is a shape that the ray did not leave met where it is from the rounded origin? And had the origin not been rounded,
    /// could it be where it is found?
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
        // Along the second surface's normal the origin moves by no more than its shift. Twice that leaves room for the
        // surface's curvature.
        let bound = 2.0 * from.shift().length() / steepness;
        shape
            .met_from(&ideal, &direction)
            .first()
            .is_some_and(|t| rounded(&magnitude(&(t * &stretch - &expected))) <= bound)
    }

    /// Does the ray, which starts on the shape and goes inwards, come out where the exact one does? Where rounding has put its origin
    /// beside the shape, it comes out at once, or where it is nearest to the middle of a round one.
    pub(crate) fn is_met_from_inside(&self, found: &Found) -> bool {
        let direction = found.arrived.direction();
        let answer = self.shapes[found.slot()].met_by(found.arrived.origin(), direction);
        let Some((_, far)) = answer.line else { return found.surface.point.is_finite() };
        let far = if far < Exact::ZERO { Exact::ZERO } else { far };
        let expected = far * length(&vector(direction));
        distance_error(&found.arrived, &found.surface, &expected) <= 2.0
    }
}
