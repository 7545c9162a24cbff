//! Materials.

use serde::Deserialize;

use super::{ColorDocument, Triple, whole};

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
    #[serde(default)]
    pub(crate) metallic: bool,
    pub(crate) pattern: Option<PatternDocument>,
    pub(crate) emission: Option<Triple>,
}

impl MaterialDocument {
    /// Returns whether it is matte without coefficients: it has a colour, which the surface would not show otherwise, and is neither
    /// transparent nor a metal.
    pub(crate) fn is_matte_by_default(&self) -> bool {
        let is_colored = self.color.is_some() || self.ambient_color.is_some() || self.pattern.is_some();
        let is_other = self.refractive.is_some() || self.metallic;
        is_colored && self.k_a.is_none() && self.k_d.is_none() && !is_other
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

/// A pattern of two colours.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Pattern")]
pub(crate) enum PatternDocument {
    Checker {
        color: ColorDocument,
        size: f64,
    },
    Stripes {
        color: ColorDocument,
        size: f64,
        #[serde(default = "half")]
        ratio: f64,
        #[serde(default = "x_axis")]
        direction: Triple,
        #[serde(default)]
        offset: f64,
    },
    Bricks {
        color: ColorDocument,
        size: Triple,
        mortar: f64,
    },
    Gradient {
        color: ColorDocument,
        size: f64,
        #[serde(default = "y_axis")]
        direction: Triple,
        #[serde(default)]
        offset: f64,
    },
    Noise {
        color: ColorDocument,
        size: f64,
        #[serde(default = "four", deserialize_with = "whole")]
        octaves: u64,
        #[serde(default = "one")]
        contrast: f64,
    },
}

fn half() -> f64 {
    0.5
}

fn x_axis() -> Triple {
    [1.0, 0.0, 0.0]
}

fn y_axis() -> Triple {
    [0.0, 1.0, 0.0]
}

fn one() -> f64 {
    1.0
}

fn four() -> u64 {
    4
}
