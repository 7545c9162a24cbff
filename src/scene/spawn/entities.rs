//! Spawns entities in batches of equal component types.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec3;
use hashbrown::HashMap;
use hecs::{ColumnBatchBuilder, ColumnBatchType, Component, Entity, World};

use super::{radians, rgb, rotation, scale, single};
use crate::color::Transfer;
use crate::components::{
    Animated, AreaShape, Channel, Cloud, CloudSource, Emission, Falloff, Light, LightKind, LookAt, Material,
    Name, Order, Parent, Pattern, PatternKind, Property, Reflective, Refractive, Shape, Specular, Target,
    Transform, Visibility, WorldTransform,
};
use crate::scene::document::{
    AreaShapeDocument, EntityDocument, LightDocument, MaterialDocument, PatternDocument, RodDocument,
    ShapeDocument, TransformDocument, Triple,
};

/// The components that a material of the file adds to entities.
#[derive(Clone, Copy, Debug)]
pub(super) struct MaterialComponents {
    material: Material,
    specular: Option<Specular>,
    reflective: Option<Reflective>,
    refractive: Option<Refractive>,
    pattern: Option<Pattern>,
    emission: Option<Emission>,
}

/// The parents, the entities looked at, the channels and the surfaces of entities.
pub(super) struct Links<'a> {
    /// The parents, by the document index of the child.
    pub(super) parents: HashMap<usize, Entity>,
    /// The entities looked at, by the document index of the entity that looks.
    pub(super) looking: HashMap<usize, Entity>,
    pub(super) channels: HashMap<Entity, Vec<Channel>>,
    /// The surfaces, by material name.
    pub(super) surfaces: HashMap<&'a str, MaterialComponents>,
    /// The surfaces of the entities with a material of their own, in document order.
    pub(super) own_surfaces: Vec<MaterialComponents>,
}

/// An entity, identified by its document index, with its surface.
struct Member<'a> {
    place: usize,
    surface: Option<&'a MaterialComponents>,
}

/// The optional components of an entity, as flags.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Types {
    name: bool,
    parent: bool,
    looking: bool,
    target: bool,
    animated: bool,
    shape: bool,
    cloud: bool,
    visibility: bool,
    light: bool,
    material: bool,
    specular: bool,
    reflective: bool,
    refractive: bool,
    pattern: bool,
    emission: bool,
}

/// Adds components to entities that already exist.
pub(super) fn spawn(
    world: &mut World,
    entities: &[Entity],
    documents: &[Arc<EntityDocument>],
    Links { parents, looking, mut channels, surfaces, own_surfaces }: Links<'_>,
) {
    let mut groups: BTreeMap<Types, Vec<Member<'_>>> = BTreeMap::new();
    let mut own_surfaces = own_surfaces.iter();
    for (place, document) in documents.iter().enumerate() {
        let surface = if document.has_own_material() {
            own_surfaces.next()
        } else {
            document.material_name().and_then(|name| surfaces.get(name))
        };
        let types = Types {
            name: document.name.is_some(),
            parent: parents.contains_key(&place),
            looking: looking.contains_key(&place),
            target: document.target.is_some(),
            animated: channels.contains_key(&entities[place]),
            shape: document.shape.is_some(),
            cloud: document.cloud.is_some(),
            visibility: has_visibility(document, channels.get(&entities[place])),
            light: document.light.is_some(),
            ..Types::of_surface(surface)
        };
        groups.entry(types).or_default().push(Member { place, surface });
    }
    for (types, members) in groups {
        let batch = types.batch(members.len());
        let places = || members.iter().map(|member| member.place);
        let surfaces = || members.iter().filter_map(|member| member.surface);
        fill(&batch, places().filter_map(|place| channels.remove(&entities[place])).map(Animated));
        let of = |place: usize| &documents[place];
        rayon::join(
            || {
                fill(&batch, places().filter_map(|place| of(place).name.clone()).map(Name));
                fill(&batch, places().map(|place| transform(&of(place).transform)));
                fill(&batch, places().filter_map(|place| of(place).shape.as_ref()).map(shape));
                fill(
                    &batch,
                    places().filter_map(|place| of(place).cloud.as_deref()).map(|_| Cloud::default()),
                );
                fill(&batch, places().filter_map(|place| of(place).cloud.as_deref()).cloned());
                fill(&batch, places().map(|place| visibility(of(place))));
                fill(&batch, places().filter_map(|place| of(place).light.as_deref()).map(light));
            },
            || {
                let origin = WorldTransform::default();
                fill(&batch, places().map(|_| origin));
                fill(&batch, places().map(|place| Order(place as u64)));
                fill(&batch, places().filter_map(|place| parents.get(&place).copied()).map(Parent));
                fill(&batch, places().filter_map(|place| looking.get(&place).copied()).map(LookAt));
                fill(&batch, places().filter_map(|place| of(place).target.as_deref()).map(target));
                fill(&batch, surfaces().map(|surface| surface.material));
                fill(&batch, surfaces().filter_map(|surface| surface.specular));
                fill(&batch, surfaces().filter_map(|surface| surface.reflective));
                fill(&batch, surfaces().filter_map(|surface| surface.refractive));
                fill(&batch, surfaces().filter_map(|surface| surface.pattern));
                fill(&batch, surfaces().filter_map(|surface| surface.emission));
            },
        );
        let entities: Vec<Entity> = places().map(|place| entities[place]).collect();
        let batch = batch.build().expect("every member has a component of each of the types");
        world.spawn_column_batch_at(&entities, batch);
    }
}

/// Writes the components of one type, if the batch contains that type.
fn fill<T: Component>(batch: &ColumnBatchBuilder, values: impl Iterator<Item = T>) {
    if let Some(mut column) = batch.writer::<T>() {
        for value in values {
            // The column has room for one value per member.
            let _ = column.push(value);
        }
    }
}

impl Types {
    /// Returns the types of the components of a surface.
    fn of_surface(surface: Option<&MaterialComponents>) -> Self {
        Self {
            material: surface.is_some(),
            specular: surface.is_some_and(|surface| surface.specular.is_some()),
            reflective: surface.is_some_and(|surface| surface.reflective.is_some()),
            refractive: surface.is_some_and(|surface| surface.refractive.is_some()),
            pattern: surface.is_some_and(|surface| surface.pattern.is_some()),
            emission: surface.is_some_and(|surface| surface.emission.is_some()),
            ..Self::default()
        }
    }

    /// Creates a batch for the components of `count` entities.
    fn batch(self, count: usize) -> ColumnBatchBuilder {
        let mut types = ColumnBatchType::new();
        types.add_bundle::<(Order, Transform, WorldTransform)>();
        let mut add = |has: bool, add: fn(&mut ColumnBatchType) -> &mut ColumnBatchType| {
            if has {
                add(&mut types);
            }
        };
        add(self.name, ColumnBatchType::add::<Name>);
        add(self.parent, ColumnBatchType::add::<Parent>);
        add(self.looking, ColumnBatchType::add::<LookAt>);
        add(self.target, ColumnBatchType::add::<Target>);
        add(self.animated, ColumnBatchType::add::<Animated>);
        add(self.shape, ColumnBatchType::add::<Shape>);
        add(self.cloud, ColumnBatchType::add::<Cloud>);
        add(self.cloud, ColumnBatchType::add::<CloudSource>);
        add(self.visibility, ColumnBatchType::add::<Visibility>);
        add(self.light, ColumnBatchType::add::<Light>);
        add(self.material, ColumnBatchType::add::<Material>);
        add(self.specular, ColumnBatchType::add::<Specular>);
        add(self.reflective, ColumnBatchType::add::<Reflective>);
        add(self.refractive, ColumnBatchType::add::<Refractive>);
        add(self.pattern, ColumnBatchType::add::<Pattern>);
        add(self.emission, ColumnBatchType::add::<Emission>);
        types.into_batch(u32::try_from(count).unwrap_or(u32::MAX))
    }
}

pub(super) fn surface(document: &MaterialDocument, transfer: Transfer) -> MaterialComponents {
    let color = document.color.map_or(Material::default().color, |color| transfer.decode(color.0));
    let base = if document.is_matte_by_default() {
        Material::matte(color)
    } else {
        Material { color, ..Material::default() }
    };
    let material = Material {
        k_a: document.k_a.map_or(base.k_a, single),
        k_d: document.k_d.map_or(base.k_d, single),
        ambient_color: document.ambient_color.map(|color| transfer.decode(color.0)),
        metallic: document.metallic,
        ..base
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
    let pattern = document.pattern.map(|document| pattern(document, transfer));
    let emission = document.emission.map(|emission| Emission(rgb(emission)));
    MaterialComponents { material, specular, reflective, refractive, pattern, emission }
}

fn pattern(document: PatternDocument, transfer: Transfer) -> Pattern {
    let (color, kind) = match document {
        PatternDocument::Checker { color, size } => (color, PatternKind::Checker { size }),
        PatternDocument::Stripes { color, size, ratio, direction, offset } => {
            (color, PatternKind::Stripes { size, ratio, direction: direction.into(), offset })
        }
        PatternDocument::Bricks { color, size, mortar } => {
            (color, PatternKind::Bricks { size: size.into(), mortar })
        }
        PatternDocument::Gradient { color, size, direction, offset } => {
            (color, PatternKind::Gradient { size, direction: direction.into(), offset })
        }
        PatternDocument::Noise { color, size, octaves, contrast } => {
            let octaves = u32::try_from(octaves).unwrap_or(u32::MAX);
            (color, PatternKind::Noise { size, octaves, contrast })
        }
    };
    Pattern { color: transfer.decode(color.0), kind }
}

fn transform(document: &TransformDocument) -> Transform {
    Transform {
        translation: document.translation.into(),
        rotation: rotation(document.rotation),
        scale: scale(document.scale),
    }
}

fn target(document: &Triple) -> Target {
    Target((*document).into())
}

fn shape(document: &ShapeDocument) -> Shape {
    match *document {
        ShapeDocument::Sphere { radius } => Shape::Sphere { radius },
        ShapeDocument::Plane { normal } => Shape::Plane { normal: normal.into() },
        ShapeDocument::Box { size } => Shape::Box { size: size.into() },
        ShapeDocument::Cylinder(ref rod) => {
            let [from, to] = ends(rod);
            Shape::Cylinder { radius: rod.radius, from, to }
        }
        ShapeDocument::Capsule(ref rod) => {
            let [from, to] = ends(rod);
            Shape::Capsule { radius: rod.radius, from, to }
        }
    }
}

/// Returns the ends of a rod's axis, which a valid document has.
fn ends(rod: &RodDocument) -> [DVec3; 2] {
    rod.ends().unwrap_or_default().map(DVec3::from)
}

/// Returns whether an entity needs its visibility as a component: not all rays see its shape, or its visibility changes.
fn has_visibility(document: &EntityDocument, channels: Option<&Vec<Channel>>) -> bool {
    let changes = |channel: &Channel| {
        matches!(channel.property, Property::Visible | Property::CastsShadow | Property::InReflections)
    };
    visibility(document) != Visibility::ALL || channels.is_some_and(|channels| channels.iter().any(changes))
}

fn visibility(document: &EntityDocument) -> Visibility {
    let EntityDocument { visible, casts_shadow, in_reflections, .. } = *document;
    Visibility { camera: visible, secondary: in_reflections, shadow: casts_shadow }
}

fn light(document: &LightDocument) -> Light {
    let (light, casts_shadows, falloff) = match *document {
        LightDocument::Point { intensity, casts_shadows, falloff } => {
            (Light::point(rgb(intensity)), casts_shadows, falloff)
        }
        LightDocument::Spot { intensity, angle, softness, casts_shadows, falloff } => {
            (Light::spot(radians(angle), softness, rgb(intensity)), casts_shadows, falloff)
        }
        LightDocument::Directional { intensity, direction, casts_shadows, .. } => {
            (Light::directional(direction.into(), rgb(intensity)), casts_shadows, None)
        }
        LightDocument::Area { shape, intensity, samples, casts_shadows, falloff } => {
            let samples = u32::try_from(samples).unwrap_or(u32::MAX);
            let kind = LightKind::Area { shape: area_shape(shape), samples };
            (Light::new(kind, rgb(intensity)), casts_shadows, falloff)
        }
    };
    Light { casts_shadows, falloff: falloff.map(self::falloff), ..light }
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
