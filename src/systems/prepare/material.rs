//! Surface materials and their checker patterns.

use super::settings::sane;
use crate::color::Rgb;
use crate::components::{
    Checker, Emission, Material, Reflective, Refractive, Shape, Specular, WorldTransform,
};
use crate::trace::{self, CheckerPattern, Refraction, SurfaceMaterial};

/// The components that define a surface's appearance and its checker pattern.
pub(super) type Surfaced<'a> = (
    &'a Shape,
    &'a WorldTransform,
    &'a Material,
    Option<&'a Specular>,
    Option<&'a Reflective>,
    Option<&'a Refractive>,
    Option<&'a Checker>,
    Option<&'a Emission>,
);

pub(super) fn surface_material(
    (shape, transform, material, specular, reflective, refractive, checker, emission): Surfaced<'_>,
) -> SurfaceMaterial {
    let shininess = |value: f32| if value > 0.0 { value.min(Specular::LARGEST_SHININESS) } else { 0.0 };
    let (k_a, k_d) = (coefficient(material.k_a), coefficient(material.k_d));
    let checker = checker.and_then(|checker| {
        let squares = prepared_squares(checker, shape, transform)?;
        let color = sane(checker.color);
        let ambient = material.ambient_color.map_or(color, sane);
        Some(Box::new(trace::PreparedChecker { ambient: ambient * k_a, diffuse: color * k_d, squares }))
    });
    SurfaceMaterial {
        ambient: sane(material.ambient_color.unwrap_or(material.color)) * k_a,
        diffuse: sane(material.color) * k_d,
        specular: specular.map_or(0.0, |specular| coefficient(specular.k_s)),
        shininess: specular.map_or(0.0, |specular| shininess(specular.shininess)),
        reflected: reflective.map_or(0.0, |reflective| coefficient(reflective.k_r)),
        refraction: refractive.and_then(prepared_refraction),
        checker,
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

/// Returns the prepared checker pattern. `None` on spheres, and for squares without a size.
fn prepared_squares(checker: &Checker, shape: &Shape, transform: &WorldTransform) -> Option<CheckerPattern> {
    let (map, size) = (transform.affine, checker.size);
    if size.is_nan() || size <= 0.0 {
        return None;
    }
    match *shape {
        Shape::Sphere { .. } => None,
        Shape::Plane { normal } => Some(CheckerPattern::on_plane(map, normal, size)),
        Shape::Box { size: edges } => Some(CheckerPattern::on_box(map, edges * 0.5, size)),
    }
}
