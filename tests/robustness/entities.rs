//! Entities and materials that are often extreme or degenerate.

use proptest::prelude::*;

use super::values::{
    absorption, coefficient, color, intensity, ior, number, point, rotation, scale, shininess, size,
};

fn refractive() -> impl Strategy<Value = String> {
    (coefficient(), ior(), absorption(), any::<bool>()).prop_map(|(k_t, ior, absorption, fresnel)| {
        format!(", refractive: (k_t: {k_t}, ior: {ior}, absorption: {absorption}, fresnel: {fresnel})")
    })
}

fn pattern() -> impl Strategy<Value = String> {
    let checker = size().prop_map(|size| format!("Checker(size: {size}"));
    let stripes = (size(), coefficient(), point(), number()).prop_map(|(size, ratio, direction, offset)| {
        format!("Stripes(size: {size}, ratio: {ratio}, direction: {direction}, offset: {offset:?}")
    });
    let bricks = (size(), size(), size(), size()).prop_map(|(length, height, depth, mortar)| {
        format!("Bricks(size: ({length}, {height}, {depth}), mortar: {mortar}")
    });
    let gradient = (size(), point(), number()).prop_map(|(size, direction, offset)| {
        format!("Gradient(size: {size}, direction: {direction}, offset: {offset:?}")
    });
    let noise = (size(), 1..=16u32, size()).prop_map(|(size, octaves, contrast)| {
        format!("Noise(size: {size}, octaves: {octaves}, contrast: {contrast}")
    });
    let some = (prop_oneof![checker, stripes, bricks, gradient, noise], color())
        .prop_map(|(pattern, color)| format!(", pattern: {pattern}, color: {color})"));
    prop_oneof![2 => Just(String::new()), 1 => some]
}

fn emission() -> impl Strategy<Value = String> {
    let some = intensity().prop_map(|emission| format!(", emission: {emission}"));
    prop_oneof![3 => Just(String::new()), 1 => some]
}

pub(crate) fn material() -> impl Strategy<Value = String> {
    let reflective = prop::option::of((coefficient(), any::<bool>()));
    let specular = prop::option::of((coefficient(), shininess()));
    let more =
        (prop_oneof![Just(String::new()), refractive()].boxed(), pattern().boxed(), emission().boxed());
    (coefficient(), coefficient(), color(), prop::option::of(color()), specular, reflective, more).prop_map(
        |(k_a, k_d, color, ambient, specular, reflective, (glass, squares, lamp))| {
            let ambient = ambient.map_or_else(String::new, |color| format!(", ambient_color: {color}"));
            let mirror = reflective.map_or_else(String::new, |(k_r, metallic)| {
                format!(", metallic: {metallic}, reflective: (k_r: {k_r})")
            });
            let gloss = specular.map_or_else(String::new, |(k_s, shininess)| {
                format!(", specular: (k_s: {k_s}, shininess: {shininess})")
            });
            format!("(k_a: {k_a}, k_d: {k_d}, color: {color}{ambient}{gloss}{mirror}{glass}{squares}{lamp})")
        },
    )
}

pub(crate) fn falloff() -> impl Strategy<Value = String> {
    let some = (size(), 0.0..2.0f64, prop_oneof![Just(0.0), 0.0..2.0, Just(1e60)]);
    prop::option::of(some).prop_map(|some| {
        some.map_or_else(String::new, |(c0, c1, c2)| format!(", falloff: ({c0}, {c1:?}, {c2:?})"))
    })
}

fn area_light() -> impl Strategy<Value = String> {
    let shape = prop_oneof![
        size().prop_map(|radius| format!("Sphere(radius: {radius})")),
        (size(), size()).prop_map(|(width, height)| format!("Rectangle(width: {width}, height: {height})")),
    ];
    let samples = prop_oneof![20 => 1u32..6, 1 => Just(100)];
    (shape, intensity(), samples, any::<bool>(), falloff()).prop_map(
        |(shape, intensity, samples, shadows, falloff)| {
            format!(
                "light: Area(shape: {shape}, intensity: {intensity}, samples: {samples}, casts_shadows: {shadows}{falloff}), "
            )
        },
    )
}

/// Generates the fields of an entity, except its name and its parent.
pub(crate) fn entity() -> impl Strategy<Value = String> {
    let shape = prop_oneof![
        size().prop_map(|radius| format!("Sphere(radius: {radius})")),
        (size(), size(), size()).prop_map(|(x, y, z)| format!("Box(size: ({x}, {y}, {z}))")),
        point().prop_map(|normal| format!("Plane(normal: {normal})")),
        (size(), size()).prop_map(|(radius, height)| format!("Cylinder(radius: {radius}, height: {height})")),
        (size(), point(), point()).prop_map(|(radius, from, to)| {
            // A rod that ends where it begins is no rod.
            let to = if to == from { "(0.5, 1.25, 3.75)".to_owned() } else { to };
            format!("Capsule(radius: {radius}, from: {from}, to: {to})")
        }),
    ];
    let surface = prop_oneof![
        4 => (0..3).prop_map(|number| format!("material: \"m{number}\"")),
        1 => (0..3, color()).prop_map(|(number, color)| format!("material: \"m{number}\", color: {color}")),
        1 => color().prop_map(|color| format!("color: {color}")),
        1 => material().boxed().prop_map(|material| format!("material: {material}")),
    ];
    let unseen = prop_oneof![
        4 => Just(String::new()),
        1 => any::<[bool; 3]>().prop_map(|[visible, shadow, reflected]| {
            format!("visible: {visible}, casts_shadow: {shadow}, in_reflections: {reflected}, ")
        }),
    ];
    let shape = (shape.boxed(), surface.boxed(), unseen);
    let shape = shape.prop_map(|(shape, surface, unseen)| format!("shape: {shape}, {surface}, {unseen}"));
    let light = prop_oneof![
        (intensity(), any::<bool>(), falloff()).prop_map(|(intensity, shadows, falloff)| format!(
            "light: Point(intensity: {intensity}, casts_shadows: {shadows}{falloff}), "
        )),
        (intensity(), 0.001..180.0f64, coefficient(), falloff()).prop_map(
            |(intensity, angle, softness, falloff)| format!(
                "light: Spot(intensity: {intensity}, angle: {angle:?}, softness: {softness}{falloff}), "
            )
        ),
        (intensity(), point()).prop_map(|(intensity, direction)| format!(
            "light: Directional(intensity: {intensity}, direction: {direction}), "
        )),
        area_light(),
    ]
    .boxed();
    let what = prop_oneof![
        6 => shape.clone(),
        2 => light.clone(),
        1 => (shape, light).prop_map(|(shape, light)| [shape, light].concat()),
        1 => Just(String::new()),
    ];
    (what, point(), rotation(), scale()).prop_map(|(what, translation, rotation, scale)| {
        format!("{what}transform: (translation: {translation}, rotation: {rotation}, scale: {scale})")
    })
}
