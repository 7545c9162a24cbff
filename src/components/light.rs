//! Light sources.

use glam::DVec3;

use crate::color::Rgb;

/// A light source. Its intensity does not decrease with distance unless it has a falloff.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// The position or direction of the light.
    pub kind: LightKind,
    /// The RGB intensity, each channel 0 or more; 1 gives full brightness on a white, fully diffuse surface that faces the light.
    pub intensity: Rgb,
    /// True if objects occlude the light. A light without shadows reaches every surface that faces it and needs no shadow rays.
    pub casts_shadows: bool,
    /// The falloff with distance, if any; ignored for directional lights, which are at infinity.
    pub falloff: Option<Falloff>,
}

/// The attenuation of a light with distance. At distance d, in world units, the intensity is multiplied by 1 / (c0 + c1 d + c2 d^2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Falloff {
    /// c0, greater than 0.
    pub constant: f64,
    /// c1, 0 or more.
    pub linear: f64,
    /// c2, 0 or more.
    pub quadratic: f64,
}

impl Light {
    /// Creates a light that casts shadows and has no falloff.
    #[must_use]
    pub const fn new(kind: LightKind, intensity: Rgb) -> Self {
        Self { kind, intensity, casts_shadows: true, falloff: None }
    }

    /// Creates a [point light](LightKind::Point).
    ///
    /// ```
    /// use rayreel::components::{Light, Transform};
    /// use rayreel::{Rgb, World};
    /// let mut world = World::new();
    /// world.spawn((Light::point(Rgb::splat(0.8)), Transform::at(-4.0, 6.0, -4.0)));
    /// let fill = Light { casts_shadows: false, ..Light::point(Rgb::splat(0.2)) };
    /// world.spawn((fill, Transform::at(4.0, 3.0, -4.0)));
    /// ```
    #[must_use]
    pub const fn point(intensity: Rgb) -> Self {
        Self::new(LightKind::Point, intensity)
    }

    /// Creates a [spot light](LightKind::Spot). `angle` is the full angle of its cone in radians, greater than 0, at most pi. `softness`,
    /// 0..=1, is the fraction of the angle between rim and axis over which the light fades.
    ///
    /// ```
    /// use glam::DVec3;
    /// use rayreel::components::{Light, Transform};
    /// use rayreel::{Rgb, World};
    /// let lamp = Light::spot(40_f64.to_radians(), 0.2, Rgb::ONE);
    /// World::new().spawn((lamp, Transform::at(0.0, 5.0, -2.0).looking_at(DVec3::ZERO)));
    /// ```
    #[must_use]
    pub const fn spot(angle: f64, softness: f64, intensity: Rgb) -> Self {
        Self::new(LightKind::Spot { angle, softness }, intensity)
    }

    /// Creates a [directional light](LightKind::Directional), such as the sun, that travels in a direction of any nonzero length.
    #[must_use]
    pub const fn directional(direction: DVec3, intensity: Rgb) -> Self {
        Self::new(LightKind::Directional { direction }, intensity)
    }

    /// Creates an [area light](LightKind::Area) with [`AreaShape::DEFAULT_SAMPLES`] sample points.
    #[must_use]
    pub const fn area(shape: AreaShape, intensity: Rgb) -> Self {
        Self::new(LightKind::Area { shape, samples: AreaShape::DEFAULT_SAMPLES }, intensity)
    }
}

/// The kind of a light source, with its position or direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// A point light: it shines from the entity's position in all directions.
    Point,
    /// A spot light: it shines from the entity's position, in a cone about the entity's own +z axis as rotated by the world transform.
    ///
    /// Let h be half the angle, and c the cosine between the axis and the direction of the emitted light. Then x is (c - cos h) / (cos((1 -
    /// softness) h) - cos h), clamped to 0..=1, and the intensity is multiplied by 3 x^2 - 2 x^3. The light has its full intensity up to an
    /// angle of (1 - softness) h from the axis, and none at h or more, except that the rim itself is lit if the softness is 0.
    Spot {
        /// The full angle of the cone in radians, greater than 0, at most pi.
        angle: f64,
        /// The fraction of the angle between rim and axis over which the light fades, 0..=1.
        softness: f64,
    },
    /// A directional light: parallel light from infinity.
    Directional {
        /// The direction in which the light travels, in the entity's own space. Any nonzero length.
        direction: DVec3,
    },
    /// An area light: it shines from a surface around the entity's position and casts soft shadows. The surface itself is not visible.
    ///
    /// Every lit point receives the mean of the light from several sample points on the surface, each of which acts as a point light. The
    /// size of the surface does not change the intensity.
    Area {
        /// The surface.
        shape: AreaShape,
        /// The number of sample points on the surface per lit point, 1..=[`AreaShape::LARGEST_SAMPLES`].
        samples: u32,
    },
}

/// The shape of an area light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AreaShape {
    /// A sphere about the entity's position, sampled as the disc that faces the lit point.
    Sphere {
        /// The radius in scene units, > 0. The world transform scales it by the cube root of its volume scale factor.
        radius: f64,
    },
    /// A rectangle about the entity's position, in the entity's own xy-plane, that emits light from both sides. The world transform scales
    /// and rotates it.
    Rectangle {
        /// The length along the own x axis, > 0.
        width: f64,
        /// The length along the own y axis, > 0.
        height: f64,
    },
}

impl AreaShape {
    /// The default number of sample points of an area light per lit point, for soft shadows.
    pub const DEFAULT_SAMPLES: u32 = 16;
    /// The maximum number of sample points of an area light per lit point.
    pub const LARGEST_SAMPLES: u32 = 4096;
}
