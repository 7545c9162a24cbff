//! The only bridge from the world to the kernel.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};
use hecs::{Entity, World};

use super::Changes;
use super::order::order_newcomers;
use crate::color::Rgb;
use crate::components::{
    Ambient, Background, Camera, Falloff, FilmSettings, Light, LightKind, Material, Noise, Order, Projection,
    Quality, Reflective, Sampling, Shape, Specular, View, WorldTransform,
};
use crate::time::Time;
use crate::trace::shapes::{AlignedBox, BoxImage, Plane, Sphere, SphereImage};
use crate::trace::{
    self, Cone, Geometry, LightSource, Precision, PreparedScene, PreparedShape, Slot, SurfaceMaterial,
};

/// The kernel's arrays, and which entity each of their slots stands for.
///
/// Entities with a [`Shape`] and a [`Material`] are drawn. Values that cannot be drawn, such as a scale of zero halfway
/// through an animation or a NaN from a system, leave the entity out of the picture; nothing non-finite gets to the kernel.
#[derive(Clone, Debug)]
pub struct Preparation {
    scene: PreparedScene,
    camera: trace::Camera,
    film: FilmSettings,
    sampling: Sampling,
    entities: Vec<Entity>,
    lights: Vec<Entity>,
    slots: SlotTable,
}

/// The components that say what a surface looks like.
type Surfaced<'a> = (&'a Material, Option<&'a Specular>, Option<&'a Reflective>);

/// Slots by entity. Ids are small and dense, so that a list does.
#[derive(Clone, Debug, Default)]
struct SlotTable(Vec<Option<(Entity, Slot)>>);

impl SlotTable {
    fn insert(&mut self, entity: Entity, slot: Slot) {
        let index = entity.id() as usize;
        if self.0.len() <= index {
            self.0.resize(index + 1, None);
        }
        self.0[index] = Some((entity, slot));
    }

    fn get(&self, entity: Entity) -> Option<Slot> {
        let (found, slot) = self.0.get(entity.id() as usize).copied().flatten()?;
        (found == entity).then_some(slot)
    }
}

impl Preparation {
    /// Reads the whole world.
    #[must_use]
    pub fn of(world: &mut World) -> Self {
        order_newcomers(world, &[]);
        type Drawn<'a> = (&'a Shape, &'a WorldTransform, Surfaced<'a>);
        let mut drawn: Vec<(Order, Entity)> = world
            .query_mut::<hecs::With<(Entity, &Order), (&Shape, &WorldTransform, &Material)>>()
            .into_iter()
            .map(|(entity, order)| (*order, entity))
            .collect();
        drawn.sort_unstable_by_key(|(order, entity)| (*order, entity.id()));

        let mut geometry = Geometry::default();
        let mut materials = Vec::with_capacity(drawn.len());
        let mut entities = Vec::with_capacity(drawn.len());
        let mut slots = SlotTable::default();
        let view = world.view_mut::<Drawn<'_>>();
        for (_, entity) in drawn {
            if let Some((shape, transform, surface)) = view.get(entity)
                && let Some(shape) = prepared_shape(shape, transform)
            {
                slots.insert(entity, geometry.push(shape));
                entities.push(entity);
                materials.push(surface_material(surface));
            }
        }
        let film = film_settings(world);
        let scene = PreparedScene::new(geometry, materials);
        let camera = prepared_camera(world, film);
        let sampling = Sampling::default();
        let mut preparation = Self { scene, camera, film, sampling, entities, lights: Vec::new(), slots };
        preparation.read_settings(world);
        preparation
    }

    /// Reads what has changed. `moved` are the entities whose world transform changed.
    pub fn update(&mut self, world: &mut World, changes: &Changes, moved: &[Entity]) {
        if changes.is_everything() || !self.update_shapes(world, moved) {
            *self = Self::of(world);
            return;
        }
        for entity in changes.materials() {
            if let Some(slot) = self.slots.get(*entity)
                && let Ok(surface) = world.query_one_mut::<Surfaced<'_>>(*entity)
            {
                self.scene.set_material(slot, surface_material(surface));
            }
        }
        self.film = film_settings(world);
        self.camera = prepared_camera(world, self.film);
        self.read_settings(world);
    }

    /// The kernel's scene.
    #[must_use]
    pub fn scene(&self) -> &PreparedScene {
        &self.scene
    }

    /// Sets how precisely the kernel asks shapes.
    pub fn set_precision(&mut self, precision: Precision) {
        self.scene.precision = precision;
    }

    /// The kernel's camera.
    #[must_use]
    pub fn camera(&self) -> &trace::Camera {
        &self.camera
    }

    /// The film's settings.
    #[must_use]
    pub fn film(&self) -> FilmSettings {
        self.film
    }

    /// How many samples every pixel has at this moment, and which.
    #[must_use]
    pub fn sampling(&self, time: Time) -> trace::Sampling {
        let sampling = trace::Sampling { samples: self.sampling.samples, seed: self.sampling.seed };
        match self.sampling.noise {
            Noise::Fixed => sampling,
            Noise::PerFrame => sampling.reseeded(time.lowest_terms().into()),
        }
    }

    /// The entity whose shape is in a slot.
    #[must_use]
    pub fn entity(&self, slot: Slot) -> Entity {
        self.entities[slot.index()]
    }

    /// The entities of the scene's lights, in their order.
    #[must_use]
    pub fn lights(&self) -> &[Entity] {
        &self.lights
    }

    /// Puts moved shapes into their slots; `false` if slots no longer fit and all must be read again.
    fn update_shapes(&mut self, world: &mut World, moved: &[Entity]) -> bool {
        let mut replacements = Vec::new();
        for entity in moved {
            let Ok((shape, transform)) =
                world.query_one_mut::<hecs::With<(&Shape, &WorldTransform), &Material>>(*entity)
            else {
                continue;
            };
            match (self.slots.get(*entity), prepared_shape(shape, transform)) {
                (Some(slot), Some(shape)) if self.scene.geometry().holds(slot, &shape) => {}
                (Some(slot), Some(shape)) => replacements.push((slot, shape)),
                (None, None) => {}
                _ => return false,
            }
        }
        self.scene.replace_shapes(&replacements)
    }

    /// Lights and the settings of the whole scene are few: they are read for every frame.
    fn read_settings(&mut self, world: &mut World) {
        let mut lights: Vec<(Order, Entity, trace::Light)> = world
            .query_mut::<(Entity, &Order, &Light, &WorldTransform)>()
            .into_iter()
            .filter_map(|(entity, order, light, transform)| {
                let own_shape = self.slots.get(entity);
                Some((*order, entity, prepared_light(light, transform, own_shape)?))
            })
            .collect();
        lights.sort_unstable_by_key(|(order, entity, _)| (*order, entity.id()));
        (self.lights, self.scene.lights) =
            lights.into_iter().map(|(_, entity, light)| (entity, light)).unzip();
        self.scene.ambient = sane(first::<Ambient>(world).0);
        let (Background::Flat(background) | Background::Gradient { bottom: background, .. }) = first(world);
        self.scene.background = sane(background);
        let sampling = first::<Sampling>(world);
        self.sampling = Sampling { samples: sampling.samples.clamp(1, Sampling::LARGEST_COUNT), ..sampling };
        self.scene.depth = first::<Quality>(world).depth.clamp(1, Quality::LARGEST_DEPTH);
    }
}

/// The first in document order of a component that a world has at most one of, or its default.
fn first<T: hecs::Component + Default + Clone>(world: &World) -> T {
    let mut query = world.query::<(Entity, Option<&Order>, &T)>();
    let all = query.iter();
    let first = all.min_by_key(|(entity, order, _)| (order.map_or(u64::MAX, |order| order.0), entity.id()));
    first.map(|(.., component)| component.clone()).unwrap_or_default()
}

/// A shape in world space. `None` where it has no extent or is beyond all measure, so that squares of its coordinates
/// would not be numbers any more.
fn prepared_shape(shape: &Shape, transform: &WorldTransform) -> Option<PreparedShape> {
    /// Magnitudes of world coordinates, and the inverse of sizes.
    const LARGEST: f64 = 1e150;
    let matrix = transform.affine.matrix3;
    let translation = transform.affine.translation;
    let largest = matrix.to_cols_array().into_iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
    // Near 1 a determinant is not in danger.
    let unit = matrix * towards_one(largest);
    let measurable = transform.affine.is_finite()
        && (1.0 / LARGEST..LARGEST).contains(&largest)
        && translation.abs().max_element() < LARGEST
        && unit.determinant() != 0.0;
    if !measurable {
        return None;
    }
    let positive = |size: f64| {
        let reach = size * largest;
        size > 0.0 && (1.0 / LARGEST..LARGEST).contains(&reach)
    };
    match *shape {
        Shape::Sphere { radius } => match transform.uniform_scale {
            Some(scale) if positive(radius) => {
                Some(PreparedShape::Sphere(Sphere { center: translation, radius: radius * scale }))
            }
            _ => positive(radius)
                .then(|| PreparedShape::SphereImage(SphereImage::new(transform.affine, radius))),
        },
        Shape::Plane { normal } => {
            // Normals go by the inverse transpose.
            let normal = normal * towards_one(normal.abs().max_element());
            let normal = (unit.inverse().transpose() * normal).try_normalize()?;
            Some(PreparedShape::Plane(Plane { point: translation, normal }))
        }
        Shape::Box { size } => {
            let half = size * 0.5;
            if !(positive(half.x) && positive(half.y) && positive(half.z)) {
                return None;
            }
            let diagonal = DVec3::new(matrix.x_axis.x, matrix.y_axis.y, matrix.z_axis.z);
            if matrix == DMat3::from_diagonal(diagonal) {
                let half = half * diagonal.abs();
                let (min, max) = (translation - half, translation + half);
                let extended = min.cmplt(max).all();
                extended.then_some(PreparedShape::AlignedBox(AlignedBox { min, max }))
            } else {
                Some(PreparedShape::BoxImage(BoxImage::new(transform.affine, half)))
            }
        }
    }
}

/// A power of two that brings a magnitude near 1.
fn towards_one(magnitude: f64) -> f64 {
    libm::ldexp(1.0, -libm::ilogb(magnitude).clamp(-1000, 1000))
}

/// The film's settings, held to their limits.
#[must_use]
pub fn film_settings(world: &World) -> FilmSettings {
    let film = first::<FilmSettings>(world);
    let side = |side: u32| side.clamp(1, FilmSettings::LARGEST_SIDE);
    let width = side(film.width);
    let most_rows = FilmSettings::LARGEST_AREA / u64::from(width);
    let height = side(film.height).min(u32::try_from(most_rows).unwrap_or(u32::MAX));
    FilmSettings { width, height, ..film }
}

fn surface_material((material, specular, reflective): Surfaced<'_>) -> SurfaceMaterial {
    let coefficient = |value: f32| if value > 0.0 { value.min(1.0) } else { 0.0 };
    let shininess = |value: f32| if value > 0.0 { value.min(Specular::LARGEST_SHININESS) } else { 0.0 };
    SurfaceMaterial {
        ambient: sane(material.ambient_color.unwrap_or(material.color)) * coefficient(material.k_a),
        diffuse: sane(material.color) * coefficient(material.k_d),
        specular: specular.map_or(0.0, |specular| coefficient(specular.k_s)),
        shininess: specular.map_or(0.0, |specular| shininess(specular.shininess)),
        reflected: reflective.map_or(0.0, |reflective| coefficient(reflective.k_r)),
    }
}

fn prepared_light(
    light: &Light,
    transform: &WorldTransform,
    own_shape: Option<Slot>,
) -> Option<trace::Light> {
    let source = match light.kind {
        LightKind::Point | LightKind::Area { .. } => LightSource::Point(transform.affine.translation),
        LightKind::Spot { angle, softness } => {
            LightSource::Spot(transform.affine.translation, prepared_cone(angle, softness, transform)?)
        }
        LightKind::Directional { direction } => {
            LightSource::Towards(-transform.affine.transform_vector3(direction))
        }
    };
    let (LightSource::Point(place) | LightSource::Spot(place, _) | LightSource::Towards(place)) = source;
    let falloff = match light.falloff {
        None => None,
        Some(_) if matches!(source, LightSource::Towards(_)) => None,
        Some(falloff) => Some(prepared_falloff(falloff)?),
    };
    place.is_finite().then_some(trace::Light {
        source,
        intensity: sane(light.intensity),
        falloff,
        casts_shadows: light.casts_shadows,
        own_shape,
    })
}

/// The cone about +z as the transform turns it. `None` where it is none.
fn prepared_cone(angle: f64, softness: f64, transform: &WorldTransform) -> Option<Cone> {
    let forward = transform.affine.matrix3.z_axis;
    let axis = (forward * towards_one(forward.abs().max_element())).try_normalize()?;
    let half = 0.5 * angle.min(PI);
    let sane = half > 0.0 && (0.0..=1.0).contains(&softness);
    sane.then(|| Cone { axis, inner: libm::cos((1.0 - softness) * half), outer: libm::cos(half) })
}

/// `None` where it is none: a light must not brighten without bounds.
fn prepared_falloff(falloff: Falloff) -> Option<trace::Falloff> {
    let Falloff { constant, linear, quadratic } = falloff;
    let sane = [constant, linear, quadratic].iter().all(|part| (0.0..=f64::MAX).contains(part));
    (sane && constant > 0.0).then_some(trace::Falloff { constant, linear, quadratic })
}

fn prepared_camera(world: &World, film: FilmSettings) -> trace::Camera {
    let camera = first::<Camera>(world);
    let view = match camera.view {
        View::Direction(direction) => direction,
        View::Target(target) => target - camera.position,
    };
    // The first and last pixel lie on the screen's edges, so that there is one pitch less than there are pixels.
    let gaps = |pixels: u32| f64::from(pixels.saturating_sub(1).max(1));
    let (across, down) = (gaps(film.width), gaps(film.height));
    let (distance, size) = match camera.projection {
        Projection::Screen { distance, width, height } => {
            (distance, (width.unwrap_or(height / down * across), height))
        }
        Projection::FieldOfView { vertical } => {
            let pitch = 2.0 * libm::tan(0.5 * vertical) / f64::from(film.height);
            (1.0, (pitch * across, pitch * down))
        }
    };
    let resolution = (film.width, film.height);
    let pinhole = trace::Camera::new(camera.position, view, camera.up, distance, size, resolution);
    camera.lens.map_or(pinhole, |lens| pinhole.with_lens(lens.aperture, lens.focus))
}

/// Finite and not negative.
fn sane(color: Rgb) -> Rgb {
    Rgb::from_array(color.to_array().map(|channel| if channel > 0.0 { channel.min(f32::MAX) } else { 0.0 }))
}
