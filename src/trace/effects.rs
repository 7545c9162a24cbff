//! Which effects a kernel has compiled in.
//!
//! Every combination of [`Lighting`], [`Paths`] and extras is a kernel of its own, in which the code of what is left
//! out does not exist. What an effect computes does not depend on which others there are: a kernel that has more than a
//! scene calls for makes the same picture, bit for bit.

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

/// A kernel, by what it has compiled in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KernelChoice {
    /// What is asked of lights.
    pub lighting: Lighting,
    /// Which rays follow camera rays.
    pub paths: Paths,
    /// Highlights, lights into cones, lights that weaken with distance, lights with a size, squares and fog.
    pub extras: bool,
}

impl KernelChoice {
    /// Everything.
    pub const FULL: Self = Self { lighting: Lighting::ClearShadows, paths: Paths::Media, extras: true };
}

/// What a kernel has compiled in.
pub(crate) trait Effects {
    const LIGHTS: bool;
    const SHADOWS: bool;
    const CLEAR_SHADOWS: bool;
    const MIRRORS: bool;
    const MEDIA: bool;
    const EXTRAS: bool;
    /// Whether rays carry the solids that they are inside of.
    const IN_MEDIA: bool = Self::CLEAR_SHADOWS || Self::MEDIA;
}

/// A kernel by its numbers: how much of [`Lighting`], how much of [`Paths`], and the extras or not.
pub(crate) struct Kernel<const LIGHTING: u8, const PATHS: u8, const EXTRAS: bool>;

/// The kernel with everything in it.
pub(crate) type FullKernel = Kernel<3, 2, true>;

impl<const LIGHTING: u8, const PATHS: u8, const EXTRAS: bool> Effects for Kernel<LIGHTING, PATHS, EXTRAS> {
    const LIGHTS: bool = LIGHTING > 0;
    const SHADOWS: bool = LIGHTING > 1;
    const CLEAR_SHADOWS: bool = LIGHTING > 2;
    const MIRRORS: bool = PATHS > 0;
    const MEDIA: bool = PATHS > 1;
    const EXTRAS: bool = EXTRAS;
}

/// Evaluates an expression with `$kernel` as the type of the chosen kernel.
macro_rules! with_kernel {
    ($choice:expr, $kernel:ident => $work:expr) => {{
        use $crate::trace::effects::{Kernel, Lighting, Paths};
        macro_rules! paths {
            ($lighting:literal) => {
                match ($choice.paths, $choice.extras) {
                    (Paths::Straight, false) => with_kernel!(@ Kernel<$lighting, 0, false>, $kernel, $work),
                    (Paths::Straight, true) => with_kernel!(@ Kernel<$lighting, 0, true>, $kernel, $work),
                    (Paths::Mirrors, false) => with_kernel!(@ Kernel<$lighting, 1, false>, $kernel, $work),
                    (Paths::Mirrors, true) => with_kernel!(@ Kernel<$lighting, 1, true>, $kernel, $work),
                    (Paths::Media, false) => with_kernel!(@ Kernel<$lighting, 2, false>, $kernel, $work),
                    (Paths::Media, true) => with_kernel!(@ Kernel<$lighting, 2, true>, $kernel, $work),
                }
            };
        }
        match $choice.lighting {
            Lighting::None => paths!(0),
            Lighting::Unshadowed => paths!(1),
            Lighting::Shadows => paths!(2),
            Lighting::ClearShadows => paths!(3),
        }
    }};
    (@ $type:ty, $kernel:ident, $work:expr) => {{
        type $kernel = $type;
        $work
    }};
}

pub(crate) use with_kernel;
