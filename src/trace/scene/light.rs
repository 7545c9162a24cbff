//! Lights in the kernel's representation.

use glam::DVec3;

use crate::color::Rgb;
use crate::trace::math::{Bytes, disc, scaled};
use crate::trace::rays::ShapeId;

/// A light in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreparedLight {
    /// The source of the light.
    pub source: LightSource,
    /// RGB intensity, 0 or more.
    pub intensity: Rgb,
    /// Attenuation with distance, if any.
    pub falloff: Option<PreparedFalloff>,
    /// Number of sample points that light a point; 1 unless it is an area light.
    pub samples: u32,
    /// True if it casts shadows, so that shadow rays are traced to it.
    pub casts_shadows: bool,
    /// The light's own shape, which does not occlude it.
    pub own_shape: Option<ShapeId>,
}

/// The attenuation of a light: at distance d, 1 / (c0 + c1 d + c2 d^2) of the intensity is left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreparedFalloff {
    /// c0, greater than 0 and finite.
    pub constant: f64,
    /// c1, 0 or more and finite.
    pub linear: f64,
    /// c2, 0 or more and finite.
    pub quadratic: f64,
}

impl PreparedFalloff {
    /// Returns the share of the intensity that is left at a distance, 0 or more.
    pub(crate) fn at(&self, distance: f64) -> f64 {
        // A finite distance times a zero coefficient is zero.
        let distance = distance.min(f64::MAX);
        1.0 / (self.constant + distance * (self.linear + distance * self.quadratic))
    }
}

/// The kind and position of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightSource {
    /// A point light at a position.
    Point(DVec3),
    /// A spot light at a position, with a cone.
    Spot(DVec3, Cone),
    /// A directional light, in this direction from every point; any length except zero.
    Directional(DVec3),
    /// A sphere, sampled as the disc that faces the lit point.
    Sphere {
        /// The centre.
        center: DVec3,
        /// The radius, 0 or more.
        radius: f64,
    },
    /// A parallelogram that emits on both sides.
    Rectangle {
        /// The centre.
        center: DVec3,
        /// The vectors from the centre to the midpoints of two adjacent edges.
        halves: [DVec3; 2],
    },
}

impl PreparedLight {
    /// Writes the bytes of everything that pictures depend on. `rank` returns a shape's index in the document.
    pub(super) fn write(&self, bytes: &mut Bytes, rank: impl Fn(ShapeId) -> u64) {
        let Self { source, intensity, falloff, samples: _, casts_shadows, own_shape } = self;
        source.write(bytes);
        bytes.colors([*intensity]);
        let PreparedFalloff { constant, linear, quadratic } =
            falloff.unwrap_or(PreparedFalloff { constant: 1.0, linear: 0.0, quadratic: 0.0 });
        [constant, linear, quadratic].into_iter().for_each(|number| bytes.number(number));
        bytes.count(self.places());
        bytes.count(*casts_shadows);
        bytes.count(own_shape.map_or(0, |shape| 1 + rank(shape)));
    }

    /// Returns the number of sample points that light a point: 1 unless it is an area light.
    pub(crate) fn places(&self) -> u32 {
        if self.source.is_extended() { self.samples.max(1) } else { 1 }
    }
}

impl LightSource {
    fn write(&self, bytes: &mut Bytes) {
        match *self {
            Self::Point(position) => {
                bytes.count(0_u32);
                bytes.vectors([position]);
            }
            Self::Spot(position, Cone { axis, inner, outer }) => {
                bytes.count(1_u32);
                bytes.vectors([position, axis]);
                [inner, outer].into_iter().for_each(|number| bytes.number(number));
            }
            Self::Directional(towards) => {
                bytes.count(2_u32);
                bytes.vectors([towards]);
            }
            Self::Sphere { center, radius } => {
                bytes.count(3_u32);
                bytes.vectors([center]);
                bytes.number(radius);
            }
            Self::Rectangle { center, halves: [right, up] } => {
                bytes.count(4_u32);
                bytes.vectors([center, right, up]);
            }
        }
    }

    /// Returns whether it is an area light.
    #[must_use]
    pub fn is_extended(&self) -> bool {
        matches!(self, Self::Sphere { .. } | Self::Rectangle { .. })
    }

    /// Returns the centre of an area light, and upper bounds of its half-extents.
    pub(crate) fn extent(&self) -> Option<(DVec3, DVec3)> {
        /// 2^-40, more than rounding shifts points by.
        const ROUNDING: f64 = f64::from_bits((1023 - 40) << 52);
        let (center, reach) = match *self {
            Self::Point(_) | Self::Spot(..) | Self::Directional(_) => return None,
            Self::Sphere { center, radius } => (center, DVec3::splat(radius)),
            Self::Rectangle { center, halves: [right, up] } => (center, right.abs() + up.abs()),
        };
        Some((center, reach + (center.abs() + reach) * ROUNDING))
    }

    /// Returns the point of an area light that corresponds to a point of the unit square, as seen from `lit`.
    pub(crate) fn place(&self, lit: DVec3, square: [f64; 2]) -> DVec3 {
        match *self {
            Self::Point(place) | Self::Spot(place, _) | Self::Directional(place) => place,
            Self::Sphere { center, radius } => {
                let Some((towards, _)) = scaled(center - lit) else {
                    return center;
                };
                let [x, y] = disc(square);
                let (right, up) = across(towards.normalize());
                center + right * (radius * x) + up * (radius * y)
            }
            Self::Rectangle { center, halves: [right, up] } => {
                let [x, y] = square.map(|place| 2.0 * place - 1.0);
                center + right * x + up * y
            }
        }
    }
}

/// Returns two unit vectors that are perpendicular to a third one and to each other.
fn across(forward: DVec3) -> (DVec3, DVec3) {
    let size = forward.abs();
    let axis = if size.x <= size.y && size.x <= size.z {
        DVec3::X
    } else if size.y <= size.z {
        DVec3::Y
    } else {
        DVec3::Z
    };
    let right = axis.cross(forward).normalize();
    (right, forward.cross(right))
}

/// The cone of a spot light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// The axis, of length 1.
    pub axis: DVec3,
    /// Cosine of the angle to the axis up to which the light has its full intensity.
    pub inner: f64,
    /// Cosine of the angle beyond which there is no light; not greater than `inner`.
    pub outer: f64,
}

impl Cone {
    /// Returns the share of the light that is emitted in a direction with this cosine to the axis: 3 x^2 - 2 x^3 between the angles, where
    /// x is linear in the cosine.
    pub(crate) fn at(&self, cosine: f64) -> f64 {
        if cosine >= self.inner {
            1.0
        } else if cosine > self.outer {
            let x = (cosine - self.outer) / (self.inner - self.outer);
            x * x * (3.0 - 2.0 * x)
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cone_fades_between_its_cosines() {
        let cone = Cone { axis: DVec3::Z, inner: 0.75, outer: 0.25 };
        for (cosine, share) in [
            (1.0, 1.0),
            (0.75, 1.0),
            (0.625, 0.84375),
            (0.5, 0.5),
            (0.375, 0.15625),
            (0.25, 0.0),
            (-1.0, 0.0),
        ] {
            assert_eq!(cone.at(cosine), share, "{cosine}");
        }
        let hard = Cone { axis: DVec3::Z, inner: 0.5, outer: 0.5 };
        assert_eq!([0.6, 0.5, 0.499].map(|cosine| hard.at(cosine)), [1.0, 1.0, 0.0]);
    }

    #[test]
    fn falloff_is_a_number_at_every_distance() {
        let falloff = |constant, linear, quadratic| PreparedFalloff { constant, linear, quadratic };
        assert_eq!(falloff(1.0, 2.0, 3.0).at(2.0), 1.0 / 17.0);
        assert_eq!(falloff(0.5, 0.0, 0.0).at(f64::INFINITY), 2.0);
        assert_eq!(falloff(1.0, 1.0, 1.0).at(f64::MAX), 0.0);
        assert_eq!(falloff(1.0, 1.0, 1.0).at(0.0), 1.0);
    }
}
