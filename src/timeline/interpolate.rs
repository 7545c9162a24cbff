//! What "between two values" means for each kind of value.

use glam::{DVec3, Vec3};

/// A value that can stand between others.
pub trait Interpolate: Clone {
    /// The value at fraction `u` in 0..=1 of the straight way. Exactly `from` at 0 and exactly `to` at 1.
    #[must_use]
    fn between(from: &Self, to: &Self, u: f64) -> Self;

    /// `sum weights[i] * values[i]`, where the weights sum to 1: a point of a curve through the values. Summed as
    /// differences from `values[1]`: between keys that crowd, weights are huge and of opposite sign.
    #[must_use]
    fn blend(values: [&Self; 4], weights: [f64; 4]) -> Self;
}

impl Interpolate for f64 {
    fn between(from: &Self, to: &Self, u: f64) -> Self {
        from * (1.0 - u) + to * u
    }

    fn blend(values: [&Self; 4], weights: [f64; 4]) -> Self {
        let [a, b, c, d] = values;
        b + (a - b) * weights[0] + (c - b) * weights[2] + (d - b) * weights[3]
    }
}

impl Interpolate for DVec3 {
    fn between(from: &Self, to: &Self, u: f64) -> Self {
        *from * (1.0 - u) + *to * u
    }

    fn blend(values: [&Self; 4], weights: [f64; 4]) -> Self {
        let [a, b, c, d] = values;
        *b + (*a - *b) * weights[0] + (*c - *b) * weights[2] + (*d - *b) * weights[3]
    }
}

/// Linear light; a curve that dips below zero is cut there.
impl Interpolate for Vec3 {
    fn between(from: &Self, to: &Self, u: f64) -> Self {
        DVec3::between(&from.as_dvec3(), &to.as_dvec3(), u).as_vec3()
    }

    fn blend(values: [&Self; 4], weights: [f64; 4]) -> Self {
        DVec3::blend(values.map(|value| value.as_dvec3()).each_ref(), weights).max(DVec3::ZERO).as_vec3()
    }
}
