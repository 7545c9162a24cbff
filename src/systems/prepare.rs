//! The only bridge from the world to the kernel.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};
use hecs::{Entity, World};

use super::Changes;
use super::Plan;
use super::order::order_newcomers;
use crate::color::{Rgb, Transfer};
use crate::components::{
    Ambient, AreaShape, Background, Camera, Checker, Falloff, FilmSettings, Fog, Light, LightKind, Material,
    Noise, Order, Projection, Quality, Reflective, Refractive, Sampling, Shape, Specular, View,
    WorldTransform,
};
use crate::time::Time;
use crate::trace::shapes::{AlignedBox, BoxImage, Plane, Sphere, SphereImage};
use crate::trace::{
    self, Cone, Geometry, LightSource, Precision, PreparedScene, PreparedShape, Refraction, Slot, Squares,
    SurfaceMaterial,
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

/// The components that say what a surface looks like, and where its squares are.
type Surfaced<'a> = (
    &'a Shape,
    &'a WorldTransform,
    &'a Material,
    Option<&'a Specular>,
    Option<&'a Reflective>,
    Option<&'a Refractive>,
    Option<&'a Checker>,
);

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
        let view = world.view_mut::<Surfaced<'_>>();
        for (_, entity) in drawn {
            if let Some(surface) = view.get(entity)
                && let Some(shape) = prepared_shape(surface.0, surface.1)
            {
                slots.insert(entity, geometry.push(shape));
                entities.push(entity);
                materials.push(surface_material(surface));
            }
        }
        let film = film_settings(world);
        let mut preparation = Self {
            scene: PreparedScene::new(geometry, materials),
            camera: prepared_camera(world, film),
            film,
            sampling: Sampling::default(),
            entities,
            lights: Vec::new(),
            slots,
        };
        preparation.read_settings(world);
        preparation
    }

    /// Reads what has changed. `moved` are the entities whose world transform changed. Is anything different?
    pub fn update(&mut self, world: &mut World, changes: &Changes, moved: &[Entity]) -> bool {
        if changes.is_everything() {
            *self = Self::of(world);
            return true;
        }
        let Some(shapes_differ) = self.update_shapes(world, moved) else {
            *self = Self::of(world);
            return true;
        };
        let repainted = changes.materials().iter().chain(moved);
        let materials = repainted.filter_map(|entity| {
            let slot = self.slots.get(*entity)?;
            Some((slot, surface_material(world.query_one_mut::<Surfaced<'_>>(*entity).ok()?)))
        });
        let surfaces_differ = self.scene.replace_materials(materials);
        let settings_differ = self.read_settings(world);
        shapes_differ || surfaces_differ || settings_differ
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

    /// What this moment calls for, and why.
    #[must_use]
    pub fn plan(&self, world: &World) -> Plan {
        Plan::of(world, self)
    }

    /// How many samples every pixel has.
    #[must_use]
    pub fn samples(&self) -> u32 {
        self.sampling.samples
    }

    /// Puts moved shapes into their slots, and says whether any has changed; `None` if slots no longer fit and all must be read
    /// again.
    fn update_shapes(&mut self, world: &mut World, moved: &[Entity]) -> Option<bool> {
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
                _ => return None,
            }
        }
        let fits = self.scene.replace_shapes(&replacements);
        fits.then_some(!replacements.is_empty())
    }

    /// The camera, lights and the settings of the whole scene are few: they are read for every frame. Is anything different?
    fn read_settings(&mut self, world: &mut World) -> bool {
        let mut lights: Vec<(Order, Entity, trace::Light)> = world
            .query_mut::<(Entity, &Order, &Light, &WorldTransform)>()
            .into_iter()
            .filter_map(|(entity, order, light, transform)| {
                let own_shape = self.slots.get(entity);
                Some((*order, entity, prepared_light(light, transform, own_shape)?))
            })
            .collect();
        lights.sort_unstable_by_key(|(order, entity, _)| (*order, entity.id()));
        let lights: (Vec<Entity>, Vec<trace::Light>) =
            lights.into_iter().map(|(_, entity, light)| (entity, light)).unzip();
        let film = film_settings(world);
        let camera = prepared_camera(world, film);
        let sampling = sane_sampling(first(world));
        let quality = first::<Quality>(world);
        let ambient = sane(first::<Ambient>(world).0);
        let background = prepared_background(first(world));
        let fog = prepared_fog(first(world));
        let depth = quality.depth.clamp(1, Quality::LARGEST_DEPTH);
        let cutoff = linear_cutoff(quality.cutoff, film.transfer);

        let scene = &mut self.scene;
        let differ = set(&mut scene.lights, lights.1)
            | set(&mut scene.ambient, ambient)
            | set(&mut scene.background, background)
            | set(&mut scene.fog, fog)
            | set(&mut scene.depth, depth)
            | set(&mut scene.cutoff, cutoff)
            | set(&mut self.camera, camera)
            | set(&mut self.film, film)
            | set(&mut self.sampling, sampling);
        self.lights = lights.0;
        differ
    }
}

/// Is it different from what it was?
fn set<T: PartialEq>(place: &mut T, value: T) -> bool {
    let differs = *place != value;
    *place = value;
    differs
}

fn sane_sampling(sampling: Sampling) -> Sampling {
    let samples = sampling.samples.clamp(1, Sampling::LARGEST_COUNT);
    let instants = sampling.instants.clamp(1, Sampling::LARGEST_INSTANTS).min(samples);
    Sampling { samples, instants, ..sampling }
}

/// How a frame is exposed, from the world as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shutter {
    /// At one instant: the camera has none.
    None,
    /// At one instant: no more are asked for, or a pixel has no more samples.
    OneInstant,
    /// Open for a share of the time from frame to frame, at this many instants, more than one.
    Open(f64, u32),
}

/// How a frame is exposed.
#[must_use]
pub(crate) fn shutter(world: &World) -> Shutter {
    let instants = sane_sampling(first(world)).instants;
    match first::<Camera>(world).shutter {
        Some(open) if open > 0.0 && instants > 1 => Shutter::Open(open.min(1.0), instants),
        Some(open) if open > 0.0 => Shutter::OneInstant,
        _ => Shutter::None,
    }
}

/// From steps of 8 bits to linear light. Where output is encoded as sRGB, steps are finest near black.
fn linear_cutoff(codes: f32, transfer: Transfer) -> f32 {
    let steepest = match transfer {
        Transfer::Classic => 1.0,
        Transfer::Srgb => 12.92,
    };
    if codes > 0.0 { codes.min(Quality::LARGEST_CUTOFF) / (255.0 * steepest) } else { 0.0 }
}

fn prepared_background(background: Background) -> trace::Background {
    match background {
        Background::Flat(color) => trace::Background::Flat(sane(color)),
        Background::Gradient { bottom, top } => {
            trace::Background::Gradient { bottom: sane(bottom), top: sane(top) }
        }
    }
}

fn prepared_fog(fog: Fog) -> trace::Fog {
    let density = if fog.density > 0.0 { fog.density.min(f64::MAX) } else { 0.0 };
    trace::Fog { color: sane(fog.color), density }
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

fn surface_material(
    (shape, transform, material, specular, reflective, refractive, checker): Surfaced<'_>,
) -> SurfaceMaterial {
    let shininess = |value: f32| if value > 0.0 { value.min(Specular::LARGEST_SHININESS) } else { 0.0 };
    let (k_a, k_d) = (coefficient(material.k_a), coefficient(material.k_d));
    let checker = checker.and_then(|checker| {
        let squares = prepared_squares(checker, shape, transform)?;
        let color = sane(checker.color);
        let ambient = material.ambient_color.map_or(color, sane);
        Some(Box::new(trace::Checker { ambient: ambient * k_a, diffuse: color * k_d, squares }))
    });
    SurfaceMaterial {
        ambient: sane(material.ambient_color.unwrap_or(material.color)) * k_a,
        diffuse: sane(material.color) * k_d,
        specular: specular.map_or(0.0, |specular| coefficient(specular.k_s)),
        shininess: specular.map_or(0.0, |specular| shininess(specular.shininess)),
        reflected: reflective.map_or(0.0, |reflective| coefficient(reflective.k_r)),
        refraction: refractive.and_then(prepared_refraction),
        checker,
    }
}

/// 0..=1.
fn coefficient(value: f32) -> f32 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

fn prepared_refraction(refractive: &Refractive) -> Option<Refraction> {
    let transmitted = coefficient(refractive.k_t);
    let sane_ior = refractive.ior > 0.0;
    (transmitted > 0.0 && sane_ior).then(|| Refraction {
        transmitted,
        ior: refractive.ior.clamp(Refractive::SMALLEST_IOR, Refractive::LARGEST_IOR),
        absorption: sane(refractive.absorption),
        fresnel: refractive.fresnel,
    })
}

/// `None` where there are none: on spheres, and where squares have no size.
fn prepared_squares(checker: &Checker, shape: &Shape, transform: &WorldTransform) -> Option<Squares> {
    let (map, size) = (transform.affine, checker.size);
    if size.is_nan() || size <= 0.0 {
        return None;
    }
    match *shape {
        Shape::Sphere { .. } => None,
        Shape::Plane { normal } => Some(Squares::on_plane(map, normal, size)),
        Shape::Box { size: edges } => Some(Squares::on_box(map, edges * 0.5, size)),
    }
}

fn prepared_light(
    light: &Light,
    transform: &WorldTransform,
    own_shape: Option<Slot>,
) -> Option<trace::Light> {
    let center = transform.affine.translation;
    let source = match light.kind {
        LightKind::Point => LightSource::Point(center),
        LightKind::Area { shape, .. } => prepared_area(shape, transform)?,
        LightKind::Spot { angle, softness } => {
            LightSource::Spot(center, prepared_cone(angle, softness, transform)?)
        }
        LightKind::Directional { direction } => {
            LightSource::Towards(-transform.affine.transform_vector3(direction))
        }
    };
    let place = match source {
        LightSource::Towards(direction) => direction,
        _ => center,
    };
    let falloff = match light.falloff {
        None => None,
        Some(_) if matches!(source, LightSource::Towards(_)) => None,
        Some(falloff) => Some(prepared_falloff(falloff)?),
    };
    place.is_finite().then_some(trace::Light {
        source,
        intensity: sane(light.intensity),
        falloff,
        samples: match light.kind {
            LightKind::Area { samples, .. } => samples.clamp(1, AreaShape::LARGEST_SAMPLES),
            _ => 1,
        },
        casts_shadows: light.casts_shadows,
        own_shape,
    })
}

/// What shines of an area light. `None` where that is not a finite size.
fn prepared_area(shape: AreaShape, transform: &WorldTransform) -> Option<LightSource> {
    let (center, linear) = (transform.affine.translation, transform.affine.matrix3);
    match shape {
        AreaShape::Sphere { radius } => {
            let scale = transform.uniform_scale.unwrap_or_else(|| libm::cbrt(linear.determinant().abs()));
            let radius = radius * scale;
            (0.0..=f64::MAX).contains(&radius).then_some(LightSource::Ball { center, radius })
        }
        AreaShape::Rectangle { width, height } => {
            let halves = [linear.x_axis * (0.5 * width), linear.y_axis * (0.5 * height)];
            halves.iter().all(|half| half.is_finite()).then_some(LightSource::Panel { center, halves })
        }
    }
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
