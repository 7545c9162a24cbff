//! The effects that a picture needs.
//!
//! The result of an effect does not depend on the other effects: with more effects than a scene needs, the picture is the same, bit for bit,
//! but takes longer to render.

/// The evaluation of light sources.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lighting {
    /// No light sources, only ambient light.
    None,
    /// Light sources without occlusion.
    Unshadowed,
    /// Shadows of opaque shapes.
    Shadows,
    /// Shadows of opaque and transparent shapes.
    TransparentShadows,
}

/// The secondary rays that follow camera rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Paths {
    /// No secondary rays.
    Straight,
    /// The reflected rays of mirrors.
    Mirrors,
    /// The rays of mirrors and of transparent media.
    Media,
}

/// The effects to compute. Stages that no effect needs are skipped; the others omit unneeded work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effects {
    /// The evaluation of light sources.
    pub lighting: Lighting,
    /// The secondary rays that follow camera rays.
    pub paths: Paths,
    /// The extras: emission, highlights, spot lights, falloff, area lights, ambient occlusion, patterns and fog.
    pub extras: bool,
}

impl Effects {
    /// All effects.
    pub const ALL: Self = Self { lighting: Lighting::TransparentShadows, paths: Paths::Media, extras: true };

    /// Returns the union of both sets of effects.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        Self {
            lighting: self.lighting.max(other.lighting),
            paths: self.paths.max(other.paths),
            extras: self.extras || other.extras,
        }
    }

    #[inline]
    pub(crate) fn lights(self) -> bool {
        self.lighting > Lighting::None
    }

    #[inline]
    pub(crate) fn shadows(self) -> bool {
        self.lighting > Lighting::Unshadowed
    }

    #[inline]
    pub(crate) fn transparent_shadows(self) -> bool {
        self.lighting == Lighting::TransparentShadows
    }

    #[inline]
    pub(crate) fn mirrors(self) -> bool {
        self.paths > Paths::Straight
    }

    #[inline]
    pub(crate) fn media(self) -> bool {
        self.paths == Paths::Media
    }

    /// Returns whether rays carry the list of the solids that they are inside.
    #[inline]
    pub(crate) fn in_media(self) -> bool {
        self.transparent_shadows() || self.media()
    }
}
