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
        /// Occlusion of ambient light.
        AmbientOcclusion => ("ambient occlusion", EXTRA),
        /// Light that surfaces give off.
        Emission => ("emission", EXTRA),
        /// Diffuse reflection of lights.
        Diffuse => ("diffuse light", APART),
        /// Specular highlights of lights.
        Specular => ("highlights", EXTRA),
        /// Shadows of opaque objects.
        Shadows => ("shadows", APART),
        /// Shadows of transparent objects.
        TransparentShadows => ("transparent shadows", APART),
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
        /// Patterns of two colours.
        Patterns => ("patterns", EXTRA),
        /// Fog.
        Fog => ("fog", EXTRA),
        /// A gradient background.
        Gradient => ("gradient", APART),
        /// A sun in the sky.
        Sun => ("sun", APART),
        /// Stars in the sky.
        Stars => ("stars", APART),
        /// Shapes that some, but not all, classes of rays see.
        RayVisibility => ("ray visibility", APART),
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

/// A set of effects.
///
/// ```
/// use rayreel::{Effect, EffectSet};
///
/// let set: EffectSet = [Effect::Fog, Effect::Shadows].into();
/// assert!(set.contains(Effect::Fog) && !set.contains(Effect::Patterns));
/// assert_eq!(set.iter().collect::<Vec<_>>(), [Effect::Shadows, Effect::Fog]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct EffectSet(u32);

impl EffectSet {
    /// Returns whether the set contains an effect.
    #[must_use]
    pub fn contains(self, effect: Effect) -> bool {
        self.0 & (1 << effect as u32) != 0
    }

    /// Returns whether the set has no effect.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Returns the set with an effect added.
    #[must_use]
    pub fn with(self, effect: Effect) -> Self {
        Self(self.0 | (1 << effect as u32))
    }

    /// Returns the effects, in the order of [`Effect::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Effect> {
        Effect::ALL.into_iter().filter(move |effect| self.contains(*effect))
    }
}

impl FromIterator<Effect> for EffectSet {
    fn from_iter<I: IntoIterator<Item = Effect>>(effects: I) -> Self {
        effects.into_iter().fold(Self::default(), Self::with)
    }
}

impl<const COUNT: usize> From<[Effect; COUNT]> for EffectSet {
    fn from(effects: [Effect; COUNT]) -> Self {
        effects.into_iter().collect()
    }
}
