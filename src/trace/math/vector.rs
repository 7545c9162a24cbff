//! Vectors of double-double numbers.

use std::ops::{Add, Neg, Sub};

use glam::DVec3;

use super::double::Double;

/// A vector of three [`Double`]s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Double3 {
    /// The x component.
    pub x: Double,
    /// The y component.
    pub y: Double,
    /// The z component.
    pub z: Double,
}

impl Double3 {
    /// The unit vector along x.
    pub(crate) const X: Self = Self { x: Double::ONE, y: Double::ZERO, z: Double::ZERO };
    /// The unit vector along y.
    pub(crate) const Y: Self = Self { x: Double::ZERO, y: Double::ONE, z: Double::ZERO };
    /// The unit vector along z.
    pub(crate) const Z: Self = Self { x: Double::ZERO, y: Double::ZERO, z: Double::ONE };

    /// Returns a - b, exactly.
    #[must_use]
    #[inline]
    pub(crate) fn difference(a: DVec3, b: DVec3) -> Self {
        Self {
            x: Double::difference(a.x, b.x),
            y: Double::difference(a.y, b.y),
            z: Double::difference(a.z, b.z),
        }
    }

    /// Returns the dot product.
    #[must_use]
    #[inline]
    pub(crate) fn dot(self, other: Self) -> Double {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Returns the product with a number.
    #[must_use]
    #[inline]
    pub(crate) fn scaled(self, factor: Double) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }

    /// Returns a + b, exactly.
    #[must_use]
    pub(crate) fn sum(a: DVec3, b: DVec3) -> Self {
        Self { x: Double::sum(a.x, b.x), y: Double::sum(a.y, b.y), z: Double::sum(a.z, b.z) }
    }

    /// Returns, per coordinate, the short decimal number that was rounded to it; see [`Double::decimal`].
    #[must_use]
    pub(crate) fn decimal(vector: DVec3) -> Self {
        let [x, y, z] = vector.to_array().map(Double::decimal);
        Self { x, y, z }
    }

    /// Returns the cross product.
    #[must_use]
    pub(crate) fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// Returns the product with a power of two, exactly.
    #[must_use]
    pub(crate) fn times_power(self, power: f64) -> Self {
        Self { x: self.x.scaled(power), y: self.y.scaled(power), z: self.z.scaled(power) }
    }

    /// Returns [x, y, z].
    #[must_use]
    pub(crate) fn to_array(self) -> [Double; 3] {
        [self.x, self.y, self.z]
    }

    /// Returns the rounding error: the vector minus its value rounded to `f64`.
    #[must_use]
    pub(crate) fn rest(self) -> DVec3 {
        DVec3::new(self.x.rest(), self.y.rest(), self.z.rest())
    }

    /// Returns the quotient by a number.
    #[must_use]
    pub(crate) fn over(self, divisor: Double) -> Self {
        Self { x: self.x / divisor, y: self.y / divisor, z: self.z / divisor }
    }

    /// Returns the vector rounded to `f64`.
    #[must_use]
    #[inline]
    pub(crate) fn rounded(self) -> DVec3 {
        DVec3::new(self.x.rounded(), self.y.rounded(), self.z.rounded())
    }
}

impl From<[Double; 3]> for Double3 {
    #[inline]
    fn from([x, y, z]: [Double; 3]) -> Self {
        Self { x, y, z }
    }
}

impl From<DVec3> for Double3 {
    #[inline]
    fn from(vector: DVec3) -> Self {
        Self { x: vector.x.into(), y: vector.y.into(), z: vector.z.into() }
    }
}

impl Add for Double3 {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl Neg for Double3 {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }
}

impl Sub for Double3 {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}
