//! Lights, as the kernel sees them.

use glam::DVec3;

use crate::color::Rgb;
use crate::trace::math::{Bytes, disc, scaled};
use crate::trace::rays::ShapeId;

/// A light in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Where the light comes from.
    pub source: LightSource,
    /// RGB, 0 or more.
    pub intensity: Rgb,
    /// How it weakens with distance, if it does.
    pub falloff: Option<Falloff>,
    /// How many of its places light a point; 1 unless it is extended.
    pub samples: u32,
    /// Whether it casts shadows: shadow rays are followed to it.
    pub casts_shadows: bool,
    /// The light's own shape, which does not stand in its way.
    pub own_shape: Option<ShapeId>,
}

/// How a light weakens: at distance d, 1 / (c0 + c1 d + c2 d^2) of the intensity is left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Falloff {
    /// c0, greater than 0 and finite.
    pub constant: f64,
    /// c1, 0 or more and finite.
    pub linear: f64,
    /// c2, 0 or more and finite.
    pub quadratic: f64,
}

impl Falloff {
    /// What is left of the intensity at a distance, 0 or more.
    pub(crate) fn at(&self, distance: f64) -> f64 {
        // A finite distance times a zero coefficient is zero.
        let distance = distance.min(f64::MAX);
        1.0 / (self.constant + distance * (self.linear + distance * self.quadratic))
    }
}

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightSource {
    /// A point.
    Point(DVec3),
    /// A point, into a cone.
    Spot(DVec3, Cone),
    /// Infinitely far away, in this direction from everywhere; any length but zero.
    Directional(DVec3),
    /// A sphere, seen from everywhere as the disc that faces there.
    Sphere {
        /// Its middle.
        center: DVec3,
        /// 0 or more.
        radius: f64,
    },
    /// A parallelogram that shines both ways.
    Rectangle {
        /// Its middle.
        center: DVec3,
        /// From the middle to the middles of two neighbouring edges.
        halves: [DVec3; 2],
    },
}

impl Light {
    /// Writes the bytes of all that pictures depend on. `rank` tells a shape's place in the document.
    pub(super) fn write(&self, bytes: &mut Bytes, rank: impl Fn(ShapeId) -> u64) {
        let Self { source, intensity, falloff, samples: _, casts_shadows, own_shape } = self;
        source.write(bytes);
        bytes.colors([*intensity]);
        let Falloff { constant, linear, quadratic } =
            falloff.unwrap_or(Falloff { constant: 1.0, linear: 0.0, quadratic: 0.0 });
        [constant, linear, quadratic].into_iter().for_each(|number| bytes.number(number));
        bytes.count(self.places());
        bytes.count(*casts_shadows);
        bytes.count(own_shape.map_or(0, |shape| 1 + rank(shape)));
    }

    /// Returns how many of its places light a point: 1 unless it has a size.
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

    /// Returns whether it has a size.
    #[must_use]
    pub fn is_extended(&self) -> bool {
        matches!(self, Self::Sphere { .. } | Self::Rectangle { .. })
    }

    /// Returns around which point an extended light is, and how far from there its places are along each axis at most.
    pub(crate) fn extent(&self) -> Option<(DVec3, DVec3)> {
        /// 2^-40, more than rounding shifts places by.
        const ROUNDING: f64 = f64::from_bits((1023 - 40) << 52);
        let (center, reach) = match *self {
            Self::Point(_) | Self::Spot(..) | Self::Directional(_) => return None,
            Self::Sphere { center, radius } => (center, DVec3::splat(radius)),
            Self::Rectangle { center, halves: [right, up] } => (center, right.abs() + up.abs()),
        };
        Some((center, reach + (center.abs() + reach) * ROUNDING))
    }

    /// The place of an extended light that a point of the unit square stands for, as it is seen from `lit`.
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

/// Two unit vectors that are perpendicular to a third one and to each other.
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

/// Which way a spot light shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// The middle; of length 1.
    pub axis: DVec3,
    /// Cosine of the angle from the axis up to which all of the light is seen.
    pub inner: f64,
    /// Cosine of the angle from which on nothing is; not greater than `inner`.
    pub outer: f64,
}

impl Cone {
    /// What share of the light leaves in a direction with this cosine to the axis: 3 x^2 - 2 x^3 between the angles, where x
    /// goes with the cosine.
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
        let falloff = |constant, linear, quadratic| Falloff { constant, linear, quadratic };
        assert_eq!(falloff(1.0, 2.0, 3.0).at(2.0), 1.0 / 17.0);
        assert_eq!(falloff(0.5, 0.0, 0.0).at(f64::INFINITY), 2.0);
        assert_eq!(falloff(1.0, 1.0, 1.0).at(f64::MAX), 0.0);
        assert_eq!(falloff(1.0, 1.0, 1.0).at(0.0), 1.0);
    }
}
