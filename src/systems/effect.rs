//! The effects: what a picture may show or not.

use std::fmt;

use crate::components::table;

/// A kernel has it together with all other extras, or none of them.
const EXTRA: bool = true;
/// Kernels have it or not by itself, or they do not know of it.
const APART: bool = false;

table! {
    /// Something that a picture may show or not.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Effect: (&'static str, bool) {
        /// Light from everywhere.
        Ambient => ("ambient light", APART),
        /// Light scattered by matt surfaces.
        Diffuse => ("diffuse light", APART),
        /// Highlights.
        Specular => ("highlights", EXTRA),
        /// Shadows of what is opaque.
        Shadows => ("shadows", APART),
        /// Shadows of what is clear.
        ClearShadows => ("clear shadows", APART),
        /// Lights with a size, and soft shadows.
        AreaLights => ("area lights", EXTRA),
        /// Lights that shine into a cone.
        SpotLights => ("spot lights", EXTRA),
        /// Lights that weaken with distance.
        Falloff => ("falloff", EXTRA),
        /// Mirrors.
        Reflection => ("reflection", APART),
        /// Clear media.
        Refraction => ("refraction", APART),
        /// Clear media that mirror as Fresnel's equations say.
        Fresnel => ("Fresnel", APART),
        /// Clear media that are tinted.
        Absorption => ("absorption", APART),
        /// Squares.
        Checker => ("checker", EXTRA),
        /// Fog.
        Fog => ("fog", EXTRA),
        /// A background that is not the same everywhere.
        Gradient => ("gradient", APART),
        /// Several samples in a pixel.
        Antialiasing => ("antialiasing", APART),
        /// A lens.
        DepthOfField => ("depth of field", APART),
        /// Several instants in a frame.
        MotionBlur => ("motion blur", APART),
    }
}

impl Effect {
    /// Its name in words.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().1.0
    }

    /// Is it one of the extras, of which a kernel has all or none?
    pub(super) fn is_extra(self) -> bool {
        self.row().1.1
    }
}

impl fmt::Display for Effect {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}
