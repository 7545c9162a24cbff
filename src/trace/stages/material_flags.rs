//! Material properties at the hits of a packet.

use crate::color::Rgb;
use crate::trace::math::Colors;
use crate::trace::scene::SurfaceMaterial;

/// Material properties at the surface points of a packet, lane by lane.
#[derive(Clone, Debug)]
pub(super) struct MaterialFlags {
    /// The diffuse colours.
    pub(super) diffuse: Colors,
    /// The colours in ambient light, if it is occluded.
    pub(super) ambient: Colors,
    /// Lanes with specular highlights.
    pub(super) shiny: u32,
    /// Lanes with transparent materials.
    pub(super) transparent: u32,
    /// Lanes whose materials spawn secondary rays.
    pub(super) continues: u32,
    /// Lanes with a pattern.
    pub(super) patterned: u32,
    /// Lanes whose surface point is needed.
    pub(super) wanted: u32,
}

impl MaterialFlags {
    /// No surfaces.
    pub(super) const EMPTY: Self = Self {
        diffuse: Colors::splat(Rgb::ZERO),
        ambient: Colors::splat(Rgb::ZERO),
        shiny: 0,
        transparent: 0,
        continues: 0,
        patterned: 0,
        wanted: 0,
    };

    /// Records the properties of a material for some lanes, given as a bit mask.
    #[inline(always)]
    pub(super) fn record(&mut self, lanes: u32, material: &SurfaceMaterial) {
        let in_lanes = |holds: bool| if holds { lanes } else { 0 };
        self.shiny = self.shiny & !lanes | in_lanes(material.specular > 0.0);
        self.transparent = self.transparent & !lanes | in_lanes(material.refraction.is_some());
        self.continues = self.continues & !lanes | in_lanes(material.continues());
        self.patterned = self.patterned & !lanes | in_lanes(material.pattern.is_some());
    }
}
