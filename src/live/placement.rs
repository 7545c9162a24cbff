//! The place of an entity at a frame, for its outline in the picture and for moves by hand.

use std::path::PathBuf;

use glam::{DAffine3, DMat3, DVec3};
use hecs::{Entity, World};
use serde::Serialize;

use super::camera_view::CameraView;
use super::frame_keys::{FrameKeys, KeyPlace};
use super::outline::entity_named;
use super::pixel_info::{order_of, place_of};
use crate::components::{
    Animated, AreaShape, Cloud, Light, LightKind, LookAt, Parent, Property, Shape, Target, Transform,
    WorldTransform,
};
use crate::drawing::OutlinedShape;
use crate::engine::Engine;
use crate::scene::{ScenePart, Sources, joined, written_value};

/// The place of an entity at a frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Placement {
    /// The camera of the frame.
    pub camera: CameraView,
    /// The position in the world: the middle of a rod, and the origin of the own space of others.
    pub position: [f64; 3],
    /// The outline in the world, which is empty without a shape; `None` for parallel light, which has no place.
    pub outline: Option<Silhouette>,
    /// The values that a move changes; none for an entity that cannot be moved by hand.
    pub values: Vec<MovedValue>,
    /// The reason why the entity cannot be moved by hand.
    pub fixed: Option<String>,
}

/// A convex outline in the world: the hull of points and of round parts.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Silhouette {
    /// Points.
    pub corners: Vec<[f64; 3]>,
    /// Ellipsoids and ellipses.
    pub rounds: Vec<RoundPart>,
    /// The unit normal of a plane, which has no outline.
    pub normal: Option<[f64; 3]>,
}

/// The image of the unit sphere or of the unit circle under a linear map.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RoundPart {
    /// The centre.
    pub center: [f64; 3],
    /// The images of the coordinate axes: three of a sphere, two of a circle.
    pub axes: Vec<[f64; 3]>,
}

/// A vector in the scene's text that changes with the position.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MovedValue {
    /// The path, as an [`Override`](crate::scene::Override) has it before its `=`.
    pub path: String,
    /// The path of the list of keys, and a time of the keys in seconds; `None` without a track.
    pub key: Option<KeyPlace>,
    /// The vector at the frame.
    pub value: [f64; 3],
    /// The change of the vector per scene unit along each axis of the world.
    pub change: [[f64; 3]; 3],
    /// True if the text has the vector, so that its numbers can be changed one by one.
    pub is_written: bool,
}

impl Placement {
    /// Describes the place of an entity at a frame. `files` are those of the scene; `None` for a world of a program. Returns `None` for other
    /// parts, and without a camera.
    pub(super) fn of(
        engine: &mut Engine,
        sources: &Sources,
        frame: u32,
        part: &ScenePart,
        files: Option<&[PathBuf]>,
    ) -> Option<Self> {
        let ScenePart::Entity(name) = part else { return None };
        let camera = CameraView::of(engine, frame, files.unwrap_or_default()).ok()?;
        let world = engine.world();
        let entity = entity_named(world, name)?;
        let placed = world.get::<&WorldTransform>(entity).ok().map(|placed| *placed)?;
        let shape = world.get::<&Shape>(entity).ok().map(|shape| *shape);
        let middle = shape.and_then(rod_ends).map_or(DVec3::ZERO, |[from, to]| 0.5 * (from + to));
        let values = match files {
            Some(files) => {
                let keys = FrameKeys::new(engine, frame, files);
                moved_values(world, entity, sources, files, &keys)
            }
            None => Err("this world is built by a program: it is moved there".to_owned()),
        };
        let (values, fixed) = match values {
            Ok(values) => (values, None),
            Err(reason) => (Vec::new(), Some(reason)),
        };
        Some(Self {
            camera,
            position: placed.affine.transform_point3(middle).to_array(),
            outline: (!is_placeless(world, entity)).then(|| Silhouette::of(world, entity, shape, &placed)),
            values,
            fixed,
        })
    }
}

impl Silhouette {
    fn of(world: &World, entity: Entity, shape: Option<Shape>, placed: &WorldTransform) -> Self {
        let cloud = world.get::<&Cloud>(entity);
        if let (Some(shape), Ok(cloud)) = (shape, &cloud) {
            return Self::of_box(cloud_bounds(shape, cloud), placed.affine);
        }
        if let Some(shape) = shape {
            return OutlinedShape::of(shape, placed).as_ref().map_or_else(Self::default, Self::of_shape);
        }
        match world.get::<&Light>(entity).ok().map(|light| light.kind) {
            Some(LightKind::Area { shape: AreaShape::Sphere { radius }, .. }) => {
                let size = libm::cbrt(placed.affine.matrix3.determinant().abs());
                Self::default().with_round(
                    placed.affine.translation,
                    &(radius * size * DMat3::IDENTITY).to_cols_array_2d(),
                )
            }
            Some(LightKind::Area { shape: AreaShape::Rectangle { width, height }, .. }) => {
                let half = 0.5 * DVec3::new(width, height, 0.0);
                Self::of_box([-half, half], placed.affine)
            }
            _ => Self::default(),
        }
    }

    fn of_shape(shape: &OutlinedShape) -> Self {
        let outline = Self::default();
        match shape {
            OutlinedShape::Ball { center, image } => outline.with_round(*center, &image.to_cols_array_2d()),
            OutlinedShape::Box(corners) => {
                Self { corners: corners.map(|corner| corner.to_array()).into(), ..outline }
            }
            OutlinedShape::Rod { ends, halves, ball } => {
                let axes = ball.map_or_else(
                    || halves.map(|half| half.to_array()).to_vec(),
                    |ball| ball.to_cols_array_2d().to_vec(),
                );
                ends.iter().fold(outline, |outline, end| outline.with_round(*end, &axes))
            }
            OutlinedShape::Plane { normal, .. } => Self { normal: Some(normal.to_array()), ..outline },
        }
    }

    /// Returns the outline of a box in an entity's own space, given by two opposite corners.
    fn of_box([least, most]: [DVec3; 2], affine: DAffine3) -> Self {
        if !(least.is_finite() && most.is_finite()) {
            return Self::default();
        }
        let corner = |index: usize| {
            let side = |axis: usize| if index >> axis & 1 == 0 { least[axis] } else { most[axis] };
            affine.transform_point3(DVec3::new(side(0), side(1), side(2))).to_array()
        };
        Self { corners: (0..8).map(corner).collect(), ..Self::default() }
    }

    fn with_round(mut self, center: DVec3, axes: &[[f64; 3]]) -> Self {
        self.rounds.push(RoundPart { center: center.to_array(), axes: axes.to_vec() });
        self
    }
}

/// Returns two opposite corners of the box, in own space, around the particles of a cloud.
fn cloud_bounds(shape: Shape, cloud: &Cloud) -> [DVec3; 2] {
    let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for position in cloud.positions.iter() {
        (least, most) = (least.min(*position), most.max(*position));
    }
    let scale = cloud.scales.as_ref().map_or(1.0, |scales| scales.iter().copied().fold(0.0, f64::max));
    let extent = OutlinedShape::of(shape, &WorldTransform::IDENTITY).and_then(|shape| shape.extent());
    let reach = extent.map_or(0.0, |(middle, radius)| scale * (middle.length() + radius));
    [least - reach, most + reach]
}

/// Returns whether an entity is only a light at infinity.
fn is_placeless(world: &World, entity: Entity) -> bool {
    let is_parallel = |light: &Light| matches!(light.kind, LightKind::Directional { .. });
    world.get::<&Light>(entity).is_ok_and(|light| is_parallel(&light)) && !world.satisfies::<&Shape>(entity)
}

/// Returns the ends of a cylinder or a capsule, in its own space.
fn rod_ends(shape: Shape) -> Option<[DVec3; 2]> {
    match shape {
        Shape::Cylinder { from, to, .. } | Shape::Capsule { from, to, .. } => Some([from, to]),
        _ => None,
    }
}

/// Returns the path of an entity that can be moved in the scene file, or the reason why it cannot be moved by hand.
fn movable_path(world: &World, entity: Entity, sources: &Sources) -> Result<Vec<String>, String> {
    let order = order_of(world, entity).ok_or("it is not in the file")?;
    let Some(path) = sources.entity_path(order) else {
        let place = place_of(world, sources, entity).unwrap_or_default();
        return Err(match sources.is_spawned(order) {
            true => "a script makes it: it is moved there".to_owned(),
            false => format!("it is written in another file, at `{place}`: it is moved there"),
        });
    };
    if sources.is_extension() && path[1].parse::<usize>().is_ok() {
        let reason =
            "the scene extends another, whose entities would be counted: give it a name to move it here";
        return Err(reason.to_owned());
    }
    if is_placeless(world, entity) {
        return Err("its light is parallel: it has a direction and no place".to_owned());
    }
    Ok(path)
}

/// Returns the values that a move of an entity changes: the ends of a rod that nothing else turns or rides on, and the translation of others.
/// Returns the reason why it cannot be moved by hand.
fn moved_values(
    world: &World,
    entity: Entity,
    sources: &Sources,
    files: &[PathBuf],
    keys: &FrameKeys<'_>,
) -> Result<Vec<MovedValue>, String> {
    let path = movable_path(world, entity, sources)?;
    let place = |field: &str| {
        path.iter().map(String::as_str).chain(field.split('.')).map(str::to_owned).collect::<Vec<_>>()
    };
    let is_written = |field: &str| written_value(&place(field), files).is_some();
    let linear = |entity: Entity| {
        world.get::<&WorldTransform>(entity).map_or(DMat3::IDENTITY, |placed| placed.affine.matrix3)
    };
    let outer = world.get::<&Parent>(entity).map_or(DMat3::IDENTITY, |parent| linear(parent.0));
    let value = |field: &str, key: Option<KeyPlace>, value: DVec3| MovedValue {
        path: joined(&place(field)),
        key,
        value: value.to_array(),
        change: outer.inverse().to_cols_array_2d(),
        is_written: is_written(field),
    };
    let key = keys.place(world, entity, Property::Translation, "this entity")?;
    let Transform { translation, rotation, scale } =
        world.get::<&Transform>(entity).map(|own| *own).unwrap_or_default();
    let is_plain = || {
        let is_unturned = rotation == Transform::IDENTITY.rotation && scale == DVec3::ONE;
        let is_moved = world.satisfies::<hecs::Or<&Animated, hecs::Or<&LookAt, &Target>>>(entity);
        let has_children = || world.query::<&Parent>().iter().any(|parent| parent.0 == entity);
        is_unturned && !is_moved && !is_written("transform") && is_written("shape.from") && !has_children()
    };
    let shape = world.get::<&Shape>(entity).ok().map(|shape| *shape);
    let values = match shape.and_then(rod_ends).filter(|_| is_plain()) {
        Some([from, to]) => vec![value("shape.from", None, from), value("shape.to", None, to)],
        None => vec![value("transform.translation", key, translation)],
    };
    let is_finite = |value: &MovedValue| {
        value.value.iter().chain(value.change.as_flattened()).all(|number| number.is_finite())
    };
    if values.iter().all(is_finite) {
        Ok(values)
    } else {
        Err("its numbers are not finite: correct them in the file".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DQuat;

    use super::*;

    #[test]
    fn outlines_hold_the_parts_of_shapes() {
        let scale = DMat3::from_diagonal(DVec3::new(2.0, 1.0, 1.0));
        let affine = DAffine3::from_mat3_translation(scale, DVec3::new(0.0, 5.0, 0.0));
        let placed = WorldTransform { affine, ..WorldTransform::IDENTITY };
        let outline = |shape| Silhouette::of_shape(&OutlinedShape::of(shape, &placed).unwrap());

        let ball = outline(Shape::Sphere { radius: 0.5 });
        let axes = vec![[1.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]];
        assert_eq!(ball, Silhouette::default().with_round(affine.translation, &axes));

        let (from, to) = (DVec3::ZERO, DVec3::Y);
        for (shape, axes) in
            [(Shape::Cylinder { radius: 1.0, from, to }, 2), (Shape::Capsule { radius: 1.0, from, to }, 3)]
        {
            let Silhouette { corners, rounds, normal } = outline(shape);
            assert!(corners.is_empty() && normal.is_none());
            assert_eq!(
                rounds.iter().map(|round| round.center).collect::<Vec<_>>(),
                [[0.0, 5.0, 0.0], [0.0, 6.0, 0.0]]
            );
            assert!(rounds.iter().all(|round| round.axes.len() == axes));
        }
        let corners = outline(Shape::Box { size: DVec3::ONE }).corners;
        assert_eq!((corners.len(), corners[0], corners[7]), (8, [-1.0, 4.5, -0.5], [1.0, 5.5, 0.5]));
        let normal = DVec3::new(1.0, 0.0, 0.0);
        assert_eq!(
            outline(Shape::Plane { normal }),
            Silhouette { normal: Some([1.0, 0.0, 0.0]), ..Silhouette::default() }
        );
    }

    #[test]
    fn boxes_hold_all_particles_of_a_cloud() {
        let positions = Arc::new(vec![DVec3::ZERO, DVec3::new(3.0, -1.0, 0.0)]);
        let cloud = Cloud { positions, scales: Some(Arc::new(vec![1.0, 2.0])), ..Cloud::default() };
        let bounds = cloud_bounds(Shape::Sphere { radius: 0.5 }, &cloud);
        assert_eq!(bounds, [DVec3::new(-1.0, -2.0, -1.0), DVec3::new(4.0, 1.0, 1.0)]);
        let turned = DAffine3::from_quat(DQuat::from_rotation_y(0.5));
        assert_eq!(Silhouette::of_box(bounds, turned).corners.len(), 8);
        // A frame without particles has no outline.
        let empty = cloud_bounds(Shape::Sphere { radius: 0.5 }, &Cloud::default());
        assert_eq!(Silhouette::of_box(empty, turned), Silhouette::default());
    }
}
