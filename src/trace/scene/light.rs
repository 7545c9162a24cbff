//! Lights in the kernel's representation.

use glam::DVec3;

use crate::color::Rgb;
use crate::trace::math::{Bytes, Real, add, dot, on_disc, pick3, scaled, spread, times};
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
    /// Number of sample points that light a point; 1 unless it is an area light or a dome.
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
    #[inline(always)]
    pub(crate) fn at<R: Real>(&self, distance: R) -> R {
        // A finite distance times a zero coefficient is zero.
        let farthest = distance.of(f64::MAX);
        let distance = distance.if_less(farthest, distance, farthest);
        distance.of(1.0) / (distance * (distance * self.quadratic + self.linear) + self.constant)
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
    /// A half sphere about each lit point, in front of its surface: ambient light. Directions are weighted by their cosine to the normal.
    Dome {
        /// The radius, greater than 0: shapes farther away do not occlude the light.
        radius: f64,
    },
}

/// The occlusion of ambient light by near shapes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreparedAmbientOcclusion {
    /// Number of directions that are tested per point, 1 or more.
    pub samples: u32,
    /// The distance up to which shapes occlude, greater than 0.
    pub distance: f64,
}

impl PreparedAmbientOcclusion {
    /// Returns ambient light of an intensity as a light source.
    pub(super) fn dome(self, intensity: Rgb) -> PreparedLight {
        PreparedLight {
            source: LightSource::Dome { radius: self.distance },
            intensity,
            falloff: None,
            samples: self.samples,
            casts_shadows: true,
            own_shape: None,
        }
    }
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
        bytes.count(self.sample_count());
        bytes.count(*casts_shadows);
        bytes.count(own_shape.map_or(0, |shape| 1 + rank(shape)));
    }

    /// Returns the number of sample points that light a point: 1 unless it is an area light or a dome.
    pub(crate) fn sample_count(&self) -> u32 {
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
            Self::Dome { radius } => {
                bytes.count(5_u32);
                bytes.number(radius);
            }
        }
    }

    /// Returns whether it lights a point from many directions: an area light or a dome.
    #[must_use]
    pub fn is_extended(&self) -> bool {
        matches!(self, Self::Sphere { .. } | Self::Rectangle { .. } | Self::Dome { .. })
    }

    /// Returns the centre of an area light, and upper bounds of its half-extents.
    pub(crate) fn extent(&self) -> Option<(DVec3, DVec3)> {
        /// 2^-40, more than rounding shifts points by.
        const ROUNDING: f64 = f64::from_bits((1023 - 40) << 52);
        let (center, reach) = match *self {
            Self::Point(_) | Self::Spot(..) | Self::Directional(_) | Self::Dome { .. } => return None,
            Self::Sphere { center, radius } => (center, DVec3::splat(radius)),
            Self::Rectangle { center, halves: [right, up] } => (center, right.abs() + up.abs()),
        };
        Some((center, reach + (center.abs() + reach) * ROUNDING))
    }

    /// Returns the point of an area light that corresponds to a point of the unit square, as seen from `lit`; for a dome, `lit` itself.
    pub(crate) fn place(&self, lit: DVec3, square: [f64; 2]) -> DVec3 {
        match *self {
            Self::Point(place) | Self::Spot(place, _) | Self::Directional(place) => place,
            Self::Sphere { center, radius } => {
                let Some((towards, _)) = scaled(center - lit) else {
                    return center;
                };
                on_sphere(center, radius, towards.into(), square).into()
            }
            Self::Rectangle { center, halves } => on_rectangle(center, halves, square).into(),
            Self::Dome { .. } => lit,
        }
    }
}

/// Returns the points of the disc of a sphere that faces points in the direction `towards`, of any length except zero, from them.
#[inline(always)]
pub(crate) fn on_sphere<R: Real>(center: DVec3, radius: f64, towards: [R; 3], square: [R; 2]) -> [R; 3] {
    let [x, y] = on_disc(square);
    let (right, up) = across(normalized(towards));
    add(add(spread(x, center), times(right, x * radius)), times(up, y * radius))
}

/// Returns the points of a parallelogram, given by the vectors from its centre to the midpoints of two adjacent edges.
#[inline(always)]
pub(crate) fn on_rectangle<R: Real>(center: DVec3, [right, up]: [DVec3; 2], [x, y]: [R; 2]) -> [R; 3] {
    let place = add(spread(x, center), times(spread(x, right), x * 2.0 - 1.0));
    add(place, times(spread(x, up), y * 2.0 - 1.0))
}

/// Returns unit vectors on the side of unit normals, whose density is the cosine to the normal: the points of the unit disc across the
/// normal, raised to the half sphere (Malley's method).
#[inline(always)]
pub(crate) fn on_dome<R: Real>(normals: [R; 3], square: [R; 2]) -> [R; 3] {
    let [x, y] = on_disc(square);
    let height = x.of(1.0) - x * x - y * y;
    // Rounding can put points of the rim outside the disc.
    let height = R::pick(height.greater(x.of(0.0)), height, x.of(0.0)).sqrt();
    let (right, up) = across(normals);
    add(add(times(right, x), times(up, y)), times(normals, height))
}

#[inline(always)]
fn normalized<R: Real>(vector: [R; 3]) -> [R; 3] {
    times(vector, vector[0].of(1.0) / dot(vector, vector).sqrt())
}

#[inline(always)]
fn cross<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]]
}

/// Returns two unit vectors that are perpendicular to a third one and to each other.
#[inline(always)]
fn across<R: Real>(forward: [R; 3]) -> ([R; 3], [R; 3]) {
    let [x, y, z] = [forward[0].abs(), forward[1].abs(), forward[2].abs()];
    let (along_x, along_y) = (x.less_or_equal(y) & x.less_or_equal(z), y.less_or_equal(z));
    let other = pick3(along_y, spread(x, DVec3::Y), spread(x, DVec3::Z));
    let right = normalized(cross(pick3(along_x, spread(x, DVec3::X), other), forward));
    (right, cross(forward, right))
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
    #[inline(always)]
    pub(crate) fn at<R: Real>(&self, cosine: R) -> R {
        let x = (cosine - self.outer) / cosine.of(self.inner - self.outer);
        let between = x * x * (x.of(3.0) - x * 2.0);
        let outside = R::pick(cosine.greater(x.of(self.outer)), between, x.of(0.0));
        R::pick(x.of(self.inner).less_or_equal(cosine), x.of(1.0), outside)
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
