//! Deterministic pseudo-random numbers, and values made of them.

use std::ops::RangeInclusive;

use glam::{DAffine3, DMat3, DQuat, DVec3};

pub(crate) use crate::splitmix::Random;

impl Random {
    pub(crate) fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.index(choices.len())]
    }

    /// Returns a number in -1..1, sometimes with few digits, so that exact coincidences occur.
    pub(crate) fn number(&mut self) -> f64 {
        let full = (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        if self.once_in(4) { (full * 8.0).round() / 8.0 } else { full }
    }

    /// Returns a number from `low` to `high`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (0.5 + 0.5 * self.number())
    }

    /// Returns an integer from `-most` to `most`.
    pub(crate) fn whole(&mut self, most: i32) -> f64 {
        let span = u64::from(most.unsigned_abs()) * 2 + 1;
        f64::from(i32::try_from(self.bits() % span).unwrap() - most)
    }

    pub(crate) fn sign(&mut self) -> f64 {
        if self.once_in(2) { 1.0 } else { -1.0 }
    }

    pub(crate) fn point(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }

    /// Returns three integers, not all of them zero.
    pub(crate) fn whole_direction(&mut self, most: i32) -> DVec3 {
        let direction = DVec3::new(self.whole(most), self.whole(most), self.whole(most));
        if direction == DVec3::ZERO { DVec3::X } else { direction }
    }

    pub(crate) fn direction(&mut self) -> DVec3 {
        let direction = self.point();
        if direction == DVec3::ZERO { DVec3::X } else { direction }
    }

    /// Returns a direction on the side of the plane that `normal` points to, sometimes nearly along the plane.
    pub(crate) fn direction_towards(&mut self, normal: DVec3) -> DVec3 {
        let direction = self.direction();
        let direction = match self.index(4) {
            0 => normal.cross(direction) + normal * self.scale(-60..=0),
            1 => normal + direction * self.scale(-20..=-1),
            _ => direction,
        };
        if direction.dot(normal) < 0.0 { -direction } else { direction }
    }

    /// Returns a power of two.
    pub(crate) fn scale(&mut self, exponents: RangeInclusive<i32>) -> f64 {
        let span = u64::from(exponents.end().abs_diff(*exponents.start())) + 1;
        let step = i32::try_from(self.bits() % span).unwrap();
        libm::ldexp(1.0, exponents.start() + step)
    }

    pub(crate) fn rotation(&mut self) -> DQuat {
        let [x, y, z, w] = [self.number(), self.number(), self.number(), self.number()];
        let rotation = DQuat::from_xyzw(x, y, z, w);
        if rotation.length_squared() < 1e-3 { DQuat::IDENTITY } else { rotation.normalize() }
    }

    /// Returns edge lengths of about one.
    pub(crate) fn extents(&mut self) -> DVec3 {
        DVec3::new(1.1 + self.number(), 1.1 + self.number(), 1.1 + self.number())
    }

    /// Returns a transform that scales by these factors along the shape's own axes, rotates, and translates.
    pub(crate) fn turned(&mut self, factors: DVec3, translation: DVec3) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(factors, self.rotation(), translation)
    }

    /// Returns a linear transform whose determinant is not near zero, with this translation.
    pub(crate) fn sheared(&mut self, translation: DVec3) -> DAffine3 {
        let columns = |random: &mut Self| {
            DMat3::from_cols(
                DVec3::X + random.point() * 0.9,
                DVec3::Y + random.point() * 0.9,
                DVec3::Z + random.point() * 0.9,
            )
        };
        let mut matrix3 = columns(self);
        while matrix3.determinant().abs() < 0.05 {
            matrix3 = columns(self);
        }
        DAffine3 { matrix3, translation }
    }

    /// Returns a transform of quarter turns and reflections, scaled by powers of two: a matrix whose inverse is exact.
    pub(crate) fn quarter_turned(&mut self, translation: DVec3) -> DAffine3 {
        let first = self.index(3);
        let second = (first + 1 + self.index(2)) % 3;
        let third = 3 - first - second;
        let mut column = |axis: usize| DVec3::AXES[axis] * self.sign() * self.scale(-2..=2);
        let matrix3 = DMat3::from_cols(column(first), column(second), column(third));
        DAffine3 { matrix3, translation }
    }
}
