//! Entities.

use serde::Deserialize;

use super::values::yes;
use super::{ColorDocument, MaterialDocument, ScaleDocument, SurfaceDocument, Triple, whole};
use crate::components::{AreaShape, CloudSource};

/// An entity of the scene.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Entity")]
pub(crate) struct EntityDocument {
    pub(crate) name: Option<String>,
    #[expect(clippy::box_collection, reason = "few entities have one, and a pointer is a third as large")]
    pub(crate) parent: Option<Box<String>>,
    #[serde(default)]
    pub(crate) transform: TransformDocument,
    pub(crate) shape: Option<ShapeDocument>,
    pub(crate) material: Option<SurfaceDocument>,
    /// Boxed because it is large and few entities have one, as the light.
    pub(crate) color: Option<Box<ColorDocument>>,
    pub(crate) light: Option<Box<LightDocument>>,
    /// Boxed because few entities have one.
    pub(crate) target: Option<Box<Triple>>,
    #[expect(clippy::box_collection, reason = "few entities have one, and a pointer is a third as large")]
    pub(crate) look_at: Option<Box<String>>,
    #[serde(default = "yes")]
    pub(crate) visible: bool,
    #[serde(default = "yes")]
    pub(crate) casts_shadow: bool,
    #[serde(default = "yes")]
    pub(crate) in_reflections: bool,
    /// The particles of a cloud.
    #[serde(skip)]
    pub(crate) cloud: Option<Box<CloudSource>>,
}

impl Default for EntityDocument {
    fn default() -> Self {
        Self {
            name: None,
            parent: None,
            transform: TransformDocument::default(),
            shape: None,
            material: None,
            color: None,
            light: None,
            target: None,
            look_at: None,
            visible: true,
            casts_shadow: true,
            in_reflections: true,
            cloud: None,
        }
    }
}

impl EntityDocument {
    /// Returns the name of the material, if it is not written in place.
    pub(crate) fn material_name(&self) -> Option<&str> {
        match &self.material {
            Some(SurfaceDocument::Named(name)) => Some(name),
            Some(SurfaceDocument::Inline(_)) | None => None,
        }
    }

    /// Returns whether it has a material of its own: written in place, or with a colour of its own.
    pub(crate) fn has_own_material(&self) -> bool {
        self.color.is_some() || matches!(self.material, Some(SurfaceDocument::Inline(_)))
    }

    /// Returns the material with the entity's own colour. `named` returns the material of a name.
    pub(crate) fn own_material<'a>(
        &'a self,
        named: impl Fn(&str) -> Option<&'a MaterialDocument>,
    ) -> MaterialDocument {
        let material = match &self.material {
            Some(SurfaceDocument::Named(name)) => named(name).cloned(),
            Some(SurfaceDocument::Inline(material)) => Some(MaterialDocument::clone(material)),
            None => None,
        };
        let material = material.unwrap_or_default();
        MaterialDocument { color: self.color.as_deref().copied().or(material.color), ..material }
    }
}

/// The placement of an entity.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default, rename = "Transform")]
pub(crate) struct TransformDocument {
    pub(crate) translation: Triple,
    pub(crate) rotation: RotationDocument,
    pub(crate) scale: ScaleDocument,
}

impl Default for TransformDocument {
    fn default() -> Self {
        Self {
            translation: [0.0; 3],
            rotation: RotationDocument::Euler(0.0, 0.0, 0.0),
            scale: ScaleDocument::Uniform(1.0),
        }
    }
}

/// A rotation, with angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename = "Rotation")]
pub(crate) enum RotationDocument {
    Euler(f64, f64, f64),
    AxisAngle(Triple, f64),
    Quat(f64, f64, f64, f64),
}

/// The visible shape of an entity. Rods are stored elsewhere, so that the many entities of large scenes are small.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(from = "ShapeFields")]
pub(crate) enum ShapeDocument {
    Sphere { radius: f64 },
    Plane { normal: Triple },
    Box { size: Triple },
    Cylinder(Box<RodDocument>),
    Capsule(Box<RodDocument>),
}

/// A cylinder or a capsule: with both ends, or with a height along the entity's own y axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RodDocument {
    pub(crate) radius: f64,
    pub(crate) from: Option<Triple>,
    pub(crate) to: Option<Triple>,
    pub(crate) height: Option<f64>,
}

impl RodDocument {
    /// Returns the ends of the axis; `None` if they are not given in one of the two ways.
    pub(crate) fn ends(&self) -> Option<[Triple; 2]> {
        match *self {
            Self { from: Some(from), to: Some(to), height: None, .. } => Some([from, to]),
            Self { from: None, to: None, height: Some(height), .. } => {
                Some([[0.0, -0.5 * height, 0.0], [0.0, 0.5 * height, 0.0]])
            }
            _ => None,
        }
    }
}

/// The fields of a [`ShapeDocument`] in a file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "Shape")]
enum ShapeFields {
    Sphere { radius: f64 },
    Plane { normal: Triple },
    Box { size: Triple },
    Cylinder { radius: f64, from: Option<Triple>, to: Option<Triple>, height: Option<f64> },
    Capsule { radius: f64, from: Option<Triple>, to: Option<Triple>, height: Option<f64> },
}

impl From<ShapeFields> for ShapeDocument {
    fn from(fields: ShapeFields) -> Self {
        match fields {
            ShapeFields::Sphere { radius } => Self::Sphere { radius },
            ShapeFields::Plane { normal } => Self::Plane { normal },
            ShapeFields::Box { size } => Self::Box { size },
            ShapeFields::Cylinder { radius, from, to, height } => {
                Self::Cylinder(Box::new(RodDocument { radius, from, to, height }))
            }
            ShapeFields::Capsule { radius, from, to, height } => {
                Self::Capsule(Box::new(RodDocument { radius, from, to, height }))
            }
        }
    }
}

/// The light source of an entity.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Light")]
pub(crate) enum LightDocument {
    Point {
        intensity: Triple,
        #[serde(default = "yes")]
        casts_shadows: bool,
        falloff: Option<Triple>,
    },
    Spot {
        intensity: Triple,
        angle: f64,
        #[serde(default)]
        softness: f64,
        #[serde(default = "yes")]
        casts_shadows: bool,
        falloff: Option<Triple>,
    },
    Directional {
        intensity: Triple,
        #[serde(default = "forward")]
        direction: Triple,
        #[serde(default = "yes")]
        casts_shadows: bool,
        /// Parsed only so that validation can reject it with a reason.
        falloff: Option<Triple>,
    },
    Area {
        shape: AreaShapeDocument,
        intensity: Triple,
        #[serde(default = "default_samples", deserialize_with = "whole")]
        samples: u64,
        #[serde(default = "yes")]
        casts_shadows: bool,
        falloff: Option<Triple>,
    },
}

/// The shape of an area light.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "AreaShape")]
pub(crate) enum AreaShapeDocument {
    Sphere { radius: f64 },
    Rectangle { width: f64, height: f64 },
}

fn default_samples() -> u64 {
    AreaShape::DEFAULT_SAMPLES.into()
}

fn forward() -> Triple {
    [0.0, 0.0, 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that a scene of a million entities grows little with rarely written fields: `color`, `target` and `look_at` add a pointer
    /// each to the 208 bytes of the other fields, the visibility a word, and the counters of an `Arc` two words.
    #[test]
    fn entities_are_small() {
        assert!(size_of::<EntityDocument>() + 2 * size_of::<usize>() <= 208 + 6 * size_of::<usize>());
    }
}
