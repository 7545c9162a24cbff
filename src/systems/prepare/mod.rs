//! The only bridge from the world to the kernel.

mod camera;
mod clouds;
mod faults;
mod idle_lights;
mod light;
mod material;
mod overlay;
mod read;
mod render_settings;
mod settings;
mod shape;
mod undeclared;

use std::collections::BTreeSet;
use std::sync::Arc;

use hecs::{Entity, World};

use super::order::order_newcomers;
use super::{Changes, Plan};
use crate::color::Rgb;
use crate::components::{
    Ambient, CloudMember, FilmSettings, Light, Noise, Order, Pattern, Quality, Sampling, WorldTransform,
};
use crate::overlay::PreparedOverlay;
use crate::time::Time;
use crate::trace::{
    self, Convergence, ErrorTarget, FilmOverlay, Geometry, MaterialTable, PreparedScene, SceneChanges,
    ShapeChange, ShapeId, SimdLevel,
};
use camera::prepared_camera;
use clouds::DrawnCloud;
use faults::surface_fault;
use light::prepared_light;
use material::{Surfaced, surface_material};
use overlay::prepared_overlay;
use read::{VisibleShapes, read_all, read_shapes};
use settings::{
    first, first_of, linear_cutoff, prepared_ambient_occlusion, prepared_background, prepared_fog,
    prepared_sky, sane, sane_sampling,
};

#[cfg(feature = "live")]
pub(crate) use camera::scene_camera;
pub use camera::{ActiveCamera, active_camera};
pub(super) use camera::{Shutter, Shutters};
pub(super) use render_settings::FrameSettings;
use render_settings::LightSettings;
pub use render_settings::{EffectiveSettings, RenderSettings, Viewpoint};
use settings::film_settings;

/// The kernel's arrays, and the entity in each of their slots.
///
/// Entities with a [`Shape`](crate::components::Shape) and a [`Material`](crate::components::Material) are drawn, unless their
/// [`Visibility`](crate::components::Visibility) hides them from all rays. Entities with values that cannot be drawn, such as a scale of zero
/// in the middle of an animation or a NaN from a system, are omitted; nothing non-finite reaches the kernel.
/// [`faults`](Preparation::faults) reports the omitted entities, with causes.
#[derive(Clone, Debug)]
pub struct Preparation {
    pub(super) scene: PreparedScene,
    pub(super) camera: trace::PreparedCamera,
    /// The view in place of that of the active camera.
    viewpoint: Option<Viewpoint>,
    /// The moment of the frame, which decides which camera is active.
    moment: Time,
    film: FilmSettings,
    pub(super) sampling: Sampling,
    /// The items over the picture; the same at all instants of the frame.
    overlay: PreparedOverlay,
    entities: Vec<Entity>,
    lights: Vec<Entity>,
    slots: SlotTable,
    /// The clouds, whose particles have slots that follow each other.
    clouds: Vec<DrawnCloud>,
    /// Entities whose surfaces have out-of-range numbers.
    unsound: BTreeSet<Entity>,
    /// True if only declared changes have been read.
    pub(super) relies_on_declarations: bool,
}

/// Slots by entity, except for clouds. Entity ids are small and dense, so a list suffices.
#[derive(Clone, Debug, Default)]
struct SlotTable(Vec<Option<(Entity, ShapeId)>>);

impl SlotTable {
    /// Assigns slots to these entities, in order, and discards all other slots.
    fn fill(&mut self, entities: &[Entity]) {
        self.0.clear();
        let largest = entities.iter().map(|entity| entity.id()).max();
        self.0.resize(largest.map_or(0, |id| id as usize + 1), None);
        for (slot, entity) in (0..).map(ShapeId).zip(entities) {
            self.0[entity.id() as usize] = Some((*entity, slot));
        }
    }

    fn remove(&mut self, entity: Entity) {
        if let Some(slot) = self.0.get_mut(entity.id() as usize) {
            *slot = None;
        }
    }

    fn get(&self, entity: Entity) -> Option<ShapeId> {
        let (found, slot) = self.0.get(entity.id() as usize).copied().flatten()?;
        (found == entity).then_some(slot)
    }
}

impl Preparation {
    /// Reads the whole world, for an instant of the frame at `moment`.
    #[must_use]
    pub fn of(world: &mut World, moment: Time) -> Self {
        let film = film_settings(world);
        let mut preparation = Self {
            scene: PreparedScene::new(Geometry::default(), MaterialTable::default()),
            camera: prepared_camera(world, film, moment, None),
            viewpoint: None,
            moment,
            film,
            sampling: Sampling::default(),
            overlay: PreparedOverlay::default(),
            entities: Vec::new(),
            lights: Vec::new(),
            slots: SlotTable::default(),
            clouds: Vec::new(),
            unsound: BTreeSet::new(),
            relies_on_declarations: false,
        };
        preparation.read_all(world);
        preparation
    }

    /// Reads the whole world and reuses the memory of the previous data.
    fn read_all(&mut self, world: &mut World) {
        order_newcomers(world, &[]);
        let mut drawn = VisibleShapes::default();
        self.scene.remake(|geometry, materials| drawn = read_all(world, geometry, materials));
        self.slots.fill(&drawn.entities);
        drawn.clouds.iter().for_each(|cloud| self.slots.remove(cloud.entity));
        self.clouds = drawn.clouds;
        self.entities = drawn.entities;
        self.unsound = drawn.unsound.into_iter().collect();
        self.relies_on_declarations = false;
        self.read_settings(world);
    }

    /// Reads the changed parts of the world, for an instant of the frame at `moment`. `moved` lists the entities whose world transform
    /// changed. Returns the changes of the kernel's data.
    pub fn update(
        &mut self,
        world: &mut World,
        moment: Time,
        changes: &Changes,
        moved: &[Entity],
    ) -> SceneChanges {
        self.moment = moment;
        let has_same_clouds = |world: &World| self.clouds.iter().all(|cloud| cloud.has_same_shapes(world));
        if changes.is_all() || self.moved_most(moved) || !has_same_clouds(world) {
            return self.start_over(world);
        }
        let reshaped = || [moved, changes.shapes()].into_iter().filter(|entities| !entities.is_empty());
        let mut shapes = Vec::new();
        if !reshaped().all(|entities| self.replace_shapes(world, entities, &mut shapes).is_some()) {
            return self.start_over(world);
        }
        let bvh = self.scene.update_tree(&shapes);
        let order = self.scene.order();
        shapes.sort_unstable_by_key(|change| order.rank(change.id));
        // Patterns move with their surfaces.
        let is_patterned = |entity: &&Entity| world.satisfies::<&Pattern>(**entity);
        let patterned: Vec<Entity> = match self.scene.surfaces().patterned {
            true => reshaped().flatten().filter(is_patterned).copied().collect(),
            false => Vec::new(),
        };
        let repainted = changes.materials().iter().chain(&patterned);
        let materials = repainted.filter_map(|entity| {
            let slot = self.slots.get(*entity);
            let is_drawn = slot.is_some() || self.clouds.iter().any(|cloud| cloud.entity == *entity);
            let surface = world.query_one_mut::<Surfaced<'_>>(*entity).ok()?;
            if is_drawn && surface_fault(*entity, surface).is_some() {
                self.unsound.insert(*entity);
            } else {
                self.unsound.remove(entity);
            }
            Some((slot?, surface_material(surface)))
        });
        let materials: Vec<_> = materials.collect();
        let Self { scene, clouds, .. } = self;
        let repainted = clouds.iter_mut().filter_map(|cloud| cloud.repaint(world).then_some(&*cloud));
        let materials =
            scene.replace_materials(materials.into_iter().chain(repainted.flat_map(DrawnCloud::surfaces)));
        self.relies_on_declarations = true;
        SceneChanges { shapes, bvh, materials, ..self.read_settings(world) }
    }

    /// Returns whether so many entities moved that reading the whole world on all threads is faster than replacing their shapes one by one.
    fn moved_most(&self, moved: &[Entity]) -> bool {
        const FEWEST: usize = 65_536;
        moved.len() > FEWEST && moved.len() > self.entities.len() / 2
    }

    /// Reads the whole world again, since anything may have changed.
    fn start_over(&mut self, world: &mut World) -> SceneChanges {
        self.read_all(world);
        SceneChanges::remade()
    }

    /// Returns the kernel's scene.
    #[must_use]
    pub fn scene(&self) -> &PreparedScene {
        &self.scene
    }

    /// Sets the precision of the kernel's intersections, and the SIMD level, for later queries too.
    pub(crate) fn configure(&mut self, settings: &RenderSettings) {
        self.scene.set_precision(settings.precision.unwrap_or_default());
        self.scene.set_simd(settings.simd.unwrap_or_else(SimdLevel::best));
    }

    /// Returns the kernel's camera.
    #[must_use]
    pub fn camera(&self) -> &trace::PreparedCamera {
        &self.camera
    }

    /// Returns the film's settings.
    #[must_use]
    pub fn film(&self) -> FilmSettings {
        self.film
    }

    /// Returns what is drawn over the picture; `None` for nothing.
    pub(crate) fn overlay(&self) -> Option<Arc<FilmOverlay>> {
        self.overlay.drawn(self.camera.resolution())
    }

    /// Returns the number and the choice of samples per pixel at this moment.
    #[must_use]
    pub fn sampling(&self, time: Time) -> trace::PixelSampling {
        let sampling = trace::PixelSampling { samples: self.sampling.samples, seed: self.sampling.seed };
        match self.sampling.noise {
            Noise::Fixed => sampling,
            Noise::PerFrame => sampling.reseeded(time.lowest_terms().into()),
        }
    }

    /// Returns the error target, if there is one. `is_open` is true if the frame has several instants. A single sample per pixel allows no
    /// error estimate, and thus no target.
    pub(crate) fn error_target(&self, is_open: bool) -> Option<ErrorTarget> {
        let error = f64::from(self.sampling.max_error);
        let convergence = Convergence::of(&self.scene, &self.camera, is_open);
        (error > 0.0 && self.sampling.samples > 1).then_some(ErrorTarget {
            error,
            norm: self.sampling.norm,
            least: self.sampling.min_samples,
            transfer: self.film.transfer,
            convergence,
        })
    }

    /// Returns the entities whose shapes are in the kernel's arrays, in document order. A cloud is there once for each of its particles.
    #[must_use]
    pub fn drawn(&self) -> &[Entity] {
        &self.entities
    }

    /// Returns the entity whose shape is in a slot.
    #[must_use]
    pub fn entity(&self, slot: ShapeId) -> Entity {
        self.entities[slot.index()]
    }

    /// Returns the numbers by which the particle or the bond in a slot is called, and where its cloud is from; `None` if the slot's entity is
    /// no [`Cloud`](crate::components::Cloud).
    #[must_use]
    pub fn cloud_member(&self, slot: ShapeId) -> Option<(CloudMember, Option<&str>)> {
        let (DrawnCloud { cloud, .. }, member) = self.cloud_at(slot)?;
        Some((member, cloud.origin.as_deref()))
    }

    /// Returns the colour of the particle or the bond in a slot; `None` if it is that of its entity's material.
    #[must_use]
    pub fn member_color(&self, slot: ShapeId) -> Option<Rgb> {
        self.cloud_at(slot)?.0.color(slot)
    }

    /// Returns the cloud of a slot, and what is drawn there.
    fn cloud_at(&self, slot: ShapeId) -> Option<(&DrawnCloud, CloudMember)> {
        let next = self.clouds.partition_point(|cloud| cloud.particles.first().0 <= slot.0);
        self.clouds[..next].iter().rev().find_map(|cloud| Some((cloud, cloud.member(slot)?)))
    }

    /// Returns the entities of the scene's lights, in the order of the lights.
    #[must_use]
    pub fn lights(&self) -> &[Entity] {
        &self.lights
    }

    /// Returns the number of samples of a light per lit point: 1 except for area lights.
    #[must_use]
    pub fn light_samples(&self, index: usize) -> u32 {
        self.scene.lights.get(index).map_or(1, |light| light.samples)
    }

    /// Returns the effects that this moment needs, with reasons.
    #[must_use]
    pub fn plan(&self, world: &World) -> Plan {
        Plan::of(world, self)
    }

    /// Returns the settings that trade accuracy for time.
    pub(crate) fn frame_settings(&self) -> FrameSettings {
        FrameSettings {
            film: self.film,
            viewpoint: self.viewpoint,
            sampling: self.sampling,
            depth: self.scene.depth,
            cutoff: self.scene.cutoff,
            lights: self.scene.lights.iter().map(own_settings).collect(),
            ambient_samples: self.scene.ambient_occlusion.map_or(1, |occlusion| occlusion.samples),
        }
    }

    /// Replaces these settings until the next update, and returns the previous ones.
    pub(crate) fn replace_frame_settings(
        &mut self,
        settings: &FrameSettings,
        world: &World,
    ) -> FrameSettings {
        let before = self.frame_settings();
        self.sampling = settings.sampling;
        let is_moved = set(&mut self.viewpoint, settings.viewpoint);
        if set(&mut self.film, settings.film) || is_moved {
            self.camera = prepared_camera(world, settings.film, self.moment, settings.viewpoint);
        }
        if is_moved {
            self.overlay = prepared_overlay(world, &self.camera, self.moment, settings.viewpoint);
        }
        self.scene.depth = settings.depth;
        self.scene.cutoff = settings.cutoff;
        for (light, settings) in self.scene.lights.iter_mut().zip(&settings.lights) {
            light.samples = settings.samples;
            light.casts_shadows = settings.casts_shadows;
        }
        if let Some(occlusion) = &mut self.scene.ambient_occlusion {
            occlusion.samples = settings.ambient_samples;
        }
        before
    }

    /// Returns the number of samples per pixel.
    #[must_use]
    pub fn samples(&self) -> u32 {
        self.sampling.samples
    }

    /// Replaces the shapes of entities that were moved or changed, and adds those that differ to `changes`. Returns `None` if the slots no
    /// longer fit, so that the whole world must be read again.
    fn replace_shapes(
        &mut self,
        world: &mut World,
        entities: &[Entity],
        changes: &mut Vec<ShapeChange>,
    ) -> Option<()> {
        read_shapes(world, entities, |entity, shape| match (self.slots.get(entity), shape) {
            (Some(slot), Some((shape, visibility)))
                if self.scene.geometry().visibility(slot) == visibility =>
            {
                self.scene.replace_shape(slot, shape, changes)
            }
            (None, None) => Some(()),
            _ => None,
        })
    }

    /// Reads the camera, the lights and the settings of the whole scene. They are few and are read for every frame. Returns their changes.
    fn read_settings(&mut self, world: &mut World) -> SceneChanges {
        let mut lights: Vec<(Order, Entity, trace::PreparedLight)> = world
            .query_mut::<(Entity, &Order, &Light, &WorldTransform)>()
            .into_iter()
            .filter_map(|(entity, order, light, transform)| {
                let own_shape = self.slots.get(entity);
                Some((*order, entity, prepared_light(light, transform, own_shape).ok()?))
            })
            .collect();
        lights.sort_unstable_by_key(|(order, entity, _)| (*order, entity.id()));
        let lights: (Vec<Entity>, Vec<trace::PreparedLight>) =
            lights.into_iter().map(|(_, entity, light)| (entity, light)).unzip();
        let film = film_settings(world);
        let camera = prepared_camera(world, film, self.moment, None);
        let overlay = prepared_overlay(world, &camera, self.moment, None);
        let sampling = sane_sampling(first(world));
        let quality = first::<Quality>(world);
        let ambient = sane(first::<Ambient>(world).0);
        let ambient_occlusion = first_of(world).and_then(prepared_ambient_occlusion);
        let background = prepared_background(first(world));
        let sky = prepared_sky(first_of(world), first_of(world));
        let fog = prepared_fog(first(world));
        let depth = quality.depth.clamp(1, Quality::LARGEST_DEPTH);
        let cutoff = linear_cutoff(quality.cutoff, film.transfer);

        let scene = &mut self.scene;
        let lights_differ = set(&mut scene.lights, lights.1);
        let camera_differs = set(&mut self.camera, camera);
        let settings = set(&mut scene.ambient, ambient)
            | set(&mut scene.ambient_occlusion, ambient_occlusion)
            | set(&mut scene.background, background)
            | set(&mut scene.sky, sky)
            | set(&mut scene.fog, fog)
            | set(&mut scene.depth, depth)
            | set(&mut scene.cutoff, cutoff)
            | set(&mut self.film, film)
            | set(&mut self.sampling, sampling)
            | set(&mut self.overlay, overlay);
        self.lights = lights.0;
        self.viewpoint = None;
        SceneChanges { lights: lights_differ, camera: camera_differs, settings, ..SceneChanges::default() }
    }
}

/// Returns a light's own settings.
fn own_settings(light: &trace::PreparedLight) -> LightSettings {
    LightSettings { samples: light.samples, casts_shadows: light.casts_shadows }
}

/// Writes a value, and returns whether it differs from the previous one.
fn set<T: PartialEq>(field: &mut T, value: T) -> bool {
    let differs = *field != value;
    *field = value;
    differs
}
