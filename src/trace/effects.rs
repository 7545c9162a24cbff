//! Which effects a picture calls for.
//!
//! What an effect computes does not depend on which others there are: more of them than a scene calls for make the same picture, bit
//! for bit, only more slowly.

/// What is asked of lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lighting {
    /// Nothing: there is only ambient light.
    None,
    /// Light that nothing stands in the way of.
    Unshadowed,
    /// Shadows of what is opaque.
    Shadows,
    /// Shadows of what is opaque or clear.
    ClearShadows,
}

/// Which rays follow camera rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Paths {
    /// None.
    Straight,
    /// Those of mirrors.
    Mirrors,
    /// Those of mirrors and of clear media.
    Media,
}

/// The effects to compute. A stage that none of them needs is not entered; the others skip what is not needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effects {
    /// What is asked of lights.
    pub lighting: Lighting,
    /// Which rays follow camera rays.
    pub paths: Paths,
    /// The extras: highlights, spot lights, falloff, area lights, checkers and fog.
    pub extras: bool,
}

impl Effects {
    /// Everything.
    pub const ALL: Self = Self { lighting: Lighting::ClearShadows, paths: Paths::Media, extras: true };

    /// Returns the effects of both.
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
    pub(crate) fn clear_shadows(self) -> bool {
        self.lighting == Lighting::ClearShadows
    }

    #[inline]
    pub(crate) fn mirrors(self) -> bool {
        self.paths > Paths::Straight
    }

    #[inline]
    pub(crate) fn media(self) -> bool {
        self.paths == Paths::Media
    }

    /// Returns whether rays carry the solids that they are inside of.
    #[inline]
    pub(crate) fn in_media(self) -> bool {
        self.clear_shadows() || self.media()
    }
}
