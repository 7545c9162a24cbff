//! Rays that start anywhere: their hits and distances.

use glam::DVec3;

use rayreel::trace::{CastRay, Geometry, Precision, PreparedScene, SurfaceMaterial, SurfacePoint};

use super::categories::Case;
use super::exact::{Exact, Shape, along, exact, length, magnitude, quotient, rounded, vector};

pub(crate) fn scene(shapes: &[Shape]) -> PreparedScene {
    let mut geometry = Geometry::default();
    for shape in shapes {
        geometry.push(shape.prepared());
    }
    PreparedScene::new(geometry, vec![SurfaceMaterial::default(); shapes.len()])
}

/// Returns the distance to the next larger number of the same sign.
pub(crate) fn unit_in_last_place(value: f64) -> f64 {
    value.abs().next_up() - value.abs()
}

/// The robust precision, and the naive ones for comparison.
pub(crate) const PRECISIONS: [Precision; 3] = [Precision::Robust, Precision::NaiveF64, Precision::NaiveF32];

/// Results of the rays of a category.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) errors: Vec<f64>,
    pub(crate) wrong_verdicts: usize,
    pub(crate) wrong: Vec<String>,
}

impl Tally {
    /// Returns the median and the maximum of the distances' errors, or 0 without hits.
    pub(crate) fn median_and_worst(&mut self) -> (f64, f64) {
        self.errors.sort_by(f64::total_cmp);
        let middle = self.errors.get(self.errors.len() / 2);
        (middle.copied().unwrap_or(0.0), self.errors.last().copied().unwrap_or(0.0))
    }
}

/// The exact result of a case: the nearest `t`, the index of the visible shape, and true for a hit from outside, if the shape has an
/// outside.
type Expected = Option<(Exact, usize, Option<bool>)>;

fn expected(case: &Case) -> Expected {
    // Roots have 1200 bits. Values that agree in about 380 bits are equal.
    let same = exact(libm::ldexp(1.0, -380));
    let mut nearest: Expected = None;
    for (index, shape) in case.shapes.iter().enumerate() {
        let answer = shape.met_by(case.origin, case.direction);
        let Some(t) = answer.first() else { continue };
        let planar = matches!(shape, Shape::Plane { .. });
        let nearer = nearest.as_ref().is_none_or(|(best, ..)| best - t > &same * (t + best));
        if nearer {
            nearest =
                Some((t.clone(), index, (!planar && !answer.touches).then(|| answer.is_from_outside())));
        }
    }
    nearest
}

/// Casts the ray at every precision, and compares the hits.
pub(crate) fn check(name: &str, case: &Case, tallies: &mut [Tally; 3]) {
    let expected = expected(case);
    let mut scene = scene(&case.shapes);
    for (precision, tally) in PRECISIONS.into_iter().zip(tallies) {
        scene.precision = precision;
        compare(name, case, &expected, &scene, tally);
    }
}

fn compare(name: &str, case: &Case, expected: &Expected, scene: &PreparedScene, tally: &mut Tally) {
    let Case { shapes, origin, direction, .. } = case;
    let ray = CastRay::new(*origin, *direction).unwrap();
    let mut wrong =
        |what: String| tally.wrong.push(format!("{name}: {what}, {shapes:?} {origin:?} {direction:?}"));
    match (scene.cast(&ray), expected) {
        (Some(surface), Some((t, index, from_outside))) => {
            let exact_direction = vector(*direction);
            let error = distance_error(&ray, &surface, &(t * length(&exact_direction)));
            if error.is_nan() || error > 2.0 {
                wrong(format!("{error} ulp"));
            }
            tally.errors.push(error);
            if *index != surface.hit.id.index() {
                wrong(format!("{:?} instead of {index:?}", surface.hit.id));
            }
            if from_outside.is_some_and(|from_outside| from_outside != surface.from_outside) {
                wrong(format!("from outside: {}", surface.from_outside));
            }
            let point = along(&vector(*origin), &exact_direction, t);
            if !is_rounded(surface.point, &point, *origin) {
                wrong(format!("at {:?}", surface.point));
            }
            if (surface.normal.length() - 1.0).abs() > 1e-9 {
                wrong(format!("normal {:?}", surface.normal));
            }
        }
        (None, None) => {}
        (found, expected) => {
            tally.wrong_verdicts += 1;
            wrong(format!("hit {} instead of {}", found.is_some(), expected.is_some()));
        }
    }
}

/// Returns the error of the kernel's distance, in units in the last place.
pub(crate) fn distance_error(ray: &CastRay, surface: &SurfacePoint, expected: &Exact) -> f64 {
    let found = surface.distance(ray);
    if !found.is_finite() {
        return f64::NAN;
    }
    let unit = unit_in_last_place(rounded(expected));
    rounded(&quotient(&magnitude(&(exact(found) - expected)), &exact(unit)))
}

/// Returns true if a point is the exact one, rounded once, up to a distance error of 2 units in the last place.
pub(crate) fn is_rounded(found: DVec3, expected: &[Exact; 3], origin: DVec3) -> bool {
    (0..3).all(|axis| {
        let part = rounded(&expected[axis]);
        let way = unit_in_last_place(part - origin[axis]);
        found[axis].is_finite()
            && magnitude(&(exact(found[axis]) - &expected[axis]))
                <= exact(unit_in_last_place(part)) * exact(0.5) + exact(way) * exact(2.0)
    })
}
