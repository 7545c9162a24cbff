//! Finds the faults of a prepared world.

use std::f64::consts::PI;

use glam::DVec3;
use hecs::{Component, Entity, World};

use super::Preparation;
use super::camera::{active_camera_entity, position_of};
use super::light::prepared_light;
use super::material::Surfaced;
use super::settings::first_entity;
use super::shape::prepared_shape;
use crate::color::Rgb;
use crate::components::{
    Ambient, Animated, AreaShape, Background, Camera, FilmSettings, Fog, Follow, Light, LightKind, LookAt,
    Material, Motion, Order, Projection, Property, Quality, Refractive, Sampling, Shape, Shots, Specular,
    Transform, View, WorldTransform,
};
use crate::systems::{Consequence, Fallback, Fault, FaultCause};
use crate::trace::LightSource;

/// The valid range of coefficients.
const SHARE: &str = "from 0 to 1";
/// The valid range of light and colours.
const POSITIVE: &str = "0 or more, and finite";

impl Preparation {
    /// Returns the faults of the world, which must be at the prepared moment, in document order. They cover every shape that is not drawn,
    /// every light that gives no light because of an invalid value, and all other values that are not used as given.
    #[must_use]
    pub fn faults(&self, world: &World) -> Vec<Fault> {
        let mut faults = Vec::new();
        self.shape_faults(world, &mut faults);
        let surfaced = self.unsound.iter();
        faults.extend(surfaced.filter_map(|entity| {
            let mut query = world.query_one::<Surfaced<'_>>(*entity);
            surface_fault(*entity, query.get().ok()?)
        }));
        light_faults(world, &mut faults);
        camera_faults(world, self, &mut faults);
        setting_faults(world, &mut faults);
        turn_faults(world, &mut faults);
        let order = |fault: &Fault| world.get::<&Order>(fault.entity).map_or(u64::MAX, |order| order.0);
        faults.sort_by_key(|fault| (order(fault), fault.entity.id()));
        faults
    }

    fn shape_faults(&self, world: &World, faults: &mut Vec<Fault>) {
        let with_shape = world.archetypes().filter(|archetype| archetype.has::<Shape>());
        let shapes: u32 = with_shape.map(hecs::Archetype::len).sum();
        if shapes as usize == self.entities.len() {
            return;
        }
        let mut query = world.query::<(
            Entity,
            &Shape,
            Option<&Transform>,
            Option<&WorldTransform>,
            hecs::Satisfies<&Material>,
        )>();
        for (entity, shape, own, transform, has_material) in &mut query {
            if self.slots.get(entity).is_some() {
                continue;
            }
            let cause = match transform {
                _ if !has_material => FaultCause::NoMaterial,
                None => FaultCause::Undeclared,
                Some(transform) => match prepared_shape(shape, transform) {
                    Ok(_) => FaultCause::Undeclared,
                    Err(cause) => explained(cause, own),
                },
            };
            faults.push(Fault { entity, consequence: Consequence::NotDrawn, cause });
        }
    }
}

/// Refines the cause of a transform fault, given the entity's own transform.
fn explained(cause: FaultCause, own: Option<&Transform>) -> FaultCause {
    let Some(Transform { translation, rotation, scale }) = own else { return cause };
    match cause {
        FaultCause::NotFinite("transform") => match () {
            () if !translation.is_finite() => FaultCause::NotFinite("translation"),
            () if !rotation.is_finite() => FaultCause::NotFinite("rotation"),
            () if !scale.is_finite() => FaultCause::NotFinite("scale"),
            () => FaultCause::Overflow,
        },
        FaultCause::Flat if scale.cmpeq(DVec3::ZERO).any() => FaultCause::NoScale,
        other => other,
    }
}

fn instead(entity: Entity, cause: FaultCause, instead: Fallback) -> Fault {
    Fault { entity, consequence: Consequence::Fallback(instead), cause }
}

/// The first fault found in the values of an entity.
struct Checked {
    entity: Entity,
    fault: Option<Fault>,
}

impl Checked {
    fn new(entity: Entity) -> Self {
        Self { entity, fault: None }
    }

    /// Checks a number, which is clamped if it is out of range.
    fn number(&mut self, what: &'static str, value: f64, (least, most): (f64, f64), range: &'static str) {
        if !(least..=most).contains(&value) && self.fault.is_none() {
            let held = if value > most { most } else { least };
            let cause = FaultCause::OutOfRange { what, value, range };
            self.fault = Some(instead(self.entity, cause, Fallback::Number(held)));
        }
    }

    /// Checks a colour.
    fn color(&mut self, what: &'static str, color: Rgb) {
        for channel in color.to_array() {
            self.number(what, channel.into(), (0.0, f32::MAX.into()), POSITIVE);
        }
    }

    /// Checks an optional part of an entity, which is ignored if it is invalid.
    fn part(&mut self, what: &'static str, value: f64, is_good: bool, range: &'static str) {
        if !is_good && self.fault.is_none() {
            let cause = FaultCause::OutOfRange { what, value, range };
            self.fault = Some(instead(self.entity, cause, Fallback::Nothing));
        }
    }
}

/// Returns the first fault of a surface.
pub(super) fn surface_fault(entity: Entity, surfaced: Surfaced<'_>) -> Option<Fault> {
    let (_, _, material, specular, reflective, refractive, checker) = surfaced;
    let mut checked = Checked::new(entity);
    let share = |checked: &mut Checked, what, value: f32| {
        checked.number(what, value.into(), (0.0, 1.0), SHARE);
    };
    share(&mut checked, "k_a", material.k_a);
    share(&mut checked, "k_d", material.k_d);
    checked.color("color", material.color);
    checked.color("ambient_color", material.ambient_color.unwrap_or_default());
    if let Some(Specular { k_s, shininess }) = specular {
        share(&mut checked, "k_s", *k_s);
        let most = Specular::LARGEST_SHININESS.into();
        checked.number("shininess", f64::from(*shininess), (0.0, most), "from 0 to 1e6");
    }
    if let Some(reflective) = reflective {
        share(&mut checked, "k_r", reflective.k_r);
    }
    if let Some(Refractive { k_t, ior, absorption, .. }) = refractive {
        share(&mut checked, "k_t", *k_t);
        checked.part("ior", *ior, *ior > 0.0, "from 0.001 to 1000");
        let limits = (Refractive::SMALLEST_IOR, Refractive::LARGEST_IOR);
        checked.number("ior", *ior, limits, "from 0.001 to 1000");
        checked.color("absorption", *absorption);
    }
    if let Some(checker) = checker {
        checked.part("square size", checker.size, checker.size > 0.0, "greater than 0");
        checked.color("checker colour", checker.color);
    }
    checked.fault
}

fn light_faults(world: &World, faults: &mut Vec<Fault>) {
    let mut query = world.query::<(Entity, &Light, Option<&Transform>, Option<&WorldTransform>)>();
    for (entity, light, own, transform) in &mut query {
        let prepared = transform
            .ok_or(FaultCause::Undeclared)
            .and_then(|transform| prepared_light(light, transform, None));
        // Such a light is still prepared, so that it keeps its index among the lights.
        let prepared = prepared.and_then(|light| match light.source {
            LightSource::Directional(DVec3::ZERO) => Err(FaultCause::NoDirection("direction")),
            _ => Ok(light),
        });
        if let Err(cause) = prepared {
            faults.push(Fault { entity, consequence: Consequence::NoLight, cause: explained(cause, own) });
            continue;
        }
        let mut checked = Checked::new(entity);
        checked.color("intensity", light.intensity);
        match light.kind {
            LightKind::Spot { angle, .. } => {
                checked.number("angle", angle, (0.0, PI), "greater than 0, and at most pi");
            }
            LightKind::Area { samples, .. } => {
                let most = AreaShape::LARGEST_SAMPLES.into();
                checked.number("number of samples", samples.into(), (1.0, most), "from 1 to 4096");
            }
            LightKind::Point | LightKind::Directional { .. } => {}
        }
        faults.extend(checked.fault);
    }
}

/// Finds the faults of the active camera.
fn camera_faults(world: &World, prepared: &Preparation, faults: &mut Vec<Fault>) {
    if let Some(entity) = first_entity::<Shots>(world) {
        let shots = world.get::<&Shots>(entity);
        let gone = |shots: &Shots| shots.0.iter().any(|shot| !world.satisfies::<&Camera>(shot.camera));
        if shots.is_ok_and(|shots| gone(&shots)) {
            faults.push(instead(entity, FaultCause::Missing("cuts to"), Fallback::Nothing));
        }
    }
    let Some(entity) = active_camera_entity(world, prepared.moment) else { return };
    let Ok(camera) = world.get::<&Camera>(entity) else { return };
    let followed = world.get::<&Follow>(entity).map(|follow| follow.0);
    let looked_at = world.get::<&LookAt>(entity).map(|look_at| look_at.0);
    let looks_at_entity = looked_at.is_ok();
    for (linked, what) in [(followed, "follows"), (looked_at, "looks at")] {
        if linked.is_ok_and(|linked| position_of(world, Some(linked)).is_none()) {
            faults.push(instead(entity, FaultCause::Missing(what), Fallback::Nothing));
        }
    }
    if let Some(cause) = target_ends(world, entity).filter(|_| !looks_at_entity)
        && matches!(cause, FaultCause::TargetEnds { target, .. } if target <= prepared.moment.seconds())
    {
        faults.push(Fault { entity, consequence: Consequence::FixedTarget, cause });
    }
    if !prepared.camera.position().is_finite() {
        let cause = FaultCause::NotFinite("place");
        faults.push(Fault { entity, consequence: Consequence::NothingSeen, cause });
        return;
    }
    if let Some((cause, value)) = projection_fault(camera.projection) {
        let consequence = if value.is_finite() { Consequence::Distorted } else { Consequence::NothingSeen };
        faults.push(Fault { entity, consequence, cause });
    }
    let looked = match camera.view {
        View::Direction(view) => view,
        View::Target(target) => target,
    };
    if !looked.is_finite() {
        faults.push(instead(entity, FaultCause::NotFinite("view"), Fallback::AlongZ));
    }
    let mut checked = Checked::new(entity);
    checked.part("roll", camera.roll, camera.roll.is_finite(), "finite");
    if let Some(lens) = camera.lens {
        let sane = (0.0..=f64::MAX).contains(&lens.aperture);
        checked.part("aperture", lens.aperture, sane, POSITIVE);
        let sane = lens.focus > 0.0 && lens.focus.is_finite();
        checked.part("focus", lens.focus, sane, "greater than 0, and finite");
    }
    if let Some(shutter) = camera.shutter {
        checked.part("shutter", shutter, shutter > 0.0, "greater than 0, and at most 1");
        checked.number("shutter", shutter, (0.0, 1.0), "greater than 0, and at most 1");
    }
    faults.extend(checked.fault);
}

/// Returns a fault if the path of a camera's target ends earlier than the path of its position, by more than rounding.
fn target_ends(world: &World, camera: Entity) -> Option<FaultCause> {
    const ROUNDING: f64 = 1e-9;
    let animated = world.get::<&Animated>(camera).ok()?;
    let end = |property: Property| {
        let channel = animated.0.iter().rfind(|channel| channel.property == property)?;
        match &channel.motion {
            Motion::Path(path) if path.length() > 0.0 => path.end(),
            _ => None,
        }
    };
    let (target, position) = (end(Property::Target)?, end(Property::Position)?);
    (position - target > ROUNDING).then_some(FaultCause::TargetEnds { target, position })
}

/// Returns the cause of an empty or inverted screen, with the value responsible.
fn projection_fault(projection: Projection) -> Option<(FaultCause, f64)> {
    let wrong = |what, value: f64| (!(value > 0.0 && value.is_finite())).then_some((what, value));
    match projection {
        Projection::Screen { distance, width, height } => wrong("screen's distance", distance)
            .or_else(|| wrong("screen's height", height))
            .or_else(|| wrong("screen's width", width?))
            .map(|(what, value)| (FaultCause::NotPositive(what, value), value)),
        Projection::FieldOfView { vertical } => {
            let range = "greater than 0 and less than pi (180 degrees)";
            let cause = FaultCause::OutOfRange { what: "field of view", value: vertical, range };
            (!(vertical > 0.0 && vertical < PI)).then_some((cause, vertical))
        }
    }
}

/// Reports rotation tracks with neighbouring keys more than half a turn apart, between which the rotation takes the shorter way.
fn turn_faults(world: &World, faults: &mut Vec<Fault>) {
    let mut query = world.query::<(Entity, &Animated)>();
    faults.extend(query.iter().filter_map(|(entity, Animated(channels))| {
        let short_turn = channels.iter().find_map(|channel| channel.short_turn)?;
        Some(Fault { entity, consequence: Consequence::ShortTurn, cause: FaultCause::ShortTurn(short_turn) })
    }));
}

/// Finds the faults of the settings of the whole scene.
fn setting_faults(world: &World, faults: &mut Vec<Fault>) {
    let mut check = |fault: Option<Fault>| faults.extend(fault);
    check(setting(world, |checked, Ambient(intensity)| checked.color("ambient light", *intensity)));
    check(setting(world, |checked, background| match background {
        Background::Flat(color) => checked.color("background", *color),
        Background::Gradient { bottom, top } => {
            checked.color("bottom of the background", *bottom);
            checked.color("top of the background", *top);
        }
    }));
    check(setting(world, |checked, Fog { color, density }| {
        checked.color("fog's colour", *color);
        checked.number("fog's density", *density, (0.0, f64::MAX), POSITIVE);
    }));
    check(setting(world, |checked, film: &FilmSettings| {
        let most = FilmSettings::LARGEST_SIDE.into();
        checked.number("film's width", film.width.into(), (1.0, most), "from 1 to 32768");
        checked.number("film's height", film.height.into(), (1.0, most), "from 1 to 32768");
        let shown = super::film_settings(world);
        if film.width == shown.width && film.height > shown.height {
            let limits = (1.0, f64::from(shown.height));
            checked.number(
                "film's height",
                film.height.into(),
                limits,
                "so small that the film has at most 2^28 pixels",
            );
        }
    }));
    check(setting(world, |checked, sampling: &Sampling| {
        let most = Sampling::LARGEST_COUNT.into();
        checked.number("number of samples", sampling.samples.into(), (1.0, most), "from 1 to 65536");
        checked.number(
            "least number of samples",
            sampling.min_samples.into(),
            (1.0, most),
            "from 1 to 65536",
        );
        let most = Sampling::LARGEST_ERROR.into();
        checked.number("largest error", sampling.max_error.into(), (0.0, most), "from 0 to 255");
        let most = Sampling::LARGEST_INSTANTS.into();
        checked.number("number of instants", sampling.instants.into(), (1.0, most), "from 1 to 256");
    }));
    check(setting(world, |checked, Quality { depth, cutoff }| {
        let most = Quality::LARGEST_DEPTH.into();
        checked.number("depth", f64::from(*depth), (1.0, most), "from 1 to 1000");
        let most = Quality::LARGEST_CUTOFF.into();
        checked.number("cutoff", f64::from(*cutoff), (0.0, most), "from 0 to 255");
    }));
}

/// Returns the fault of a setting, checked in the first entity in document order that has it.
fn setting<T: Component>(world: &World, check: impl FnOnce(&mut Checked, &T)) -> Option<Fault> {
    let entity = first_entity::<T>(world)?;
    let mut checked = Checked::new(entity);
    check(&mut checked, &*world.get::<&T>(entity).ok()?);
    checked.fault
}
