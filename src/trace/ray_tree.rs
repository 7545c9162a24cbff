//! The rays of one sample of a pixel, with all that is needed to explain its colour.

use glam::DVec3;

use crate::color::Rgb;
use crate::trace::intersect::SurfacePoint;
use crate::trace::rays::{PreparedRay, ShapeId};
use crate::trace::scene::{Attenuation, BackgroundTerms, PassageTerms};
use crate::trace::shading::{LightTerms, SecondaryTerms, Unlit, clamped};

/// All rays of one sample of a pixel, breadth first.
#[derive(Clone, Debug, PartialEq)]
pub struct RayTree {
    /// The rays: the camera ray is the first, and every ray comes after its parent.
    pub rays: Vec<TracedRay>,
}

/// A ray of a ray tree.
#[derive(Clone, Debug, PartialEq)]
pub struct TracedRay {
    /// The kind of the ray.
    pub kind: RayKind,
    /// Index of the parent, from whose hit this ray continues; `None` for a camera ray.
    pub parent: Option<usize>,
    /// The ray.
    pub ray: PreparedRay,
    /// The share of the radiance along the ray that reaches the pixel, before the mean over samples is taken.
    pub throughput: Rgb,
    /// The transparent solids that the ray is inside, the last entered first.
    pub inside: Vec<ShapeId>,
    /// The transmittance along the ray, and the light added on the way.
    pub passage: Attenuation,
    /// The medium along the ray.
    pub medium: PassageTerms,
    /// The end of the ray.
    pub end: RayEnd,
    /// The number of secondary rays that are cut because their contribution is negligible.
    pub cut: u64,
}

impl SecondaryTerms {
    /// Returns the share of the light of a secondary ray.
    #[must_use]
    pub fn share(&self, kind: RayKind) -> f32 {
        match kind {
            RayKind::Camera => 1.0,
            RayKind::Reflection => self.reflected,
            RayKind::Refraction => self.refraction.map_or(0.0, |refraction| refraction.share),
        }
    }

    /// Returns the part of the light of a secondary ray that the surface sends back.
    #[must_use]
    pub fn part(&self, kind: RayKind, light: Rgb) -> Rgb {
        let tint = self.tint.filter(|_| kind == RayKind::Reflection).unwrap_or(Rgb::ONE);
        light * self.share(kind) * tint
    }
}

/// The kind of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// A camera ray.
    Camera,
    /// A reflected ray, from a mirror or by total internal reflection.
    Reflection,
    /// A ray refracted at the surface of a transparent medium.
    Refraction,
}

/// The end of a ray.
#[derive(Clone, Debug, PartialEq)]
pub enum RayEnd {
    /// No hit: the background.
    Background(Box<BackgroundTerms>),
    /// Not traced, as it is beyond the last bounce or the maximum number of rays: the background.
    BeyondDepth(Box<BackgroundTerms>),
    /// A surface.
    Surface(Box<LitSurface>),
}

/// A surface point and its illumination.
#[derive(Clone, Debug, PartialEq)]
pub struct LitSurface {
    /// The point.
    pub surface: SurfacePoint,
    /// The other shapes at the point, in document order.
    pub coincident: Vec<ShapeId>,
    /// Ambient light scattered back along the ray.
    pub ambient: Rgb,
    /// The samples of ambient light, if it can be occluded.
    pub ambient_samples: Vec<TracedLightSample>,
    /// Light that the surface gives off.
    pub emission: Rgb,
    /// The result of every light of the scene, in document order.
    pub lights: Vec<LightReach>,
    /// The samples of all lights that are not [`Unlit`], light by light.
    pub samples: Vec<TracedLightSample>,
    /// The values of which the light of the surface and of its secondary rays consists.
    pub terms: SurfaceTerms,
}

/// The values of a surface's textbook sum at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceTerms {
    /// The fraction of the pattern's colour, 0 to 1; 0 without a pattern.
    pub pattern: f32,
    /// k_a c, the ambient coefficient times the colour in ambient light.
    pub ambient_color: Rgb,
    /// I_a, the intensity of the ambient light.
    pub ambient_light: Rgb,
    /// k_d c, the diffuse coefficient times the colour.
    pub diffuse_color: Rgb,
    /// k_s, the specular coefficient; 0 without highlights.
    pub specular: f32,
    /// The exponent of N.H.
    pub shininess: f32,
    /// The shares of the reflected and the refracted light.
    pub secondary: SecondaryTerms,
}

/// A sample of a light at a surface point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracedLightSample {
    /// Index of the light in the scene.
    pub light: usize,
    /// Index of the sample; 0 unless the light is an area light.
    pub sample: u32,
    /// The terms of the unoccluded contribution.
    pub terms: LightTerms,
    /// V, the share of the light that is not occluded.
    pub visibility: Rgb,
    /// The first shape in document order that occludes the light.
    pub occluder: Option<ShapeId>,
}

impl TracedLightSample {
    /// Returns the contribution of the sample, before the mean over the light's samples is taken.
    #[must_use]
    pub fn contribution(&self) -> Rgb {
        self.terms.contribution() * self.visibility
    }
}

/// The result of a light at a surface point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightReach {
    /// The light cannot contribute, and no shadow ray is traced. Holds the reason, for an area light that of its last sample.
    NoShadowRay(Unlit),
    /// Nothing of the light arrives, and shadow rays are occluded. Holds the first shape in document order that occludes the first occluded
    /// shadow ray.
    Occluded(ShapeId),
    /// Nothing of the light arrives: the transparent shapes on the way transmit none of it.
    Absorbed,
    /// The light is scattered back along the ray.
    Reaches {
        /// The mean over the light's samples.
        color: Rgb,
        /// The number of occluded samples.
        occluded: u32,
    },
}

impl LitSurface {
    /// Returns V_a, the share of ambient light that is not occluded; `None` if none can be occluded.
    #[must_use]
    pub fn ambient_visibility(&self) -> Option<Rgb> {
        let sum: DVec3 = self.ambient_samples.iter().map(|sample| sample.visibility.as_dvec3()).sum();
        let count = self.ambient_samples.len();
        (count > 0).then(|| (sum / count as f64).as_vec3())
    }
}

impl LightReach {
    /// Returns the light that is scattered back along the ray.
    #[must_use]
    pub fn color(&self) -> Rgb {
        match self {
            Self::Reaches { color, .. } => *color,
            Self::NoShadowRay(_) | Self::Occluded(_) | Self::Absorbed => Rgb::ZERO,
        }
    }
}

impl RayTree {
    /// Returns the sample's colour: the sum of the contributions of all rays, in order.
    #[must_use]
    pub fn color(&self) -> Rgb {
        self.rays.iter().fold(Rgb::ZERO, |sum, traced| sum + traced.contribution())
    }

    /// Returns the light that each ray brings back to its origin, by the recursion of the textbooks: the light of its end and the shares of
    /// the light of its secondary rays, after attenuation along the ray. Rounding distinguishes the first from [`RayTree::color`].
    #[must_use]
    pub fn returned(&self) -> Vec<Rgb> {
        let mut returned: Vec<Rgb> = self.rays.iter().map(|traced| traced.end.light()).collect();
        for (index, traced) in self.rays.iter().enumerate().rev() {
            let light = traced.passage.of(returned[index]);
            returned[index] = light;
            let Some(parent) = traced.parent else { continue };
            if let RayEnd::Surface(lit) = &self.rays[parent].end {
                let sum = returned[parent] + lit.terms.secondary.part(traced.kind, light);
                returned[parent] = clamped(sum);
            }
        }
        returned
    }

    /// Returns whether the scene covers the pixel in this sample: the camera ray does not see the unattenuated background.
    #[must_use]
    pub fn is_covered(&self) -> bool {
        let sees_background = |traced: &TracedRay| {
            traced.passage == Attenuation::CLEAR && matches!(traced.end, RayEnd::Background(_))
        };
        !self.rays.first().is_some_and(sees_background)
    }
}

impl TracedRay {
    /// Returns the ray's contribution to the sample.
    #[must_use]
    pub fn contribution(&self) -> Rgb {
        self.throughput * self.passage.of(self.end.light())
    }

    /// Returns the surface at the end of the ray, if there is one.
    #[must_use]
    pub fn surface(&self) -> Option<&LitSurface> {
        match &self.end {
            RayEnd::Surface(lit) => Some(lit),
            RayEnd::Background(_) | RayEnd::BeyondDepth(_) => None,
        }
    }
}

impl RayEnd {
    /// Returns the radiance from the end of the ray towards its origin.
    #[must_use]
    pub fn light(&self) -> Rgb {
        match self {
            Self::Background(terms) | Self::BeyondDepth(terms) => terms.color,
            Self::Surface(lit) => {
                clamped(lit.lights.iter().fold(lit.ambient + lit.emission, |sum, reach| sum + reach.color()))
            }
        }
    }
}
