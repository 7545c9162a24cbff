//! Finds the faults of a prepared world.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use glam::DVec3;
use hecs::{Component, Entity, World};

use super::Preparation;
use super::camera::{active_camera_entity, position_of};
use super::clouds::{DrawnCloud, DrawnRun};
use super::light::prepared_light;
use super::material::Surfaced;
use super::settings::first_entity;
use super::shape::prepared_shape;
use crate::color::Rgb;
use crate::components::{
    Ambient, AmbientOcclusion, Animated, AreaShape, Background, Camera, FilmSettings, FocusOn, Fog, Follow,
    Light, LightKind, LookAt, Material, Motion, Order, Parent, Pattern, PatternKind, Projection, Property,
    Quality, Quantity, Refractive, Sampling, Shape, Shots, Specular, Stars, Sun, Target, Transform,
    ValidRange, View, Visibility, WorldTransform,
};
use crate::systems::aim::circular_aims;
use crate::systems::{Consequence, Fallback, Fault, FaultCause, Unplaced};
use crate::trace::LightSource;

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
        aim_faults(world, &mut faults);
        faults.extend(self.idle_lights());
        camera_faults(world, self, &mut faults);
        setting_faults(world, &mut faults);
        turn_faults(world, &mut faults);
        parent_faults(world, &mut faults);
        self.lacking_faults(world, &mut faults);
        if cfg!(debug_assertions) && self.relies_on_declarations {
            self.undeclared_changes(world, &mut faults);
        }
        let order = |fault: &Fault| world.get::<&Order>(fault.entity).map_or(u64::MAX, |order| order.0);
        faults.sort_by_key(|fault| (order(fault), fault.entity.id()));
        faults
    }

    /// Reports the components that the world lacks, at the first shape in document order.
    fn lacking_faults(&self, world: &World, faults: &mut Vec<Fault>) {
        let Some(entity) = self.entities.first().copied() else { return };
        if first_entity::<Camera>(world).is_none() {
            faults.push(Fault { entity, consequence: Consequence::DefaultView, cause: FaultCause::NoCamera });
        }
        if first_entity::<Light>(world).is_none() && first_entity::<Ambient>(world).is_none() {
            let is_lit = |entity: &&Entity| {
                world
                    .get::<&Material>(**entity)
                    .is_ok_and(|material| material.k_a > 0.0 || material.k_d > 0.0)
            };
            let first_lit = self.entities.iter().find(is_lit);
            faults.extend(first_lit.map(|entity| Fault {
                entity: *entity,
                consequence: Consequence::Black,
                cause: FaultCause::NoLight,
            }));
        }
    }

    fn shape_faults(&self, world: &World, faults: &mut Vec<Fault>) {
        let with_shape = world.archetypes().filter(|archetype| archetype.has::<Shape>());
        let shapes: u32 = with_shape.map(hecs::Archetype::len).sum();
        for drawn_cloud in &self.clouds {
            let DrawnCloud { entity, particles: DrawnRun { drawn, left_out, .. }, cloud, .. } = drawn_cloud;
            let is_hidden = world.get::<&Visibility>(*entity).is_ok_and(|seen| *seen == Visibility::NONE);
            if !left_out.is_empty() && !is_hidden {
                let consequence = if *drawn == 0 { Consequence::NotDrawn } else { Consequence::Incomplete };
                let of_particles =
                    FaultCause::Particles { left_out: left_out.len(), count: cloud.positions.len() };
                let cause = drawn_cloud.fault().unwrap_or(of_particles);
                faults.push(Fault { entity: *entity, consequence, cause });
            }
            let radius = cloud.bonds.as_ref().map_or(1.0, |bonds| bonds.radius);
            if let Err(error) = ValidRange::Positive.check(radius) {
                let cause = FaultCause::OutOfRange { what: "radius of bonds", error };
                faults.push(Fault { entity: *entity, consequence: Consequence::Incomplete, cause });
            }
        }
        let copies: usize = self.clouds.iter().map(|cloud| cloud.particles.drawn + cloud.rods.drawn).sum();
        if shapes as usize + copies == self.entities.len() + self.clouds.len() {
            return;
        }
        let mut query = world.query::<(
            Entity,
            &Shape,
            Option<&Transform>,
            Option<&WorldTransform>,
            hecs::Satisfies<&Material>,
            Option<&Visibility>,
        )>();
        for (entity, shape, own, transform, has_material, visibility) in &mut query {
            let is_cloud = self.clouds.iter().any(|cloud| cloud.entity == entity);
            if is_cloud || self.slots.get(entity).is_some() || visibility == Some(&Visibility::NONE) {
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
    fn number(&mut self, what: &'static str, value: f64, range: ValidRange) {
        self.clamped(what, value, range, range.limits());
    }

    /// Checks a number, which is clamped to `limits`.
    fn clamped(&mut self, what: &'static str, value: f64, range: ValidRange, limits: RangeInclusive<f64>) {
        if !limits.contains(&value) {
            let clamped = if value > *limits.end() { *limits.end() } else { *limits.start() };
            self.fault(what, value, range, Fallback::Number(range.written(clamped)));
        }
    }

    /// Checks a count.
    fn count(&mut self, what: &'static str, value: u32, most: u32) {
        self.number(what, value.into(), ValidRange::Between(1.0, most.into()));
    }

    /// Checks a colour.
    fn color(&mut self, what: &'static str, color: Rgb) {
        for channel in color.to_array() {
            self.clamped(what, channel.into(), ValidRange::NotNegative, 0.0..=f32::MAX.into());
        }
    }

    /// Checks a colour that a surface reflects. It is used as given if it is brighter than white.
    fn reflected_color(&mut self, what: &'static str, color: Rgb) {
        self.color(what, color);
        let brightest = color.max_element();
        if brightest > 1.0 {
            let cause = FaultCause::AboveWhite { what, value: brightest };
            let (entity, consequence) = (self.entity, Consequence::TooBright);
            self.fault.get_or_insert(Fault { entity, consequence, cause });
        }
    }

    /// Checks an optional part of an entity, which is ignored if it is invalid.
    fn part(&mut self, what: &'static str, value: f64, is_good: bool, range: ValidRange) {
        if !is_good {
            self.fault(what, value, range, Fallback::Nothing);
        }
    }

    /// Checks a pattern, which is ignored if it has no size, no direction or no place.
    fn pattern(&mut self, pattern: &Pattern) {
        let length = |checked: &mut Self, what, value: f64| {
            checked.part(what, value, value > 0.0, Quantity::Length.range());
        };
        match pattern.kind {
            PatternKind::Checker { size } => length(self, "pattern size", size),
            PatternKind::Stripes { size, ratio, direction, offset } => {
                length(self, "pattern size", size);
                self.number("ratio", ratio, Quantity::StripeRatio.range());
                self.direction("pattern", direction);
                self.part("offset", offset, offset.is_finite(), ValidRange::Any);
            }
            PatternKind::Bricks { size, mortar } => {
                size.to_array().into_iter().for_each(|size| length(self, "brick size", size));
                self.part("mortar", mortar, mortar.is_finite(), Quantity::Mortar.range());
                self.number("mortar", mortar, Quantity::Mortar.range());
            }
            PatternKind::Gradient { size, direction, offset } => {
                length(self, "pattern size", size);
                self.direction("pattern", direction);
                self.part("offset", offset, offset.is_finite(), ValidRange::Any);
            }
            PatternKind::Noise { size, octaves, contrast } => {
                length(self, "pattern size", size);
                self.count("number of octaves", octaves, PatternKind::LARGEST_OCTAVES);
                self.part("contrast", contrast, contrast.is_finite(), Quantity::Contrast.range());
                self.number("contrast", contrast, Quantity::Contrast.range());
            }
        }
        self.reflected_color("pattern colour", pattern.color);
    }

    /// Checks the direction of an optional part of an entity, which is ignored without one.
    fn direction(&mut self, what: &'static str, direction: DVec3) {
        if !direction.is_finite() || direction == DVec3::ZERO {
            let fault = instead(self.entity, FaultCause::NoDirection(what), Fallback::Nothing);
            self.fault.get_or_insert(fault);
        }
    }

    fn fault(&mut self, what: &'static str, value: f64, range: ValidRange, fallback: Fallback) {
        let cause = FaultCause::OutOfRange { what, error: range.violated_by(value) };
        self.fault.get_or_insert(instead(self.entity, cause, fallback));
    }
}

/// Returns the first fault of a surface.
pub(super) fn surface_fault(entity: Entity, surfaced: Surfaced<'_>) -> Option<Fault> {
    let (_, _, material, specular, reflective, refractive, pattern, emission) = surfaced;
    let mut checked = Checked::new(entity);
    let share = |checked: &mut Checked, what, value: f32| {
        checked.number(what, value.into(), Quantity::Coefficient.range());
    };
    share(&mut checked, "k_a", material.k_a);
    share(&mut checked, "k_d", material.k_d);
    checked.reflected_color("color", material.color);
    checked.reflected_color("ambient_color", material.ambient_color.unwrap_or_default());
    if let Some(Specular { k_s, shininess }) = specular {
        share(&mut checked, "k_s", *k_s);
        checked.number("shininess", f64::from(*shininess), Quantity::Shininess.range());
    }
    if let Some(reflective) = reflective {
        share(&mut checked, "k_r", reflective.k_r);
    }
    if let Some(Refractive { k_t, ior, absorption, .. }) = refractive {
        share(&mut checked, "k_t", *k_t);
        checked.part("ior", *ior, *ior > 0.0, Quantity::RefractiveIndex.range());
        checked.number("ior", *ior, Quantity::RefractiveIndex.range());
        checked.color("absorption", *absorption);
    }
    if let Some(pattern) = pattern {
        checked.pattern(pattern);
    }
    if let Some(emission) = emission {
        checked.color("emission", emission.0);
    }
    checked.fault
}

fn light_faults(world: &World, faults: &mut Vec<Fault>) {
    type Placed<'a> = (Option<&'a Transform>, Option<&'a WorldTransform>, hecs::Satisfies<&'a Unplaced>);
    let mut query = world.query::<(Entity, &Light, Placed<'_>)>();
    for (entity, light, (own, transform, is_unplaced)) in &mut query {
        // A light with a parent is at the parent's origin.
        if is_unplaced && own == Some(&Transform::IDENTITY) && !world.satisfies::<&Parent>(entity) {
            faults.push(Fault { entity, consequence: Consequence::AtOrigin, cause: FaultCause::NoTransform });
        }
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
                checked.clamped("angle", angle, ValidRange::SpotAngle, 0.0..=PI);
            }
            LightKind::Area { samples, .. } => {
                checked.count("number of samples", samples, AreaShape::LARGEST_SAMPLES);
            }
            LightKind::Point | LightKind::Directional { .. } => {}
        }
        faults.extend(checked.fault);
    }
}

/// Finds the faults of entities without a camera that look at something.
fn aim_faults(world: &World, faults: &mut Vec<Fault>) {
    let mut linked = world.query::<hecs::Without<(Entity, &LookAt), &Camera>>();
    let missing = linked.iter().filter(|(_, LookAt(target))| position_of(world, Some(*target)).is_none());
    faults.extend(
        missing.map(|(entity, _)| instead(entity, FaultCause::Missing("looks at"), Fallback::Nothing)),
    );
    let circular = circular_aims(world).into_iter();
    faults.extend(circular.map(|entity| instead(entity, FaultCause::CircularAim, Fallback::Nothing)));
    let mut pointed = world.query::<hecs::Without<(Entity, &Target), hecs::Or<&Camera, &LookAt>>>();
    let undefined = pointed.iter().filter(|(_, Target(point))| !point.is_finite());
    faults.extend(
        undefined.map(|(entity, _)| instead(entity, FaultCause::NotFinite("target"), Fallback::AlongZ)),
    );
}

/// Finds the faults of the active camera.
fn camera_faults(world: &World, prepared: &Preparation, faults: &mut Vec<Fault>) {
    if let Some(entity) = first_entity::<Shots>(world) {
        let shots = world.get::<&Shots>(entity);
        let lacks_camera =
            |shots: &Shots| shots.0.iter().any(|shot| !world.satisfies::<&Camera>(shot.camera));
        if shots.is_ok_and(|shots| lacks_camera(&shots)) {
            faults.push(instead(entity, FaultCause::Missing("cuts to"), Fallback::Nothing));
        }
    }
    let Some(entity) = active_camera_entity(world, prepared.moment) else { return };
    let Ok(camera) = world.get::<&Camera>(entity) else { return };
    let followed = world.get::<&Follow>(entity).map(|follow| follow.0);
    let looked_at = world.get::<&LookAt>(entity).map(|look_at| look_at.0);
    let looks_at_entity = looked_at.is_ok();
    let focused = world.get::<&FocusOn>(entity).ok().filter(|_| camera.lens.is_some()).map(|focus| focus.0);
    for (linked, what) in [(followed.ok(), "follows"), (looked_at.ok(), "looks at"), (focused, "focuses on")]
    {
        if linked.is_some_and(|linked| position_of(world, Some(linked)).is_none()) {
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
    } else if camera.view == View::Direction(DVec3::ZERO) && !looks_at_entity {
        faults.push(instead(entity, FaultCause::NoDirection("view"), Fallback::AlongZ));
    }
    if !camera.up.is_finite() {
        faults.push(instead(entity, FaultCause::NotFinite("up vector"), Fallback::AlongY));
    } else if camera.up == DVec3::ZERO {
        faults.push(instead(entity, FaultCause::NoDirection("up vector"), Fallback::AlongY));
    }
    let mut checked = Checked::new(entity);
    checked.part("roll", camera.roll, camera.roll.is_finite(), ValidRange::Any);
    if let Some(lens) = camera.lens {
        let sane = (0.0..=f64::MAX).contains(&lens.aperture);
        checked.part("aperture", lens.aperture, sane, ValidRange::NotNegative);
        let sane = lens.focus > 0.0 && lens.focus.is_finite();
        checked.part("focus", lens.focus, sane, ValidRange::Positive);
    }
    if let Some(shutter) = camera.shutter {
        checked.part("shutter", shutter, shutter > 0.0, ValidRange::AboveZero(1.0));
        checked.clamped("shutter", shutter, ValidRange::AboveZero(1.0), 0.0..=1.0);
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
    let cause = |what, value, range: ValidRange, is_good: bool| {
        (!is_good).then(|| (FaultCause::OutOfRange { what, error: range.violated_by(value) }, value))
    };
    let length =
        |what, value: f64| cause(what, value, ValidRange::Positive, value > 0.0 && value.is_finite());
    match projection {
        Projection::Screen { distance, width, height } => length("screen's distance", distance)
            .or_else(|| length("screen's height", height))
            .or_else(|| length("screen's width", width?)),
        Projection::Orthographic { height } => length("height of the view", height),
        Projection::FieldOfView { vertical: angle }
        | Projection::HorizontalFieldOfView { horizontal: angle } => {
            cause("field of view", angle, ValidRange::FieldOfView, angle > 0.0 && angle < PI)
        }
    }
}

/// Reports entities whose parent does not exist.
fn parent_faults(world: &World, faults: &mut Vec<Fault>) {
    let mut query = world.query::<(Entity, &Parent)>();
    faults.extend(
        query
            .iter()
            .filter(|(_, parent)| !world.contains(parent.0))
            .map(|(entity, _)| instead(entity, FaultCause::Missing("is a child of"), Fallback::Nothing)),
    );
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
    check(setting(world, |checked, AmbientOcclusion { samples, distance }| {
        let what = "distance of ambient occlusion";
        checked.part(what, *distance, *distance > 0.0, Quantity::Length.range());
        checked.number(what, *distance, Quantity::Length.range());
        checked.count("number of samples of ambient occlusion", *samples, AmbientOcclusion::LARGEST_SAMPLES);
    }));
    check(setting(world, |checked, background| match background {
        Background::Flat(color) => checked.color("background", *color),
        Background::Gradient { bottom, horizon, top } => {
            checked.color("bottom of the background", *bottom);
            if let Some(horizon) = horizon {
                checked.color("horizon of the background", *horizon);
            }
            checked.color("top of the background", *top);
        }
        Background::Stops(ramp) => {
            ramp.stops().iter().for_each(|(_, color)| checked.color("stop of the background", *color));
        }
    }));
    check(setting(world, |checked, Sun { direction, intensity, size, glow, glow_size }| {
        if !direction.is_finite() || *direction == DVec3::ZERO {
            let cause = FaultCause::NoDirection("sun");
            checked.fault.get_or_insert(instead(checked.entity, cause, Fallback::Nothing));
        }
        checked.color("sun's intensity", *intensity);
        let range = Quantity::AngularSize.range();
        checked.number("sun's size", *size, range);
        checked.number("sun's glow", *glow, Quantity::Coefficient.range());
        checked.number("size of the sun's glow", *glow_size, range);
    }));
    check(setting(world, |checked, Stars { count, intensity, size, .. }| {
        checked.count("number of stars", *count, Stars::LARGEST_COUNT);
        checked.color("stars' intensity", *intensity);
        checked.number("size of the stars", *size, Quantity::AngularSize.range());
    }));
    check(setting(world, |checked, Fog { color, density, height, level, .. }| {
        checked.color("fog's colour", *color);
        checked.clamped("fog's density", *density, ValidRange::NotNegative, 0.0..=f64::MAX);
        if let Some(height) = *height {
            let is_good = height > 0.0 && height.is_finite();
            checked.part("fog's height", height, is_good, ValidRange::Positive);
            checked.part("fog's level", *level, level.is_finite(), ValidRange::Any);
        }
    }));
    check(setting(world, |checked, film: &FilmSettings| {
        checked.count("film's width", film.width, FilmSettings::LARGEST_SIDE);
        checked.count("film's height", film.height, FilmSettings::LARGEST_SIDE);
        let shown = super::film_settings(world);
        if film.width == shown.width && film.height > shown.height {
            checked.count("film's height", film.height, shown.height);
        }
    }));
    check(setting(world, |checked, sampling: &Sampling| {
        checked.count("number of samples", sampling.samples, Sampling::LARGEST_COUNT);
        checked.count("least number of samples", sampling.min_samples, Sampling::LARGEST_COUNT);
        let errors = ValidRange::Between(0.0, Sampling::LARGEST_ERROR.into());
        checked.number("largest error", sampling.max_error.into(), errors);
        checked.count("number of instants", sampling.instants, Sampling::LARGEST_INSTANTS);
    }));
    check(setting(world, |checked, Quality { depth, cutoff }| {
        checked.count("depth", *depth, Quality::LARGEST_DEPTH);
        let cutoffs = ValidRange::Between(0.0, Quality::LARGEST_CUTOFF.into());
        checked.number("cutoff", f64::from(*cutoff), cutoffs);
    }));
}

/// Returns the fault of a setting, checked in the first entity in document order that has it.
fn setting<T: Component>(world: &World, check: impl FnOnce(&mut Checked, &T)) -> Option<Fault> {
    let entity = first_entity::<T>(world)?;
    let mut checked = Checked::new(entity);
    check(&mut checked, &*world.get::<&T>(entity).ok()?);
    checked.fault
}
