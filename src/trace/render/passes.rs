//! Passes: depth, normal, position and other values at the closest hit of the ray through each pixel's centre, for compositing in other
//! programs.
//!
//! The closest hits are those that pictures use, at the scene's precision; values are rounded to the `f32` of a file. Passes are never means:
//! there is no shape between two others, and no depth without a surface. Neither a lens nor an open shutter therefore blurs them.

use std::fmt;
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use crate::color::Rgb;
use crate::trace::intersect::{Naive, Scratch};
use crate::trace::render::film::Film;
use crate::trace::scene::{PreparedCamera, PreparedScene};

/// A value of each pixel besides its radiance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Pass {
    /// Distance from the eye along the camera's view axis, in scene units: constant on a wall perpendicular to the view. Infinite in the
    /// background.
    Depth,
    /// Distance from the eye along the ray, in scene units. Infinite in the background.
    Distance,
    /// Unit normal in world space, on the visible side. 0 in the background.
    Normal,
    /// Index of the shape among the shapes drawn in the frame, in document order, counted from 1. Shapes that cannot be drawn in a frame, such
    /// as a shape scaled to zero, are not counted. 0 in the background.
    Id,
    /// Diffuse albedo, by channel, in linear light: k_d times the colour of the surface. 0 in the background.
    Albedo,
    /// Point on the surface, in world space. 0 in the background.
    Position,
}

impl Pass {
    /// All passes.
    pub const ALL: [Self; 6] =
        [Self::Depth, Self::Distance, Self::Normal, Self::Id, Self::Albedo, Self::Position];

    /// Returns the name of the pass in the textual form of [`Passes`].
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Distance => "distance",
            Self::Normal => "normal",
            Self::Id => "id",
            Self::Albedo => "albedo",
            Self::Position => "position",
        }
    }
}

/// A set of passes.
///
/// ```
/// use rayreel::trace::{Pass, Passes};
///
/// let passes: Passes = "normal,depth".parse()?;
/// assert!(passes.contains(Pass::Depth) && !passes.contains(Pass::Id));
/// assert_eq!(passes.to_string(), "depth,normal");
/// # Ok::<(), rayreel::trace::UnknownPass>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Passes(u8);

impl Passes {
    /// Returns whether the set contains a pass.
    #[must_use]
    pub fn contains(self, pass: Pass) -> bool {
        self.0 & (1 << pass as u8) != 0
    }

    /// Returns whether the set is empty.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

impl FromIterator<Pass> for Passes {
    fn from_iter<I: IntoIterator<Item = Pass>>(passes: I) -> Self {
        Self(passes.into_iter().fold(0, |bits, pass| bits | 1 << pass as u8))
    }
}

/// The error for an unknown pass name.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no pass `{0}`: choose from {all}, with commas between them", all = Pass::ALL.map(Pass::name).join(", "))]
pub struct UnknownPass(String);

debug_as_message!(UnknownPass);

impl FromStr for Passes {
    type Err = UnknownPass;

    fn from_str(text: &str) -> Result<Self, UnknownPass> {
        let named = |name: &str| Pass::ALL.into_iter().find(|pass| pass.name() == name);
        text.split(',')
            .map(str::trim)
            .map(|name| named(name).ok_or_else(|| UnknownPass(name.to_owned())))
            .collect()
    }
}

impl fmt::Display for Passes {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&str> =
            Pass::ALL.into_iter().filter(|pass| self.contains(*pass)).map(Pass::name).collect();
        formatter.write_str(&names.join(","))
    }
}

/// The passes of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassPixel {
    /// See [`Pass::Depth`].
    pub depth: f32,
    /// See [`Pass::Distance`].
    pub distance: f32,
    /// See [`Pass::Normal`].
    pub normal: [f32; 3],
    /// See [`Pass::Id`].
    pub id: u32,
    /// See [`Pass::Albedo`].
    pub albedo: Rgb,
    /// See [`Pass::Position`].
    pub position: [f32; 3],
}

impl PassPixel {
    /// The values in the background.
    pub const NOTHING: Self = Self {
        depth: f32::INFINITY,
        distance: f32::INFINITY,
        normal: [0.0; 3],
        id: 0,
        albedo: Rgb::ZERO,
        position: [0.0; 3],
    };
}

impl PreparedScene {
    /// Computes the passes of all pixels, on the current rayon pool's threads. `None` if `cancelled` became true
    /// meanwhile.
    pub(crate) fn passes(&self, camera: &PreparedCamera, cancelled: &AtomicBool) -> Option<Film<PassPixel>> {
        let (columns, rows) = camera.resolution();
        let [_, _, view_axis] = camera.axes();
        let naive = Naive::of(self);
        let pixel = |scratch: &mut Scratch<'_>, (i, j)| {
            let ray = camera.ray(i, j)?;
            scratch.tied_hits.clear();
            scratch.ties.clear();
            let closest = self.closest(&ray, scratch)?;
            let surface = self.surface(&ray, &closest, scratch);
            let (_, albedo) = self.material(surface.hit.id).colors_at(surface.point, surface.normal);
            // Adding zero turns negative zeros positive.
            let rounded = |vector: DVec3| (vector + DVec3::ZERO).to_array().map(to_f32);
            Some(PassPixel {
                depth: to_f32(surface.depth(&ray, view_axis)),
                distance: to_f32(surface.distance(&ray)),
                normal: rounded(surface.facing_normal()),
                id: self.order().rank(surface.hit.id).number() + 1,
                albedo,
                position: rounded(surface.point),
            })
        };
        let row = |scratch: &mut Scratch<'_>, j| {
            let row = (0..columns).map(|i| pixel(scratch, (i, j)).unwrap_or(PassPixel::NOTHING));
            (!cancelled.load(Ordering::Relaxed)).then(|| row.collect::<Vec<_>>())
        };
        let all = (0..rows).into_par_iter().map_init(|| Scratch::new(cancelled, naive.as_ref()), row);
        let all: Option<Vec<_>> = all.collect();
        let all = all.filter(|_| !cancelled.load(Ordering::Relaxed))?;
        Some(Film::from_values(columns, rows, all.concat()))
    }
}

/// Rounds to the nearest `f32`; numbers that are too large become infinite.
#[expect(clippy::cast_possible_truncation, reason = "rounding to f32 is the point")]
fn to_f32(number: f64) -> f32 {
    number as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_read_as_they_are_written() {
        for bits in 1..1_u8 << Pass::ALL.len() {
            let passes: Passes =
                Pass::ALL.into_iter().filter(|pass| bits & (1 << *pass as u8) != 0).collect();
            assert_eq!(passes.to_string().parse(), Ok(passes));
        }
        assert_eq!("depth, id".parse(), Ok([Pass::Depth, Pass::Id].into_iter().collect::<Passes>()));
        for wrong in ["", "deep", "depth,", "depth;id"] {
            let message = wrong.parse::<Passes>().unwrap_err().to_string();
            assert!(Pass::ALL.iter().all(|pass| message.contains(pass.name())), "{message}");
        }
    }
}
