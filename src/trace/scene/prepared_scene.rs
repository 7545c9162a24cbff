//! A scene as arrays, ready for rays.

use std::sync::OnceLock;

use super::changes::{BvhUpdate, ShapeChange};
use super::document_order::DocumentOrder;
use super::environment::{Background, Fog};
use super::equal_shapes::EqualShapes;
use super::geometry::{Geometry, PreparedShape};
use super::leaf_shapes::LeafShapes;
use super::light::Light;
use super::material::SurfaceMaterial;
use super::material_summary::MaterialSummary;
use super::material_table::MaterialTable;
use super::precision::Precision;
use super::tree_maintenance::{SceneTree, TreeMaintenance};
use crate::color::Rgb;
use crate::trace::bvh::Tree;
use crate::trace::math::{Bytes, Digest, SimdLevel, digest_of_all};
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
    maintenance: TreeMaintenance,
    /// That of the shapes and their materials, once it is known.
    digest: OnceLock<Digest>,
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
            maintenance: TreeMaintenance::default(),
            digest: OnceLock::new(),
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

    /// Makes the scene anew of other shapes, with one material each, in the memory of these. The rest stays as it is. `fill` gets
    /// both empty.
    pub fn remake(&mut self, fill: impl FnOnce(&mut Geometry, &mut MaterialTable)) {
        self.geometry.clear();
        self.materials.clear();
        fill(&mut self.geometry, &mut self.materials);
        self.surfaces = MaterialSummary::of(&self.materials);
        self.digest.take();
        self.rebuild_tree();
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
        self.digest.take();
        self.rebuild_tree();
    }

    /// Puts another shape of the same kind in the place of one, and notes it if they differ. `None` if their kinds do: the scene must
    /// then be made anew. Otherwise the tree must be [updated](PreparedScene::update_tree) before the next ray.
    #[must_use]
    pub(crate) fn replace_shape(
        &mut self,
        id: ShapeId,
        shape: PreparedShape,
        changes: &mut Vec<ShapeChange>,
    ) -> Option<()> {
        if self.geometry.holds(id, &shape) {
            return Some(());
        }
        self.digest.take();
        let before = self.geometry.bounds(id);
        self.geometry.replace(id, shape).then(|| {
            changes.push(ShapeChange { id, before, after: self.geometry.bounds(id) });
        })
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
            self.digest.take();
            self.surfaces = MaterialSummary::of(&self.materials);
            self.sort_equal_shapes();
        }
        changed
    }

    /// Returns the digest of all shapes and their materials, in document order.
    pub(crate) fn shapes_digest(&self) -> &Digest {
        self.digest.get_or_init(|| {
            let (materials, order) = (self.materials.digests(), self.order());
            digest_of_all(self.geometry.len(), |rank, bytes| {
                let id = order.shape_at(u32::try_from(rank).unwrap_or(u32::MAX));
                self.geometry.write(id, bytes);
                bytes.digest(&materials[self.materials.place_of(id)]);
            })
        })
    }

    /// Writes the bytes of all else that pictures depend on, apart from the camera.
    pub(crate) fn write_surroundings(&self, bytes: &mut Bytes) {
        bytes.count(self.lights.len() as u64);
        for light in &self.lights {
            light.write(bytes, |shape| self.order().rank(shape).number().into());
        }
        bytes.colors([self.ambient, self.fog.color]);
        self.background.write(bytes);
        [self.fog.density, self.cutoff.into()].into_iter().for_each(|number| bytes.number(number));
        bytes.count(self.depth);
        bytes.count(self.precision as u64);
    }

    fn sort_equal_shapes(&mut self) {
        self.equal_shapes.sort(|id| self.materials.of(id).refraction.is_some());
    }

    /// Brings the tree up to date after these shapes have changed, each of which is there once.
    pub(crate) fn update_tree(&mut self, changes: &[ShapeChange]) -> BvhUpdate {
        if changes.is_empty() {
            return BvhUpdate::Kept;
        }
        let Self { geometry, equal_shapes, tree, leaves, beside, maintenance, .. } = self;
        if maintenance.refit(geometry, equal_shapes, SceneTree { tree, leaves, beside }, changes) {
            return BvhUpdate::Refitted;
        }
        self.rebuild_tree();
        BvhUpdate::Built
    }

    fn rebuild_tree(&mut self) {
        self.equal_shapes.find(&self.geometry);
        self.sort_equal_shapes();
        let Self { geometry, equal_shapes, tree, leaves, beside, maintenance, .. } = self;
        maintenance.build(geometry, equal_shapes, SceneTree { tree, leaves, beside });
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
