//! Contacts of boxes, and the impulses at them.

use super::body::{Body, STEP, Vector, add, cross, difference, dot, sign, unit};

const FRICTION: f64 = 0.45;
/// Gap below which two boxes have contacts.
pub(super) const MARGIN: f64 = 0.02;
/// Overlap that is not corrected.
const SLOP: f64 = 0.003;
/// The part of the rest that is corrected in a step.
const CORRECTION: f64 = 0.1;
/// Greatest speed of the correction.
const FASTEST_CORRECTION: f64 = 1.0;
/// Square of the distance between contacts of two steps that are the same one.
const SAME: f64 = 0.0025;

/// A point at which two boxes touch or nearly do.
#[derive(Clone, Debug)]
pub(super) struct Contact {
    pub(super) bodies: [usize; 2],
    /// From the centres to the point.
    arms: [Vector; 2],
    /// The normal towards the second box, and two tangents.
    directions: [Vector; 3],
    /// Change of an impulse for a change of the relative velocity along each direction.
    masses: Vector,
    /// Least relative velocity along the normal.
    least: f64,
    impulses: Vector,
}

impl Contact {
    fn new(bodies: &[Body], pair: [usize; 2], point: Vector, normal: Vector, overlap: f64) -> Self {
        let [a, b] = pair.map(|index| &bodies[index]);
        let arms = [difference(point, a.position), difference(point, b.position)];
        let side = if normal[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let tangent = unit(cross(normal, side));
        let directions = [normal, tangent, cross(normal, tangent)];
        let masses = directions.map(|direction| {
            let turning = [(a, arms[0]), (b, arms[1])].map(|(body, arm)| {
                let moment = cross(arm, direction);
                body.inverse_mass + dot(body.spin_of(moment), moment)
            });
            1.0 / (turning[0] + turning[1])
        });
        let least = if overlap < 0.0 {
            overlap / STEP
        } else {
            (CORRECTION / STEP * (overlap - SLOP)).clamp(0.0, FASTEST_CORRECTION)
        };
        Self { bodies: pair, arms, directions, masses, least, impulses: [0.0; 3] }
    }

    /// Applies an impulse along a direction.
    fn push(&self, bodies: &mut [Body], axis: usize, impulse: f64) {
        let ([a, b], [first, second]) = (self.bodies, self.arms);
        bodies[a].kick(first, -impulse, self.directions[axis]);
        bodies[b].kick(second, impulse, self.directions[axis]);
    }

    /// Takes over the impulses of the nearest contact of the step before, and applies them.
    pub(super) fn start(&mut self, before: &[Self], bodies: &mut [Body]) {
        let apart = |other: &Self| {
            let way = difference(other.arms[1], self.arms[1]);
            dot(way, way)
        };
        let nearest = before.iter().min_by(|one, other| apart(one).total_cmp(&apart(other)));
        if let Some(same) = nearest.filter(|nearest| apart(nearest) < SAME) {
            self.impulses = same.impulses;
            (0..3).for_each(|axis| self.push(bodies, axis, self.impulses[axis]));
        }
    }

    /// Corrects the impulses: along the normal, then along both tangents.
    pub(super) fn correct(&mut self, bodies: &mut [Body]) {
        for axis in 0..3 {
            let [a, b] = [0, 1].map(|side| bodies[self.bodies[side]].velocity_at(self.arms[side]));
            let motion = dot(difference(b, a), self.directions[axis]);
            let bound = FRICTION * self.impulses[0];
            let before = self.impulses[axis];
            self.impulses[axis] = if axis == 0 {
                (before + self.masses[0] * (self.least - motion)).max(0.0)
            } else {
                (before - self.masses[axis] * motion).clamp(-bound, bound)
            };
            self.push(bodies, axis, self.impulses[axis] - before);
        }
    }
}

/// The axis of the least overlap of two boxes.
#[derive(Clone, Copy, Debug)]
pub(super) enum Axis {
    Face { of_second: bool, axis: usize },
    Edges([usize; 2]),
}

/// Returns the least overlap of two boxes, negative if there is a gap, its direction towards the second one, and its axis.
pub(super) fn overlap(a: &Body, b: &Body) -> (f64, Vector, Axis) {
    let way = difference(b.position, a.position);
    let along = |direction: Vector| a.reach(direction) + b.reach(direction) - dot(way, direction).abs();
    let mut least = (f64::INFINITY, [0.0; 3], Axis::Edges([0; 2]));
    for (of_second, body) in [(false, a), (true, b)] {
        for axis in 0..3 {
            let overlap = along(body.axes[axis]);
            if overlap < least.0 - if of_second { 0.001 } else { 0.0 } {
                least = (overlap, body.axes[axis], Axis::Face { of_second, axis });
            }
        }
    }
    for one in 0..3 {
        for other in 0..3 {
            let normal = cross(a.axes[one], b.axes[other]);
            // Nearly parallel edges add nothing to faces, which are preferred, too.
            if dot(normal, normal) > 1e-4 {
                let normal = unit(normal);
                let overlap = along(normal);
                if overlap < least.0 - 0.005 {
                    least = (overlap, normal, Axis::Edges([one, other]));
                }
            }
        }
    }
    (least.0, least.1.map(|part| part * sign(dot(way, least.1))), least.2)
}

/// Returns the contacts of two boxes.
pub(super) fn touch(bodies: &[Body], pair: [usize; 2]) -> Vec<Contact> {
    let [a, b] = pair.map(|index| &bodies[index]);
    let (depth, normal, axis) = overlap(a, b);
    let contact = |point: Vector, depth: f64| Contact::new(bodies, pair, point, normal, depth);
    if depth < -MARGIN {
        return Vec::new();
    }
    match axis {
        Axis::Edges([one, other]) => {
            let (u, v) = (a.axes[one], b.axes[other]);
            let (p, q) = (a.farthest(normal, Some(one)), b.farthest(normal.map(|part| -part), Some(other)));
            let (way, c) = (difference(q, p), dot(u, v));
            let t = (dot(way, u) - c * dot(way, v)) / (1.0 - c * c);
            vec![contact(add(add(p, t, u), 0.5 * depth, normal.map(|part| -part)), depth)]
        }
        Axis::Face { of_second, axis } => {
            let (own, other) = if of_second { (b, a) } else { (a, b) };
            let outwards = if of_second { normal.map(|part| -part) } else { normal };
            let height = own.half[axis];
            let depth = |point: &Vector| height - dot(difference(*point, own.position), outwards);
            let points = clipped_face(own, axis, other, outwards);
            let near = points.into_iter().filter(|point| depth(point) > -MARGIN);
            near.map(|point| contact(add(point, 0.5 * depth(&point), outwards), depth(&point))).collect()
        }
    }
}

/// Returns the corners of the face of a box that looks against a direction, clipped by the sides of the prism over a face of another box.
fn clipped_face(own: &Body, face: usize, other: &Body, outwards: Vector) -> Vec<Vector> {
    let facing = |axis: usize| dot(other.axes[axis], outwards);
    let axis = (0..3).max_by(|a, b| facing(*a).abs().total_cmp(&facing(*b).abs())).unwrap_or(0);
    let middle = add(other.position, -sign(facing(axis)) * other.half[axis], other.axes[axis]);
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let corner = |(s, t): (f64, f64)| {
        add(add(middle, s * other.half[u], other.axes[u]), t * other.half[v], other.axes[v])
    };
    let mut points: Vec<Vector> =
        [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].into_iter().map(corner).collect();
    for (side, sign) in (0..3).filter(|side| *side != face).flat_map(|side| [(side, 1.0), (side, -1.0)]) {
        let inside =
            |point: Vector| own.half[side] - sign * dot(difference(point, own.position), own.axes[side]);
        let mut kept = Vec::with_capacity(8);
        for (index, point) in points.iter().enumerate() {
            let next = points[(index + 1) % points.len()];
            let (here, there) = (inside(*point), inside(next));
            kept.extend((here >= 0.0).then_some(*point));
            if (here < 0.0) != (there < 0.0) {
                kept.push(add(*point, here / (here - there), difference(next, *point)));
            }
        }
        points = kept;
    }
    points
}
