//! Rays that leave a surface which another ray has found.
//!
//! They start at a point that is rounded, and must neither meet what they leave by that rounding nor pass by what is close.

use std::fmt;

use glam::DVec3;

use rayreel::trace::{PreparedScene, Ray, Surface};

use crate::exact::{
    Exact, Exact3, Shape, along, difference, dot, exact, length, magnitude, quotient, rounded, vector,
};
use crate::primary::{distance_error, is_rounded, scene, unit_in_last_place};

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
    pub(crate) arrived: Ray,
    pub(crate) surface: Surface,
}

impl fmt::Debug for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (from, along) = (self.arrived.origin(), self.arrived.direction());
        let (slot, far) = (self.slot(), if self.surface.hit.far { " far" } else { "" });
        let Surface { point, normal, .. } = &self.surface;
        write!(f, "[{from:?} + t {along:?} finds {slot}{far} at {point:?}, normal {normal:?}]")
    }
}

impl Found {
    pub(crate) fn slot(&self) -> usize {
        self.surface.hit.slot.index()
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

    fn found(&self, arrived: Ray) -> Option<Found> {
        self.scene.cast(&arrived).map(|surface| Found { arrived, surface })
    }

    pub(crate) fn cast(&self, origin: DVec3, direction: DVec3) -> Option<Found> {
        self.found(Ray::new(origin, direction)?)
    }

    /// What a ray meets that leaves the surface in this direction.
    pub(crate) fn leave(&self, from: &Found, direction: DVec3) -> Option<Found> {
        self.found(from.surface.leave_towards(direction)?)
    }

    /// What a ray meets that goes on as it came.
    pub(crate) fn go_on(&self, from: &Found) -> Option<Found> {
        self.leave(from, from.arrived.direction())
    }

    pub(crate) fn distance(&self, found: &Found) -> f64 {
        found.surface.distance(&found.arrived)
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

    /// Does the ray, which starts in a box or on it, come out where the exact one does?
    pub(crate) fn is_met_from_inside(&self, found: &Found) -> bool {
        let direction = found.arrived.direction();
        let answer = self.shapes[found.slot()].met_by(found.arrived.origin(), direction);
        answer.line.is_some_and(|(_, far)| {
            let expected = far * length(&vector(direction));
            distance_error(&found.arrived, &found.surface, &expected) <= 2.0
        })
    }

    /// Is the far side of a round shape, which a ray went into, where the chord from the exact point ends? The bound is
    /// what the point's rounding and a few units in the last place of the shape's own numbers can do.
    pub(crate) fn is_far_side_of_ball(&self, from: &Found, found: &Found, radius: f64) -> bool {
        let shape = &self.shapes[found.slot()];
        let Some((back, ideal)) = shape.back().zip(self.exact_point(from)) else { return false };
        let direction = vector(found.arrived.direction());
        let (own, way) = (back.point(&ideal), back.direction(&direction));
        let squared = dot(&way, &way);
        let expected = quotient(&(dot(&own, &way) * exact(-2.0)), &squared);
        // All as lengths in the shape's own space, times the determinant.
        let (shift, wobble) = self.own_errors(from, found);
        let radius = exact(radius) * &back.determinant;
        let chord = shift * exact(2.0) + quotient(&(radius * &wobble * exact(4.0)), &length(&way));
        let stretch = length(&direction);
        let bound = quotient(&(chord * &stretch), &length(&way))
            + magnitude(&expected) * &stretch * exact(8.0 * f64::EPSILON);
        // Outwards by rounding alone, it comes out at once.
        let expected = if expected < Exact::ZERO { Exact::ZERO } else { expected };
        magnitude(&(exact(self.distance(found)) - expected * stretch)) <= bound
    }

    /// Is the far side of a turned box where the ray from the exact point leaves the first slab?
    pub(crate) fn is_far_side_of_turned_box(&self, from: &Found, found: &Found, half: DVec3) -> bool {
        let shape = &self.shapes[found.slot()];
        let Some((back, ideal)) = shape.back().zip(self.exact_point(from)) else { return false };
        let direction = vector(found.arrived.direction());
        let (own, way) = (back.point(&ideal), back.direction(&direction));
        let (shift, wobble) = self.own_errors(from, found);
        // The earliest and the latest that any slab's plane ahead may be met by rounding.
        let (mut earliest, mut latest): (Option<Exact>, Option<Exact>) = (None, None);
        for axis in 0..3 {
            let speed = magnitude(&way[axis]);
            let face = exact(half[axis]) * &back.determinant;
            let height = if way[axis] < Exact::ZERO { &face + &own[axis] } else { &face - &own[axis] };
            let early = quotient(&(&height - &shift), &(&speed + &wobble));
            earliest =
                Some(earliest.map_or(early.clone(), |least| if early < least { early } else { least }));
            if speed > wobble {
                let late = quotient(&(&height + &shift), &(&speed - &wobble));
                latest = Some(latest.map_or(late.clone(), |least| if late < least { late } else { least }));
            } else if &face - magnitude(&own[axis]) <= shift {
                // Along a face as good as exactly: it may come out there and then.
                earliest = earliest.map(|least| if least > Exact::ZERO { Exact::ZERO } else { least });
            }
        }
        let stretch = length(&direction);
        let distance = exact(self.distance(found));
        let slack = &distance * exact(8.0 * f64::EPSILON);
        earliest.is_some_and(|t| &distance + &slack >= t * &stretch)
            && latest.is_none_or(|t| &distance - &slack <= t * &stretch)
    }

    /// In a shape's own space, times the determinant: by how much a point can be off, and by how much a direction, that
    /// were rounded in the world and taken back with plain `f64`.
    fn own_errors(&self, from: &Found, found: &Found) -> (Exact, Exact) {
        const UNITS: f64 = 16.0 * f64::EPSILON;
        let back = self.shapes[found.slot()].back().unwrap();
        let norm = back.rows.iter().map(length).fold(Exact::ZERO, |norm, row| norm + row);
        let reach = length(&difference(&vector(from.surface.point), &back.translation));
        let condition = exact(self.condition(found.slot()));
        let shift = exact(from.shift().length()) + reach * &condition * exact(UNITS);
        let wobble = length(&vector(found.arrived.direction())) * condition * exact(UNITS);
        (shift * &norm, wobble * norm)
    }

    /// How many times the shape's map stretches one direction more than another, at most.
    fn condition(&self, slot: usize) -> f64 {
        match &self.shapes[slot] {
            Shape::Ellipsoid { forward, .. } | Shape::Turned { forward, .. } => {
                let columns = [forward.matrix3.x_axis, forward.matrix3.y_axis, forward.matrix3.z_axis];
                let longest = columns.iter().map(|column| column.length()).fold(0.0, f64::max);
                let squeeze = longest * longest * longest / forward.matrix3.determinant().abs();
                squeeze.max(1.0)
            }
            _ => 1.0,
        }
    }
}
