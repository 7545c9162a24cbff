//! Scenes made up of parts that are often extreme or degenerate.

use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

use super::read;

/// Numbers from the far ends of what a scene file may hold, and beyond.
pub(crate) fn number() -> impl Strategy<Value = f64> {
    let extreme = prop::sample::select(vec![
        0.0,
        -0.0,
        1.0,
        -1.0,
        1e-60,
        -1e-60,
        1e60,
        -1e60,
        1e-310,
        -1e-310,
        5e-324,
        1e-20,
        1e20,
        1e-9,
        1e9,
        1e300,
        0.1,
        1.0 + f64::EPSILON,
        90.0,
        180.0,
        360.0,
    ]);
    prop_oneof![
        6 => -3.0..3.0f64,
        3 => (-8i32..8).prop_map(f64::from),
        2 => extreme,
        1 => (-60.0..60.0f64).prop_map(libm::exp10),
    ]
}

/// Sizes: mostly good ones.
fn size() -> impl Strategy<Value = String> {
    prop_oneof![4 => (0.01..4.0f64).boxed(), 1 => number().prop_map(f64::abs).boxed()]
        .prop_map(|size| format!("{size:?}"))
}

fn triple() -> impl Strategy<Value = String> {
    (number(), number(), number()).prop_map(|(x, y, z)| format!("({x:?}, {y:?}, {z:?})"))
}

/// A point in the middle of things, mostly.
fn point() -> impl Strategy<Value = String> {
    let near = (-4i32..=4, -4i32..=4, -4i32..=4).prop_map(|(x, y, z)| format!("({x}, {y}, {z})"));
    prop_oneof![2 => near, 2 => triple()]
}

fn rotation() -> impl Strategy<Value = String> {
    prop_oneof![
        3 => Just("Euler(0, 0, 0)".to_owned()),
        1 => triple().prop_map(|angles| format!("Euler{angles}")),
        1 => (triple(), number()).prop_map(|(axis, angle)| format!("AxisAngle({axis}, {angle:?})")),
        1 => (number(), number(), number(), number()).prop_map(|(x, y, z, w)| format!("Quat({x:?}, {y:?}, {z:?}, {w:?})")),
    ]
}

fn scale() -> impl Strategy<Value = String> {
    prop_oneof![3 => Just("1".to_owned()), 2 => number().prop_map(|factor| format!("{factor:?}")), 2 => triple()]
}

fn intensity() -> impl Strategy<Value = String> {
    let channel =
        || prop_oneof![4 => 0.0..2.0f64, 1 => prop::sample::select(vec![0.0, 1e30, 1e29, 1e-40, 1e-310])];
    (channel(), channel(), channel()).prop_map(|(r, g, b)| format!("({r:?}, {g:?}, {b:?})"))
}

fn coefficient() -> impl Strategy<Value = String> {
    prop_oneof![3 => (0.0..=1.0f64).boxed(), 1 => prop::sample::select(vec![0.0, 1.0, 1e-310, 1e-45]).boxed()]
        .prop_map(|value| format!("{value:?}"))
}

fn shininess() -> impl Strategy<Value = String> {
    prop_oneof![1.0..200.0f64, prop::sample::select(vec![0.0, 1e-310, 1e6])]
        .prop_map(|value| format!("{value:?}"))
}

fn color() -> impl Strategy<Value = String> {
    prop_oneof![
        ((0u8..), (0u8..), (0u8..)).prop_map(|(r, g, b)| format!("({r}, {g}, {b})")),
        (0u32..0x100_0000).prop_map(|color| format!("\"#{color:06x}\"")),
    ]
}

fn ior() -> impl Strategy<Value = String> {
    prop_oneof![2 => (1.0..2.5f64).boxed(), 1 => prop::sample::select(vec![1.0, 1e-3, 1e3, 1.0 + f64::EPSILON]).boxed()]
        .prop_map(|ior| format!("{ior:?}"))
}

/// Three numbers, 0 or more, as intensities are.
fn absorption() -> impl Strategy<Value = String> {
    prop_oneof![Just("(0, 0, 0)".to_owned()), intensity()]
}

fn refractive() -> impl Strategy<Value = String> {
    (coefficient(), ior(), absorption(), any::<bool>()).prop_map(|(k_t, ior, absorption, fresnel)| {
        format!(", refractive: (k_t: {k_t}, ior: {ior}, absorption: {absorption}, fresnel: {fresnel})")
    })
}

/// Seldom, as a sphere cannot have it.
fn checker() -> impl Strategy<Value = String> {
    let some =
        (color(), size()).prop_map(|(color, size)| format!(", checker: (color: {color}, size: {size})"));
    prop_oneof![4 => Just(String::new()), 1 => some]
}

fn material() -> impl Strategy<Value = String> {
    let reflective = prop::option::of(coefficient());
    let specular = prop::option::of((coefficient(), shininess()));
    let more = (prop_oneof![Just(String::new()), refractive()], checker());
    (coefficient(), coefficient(), color(), prop::option::of(color()), specular, reflective, more).prop_map(
        |(k_a, k_d, color, ambient, specular, reflective, (glass, squares))| {
            let ambient = ambient.map_or_else(String::new, |color| format!(", ambient_color: {color}"));
            let mirror = reflective.map_or_else(String::new, |k_r| format!(", reflective: (k_r: {k_r})"));
            let gloss = specular.map_or_else(String::new, |(k_s, shininess)| {
                format!(", specular: (k_s: {k_s}, shininess: {shininess})")
            });
            format!("(k_a: {k_a}, k_d: {k_d}, color: {color}{ambient}{gloss}{mirror}{glass}{squares})")
        },
    )
}

fn falloff() -> impl Strategy<Value = String> {
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

/// What is between an entity's brackets besides its name and parent.
fn entity() -> impl Strategy<Value = String> {
    let shape = prop_oneof![
        size().prop_map(|radius| format!("Sphere(radius: {radius})")),
        (size(), size(), size()).prop_map(|(x, y, z)| format!("Box(size: ({x}, {y}, {z}))")),
        point().prop_map(|normal| format!("Plane(normal: {normal})")),
    ];
    let shape =
        (shape, 0..3).prop_map(|(shape, material)| format!("shape: {shape}, material: \"m{material}\", "));
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
    ];
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

fn camera() -> impl Strategy<Value = String> {
    let view = prop_oneof![
        3 => point().prop_map(|target| format!("target: {target}")),
        1 => triple().prop_map(|view| format!("view: {view}")),
    ];
    let up = prop_oneof![2 => Just("(0, 1, 0)".to_owned()), 1 => triple()];
    let projection = prop_oneof![
        2 => Just(String::new()),
        1 => prop_oneof![1.0..179.0f64, number()].prop_map(|fov| format!(", fov: {fov:?}")),
        1 => (size(), size(), size()).prop_map(|(distance, width, height)| {
            format!(", screen: (distance: {distance}, width: {width}, height: {height})")
        }),
    ];
    let lens = (number(), size())
        .prop_map(|(aperture, focus)| format!(", lens: (aperture: {:?}, focus: {focus})", aperture.abs()));
    let lens = prop_oneof![2 => Just(String::new()), 1 => lens];
    (point(), view, up, projection, lens, shutter()).prop_map(
        |(position, view, up, projection, lens, shutter)| {
            format!("position: {position}, {view}, up: {up}{projection}{lens}{shutter}")
        },
    )
}

fn shutter() -> impl Strategy<Value = String> {
    let share = prop_oneof![Just(1.0), Just(5e-324), 0.01..1.0f64];
    prop_oneof![2 => Just(String::new()), 1 => share.prop_map(|share| format!(", shutter: {share:?}"))]
}

fn background() -> impl Strategy<Value = String> {
    prop_oneof![
        color(),
        (color(), color()).prop_map(|(bottom, top)| format!("(bottom: {bottom}, top: {top})"))
    ]
}

fn fog() -> impl Strategy<Value = String> {
    let some = (color(), prop_oneof![0.0..1.0f64, number().prop_map(f64::abs)])
        .prop_map(|(color, density)| format!("fog: (color: {color}, density: {density:?}), "));
    prop_oneof![2 => Just(String::new()), 1 => some]
}

/// What is between the brackets of quality and of sampling.
fn effort() -> impl Strategy<Value = (String, String)> {
    let depth = prop_oneof![20 => 1u32..8, 1 => Just(1000)];
    let cutoff = prop_oneof![Just(0.25), Just(0.0), Just(255.0), 0.0..255.0f64];
    let samples = prop_oneof![4 => Just(1u32), 1 => 2..4u32];
    let instants = prop_oneof![1..4u32, Just(256)];
    (depth, cutoff, samples, instants).prop_map(|(depth, cutoff, samples, instants)| {
        (format!("depth: {depth}, cutoff: {cutoff:?}"), format!("samples: {samples}, instants: {instants}"))
    })
}

fn keys(value: impl Strategy<Value = String>) -> impl Strategy<Value = String> {
    let easing = prop::sample::select(vec![
        "Hold",
        "Linear",
        "EaseInOut",
        "OutExpo",
        "InOutBack",
        "InElastic",
        "OutBounce",
        "Steps(3)",
        "Bezier(1, -1000, 0, 1000)",
        "Cubic",
        "CatmullRom",
        "Monotone",
    ]);
    let gap =
        prop_oneof![6 => 0.1..1.0f64, 1 => prop::sample::select(vec![5e-324, 1e-300, 1e-16, 1e-9, 1e9])];
    prop::collection::vec((gap, value, easing), 1..5).prop_map(|keys| {
        let mut time = -0.5;
        let mut text = String::new();
        for (gap, value, easing) in keys {
            time += gap;
            text += &format!("({time:?}, {value}, {easing}), ");
        }
        format!("Keys([{text}])")
    })
}

fn animation() -> impl Strategy<Value = String> {
    let of = |targets: &'static str, channel: &'static str, keys: BoxedStrategy<String>| {
        (0..6u32, keys).prop_map(move |(index, keys)| {
            let target = targets.replace('#', &index.to_string());
            let played = match index {
                1 => ", repeat: Loop",
                2 => ", repeat: PingPong, speed: -1e60",
                3 => ", repeat: Loop, offset: 0.3, speed: 7",
                _ => "",
            };
            format!("({target}, channel: {channel}, track: {keys}{played})")
        })
    };
    let (entity, camera, material) = ("target: \"e#\"", "target: \"camera\"", "material: \"m#\"");
    prop_oneof![
        2 => of(entity, "Translation", keys(point()).boxed()),
        2 => of(entity, "Rotation", keys(rotation()).boxed()),
        2 => of(entity, "Scale", keys(scale()).boxed()),
        1 => of(entity, "Intensity", keys(intensity()).boxed()),
        1 => of(entity, "Direction", keys(point()).boxed()),
        1 => of(entity, "Kd", keys(coefficient()).boxed()),
        1 => of(material, "Ka", keys(coefficient()).boxed()),
        1 => of(material, "Ks", keys(coefficient()).boxed()),
        1 => of(entity, "Shininess", keys(shininess()).boxed()),
        1 => of(material, "Kr", keys(coefficient()).boxed()),
        1 => of(material, "Kt", keys(coefficient()).boxed()),
        1 => of(material, "Ior", keys(ior()).boxed()),
        1 => of(material, "Absorption", keys(absorption()).boxed()),
        1 => of(material, "Color", keys(color()).boxed()),
        1 => of(entity, "AmbientColor", keys(color()).boxed()),
        2 => of(camera, "Position", keys(point()).boxed()),
        2 => of(camera, "Target", keys(point()).boxed()),
    ]
}

/// The parts of a scene.
#[derive(Clone, Debug)]
pub(crate) struct Parts {
    transfer: &'static str,
    quality: String,
    sampling: String,
    camera: String,
    ambient: String,
    background: String,
    /// With its name, or nothing.
    fog: String,
    materials: [String; 3],
    /// What each is, and perhaps the index of its parent.
    entities: Vec<(String, Option<usize>)>,
    animations: Vec<String>,
}

pub(crate) fn parts() -> impl Strategy<Value = Parts> {
    let transfer = prop::sample::select(vec!["Classic", "Srgb"]);
    let settings = (transfer, effort(), camera().boxed(), intensity(), background(), fog());
    // Boxed: strategies made of strategies grow too large for a stack.
    let materials = [material().boxed(), material().boxed(), material().boxed()];
    let entities = prop::collection::vec((entity().boxed(), prop::option::weighted(0.3, 0..12usize)), 0..12);
    (settings, materials, entities, prop::collection::vec(animation().boxed(), 0..5)).prop_map(
        |(settings, materials, entities, animations)| {
            let (transfer, (quality, sampling), camera, ambient, background, fog) = settings;
            Parts {
                transfer,
                quality,
                sampling,
                camera,
                ambient,
                background,
                fog,
                materials,
                entities,
                animations,
            }
        },
    )
}

impl Parts {
    pub(crate) fn text(&self) -> String {
        let Self { transfer, quality, sampling, camera, ambient, background, fog, .. } = self;
        let [m0, m1, m2] = &self.materials;
        let mut entities = String::new();
        for (index, (what, parent)) in self.entities.iter().enumerate() {
            // An odd one out may make a ring.
            let parent = parent.filter(|parent| *parent < index || *parent == 11);
            let parent = parent.map_or_else(String::new, |parent| format!("parent: \"e{parent}\", "));
            entities += &format!("(name: \"e{index}\", {parent}{what}),\n");
        }
        let animations = self.animations.join(",\n");
        format!(
            r#"Scene(timeline: (fps: 5, duration: 2), film: (width: 32, height: 18, transfer: {transfer}),
            quality: ({quality}), sampling: ({sampling}), camera: ({camera}),
            ambient: {ambient}, background: {background}, {fog}
            materials: {{ "m0": {m0}, "m1": {m1}, "m2": {m2} }},
            entities: [{entities}], animate: [{animations}])"#
        )
    }

    /// Leaves parts out that are refused, so that one of them does not waste the others.
    pub(crate) fn good(mut self) -> Result<Self, TestCaseError> {
        let alone = Self { entities: Vec::new(), animations: Vec::new(), ..self.clone() };
        if read(&alone.text())?.is_none() {
            "position: (0, 0, -9), target: (0, 0, 0)".clone_into(&mut self.camera);
        }
        let frame = Self { entities: Vec::new(), animations: Vec::new(), ..self.clone() };
        let mut entities = Vec::new();
        for (what, parent) in self.entities {
            if read(&Self { entities: vec![(what.clone(), None)], ..frame.clone() }.text())?.is_some() {
                entities.push((what, parent));
            }
        }
        let mut good = Self { entities, ..frame };
        for animation in self.animations {
            good.animations.push(animation);
            if read(&good.text())?.is_none() {
                good.animations.pop();
            }
        }
        Ok(good)
    }
}
