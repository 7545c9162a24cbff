//! Builds the world of a validated document.

mod entities;
mod value_text;

use std::f64::consts::PI;

use glam::{DQuat, DVec3, Vec3};
use hashbrown::{HashMap, HashSet};
use hecs::{Entity, EntityBuilder, World};
use rayon::prelude::*;

pub(super) use value_text::value_text;

use self::entities::{Links, MaterialComponents, surface};
use super::document::{
    AmbientOcclusionDocument, AnchorDocument, AnimationDocument, BackgroundDocument, CameraDocument,
    EasingDocument, EntityDocument, FilmDocument, FogDocument, KeyDocument, MaterialDocument, NoiseDocument,
    NormDocument, OverlayDocument, QualityDocument, RotationDocument, SamplingDocument, ScaleDocument,
    SceneDocument, ShotDocument, SpaceDocument, StarsDocument, SunDocument, TimelineDocument, TrackDocument,
    TracksDocument, TransferDocument, Triple, parse_particle_name,
};
use super::files::Merged;
use super::paths::motion_along;
use super::playback::{ValueDocument, keys, playback};
use crate::animation::{Interpolate, Notation, Playback, Rotation, Track};
use crate::color::{ColorRamp, ErrorNorm, Rgb, Transfer};
use crate::components::{
    Ambient, AmbientOcclusion, Anchor, Animated, AtParticle, Background, Camera, Channel, FilmSettings,
    FocusOn, Fog, Follow, Lens, LookAt, Motion, Name, Noise, Overlay, OverlayContent, OverlayItem, Parent,
    Projection, Property, Quality, Sampling, ScriptId, ShortTurn, Shot, Shots, Space, Stars, Sun, TextPart,
    Transform, View, Way, WorldTransform,
};
use crate::time::{FrameRate, Timeline};

/// Builds the world and the timeline of a validated document. Entities are numbered in document order.
pub(super) fn spawn(Merged { document, parents, .. }: &Merged) -> (World, Timeline) {
    let transfer = transfer(document.film.transfer);
    let timeline = timeline(&document.timeline);
    let mut world = World::new();

    let count = u32::try_from(document.entities.len()).unwrap_or(u32::MAX);
    let entities: Vec<Entity> = world.reserve_entities(count).collect();
    world.flush();
    let cameras: Vec<(&str, Entity)> = document
        .named_cameras()
        .map(|(name, camera)| (name, world.spawn((Name::new(name), self::camera(camera)))))
        .collect();
    let settings = spawn_settings(&mut world, document, transfer);

    let (mut names, particles) = referred_to(document, &entities);
    for (name, cloud, number) in particles {
        let placed = (AtParticle(number), Parent(cloud), Transform::IDENTITY, WorldTransform::default());
        names.insert(name, world.spawn(placed));
    }
    names.extend(cameras.iter().copied());
    names.insert(SceneDocument::SCENE, settings);
    for ((_, entity), (_, camera)) in cameras.iter().zip(document.named_cameras()) {
        link(&mut world, *entity, camera, &names);
    }
    let shot = |ShotDocument(start, name): &ShotDocument| {
        Some(Shot { start: *start, camera: *names.get(name.as_str())? })
    };
    let mut shots: Vec<Shot> = document.shots.iter().filter_map(shot).collect();
    // Cameras have no `Order` component that would define which of several is the first.
    if let [(_, first), _, ..] = cameras[..]
        && shots.is_empty()
    {
        shots.push(Shot { start: 0.0, camera: first });
    }
    let overlay = document.overlay.iter().filter_map(|item| overlay_item(item, &names, transfer));
    let overlay: Vec<OverlayItem> = overlay.collect();
    if !overlay.is_empty() {
        // The entity exists: it was spawned above.
        let _ = world.insert_one(settings, Overlay(overlay));
    }
    // The entity exists, as above.
    let _ = world.insert_one(settings, Shots(shots));

    let mut channels = animated(document, &entities, &names, transfer);
    for entity in cameras.iter().map(|(_, camera)| *camera).chain([settings]) {
        if let Some(channels) = channels.remove(&entity) {
            // The entity exists, as above.
            let _ = world.insert_one(entity, Animated(channels));
        }
    }
    let named = document.entities.iter().map(|entity| names.get(entity.parent.as_deref()?.as_str()).copied());
    let named = named.enumerate().filter_map(|(entity, parent)| Some((entity, parent?)));
    let unnamed = parents.iter().map(|(entity, parent)| (*entity, entities[*parent]));
    let parents: HashMap<usize, Entity> = named.chain(unnamed).collect();
    let looking =
        document.entities.iter().map(|entity| names.get(entity.look_at.as_deref()?.as_str()).copied());
    let looking = looking.enumerate().filter_map(|(entity, looked_at)| Some((entity, looked_at?))).collect();
    let materials = || document.materials.0.iter().map(|(name, material)| (name.as_str(), material));
    let surfaces = materials().map(|(name, material)| (name, surface(material, transfer))).collect();
    let own_surfaces = own_surfaces(document, &materials().collect(), transfer);
    let links = Links { parents, looking, channels, surfaces, own_surfaces };
    entities::spawn(&mut world, &entities, &document.entities, links);
    (world, timeline)
}

/// Returns the surfaces of the entities that have a material of their own, in document order.
fn own_surfaces(
    document: &SceneDocument,
    materials: &HashMap<&str, &MaterialDocument>,
    transfer: Transfer,
) -> Vec<MaterialComponents> {
    let own = document.entities.par_iter().filter(|entity| entity.has_own_material());
    let own = own.map(|entity| entity.own_material(|name| materials.get(name).copied()));
    own.map(|material| surface(&material, transfer)).collect()
}

/// The name of a particle, its cloud and its number.
type NamedParticle<'a> = (&'a str, Entity, u64);

/// Returns the entities that are referred to by name, and the particles: their names, clouds and numbers.
fn referred_to<'a>(
    document: &'a SceneDocument,
    entities: &[Entity],
) -> (HashMap<&'a str, Entity>, Vec<NamedParticle<'a>>) {
    let parents =
        document.entities.iter().flat_map(|entity| [entity.parent.as_deref(), entity.look_at.as_deref()]);
    let targets = document.animate.iter().map(|animation| animation.target.as_ref());
    let cameras = document.named_cameras().flat_map(|(_, camera)| camera.links().map(|(_, name)| name));
    let explained = document.overlay.iter().map(OverlayDocument::cloud);
    let names = parents.chain(targets).chain(cameras).chain(explained).flatten();
    let wanted: HashSet<&str> = names.map(String::as_str).collect();
    if wanted.is_empty() {
        return (HashMap::new(), Vec::new());
    }
    let named = document.entities.iter().zip(entities);
    let named = named.filter_map(|(entity, id)| Some((entity.name.as_deref()?, *id)));
    let clouds = wanted.iter().filter_map(|name| parse_particle_name(name)).map(|(cloud, _)| cloud);
    let clouds: HashSet<&str> = clouds.collect();
    let named: HashMap<&str, Entity> =
        named.filter(|(name, _)| wanted.contains(name) || clouds.contains(name)).collect();
    let mut particles: Vec<NamedParticle<'_>> = wanted
        .into_iter()
        .filter(|name| !named.contains_key(name))
        .filter_map(|name| {
            parse_particle_name(name).and_then(|(cloud, number)| Some((name, *named.get(cloud)?, number)))
        })
        .collect();
    // The set has no order, and ids are given in turn.
    particles.sort_unstable();
    (named, particles)
}

/// Links a camera to the entities that it names.
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
    if let Some(focused) = named(&camera.focus_on) {
        builder.add(FocusOn(focused));
    }
    // The entity exists: the camera was spawned before.
    let _ = world.insert(entity, builder.build());
}

fn spawn_settings(world: &mut World, document: &SceneDocument, transfer: Transfer) -> Entity {
    let mut builder = EntityBuilder::new();
    builder.add_bundle((
        Name::new(SceneDocument::SCENE),
        film(&document.film),
        Ambient(rgb(document.ambient)),
        background(&document.background, transfer),
        quality(&document.quality),
        sampling(&document.sampling),
        space(document.space),
    ));
    if let Some(AmbientOcclusionDocument { samples, distance }) = document.ambient_occlusion {
        builder.add(AmbientOcclusion { samples: u32::try_from(samples).unwrap_or(u32::MAX), distance });
    }
    if let Some(sun) = document.sun {
        let SunDocument { direction, intensity, size, glow, glow_size } = sun;
        let [size, glow_size] = [size, glow_size].map(f64::to_radians);
        builder.add(Sun { direction: direction.into(), intensity: rgb(intensity), size, glow, glow_size });
    }
    if let Some(StarsDocument { count, intensity, size, seed }) = document.stars {
        let count = u32::try_from(count).unwrap_or(u32::MAX);
        builder.add(Stars { count, intensity: rgb(intensity), size: size.to_radians(), seed });
    }
    if let Some(fog) = document.fog {
        let FogDocument { color, density, height, level, hides_background } = fog;
        let (color, hides_background) = (transfer.decode(color.0), hides_background.unwrap_or(true));
        builder.add(Fog { color, density, height, level, hides_background });
    }
    world.spawn(builder.build())
}

fn overlay_item(
    document: &OverlayDocument,
    names: &HashMap<&str, Entity>,
    transfer: Transfer,
) -> Option<OverlayItem> {
    let named = |name: &String| names.get(name.as_str()).copied();
    let content = match document {
        OverlayDocument::Text { text, cloud, .. } => OverlayContent::Text {
            parts: TextPart::parse(text).ok()?,
            cloud: match cloud {
                Some(cloud) => Some(named(cloud)?),
                None => None,
            },
        },
        OverlayDocument::ScaleBar { length, label, at, .. } => {
            OverlayContent::ScaleBar { length: *length, label: label.clone(), at: at.map(DVec3::from) }
        }
        OverlayDocument::Legend { cloud, title, .. } => {
            OverlayContent::Legend { cloud: named(cloud)?, title: title.clone() }
        }
    };
    let (anchor, size, color) = document.look();
    let anchor = match anchor {
        AnchorDocument::TopLeft => Anchor::TopLeft,
        AnchorDocument::Top => Anchor::Top,
        AnchorDocument::TopRight => Anchor::TopRight,
        AnchorDocument::Left => Anchor::Left,
        AnchorDocument::Center => Anchor::Center,
        AnchorDocument::Right => Anchor::Right,
        AnchorDocument::BottomLeft => Anchor::BottomLeft,
        AnchorDocument::Bottom => Anchor::Bottom,
        AnchorDocument::BottomRight => Anchor::BottomRight,
    };
    let (times, fade) = document.times();
    let times = times.map(<[f64; 2]>::from);
    Some(OverlayItem { content, anchor, size, color: transfer.decode(color.0), times, fade })
}

fn background(document: &BackgroundDocument, transfer: Transfer) -> Background {
    match document {
        BackgroundDocument::Flat(color) => Background::Flat(transfer.decode(color.0)),
        BackgroundDocument::Gradient { bottom, horizon, top } => Background::Gradient {
            bottom: transfer.decode(bottom.0),
            horizon: horizon.map(|horizon| transfer.decode(horizon.0)),
            top: transfer.decode(top.0),
        },
        BackgroundDocument::Stops(stops) => {
            let stops: Vec<_> =
                stops.iter().map(|(height, color)| (*height, transfer.decode(color.0))).collect();
            // Validation has refused all stops that are no ramp.
            ColorRamp::new(&stops).map_or_else(Background::default, Background::Stops)
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

fn space(document: Option<SpaceDocument>) -> Space {
    match document.unwrap_or_default() {
        SpaceDocument::LeftHanded => Space::LeftHanded,
        SpaceDocument::RightHanded => Space::RightHanded,
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
        min_samples: count(document.min_samples),
        max_error: single(document.max_error),
        norm: match document.norm {
            NormDocument::Rms => ErrorNorm::Rms,
            NormDocument::Max => ErrorNorm::Max,
            NormDocument::P99 => ErrorNorm::P99,
        },
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
    let screen = document.screen.as_ref().map(|screen| Projection::Screen {
        distance: screen.distance,
        width: screen.width,
        height: screen.height,
    });
    let vertical = document.fov.map(|degrees| Projection::FieldOfView { vertical: radians(degrees) });
    let horizontal = document
        .horizontal_fov
        .map(|degrees| Projection::HorizontalFieldOfView { horizontal: radians(degrees) });
    let orthographic = document.orthographic.map(|height| Projection::Orthographic { height });
    let projection = screen.or(vertical).or(horizontal).or(orthographic).unwrap_or(defaults.projection);
    // With `focus_on`, the distance matters only while its entity is behind the camera.
    let lens = document.lens.as_ref();
    let lens = lens.map(|lens| Lens { aperture: lens.aperture, focus: lens.focus.unwrap_or(1.0) });
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

fn rotation(document: RotationDocument) -> DQuat {
    let rotation = match document {
        RotationDocument::Euler(x, y, z) => Rotation::Euler(DVec3::new(x, y, z)),
        RotationDocument::AxisAngle(axis, angle) => Rotation::AxisAngle(axis.into(), angle),
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

/// Returns the channels of every animated entity. A track of a material applies to all entities with that material, before their own
/// tracks; a track of its colour not to those with a colour of their own.
fn animated(
    document: &SceneDocument,
    entities: &[Entity],
    names: &HashMap<&str, Entity>,
    transfer: Transfer,
) -> HashMap<Entity, Vec<Channel>> {
    let mut channels: HashMap<Entity, Vec<Channel>> = HashMap::new();
    for animation in &document.animate {
        let Some(channel) = channel(animation, transfer) else {
            continue;
        };
        let targets: Vec<Entity> = match (&animation.target, &animation.material) {
            (Some(name), _) => names.get(name.as_str()).copied().into_iter().collect(),
            (None, material) => {
                // A colour of the entity takes the place of the material's, also where that changes.
                let is_color = animation.channel.0 == Property::Color;
                let is_made_of_it = |entity: &EntityDocument| {
                    entity.material_name() == material.as_deref() && !(is_color && entity.color.is_some())
                };
                let all = document.entities.iter().zip(entities);
                all.filter(|(entity, _)| is_made_of_it(entity)).map(|(_, id)| *id).collect()
            }
        };
        for target in targets {
            let own = channels.entry(target).or_default();
            // Channels are applied in order: the entity's own channels follow the channels of its material, and take precedence.
            if animation.target.is_some() {
                own.push(channel.clone());
            } else {
                own.insert(0, channel.clone());
            }
        }
    }
    for animation in document.animate.iter().filter(|animation| animation.track.is_along()) {
        let target = animation.target.as_deref().and_then(|name| names.get(name));
        if let Some(own) = target.and_then(|target| channels.get_mut(target)) {
            let motion = along(animation.channel.0, own);
            own.extend(motion.map(|motion| Channel::new(animation.channel.0, motion)));
        }
    }
    channels
}

/// Returns the motion of a property along the way of the same entity's position, given its other channels.
fn along(property: Property, channels: &[Channel]) -> Option<Motion> {
    let position = property.along()?;
    let way = channels.iter().rfind(|channel| channel.property == position)?;
    let way = Way::of(&way.motion)?;
    Some(if property == Property::View { Motion::Direction(way) } else { Motion::Facing(way) })
}

fn channel(animation: &AnimationDocument, transfer: Transfer) -> Option<Channel> {
    let motion = motion(animation, transfer)?;
    let short_turn = match &animation.track {
        TracksDocument::Rotation(TrackDocument::Keys(keys)) => short_turn(keys),
        _ => None,
    };
    Some(Channel { property: animation.channel.0, motion, short_turn })
}

/// Returns the first adjacent keys with angles in the same notation that differ by more than half a turn.
fn short_turn(keys: &[KeyDocument<RotationDocument>]) -> Option<ShortTurn> {
    let turning = keys.windows(2).filter(|pair| pair[0].easing != EasingDocument::Hold);
    turning
        .flat_map(|pair| written_angles(pair[0].value, pair[1].value).map(move |angles| (pair, angles)))
        .find_map(|(pair, angles)| {
            let times = [pair[0].time, pair[1].time];
            ((angles[1] - angles[0]).abs() > 180.0).then_some(ShortTurn { times, angles })
        })
}

/// Returns the pairs of corresponding angles of two rotations in the same notation.
fn written_angles(from: RotationDocument, to: RotationDocument) -> impl Iterator<Item = [f64; 2]> {
    let pairs = match (from, to) {
        (RotationDocument::Euler(x, y, z), RotationDocument::Euler(to_x, to_y, to_z)) => {
            [Some([x, to_x]), Some([y, to_y]), Some([z, to_z])]
        }
        (RotationDocument::AxisAngle(axis, angle), RotationDocument::AxisAngle(to_axis, to_angle))
            if axis == to_axis =>
        {
            [Some([angle, to_angle]), None, None]
        }
        _ => [None; 3],
    };
    pairs.into_iter().flatten()
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
        (TracksDocument::Flag(keys), _) => track(keys, playback, |value| *value),
    }
}

fn track<D: ValueDocument, T: Interpolate>(
    document: &TrackDocument<D>,
    playback: Playback,
    value: impl Fn(&D) -> T,
) -> Option<Motion>
where
    Motion: From<Track<T>>,
{
    let TrackDocument::Keys(written) = document else {
        return motion_along(document, playback);
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
