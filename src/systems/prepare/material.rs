//! Surface materials and their patterns.

use super::settings::sane;
use crate::color::Rgb;
use crate::components::{
    Emission, Material, Pattern, PatternKind, Reflective, Refractive, Shape, Specular, WorldTransform,
};
use crate::trace::{
    PatternFunction, PatternLayout, PatternedSurface, PreparedPattern, Refraction, SurfaceMaterial,
};

/// The components that define a surface's appearance and its pattern.
pub(super) type Surfaced<'a> = (
    &'a Shape,
    &'a WorldTransform,
    &'a Material,
    Option<&'a Specular>,
    Option<&'a Reflective>,
    Option<&'a Refractive>,
    Option<&'a Pattern>,
    Option<&'a Emission>,
);

pub(super) fn surface_material(
    (shape, transform, material, specular, reflective, refractive, pattern, emission): Surfaced<'_>,
) -> SurfaceMaterial {
    let shininess = |value: f32| if value > 0.0 { value.min(Specular::LARGEST_SHININESS) } else { 0.0 };
    let (k_a, k_d) = (coefficient(material.k_a), coefficient(material.k_d));
    let pattern = pattern.and_then(|pattern| {
        let layout = pattern_layout(pattern, shape, transform)?;
        let color = sane(pattern.color);
        let ambient = material.ambient_color.map_or(color, sane);
        Some(Box::new(PreparedPattern { ambient: ambient * k_a, diffuse: color * k_d, layout }))
    });
    SurfaceMaterial {
        ambient: sane(material.ambient_color.unwrap_or(material.color)) * k_a,
        diffuse: sane(material.color) * k_d,
        specular: specular.map_or(0.0, |specular| coefficient(specular.k_s)),
        shininess: specular.map_or(0.0, |specular| shininess(specular.shininess)),
        tint: material.metallic.then(|| sane(material.color).min(Rgb::ONE)),
        reflected: reflective.map_or(0.0, |reflective| coefficient(reflective.k_r)),
        refraction: refractive.and_then(prepared_refraction),
        pattern,
        emission: emission.map_or(Rgb::ZERO, |emission| sane(emission.0)),
    }
}

/// Clamps to 0..=1.
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

/// Returns the layout of a pattern. `None` for values without a use, as a size of 0.
fn pattern_layout(pattern: &Pattern, shape: &Shape, transform: &WorldTransform) -> Option<PatternLayout> {
    let surface = match *shape {
        Shape::Sphere { .. } => PatternedSurface::Sphere,
        Shape::Cylinder { radius, from, to } => {
            PatternedSurface::Rod { ends: [from, to], radius, is_flat: true }
        }
        Shape::Capsule { radius, from, to } => {
            PatternedSurface::Rod { ends: [from, to], radius, is_flat: false }
        }
        Shape::Plane { normal } => PatternedSurface::plane(normal),
        Shape::Box { size } => PatternedSurface::Box(size * 0.5),
    };
    let function = match pattern.kind {
        PatternKind::Checker { size } => PatternFunction::Checker { size },
        PatternKind::Stripes { size, ratio, direction, offset } => {
            PatternFunction::Stripes { size, ratio, direction, offset }
        }
        PatternKind::Bricks { size, mortar } => PatternFunction::Bricks { size, mortar },
        PatternKind::Gradient { size, direction, offset } => {
            PatternFunction::Gradient { size, direction, offset }
        }
        PatternKind::Noise { size, octaves, contrast } => PatternFunction::Noise { size, octaves, contrast },
    };
    PatternLayout::new(transform.affine, surface, function)
}
