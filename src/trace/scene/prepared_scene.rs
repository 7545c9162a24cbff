//! A scene as arrays, prepared for ray queries.

use std::sync::OnceLock;

use glam::DVec3;

use super::changes::{BvhUpdate, ShapeChange};
use super::document_order::DocumentOrder;
use super::environment::{GradientTerms, PreparedBackground, PreparedFog};
use super::equal_shapes::EqualShapes;
use super::geometry::{Geometry, PreparedShape};
use super::leaf_shapes::LeafShapes;
use super::light::{PreparedAmbientOcclusion, PreparedLight};
use super::material::SurfaceMaterial;
use super::material_summary::MaterialSummary;
use super::material_table::MaterialTable;
use super::precision::Precision;
use super::ray_visibility::{RayClass, RayViews, RayVisibility};
use super::sky::{PreparedSky, SkyLight};
use super::tree_maintenance::{SceneTree, TreeMaintenance};
use crate::color::Rgb;
use crate::trace::bvh::Tree;
use crate::trace::math::{Bytes, Digest, SimdLevel, digest_of_all};
use crate::trace::rays::ShapeId;

/// The terms of the radiance of a ray that hits nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BackgroundTerms {
    /// The background in the ray's direction.
    pub background: Rgb,
    /// The terms of the background, if it is a gradient.
    pub gradient: Option<GradientTerms>,
    /// The light of the sun, if there is one.
    pub sun: Option<SkyLight>,
    /// The light of the stars, if there are any.
    pub stars: Option<SkyLight>,
    /// The sum of background, sun and stars.
    pub color: Rgb,
}

/// Everything that the kernel uses of a scene at one moment, except the camera.
#[derive(Clone, Debug)]
pub struct PreparedScene {
    pub(crate) geometry: Geometry,
    materials: MaterialTable,
    /// The groups of equal shapes. The tree and `unbounded` hold only the first of each group in document order.
    pub(crate) equal_shapes: EqualShapes,
    pub(crate) tree: Tree,
    /// The shapes of the tree's leaves.
    pub(crate) leaves: LeafShapes,
    /// Unbounded shapes such as planes, and shapes so much larger than the rest that they would degrade the tree.
    pub(crate) unbounded: Vec<ShapeId>,
    maintenance: TreeMaintenance,
    /// The class of the rays that this scene is prepared for.
    class: RayClass,
    /// By class of rays: true if rays of that class do not see a shape that rays of this scene's class see.
    sees_more: [bool; 3],
    /// The scenes of the other classes of rays; `None` if all rays see all shapes, and in those scenes themselves.
    views: Option<Box<RayViews<Self>>>,
    /// The digest of the shapes and their materials, once computed.
    digest: OnceLock<Digest>,
    surfaces: MaterialSummary,
    /// The lights, in document order.
    pub lights: Vec<PreparedLight>,
    /// The ambient light, I_a.
    pub ambient: Rgb,
    /// The occlusion of ambient light, if any.
    pub ambient_occlusion: Option<PreparedAmbientOcclusion>,
    /// The background, seen by rays that hit nothing.
    pub background: PreparedBackground,
    /// The sun and the stars in front of the background.
    pub(crate) sky: PreparedSky,
    /// The fog between shapes.
    pub(crate) fog: PreparedFog,
    /// Maximum ray depth: the number of bounces that are traced. Camera rays are the first one, which is always traced.
    pub depth: u32,
    /// Maximum loss of a sample's light, in linear light, by not tracing rays of low contribution; 0 traces all rays.
    pub cutoff: f32,
    /// The precision of intersection tests.
    pub precision: Precision,
    /// The vector instructions used to trace rays.
    pub simd: SimdLevel,
}

impl PreparedScene {
    /// Creates a scene of these shapes with one material each, without lights and with a black background.
    #[must_use]
    pub fn new(geometry: Geometry, materials: impl Into<MaterialTable>) -> Self {
        let mut scene = Self::of(geometry, materials.into(), RayClass::Camera);
        scene.rebuild_tree();
        scene
    }

    /// Creates a scene without a tree.
    fn of(geometry: Geometry, materials: MaterialTable, class: RayClass) -> Self {
        Self {
            geometry,
            surfaces: MaterialSummary::of(&materials),
            materials,
            equal_shapes: EqualShapes::default(),
            tree: Tree::default(),
            leaves: LeafShapes::default(),
            unbounded: Vec::new(),
            maintenance: TreeMaintenance::default(),
            class,
            sees_more: [false; 3],
            views: None,
            digest: OnceLock::new(),
            lights: Vec::new(),
            ambient: Rgb::ZERO,
            ambient_occlusion: None,
            background: PreparedBackground::default(),
            sky: PreparedSky::default(),
            fog: PreparedFog::default(),
            depth: 1,
            cutoff: 0.0,
            precision: Precision::default(),
            simd: SimdLevel::best(),
        }
    }

    /// Creates the scene of another class of rays. The shapes that they do not see are in no tree, and their materials are blank.
    fn view(&self, class: RayClass) -> Self {
        let mut materials = self.materials.clone();
        for id in self.geometry.hidden_from(class) {
            materials.replace(id, SurfaceMaterial::default());
        }
        let mut view = Self::of(self.geometry.clone(), materials, class);
        (view.precision, view.simd) = (self.precision, self.simd);
        view.rebuild_tree();
        view
    }

    /// Returns the scene of a class of rays.
    pub(crate) fn seen_by(&self, class: RayClass) -> &Self {
        self.views.as_ref().and_then(|views| views.get(class)).unwrap_or(self)
    }

    /// Returns whether the rays of this scene see a shape.
    pub(crate) fn sees(&self, id: ShapeId) -> bool {
        self.geometry.visibility(id).sees(self.class)
    }

    /// Returns whether the rays of this scene see a shape that rays of another scene do not see.
    pub(crate) fn sees_more_than(&self, other: &Self) -> bool {
        self.sees_more[other.class as usize]
    }

    /// Lets all rays see all shapes of the scene. Shapes that no ray sees are not in it.
    pub(crate) fn show_all(&mut self) {
        self.geometry.show_all();
        self.digest.take();
        self.rebuild_tree();
    }

    /// Sets the vector instructions used to trace rays.
    pub fn set_simd(&mut self, simd: SimdLevel) {
        self.simd = simd;
        self.scenes_of_others().for_each(|view| view.simd = simd);
    }

    /// Sets the precision of intersection tests.
    pub(crate) fn set_precision(&mut self, precision: Precision) {
        self.precision = precision;
        self.scenes_of_others().for_each(|view| view.precision = precision);
    }

    /// Returns the scenes of the other classes of rays.
    fn scenes_of_others(&mut self) -> impl Iterator<Item = &mut Self> {
        self.views.iter_mut().flat_map(|views| &mut views.scenes)
    }

    /// Rebuilds the scene from other shapes with one material each, and reuses the memory. Everything else stays as it is. `fill` receives
    /// the geometry and the materials empty.
    pub(crate) fn remake(&mut self, fill: impl FnOnce(&mut Geometry, &mut MaterialTable)) {
        self.geometry.clear();
        self.materials.clear();
        fill(&mut self.geometry, &mut self.materials);
        self.surfaces = MaterialSummary::of(&self.materials);
        self.digest.take();
        self.rebuild_tree();
    }

    /// Returns the radiance of a ray that hits nothing, in a direction of any length except zero.
    #[inline]
    pub(crate) fn miss_radiance(&self, direction: DVec3) -> Rgb {
        let background = self.background.towards(direction);
        if self.sky.is_empty() {
            return background;
        }
        (background + self.sky.towards(direction / direction.length())).min(Rgb::splat(f32::MAX))
    }

    /// Returns the terms of [`miss_radiance`](Self::miss_radiance).
    pub(crate) fn background_terms(&self, direction: DVec3) -> BackgroundTerms {
        let [sun, stars] = self.sky.lights(direction / direction.length());
        BackgroundTerms {
            background: self.background.towards(direction),
            gradient: self.background.gradient_terms(direction),
            sun,
            stars,
            color: self.miss_radiance(direction),
        }
    }

    /// Returns the radiance of all rays that hit nothing; `None` if it can differ between directions.
    pub(crate) fn constant_miss_radiance(&self) -> Option<Rgb> {
        match self.background {
            PreparedBackground::Flat(color) if self.sky.is_empty() => Some(color),
            _ => None,
        }
    }

    /// Returns an upper bound of each channel of the radiance of rays that hit nothing.
    pub(crate) fn miss_radiance_bound(&self) -> Rgb {
        (self.background.radiance_bound() + self.sky.radiance_bound()).min(Rgb::splat(f32::MAX))
    }

    /// Returns the shapes.
    #[must_use]
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// Returns the document order of the shapes.
    #[inline]
    pub(crate) fn order(&self) -> &DocumentOrder {
        self.geometry.order()
    }

    /// Sets another document order of the shapes. They keep their ids.
    ///
    /// # Panics
    ///
    /// Unless `ids` has every shape once.
    pub fn renumber(&mut self, ids: &[ShapeId]) {
        self.geometry.renumber(ids);
        self.digest.take();
        self.rebuild_tree();
    }

    /// Replaces a shape by another of the same kind, and adds it to `changes` if they differ. `None` if their kinds differ: the scene must
    /// then be [remade](PreparedScene::remake). Otherwise the tree must be [updated](PreparedScene::update_tree) before the next ray.
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
            self.scenes_of_others().for_each(|view| assert!(view.geometry.replace(id, shape)));
            changes.push(ShapeChange { id, before, after: self.geometry.bounds(id) });
        })
    }

    /// Returns the material of a shape.
    #[must_use]
    pub fn material(&self, id: ShapeId) -> &SurfaceMaterial {
        self.materials.of(id)
    }

    /// Returns the materials of all shapes.
    pub(super) fn materials(&self) -> &MaterialTable {
        &self.materials
    }

    /// Returns the bit of a shape's material in sets of materials. It depends on the material alone; different ones may share it.
    #[inline]
    pub(crate) fn material_bit(&self, id: ShapeId) -> u64 {
        self.materials.bit(id)
    }

    /// Returns the summary of the materials.
    #[must_use]
    pub(crate) fn surfaces(&self) -> &MaterialSummary {
        &self.surfaces
    }

    /// Replaces the materials of shapes, and returns the shapes whose materials differ.
    pub fn replace_materials(
        &mut self,
        replacements: impl IntoIterator<Item = (ShapeId, SurfaceMaterial)>,
    ) -> Vec<ShapeId> {
        let changed = self.replace_own_materials(replacements);
        let Self { materials, views, .. } = self;
        for view in views.iter_mut().flat_map(|views| &mut views.scenes) {
            let seen: Vec<ShapeId> = changed.iter().copied().filter(|id| view.sees(*id)).collect();
            view.replace_own_materials(seen.into_iter().map(|id| (id, materials.of(id).clone())));
        }
        changed
    }

    fn replace_own_materials(
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
                // Absent visibility writes nothing, so that frames of scenes without it stay valid. No kind of shape has such a number.
                let visibility = self.geometry.visibility(id);
                if visibility != RayVisibility::ALL {
                    bytes.count(0x100 | visibility.bits());
                }
            })
        })
    }

    /// Writes the bytes of a shape and its material.
    pub(crate) fn write_shape(&self, id: ShapeId, bytes: &mut Bytes) {
        self.geometry.write(id, bytes);
        self.material(id).write(bytes);
    }

    /// Writes the bytes of everything else that pictures depend on, except the camera. Fingerprints and the reuse of tiles rely on it.
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
        // Absent parts write nothing, so that frames of scenes without them stay valid.
        self.fog.write_layer(bytes);
        self.sky.write(bytes);
        if let Some(PreparedAmbientOcclusion { samples, distance }) = self.ambient_occlusion {
            // Another number than those of fog and sky.
            bytes.count(16_u32);
            bytes.count(samples);
            bytes.number(distance);
        }
    }

    /// Returns the ambient light as a light source, if it can be occluded.
    pub(crate) fn dome(&self) -> Option<PreparedLight> {
        let occlusion = self.ambient_occlusion.filter(|_| self.ambient != Rgb::ZERO)?;
        Some(occlusion.dome(self.ambient))
    }

    /// Returns whether points are lit from directions that are sampled.
    pub(crate) fn samples_light(&self) -> bool {
        self.dome().is_some() || self.lights.iter().any(|light| light.source.is_extended())
    }

    fn sort_equal_shapes(&mut self) {
        self.equal_shapes.sort(|id| self.materials.of(id).refraction.is_some());
    }

    /// Updates the tree after these shapes have changed. Each shape is listed once.
    pub(crate) fn update_tree(&mut self, changes: &[ShapeChange]) -> BvhUpdate {
        if changes.is_empty() {
            return BvhUpdate::Kept;
        }
        self.scenes_of_others().for_each(|view| {
            view.update_tree(changes);
        });
        let Self { geometry, equal_shapes, tree, leaves, unbounded, maintenance, .. } = self;
        if maintenance.refit(geometry, equal_shapes, SceneTree { tree, leaves, unbounded }, changes) {
            return BvhUpdate::Refitted;
        }
        self.build_own_tree();
        BvhUpdate::Built
    }

    /// Builds the tree, and the scenes of the other classes of rays.
    fn rebuild_tree(&mut self) {
        self.build_own_tree();
        if self.class == RayClass::Camera {
            self.views = RayViews::new(self.geometry.visibilities(), |class| self.view(class));
        }
    }

    fn build_own_tree(&mut self) {
        let class = self.class;
        self.equal_shapes.find(&self.geometry, class);
        self.sort_equal_shapes();
        let Self { geometry, equal_shapes, tree, leaves, unbounded, maintenance, .. } = self;
        maintenance.build((geometry, class), equal_shapes, SceneTree { tree, leaves, unbounded });
        let visibilities = geometry.visibilities();
        self.sees_more = RayClass::ALL.map(|other| {
            visibilities.iter().any(|visibility| visibility.sees(class) && !visibility.sees(other))
        });
    }

    /// Returns the first in document order of all shapes that equal a shape: the one that rays query.
    #[must_use]
    #[inline]
    pub(crate) fn first_equal(&self, id: ShapeId) -> ShapeId {
        self.equal_shapes.first(id)
    }

    /// Returns the transparent shapes, of a shape and its equals, that may count among the solids that contain a ray.
    pub(crate) fn media_at<'a>(&'a self, id: &'a ShapeId) -> &'a [ShapeId] {
        match self.equal_shapes.group(*id) {
            Some(group) => group.media(),
            None if self.material(*id).refraction.is_some() => std::slice::from_ref(id),
            None => &[],
        }
    }

    /// Returns whether a transparent shape may count among the solids that contain a ray.
    pub(crate) fn may_be_medium(&self, transparent: ShapeId) -> bool {
        self.equal_shapes.group(transparent).is_none_or(|group| group.media().contains(&transparent))
    }
}
