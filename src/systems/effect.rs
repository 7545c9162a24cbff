//! Rendering effects.

use std::fmt;

use crate::components::table;

/// Chosen together with all other extras.
const EXTRA: bool = true;
/// Chosen by itself, or follows from the data.
const APART: bool = false;

table! {
    /// A rendering effect that a picture may or may not need.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Effect: (&'static str, bool) {
        /// Light from everywhere.
        Ambient => ("ambient light", APART),
        /// Light scattered by matt surfaces.
        Diffuse => ("diffuse light", APART),
        /// Highlights.
        Specular => ("highlights", EXTRA),
        /// Shadows of opaque objects.
        Shadows => ("shadows", APART),
        /// Shadows of transparent objects.
        ClearShadows => ("clear shadows", APART),
        /// Lights with a size, and soft shadows.
        AreaLights => ("area lights", EXTRA),
        /// Lights that shine in a cone.
        SpotLights => ("spot lights", EXTRA),
        /// Lights that weaken with distance.
        Falloff => ("falloff", EXTRA),
        /// Mirror reflection.
        Reflection => ("reflection", APART),
        /// Transparent media.
        Refraction => ("refraction", APART),
        /// Transparent media that reflect according to Fresnel's equations.
        Fresnel => ("Fresnel", APART),
        /// Tinted transparent media.
        Absorption => ("absorption", APART),
        /// Checker patterns.
        Checker => ("checker", EXTRA),
        /// Fog.
        Fog => ("fog", EXTRA),
        /// A background that is not the same everywhere.
        Gradient => ("gradient", APART),
        /// Several samples per pixel.
        Antialiasing => ("antialiasing", APART),
        /// A lens.
        DepthOfField => ("depth of field", APART),
        /// Several instants per frame.
        MotionBlur => ("motion blur", APART),
    }
}

impl Effect {
    /// Returns its name in words.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().1.0
    }

    /// Returns whether it is one of the extras, which are chosen all together or not at all.
    pub(super) fn is_extra(self) -> bool {
        self.row().1.1
    }
}

impl fmt::Display for Effect {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}
