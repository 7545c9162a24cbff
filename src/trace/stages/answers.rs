//! How the surfaces that a packet's rays meet answer light.

use crate::color::Rgb;
use crate::trace::math::Colors;
use crate::trace::scene::SurfaceMaterial;

/// How the surfaces of a packet's points answer light, lane by lane.
#[derive(Clone, Debug)]
pub(super) struct AnswerPacket {
    /// The diffuse colours at points.
    pub(super) diffuse: Colors,
    /// Lanes of highlights.
    pub(super) shiny: u32,
    /// Lanes of clear shapes.
    pub(super) clear: u32,
    /// Lanes whose rays are sent on.
    pub(super) continues: u32,
    /// Lanes with squares of other colours.
    pub(super) checkered: u32,
    /// Lanes whose points have to be known.
    pub(super) wanted: u32,
}

impl AnswerPacket {
    /// Of no surface.
    pub(super) const EMPTY: Self =
        Self { diffuse: Colors::splat(Rgb::ZERO), shiny: 0, clear: 0, continues: 0, checkered: 0, wanted: 0 };

    /// Notes how a material answers in some lanes.
    #[inline(always)]
    pub(super) fn note(&mut self, lanes: u32, material: &SurfaceMaterial) {
        let in_lanes = |holds: bool| if holds { lanes } else { 0 };
        self.shiny = self.shiny & !lanes | in_lanes(material.specular > 0.0);
        self.clear = self.clear & !lanes | in_lanes(material.refraction.is_some());
        self.continues = self.continues & !lanes | in_lanes(material.continues());
        self.checkered = self.checkered & !lanes | in_lanes(material.checker.is_some());
    }
}
