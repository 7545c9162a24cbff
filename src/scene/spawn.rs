//! From a validated document to a world.

use std::collections::HashMap;
use std::f64::consts::PI;

use glam::{DQuat, DVec3, Vec3};
use hecs::{Entity, EntityBuilder, World};

use super::document::{
    AnimationDocument, AreaShapeDocument, BackgroundDocument, CameraDocument, EntityDocument, FilmDocument,
    LightDocument, MaterialDocument, NoiseDocument, QualityDocument, RotationDocument, SamplingDocument,
    ScaleDocument, SceneDocument, ShapeDocument, TimelineDocument, TrackDocument, TracksDocument,
    TransferDocument, TransformDocument, Triple,
};
use super::include::Merged;
use super::playback::{Written, keys, playback};
use super::ways::way;
use crate::color::{Rgb, Transfer};
use crate::components::{
    Ambient, Animated, AreaShape, Background, Camera, Channel, Checker, Falloff, FilmSettings, Fog, Follow,
    Lens, Light, LightKind, LookAt, Material, Motion, Name, Noise, Order, Parent, Projection, Quality,
    Reflective, Refractive, Sampling, ScriptId, Shape, Shot, Shots, Specular, Transform, View,
    WorldTransform,
};
use crate::time::{FrameRate, Timeline};
use crate::timeline::{Interpolate, Notation, Playback, Rotation, Track};

/// What a material of the file gives to the entities made of it.
#[derive(Clone, Copy, Debug)]
struct Surface {
    material: Material,
    specular: Option<Specular>,
    reflective: Option<Reflective>,
    refractive: Option<Refractive>,
    checker: Option<Checker>,
}

impl Surface {
    fn add_to(&self, builder: &mut EntityBuilder) {
        builder.add(self.material);
        if let Some(specular) = self.specular {
            builder.add(specular);
        }
        if let Some(reflective) = self.reflective {
            builder.add(reflective);
        }
        if let Some(refractive) = self.refractive {
            builder.add(refractive);
        }
        if let Some(checker) = self.checker {
            builder.add(checker);
        }
    }
}

/// Makes the world that a validated document describes. Entities get their places in document order.
pub(super) fn spawn(Merged { document, parents, .. }: &Merged) -> (World, Timeline) {
    let transfer = transfer(document.film.transfer);
    let timeline = timeline(&document.timeline);
    let mut world = World::new();

    let surfaces: HashMap<&str, Surface> = document
        .materials
        .0
        .iter()
        .map(|(name, material)| (name.as_str(), surface(material, transfer)))
        .collect();
    let mut builder = EntityBuilder::new();
    let entities: Vec<Entity> = document
        .entities
        .iter()
        .zip(0..)
        .map(|(entity, order)| spawn_entity(&mut world, &mut builder, entity, Order(order), &surfaces))
        .collect();
    let cameras: Vec<(&str, Entity)> = document
        .named_cameras()
        .map(|(name, camera)| (name, world.spawn((Name(name.to_owned()), self::camera(camera)))))
        .collect();
    let settings = spawn_settings(&mut world, document, transfer);

    let mut names: HashMap<&str, Entity> = document
        .entities
        .iter()
        .zip(&entities)
        .filter_map(|(entity, id)| Some((entity.name.as_deref()?, *id)))
        .collect();
    names.extend(cameras.iter().copied());
    names.insert(SceneDocument::SCENE, settings);
    for ((_, entity), (_, camera)) in cameras.iter().zip(document.named_cameras()) {
        link(&mut world, *entity, camera, &names);
    }
    let shot =
        |(start, name): &(f64, String)| Some(Shot { start: *start, camera: *names.get(name.as_str())? });
    let mut shots: Vec<Shot> = document.shots.iter().filter_map(shot).collect();
    // Cameras have no place in document order that would say which of several is the first.
    if let [(_, first), _, ..] = cameras[..]
        && shots.is_empty()
    {
        shots.push(Shot { start: 0.0, camera: first });
    }
    // The entity exists: it was spawned above.
    let _ = world.insert_one(settings, Shots(shots));
    for (entity, id) in document.entities.iter().zip(&entities) {
        if let Some(parent) = entity.parent.as_deref().and_then(|parent| names.get(parent)) {
            // The entity exists: it was spawned above.
            let _ = world.insert_one(*id, Parent(*parent));
        }
    }
    for (entity, parent) in parents {
        // As above.
        let _ = world.insert_one(entities[*entity], Parent(entities[*parent]));
    }
    for (entity, channels) in animated(document, &entities, &names, transfer) {
        // The entity exists: it was spawned above.
        let _ = world.insert_one(entity, Animated(channels));
    }
    (world, timeline)
}

/// Ties a camera to the entities that it names.
fn link(world: &mut World, entity: Entity, camera: &CameraDocument, names: &HashMap<&str, Entity>) {
    let named = |name: &Option<String>| names.get(name.as_deref()?).copied();
    let mut builder = EntityBuilder::new();
    if let Some(parent) = named(&camera.parent) {
        builder.add_bundle((Parent(parent), Transform::IDENTITY, WorldTransform::default()));
    }
    if let Some(followed) = named(&camera.follow) {
        builder.add(Follow(followed));
    }
    if let Some(looked_at) = named(&camera.look_at) {
        builder.add(LookAt(looked_at));
    }
    // The entity exists: the camera was spawned before.
    let _ = world.insert(entity, builder.build());
}

fn spawn_entity(
    world: &mut World,
    builder: &mut EntityBuilder,
    document: &EntityDocument,
    order: Order,
    surfaces: &HashMap<&str, Surface>,
) -> Entity {
    builder.add_bundle((order, transform(&document.transform), WorldTransform::default()));
    if let Some(name) = &document.name {
        builder.add(Name(name.clone()));
    }
    if let Some(shape) = &document.shape {
        builder.add(self::shape(shape));
    }
    if let Some(surface) = document.material.as_deref().and_then(|name| surfaces.get(name)) {
        surface.add_to(builder);
    }
    if let Some(light) = &document.light {
        builder.add(self::light(light));
    }
    world.spawn(builder.build())
}

fn spawn_settings(world: &mut World, document: &SceneDocument, transfer: Transfer) -> Entity {
    let mut builder = EntityBuilder::new();
    builder.add_bundle((
        Name(SceneDocument::SCENE.to_owned()),
        film(&document.film),
        Ambient(rgb(document.ambient)),
        background(document.background, transfer),
        quality(&document.quality),
        sampling(&document.sampling),
    ));
    if let Some(fog) = document.fog {
        builder.add(Fog { color: transfer.decode(fog.color.0), density: fog.density });
    }
    world.spawn(builder.build())
}

fn background(document: BackgroundDocument, transfer: Transfer) -> Background {
    match document {
        BackgroundDocument::Flat(color) => Background::Flat(transfer.decode(color.0)),
        BackgroundDocument::Gradient { bottom, top } => {
            Background::Gradient { bottom: transfer.decode(bottom.0), top: transfer.decode(top.0) }
        }
    }
}

fn timeline(document: &TimelineDocument) -> Timeline {
    let part = |value: u64| u32::try_from(value).unwrap_or(u32::MAX);
    let rate = FrameRate::new(part(document.fps.numerator), part(document.fps.denominator));
    Timeline { rate: rate.unwrap_or_default(), duration: document.duration }
}

pub(super) fn transfer(document: TransferDocument) -> Transfer {
    match document {
        TransferDocument::Classic => Transfer::Classic,
        TransferDocument::Srgb => Transfer::Srgb,
    }
}

fn film(document: &FilmDocument) -> FilmSettings {
    let side = |side: u64| u32::try_from(side).unwrap_or(u32::MAX);
    FilmSettings {
        width: side(document.width),
        height: side(document.height),
        transfer: transfer(document.transfer),
    }
}

fn quality(document: &QualityDocument) -> Quality {
    Quality { depth: u32::try_from(document.depth).unwrap_or(u32::MAX), cutoff: single(document.cutoff) }
}

fn sampling(document: &SamplingDocument) -> Sampling {
    let noise = match document.noise {
        NoiseDocument::Fixed => Noise::Fixed,
        NoiseDocument::PerFrame => Noise::PerFrame,
    };
    let count = |count: u64| u32::try_from(count).unwrap_or(u32::MAX);
    Sampling {
        samples: count(document.samples),
        seed: document.seed,
        noise,
        instants: count(document.instants),
    }
}

fn camera(document: &CameraDocument) -> Camera {
    let defaults = Camera::default();
    let view = match (document.target, document.view) {
        (Some(target), _) => View::Target(target.into()),
        (None, Some(view)) => View::Direction(view.into()),
        (None, None) => defaults.view,
    };
    let projection = match (&document.screen, document.fov) {
        (Some(screen), _) => {
            Projection::Screen { distance: screen.distance, width: screen.width, height: screen.height }
        }
        (None, Some(degrees)) => Projection::FieldOfView { vertical: radians(degrees) },
        (None, None) => defaults.projection,
    };
    let lens = document.lens.as_ref().map(|lens| Lens { aperture: lens.aperture, focus: lens.focus });
    Camera {
        position: document.position.into(),
        view,
        up: document.up.into(),
        roll: radians(document.roll),
        projection,
        lens,
        shutter: document.shutter,
    }
}

fn surface(document: &MaterialDocument, transfer: Transfer) -> Surface {
    let material = Material {
        k_a: single(document.k_a),
        k_d: single(document.k_d),
        color: transfer.decode(document.color.0),
        ambient_color: document.ambient_color.map(|color| transfer.decode(color.0)),
    };
    let specular = document
        .specular
        .map(|specular| Specular { k_s: single(specular.k_s), shininess: single(specular.shininess) });
    let reflective = document.reflective.map(|reflective| Reflective { k_r: single(reflective.k_r) });
    let refractive = document.refractive.map(|refractive| Refractive {
        k_t: single(refractive.k_t),
        ior: refractive.ior,
        absorption: rgb(refractive.absorption),
        fresnel: refractive.fresnel,
    });
    let checker = document
        .checker
        .map(|checker| Checker { color: transfer.decode(checker.color.0), size: checker.size });
    Surface { material, specular, reflective, refractive, checker }
}

fn transform(document: &TransformDocument) -> Transform {
    Transform {
        translation: document.translation.into(),
        rotation: rotation(document.rotation),
        scale: scale(document.scale),
    }
}

fn rotation(document: RotationDocument) -> DQuat {
    let rotation = match document {
        RotationDocument::Euler(x, y, z) => Rotation::Euler(DVec3::new(radians(x), radians(y), radians(z))),
        RotationDocument::AxisAngle(axis, angle) => Rotation::AxisAngle(axis.into(), radians(angle)),
        RotationDocument::Quat(x, y, z, w) => Rotation::Quat(x, y, z, w),
    };
    rotation.quaternion()
}

fn scale(document: ScaleDocument) -> DVec3 {
    match document {
        ScaleDocument::Uniform(factor) => DVec3::splat(factor),
        ScaleDocument::PerAxis(factors) => factors.into(),
    }
}

fn shape(document: &ShapeDocument) -> Shape {
    match *document {
        ShapeDocument::Sphere { radius } => Shape::Sphere { radius },
        ShapeDocument::Plane { normal } => Shape::Plane { normal: normal.into() },
        ShapeDocument::Box { size } => Shape::Box { size: size.into() },
    }
}

fn light(document: &LightDocument) -> Light {
    match *document {
        LightDocument::Point { intensity, casts_shadows, falloff } => Light {
            casts_shadows,
            falloff: falloff.map(self::falloff),
            ..Light::new(LightKind::Point, rgb(intensity))
        },
        LightDocument::Spot { intensity, angle, softness, casts_shadows, falloff } => Light {
            casts_shadows,
            falloff: falloff.map(self::falloff),
            ..Light::new(LightKind::Spot { angle: radians(angle), softness }, rgb(intensity))
        },
        LightDocument::Directional { intensity, direction, casts_shadows, .. } => {
            let kind = LightKind::Directional { direction: direction.into() };
            Light { casts_shadows, ..Light::new(kind, rgb(intensity)) }
        }
        LightDocument::Area { shape, intensity, samples, casts_shadows, falloff } => {
            let samples = u32::try_from(samples).unwrap_or(u32::MAX);
            let kind = LightKind::Area { shape: area_shape(shape), samples };
            Light { casts_shadows, falloff: falloff.map(self::falloff), ..Light::new(kind, rgb(intensity)) }
        }
    }
}

fn area_shape(document: AreaShapeDocument) -> AreaShape {
    match document {
        AreaShapeDocument::Sphere { radius } => AreaShape::Sphere { radius },
        AreaShapeDocument::Rectangle { width, height } => AreaShape::Rectangle { width, height },
    }
}

fn falloff([constant, linear, quadratic]: Triple) -> Falloff {
    Falloff { constant, linear, quadratic }
}

/// The channels of every animated entity, in the order of the file. A material's track goes to all entities made of it.
fn animated(
    document: &SceneDocument,
    entities: &[Entity],
    names: &HashMap<&str, Entity>,
    transfer: Transfer,
) -> Vec<(Entity, Vec<Channel>)> {
    let mut channels: HashMap<Entity, Vec<Channel>> = HashMap::new();
    let mut order = Vec::new();
    for animation in &document.animate {
        let Some(channel) = channel(animation, transfer) else {
            continue;
        };
        let targets: Vec<Entity> = match (&animation.target, &animation.material) {
            (Some(name), _) => names.get(name.as_str()).copied().into_iter().collect(),
            (None, material) => {
                let made_of_it =
                    document.entities.iter().zip(entities).filter(|(entity, _)| entity.material == *material);
                made_of_it.map(|(_, id)| *id).collect()
            }
        };
        for target in targets {
            let own = channels.entry(target).or_insert_with(|| {
                order.push(target);
                Vec::new()
            });
            // Applied in order: what an entity says of itself comes after what its material says, and wins.
            if animation.target.is_some() {
                own.push(channel.clone());
            } else {
                own.insert(0, channel.clone());
            }
        }
    }
    order.into_iter().filter_map(|entity| Some((entity, channels.remove(&entity)?))).collect()
}

fn channel(animation: &AnimationDocument, transfer: Transfer) -> Option<Channel> {
    let motion = motion(animation, transfer)?;
    Some(Channel { property: animation.channel.0, motion })
}

fn motion(animation: &AnimationDocument, transfer: Transfer) -> Option<Motion> {
    if let Some(script) = animation.script {
        return Some(Motion::Script(ScriptId(script)));
    }
    let playback = playback(animation);
    match (&animation.track, animation.channel.0.notation()) {
        (TracksDocument::Number(keys), Notation::Degrees) => track(keys, playback, |value| radians(*value)),
        (TracksDocument::Number(keys), _) => track(keys, playback, |value| *value),
        (TracksDocument::Vector(keys), Notation::Light) => track(keys, playback, |value| rgb(*value)),
        (TracksDocument::Vector(keys), _) => track(keys, playback, |value| DVec3::from(*value)),
        (TracksDocument::Scale(keys), _) => track(keys, playback, |value| scale(*value)),
        (TracksDocument::Rotation(keys), _) => track(keys, playback, |value| rotation(*value)),
        (TracksDocument::Color(keys), _) => track(keys, playback, |value| transfer.decode(value.0)),
    }
}

fn track<D: Written, T: Interpolate>(
    document: &TrackDocument<D>,
    playback: Playback,
    value: impl Fn(&D) -> T,
) -> Option<Motion>
where
    Motion: From<Track<T>>,
{
    let TrackDocument::Keys(written) = document else {
        return way(document, playback);
    };
    Track::new(keys(written, value)).map(|track| track.played(playback).into())
}

fn radians(degrees: f64) -> f64 {
    degrees * (PI / 180.0)
}

#[expect(clippy::cast_possible_truncation, reason = "colour is f32")]
fn single(value: f64) -> f32 {
    value as f32
}

fn rgb(document: Triple) -> Rgb {
    Vec3::from_array(document.map(single))
}
