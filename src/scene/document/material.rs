//! Materials.

use serde::Deserialize;

use super::{ColorDocument, Triple};

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
    pub(crate) emission: Option<Triple>,
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
