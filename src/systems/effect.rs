//! Rendering effects.

use std::fmt;

use crate::components::table;

/// Enabled together with all other extras.
const EXTRA: bool = true;
/// Enabled separately, or derived from the data.
const APART: bool = false;

table! {
    /// A rendering effect that a frame may or may not need.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Effect: (&'static str, bool) {
        /// Ambient light.
        Ambient => ("ambient light", APART),
        /// Diffuse reflection of lights.
        Diffuse => ("diffuse light", APART),
        /// Specular highlights of lights.
        Specular => ("highlights", EXTRA),
        /// Shadows of opaque objects.
        Shadows => ("shadows", APART),
        /// Shadows of transparent objects.
        ClearShadows => ("clear shadows", APART),
        /// Area lights with soft shadows.
        AreaLights => ("area lights", EXTRA),
        /// Spot lights.
        SpotLights => ("spot lights", EXTRA),
        /// Lights with a falloff.
        Falloff => ("falloff", EXTRA),
        /// Mirror reflection.
        Reflection => ("reflection", APART),
        /// Refraction by transparent media.
        Refraction => ("refraction", APART),
        /// Fresnel reflectance of transparent media.
        Fresnel => ("Fresnel", APART),
        /// Absorption in transparent media.
        Absorption => ("absorption", APART),
        /// Checker patterns.
        Checker => ("checker", EXTRA),
        /// Fog.
        Fog => ("fog", EXTRA),
        /// A gradient background.
        Gradient => ("gradient", APART),
        /// Several samples per pixel.
        Antialiasing => ("antialiasing", APART),
        /// The depth of field of a lens.
        DepthOfField => ("depth of field", APART),
        /// Several instants per frame.
        MotionBlur => ("motion blur", APART),
    }
}

impl Effect {
    /// Returns the name of the effect in words.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().1.0
    }

    /// Returns whether the effect is an extra. Extras are enabled all together or not at all.
    pub(super) fn is_extra(self) -> bool {
        self.row().1.1
    }
}

impl fmt::Display for Effect {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}
