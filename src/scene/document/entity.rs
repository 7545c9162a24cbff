//! Materials and entities.

use serde::Deserialize;

use super::{ColorDocument, ScaleDocument, Triple, whole};
use crate::components::AreaShape;

/// The response of a surface to light.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Material")]
pub(crate) struct MaterialDocument {
    pub(crate) k_a: Option<f64>,
    pub(crate) k_d: Option<f64>,
    pub(crate) color: Option<ColorDocument>,
    pub(crate) ambient_color: Option<ColorDocument>,
    pub(crate) specular: Option<SpecularDocument>,
    pub(crate) reflective: Option<ReflectiveDocument>,
    pub(crate) refractive: Option<RefractiveDocument>,
    pub(crate) checker: Option<CheckerDocument>,
}

impl MaterialDocument {
    /// Returns whether it is matte without coefficients: it has a colour, which the surface would not show otherwise, and is not
    /// transparent.
    pub(crate) fn is_matte_by_default(&self) -> bool {
        let is_colored = self.color.is_some() || self.ambient_color.is_some() || self.checker.is_some();
        is_colored && self.k_a.is_none() && self.k_d.is_none() && self.refractive.is_none()
    }
}

/// Specular highlights.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Specular")]
pub(crate) struct SpecularDocument {
    pub(crate) k_s: f64,
    pub(crate) shininess: f64,
}

/// Mirror reflection.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Reflective")]
pub(crate) struct ReflectiveDocument {
    pub(crate) k_r: f64,
}

/// Refraction and absorption.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Refractive")]
pub(crate) struct RefractiveDocument {
    pub(crate) k_t: f64,
    pub(crate) ior: f64,
    #[serde(default)]
    pub(crate) absorption: Triple,
    #[serde(default)]
    pub(crate) fresnel: bool,
}

/// A checkerboard pattern.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Checker")]
pub(crate) struct CheckerDocument {
    pub(crate) color: ColorDocument,
    pub(crate) size: f64,
}

/// An entity of the scene.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Entity")]
pub(crate) struct EntityDocument {
    pub(crate) name: Option<String>,
    pub(crate) parent: Option<String>,
    #[serde(default)]
    pub(crate) transform: TransformDocument,
    pub(crate) shape: Option<ShapeDocument>,
    pub(crate) material: Option<String>,
    /// Boxed because it is large and few entities have one.
    pub(crate) light: Option<Box<LightDocument>>,
    /// Boxed because few entities have one.
    pub(crate) target: Option<Box<Triple>>,
    pub(crate) look_at: Option<String>,
}

/// The placement of an entity.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default, rename = "Transform")]
pub(crate) struct TransformDocument {
    pub(crate) translation: Triple,
    pub(crate) rotation: RotationDocument,
    pub(crate) scale: ScaleDocument,
}

impl Default for TransformDocument {
    fn default() -> Self {
        Self {
            translation: [0.0; 3],
            rotation: RotationDocument::Euler(0.0, 0.0, 0.0),
            scale: ScaleDocument::Uniform(1.0),
        }
    }
}

/// A rotation, with angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename = "Rotation")]
pub(crate) enum RotationDocument {
    Euler(f64, f64, f64),
    AxisAngle(Triple, f64),
    Quat(f64, f64, f64, f64),
}

/// The visible shape of an entity.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Shape")]
pub(crate) enum ShapeDocument {
    Sphere { radius: f64 },
    Plane { normal: Triple },
    Box { size: Triple },
}

/// The light source of an entity.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Light")]
pub(crate) enum LightDocument {
    Point {
        intensity: Triple,
        #[serde(default = "yes")]
        casts_shadows: bool,
        falloff: Option<Triple>,
    },
    Spot {
        intensity: Triple,
        angle: f64,
        #[serde(default)]
        softness: f64,
        #[serde(default = "yes")]
        casts_shadows: bool,
        falloff: Option<Triple>,
    },
    Directional {
        intensity: Triple,
        #[serde(default = "forward")]
        direction: Triple,
        #[serde(default = "yes")]
        casts_shadows: bool,
        /// Parsed only so that validation can reject it with a reason.
        falloff: Option<Triple>,
    },
    Area {
        shape: AreaShapeDocument,
        intensity: Triple,
        #[serde(default = "default_samples", deserialize_with = "whole")]
        samples: u64,
        #[serde(default = "yes")]
        casts_shadows: bool,
        falloff: Option<Triple>,
    },
}

/// The shape of an area light.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "AreaShape")]
pub(crate) enum AreaShapeDocument {
    Sphere { radius: f64 },
    Rectangle { width: f64, height: f64 },
}

fn default_samples() -> u64 {
    AreaShape::DEFAULT_SAMPLES.into()
}

fn yes() -> bool {
    true
}

fn forward() -> Triple {
    [0.0, 0.0, 1.0]
}
