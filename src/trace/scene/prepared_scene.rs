//! A scene as arrays, ready for rays.

use rayon::prelude::*;

use super::changes::ShapeChange;
use super::document_order::DocumentOrder;
use super::environment::{Background, Fog};
use super::equal_shapes::EqualShapes;
use super::geometry::{Geometry, PreparedShape, ShapeRef};
use super::leaf_shapes::LeafShapes;
use super::light::Light;
use super::material::SurfaceMaterial;
use super::material_summary::MaterialSummary;
use super::material_table::MaterialTable;
use super::precision::Precision;
use crate::color::Rgb;
use crate::trace::bvh::{Builder, Extent, Tree};
use crate::trace::math::SimdLevel;
use crate::trace::rays::ShapeId;

/// All that the kernel knows of a scene at one moment, apart from the camera.
#[derive(Clone, Debug)]
pub struct PreparedScene {
    pub(crate) geometry: Geometry,
    materials: MaterialTable,
    /// Of equal shapes the tree and what is beside it hold the first in document order.
    pub(crate) equal_shapes: EqualShapes,
    pub(crate) tree: Tree,
    /// What its leaves stand for.
    pub(crate) leaves: LeafShapes,
    /// Shapes without bounds, as planes, and shapes so much larger than the rest that they would spoil the tree.
    pub(crate) beside: Vec<ShapeId>,
    surfaces: MaterialSummary,
    /// In document order.
    pub lights: Vec<Light>,
    /// I_a.
    pub ambient: Rgb,
    /// What rays see that meet nothing.
    pub background: Background,
    /// What is between things.
    pub fog: Fog,
    /// Generations of rays that are traced; that of camera rays is, whatever it says.
    pub depth: u32,
    /// How much of a sample's light may be left out, in linear light, by not following rays that bring little; 0 follows
    /// all.
    pub cutoff: f32,
    /// How shapes are asked.
    pub precision: Precision,
    /// With which vector instructions rays are followed.
    pub simd: SimdLevel,
}

impl PreparedScene {
    /// A scene of these shapes with one material each, without lights, black all around.
    #[must_use]
    pub fn new(geometry: Geometry, materials: impl Into<MaterialTable>) -> Self {
        let materials = materials.into();
        let mut scene = Self {
            geometry,
            surfaces: MaterialSummary::of(&materials),
            materials,
            equal_shapes: EqualShapes::default(),
            tree: Tree::default(),
            leaves: LeafShapes::default(),
            beside: Vec::new(),
            lights: Vec::new(),
            ambient: Rgb::ZERO,
            background: Background::default(),
            fog: Fog::default(),
            depth: 1,
            cutoff: 0.0,
            precision: Precision::default(),
            simd: SimdLevel::best(),
        };
        scene.rebuild_tree();
        scene
    }

    /// The shapes.
    #[must_use]
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// Which shape comes first in the document.
    #[inline]
    pub(crate) fn order(&self) -> &DocumentOrder {
        self.geometry.order()
    }

    /// Puts the shapes into another document order. They keep their ids.
    ///
    /// # Panics
    ///
    /// Unless `ids` has every shape once.
    pub fn renumber(&mut self, ids: &[ShapeId]) {
        self.geometry.renumber(ids);
        self.rebuild_tree();
    }

    /// Puts other shapes of the same kinds in the place of some, and returns those that differ. `None` if a kind differs: the
    /// scene must then be made anew.
    #[must_use]
    pub fn replace_shapes(&mut self, replacements: &[(ShapeId, PreparedShape)]) -> Option<Vec<ShapeChange>> {
        let mut changes = Vec::new();
        for (id, shape) in replacements {
            if self.geometry.holds(*id, shape) {
                continue;
            }
            let before = self.geometry.bounds(*id);
            if !self.geometry.replace(*id, *shape) {
                return None;
            }
            changes.push(ShapeChange { id: *id, before, after: self.geometry.bounds(*id) });
        }
        if !changes.is_empty() {
            self.rebuild_tree();
        }
        changes.sort_unstable_by_key(|change| self.order().rank(change.id));
        Some(changes)
    }

    /// Returns the material of a shape.
    #[must_use]
    pub fn material(&self, id: ShapeId) -> &SurfaceMaterial {
        self.materials.of(id)
    }

    /// What there is among the surfaces.
    #[must_use]
    pub fn surfaces(&self) -> &MaterialSummary {
        &self.surfaces
    }

    /// Replaces the materials of shapes, and returns the shapes whose materials differ.
    pub fn replace_materials(
        &mut self,
        replacements: impl IntoIterator<Item = (ShapeId, SurfaceMaterial)>,
    ) -> Vec<ShapeId> {
        let mut changed = Vec::new();
        for (id, material) in replacements {
            if self.materials.replace(id, material) {
                changed.push(id);
            }
        }
        if !changed.is_empty() {
            self.surfaces = MaterialSummary::of(&self.materials);
            self.sort_equal_shapes();
        }
        changed
    }

    fn sort_equal_shapes(&mut self) {
        self.equal_shapes.sort(|id| self.materials.of(id).refraction.is_some());
    }

    fn rebuild_tree(&mut self) {
        self.equal_shapes = EqualShapes::of(&self.geometry);
        self.sort_equal_shapes();
        let asked = || self.geometry.ids().filter(|id| self.first_equal(*id) == *id);
        let round = |id: ShapeId| matches!(self.geometry.shape(id), ShapeRef::Sphere(_));
        let bounded = asked()
            .filter_map(|id| Some((id, Extent { bounds: self.geometry.bounds(id)?, round: round(id) })));
        let (mut ids, mut extents): (Vec<ShapeId>, Vec<Extent>) = bounded.unzip();
        self.beside = asked().filter(|id| self.geometry.bounds(*id).is_none()).collect();
        let huge = huge_shapes(&extents);
        for index in huge.into_iter().rev() {
            self.beside.push(ids.remove(index));
            extents.remove(index);
        }
        self.beside.sort_unstable_by_key(|id| self.geometry.order().rank(*id));
        let mut builder = Builder::default();
        let leaves = builder.build(&extents, &mut self.tree);
        self.leaves = LeafShapes::new(&self.geometry, leaves.par_iter().map(|index| ids[*index as usize]));
    }

    /// The first in document order of all shapes that equal one: the one that is asked what a ray meets.
    #[must_use]
    #[inline]
    pub(crate) fn first_equal(&self, id: ShapeId) -> ShapeId {
        self.equal_shapes.first(id)
    }

    /// The clear ones, of a shape and all that equal it, that may count among the solids that a ray is inside of.
    pub(crate) fn media_at<'a>(&'a self, asked: &'a ShapeId) -> &'a [ShapeId] {
        match self.equal_shapes.group(*asked) {
            Some(group) => group.media(),
            None if self.material(*asked).refraction.is_some() => std::slice::from_ref(asked),
            None => &[],
        }
    }

    /// Returns whether a clear shape may count among the solids that a ray is inside of.
    pub(crate) fn may_be_medium(&self, clear: ShapeId) -> bool {
        self.equal_shapes.group(clear).is_none_or(|group| group.media().contains(&clear))
    }
}

/// Indices of at most 64 boxes whose longest edge is over 2^16 times the median of all that have one, ascending.
fn huge_shapes(extents: &[Extent]) -> Vec<usize> {
    const TIMES_MEDIAN: f64 = 65_536.0;
    const MOST: usize = 64;
    let edge = |extent: &Extent| extent.bounds.extent();
    let mut edges: Vec<f64> = extents.iter().map(edge).filter(|edge| *edge > 0.0).collect();
    if edges.is_empty() {
        return Vec::new();
    }
    let middle = edges.len() / 2;
    let median = *edges.select_nth_unstable_by(middle, f64::total_cmp).1;
    let mut huge: Vec<usize> =
        (0..extents.len()).filter(|index| edge(&extents[*index]) > median * TIMES_MEDIAN).collect();
    huge.sort_by(|left, right| edge(&extents[*right]).total_cmp(&edge(&extents[*left])));
    huge.truncate(MOST);
    huge.sort_unstable();
    huge
}
