//! Random rooms of mirrors and glass.

use std::fmt::Write as _;

/// Knuth's generator (The Art of Computer Programming, volume 2, section 3.3.4).
struct Random(u64);

impl Random {
    /// Returns a number in 0..1.
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.number()
    }

    fn chance(&mut self, share: f64) -> bool {
        self.number() < share
    }

    fn triple(&mut self, from: f64, to: f64) -> String {
        let [x, y, z] = [0; 3].map(|_| self.between(from, to));
        format!("({x:?}, {y:?}, {z:?})")
    }
}

/// Returns the text of a scene.
pub(crate) fn room(seed: u64) -> String {
    let mut random = Random(seed);
    for _ in 0..4 {
        random.number();
    }
    let (mut materials, mut entities) = (String::new(), String::new());
    let _ = write!(
        materials,
        r#""wall": (k_a: {:?}, k_d: {:?}, reflective: (k_r: {:?})), "#,
        0.3 * random.number(),
        0.3 * random.number(),
        random.between(0.3, 0.9)
    );
    for index in 0..4 {
        let _ = write!(materials, r#""{index}": {}, "#, material(&mut random));
    }
    entities += r#"(shape: Box(size: (8, 6, 8)), material: "wall"), "#;
    for index in 0..6 {
        entities += &thing(&mut random, index % 4);
    }
    for _ in 0..3 {
        entities += &light(&mut random);
    }
    let fog = if random.chance(0.3) {
        format!("fog: (color: {}, density: {:?}),", random.triple(0.0, 255.0), random.between(0.0, 0.5))
    } else {
        String::new()
    };
    format!(
        r#"Scene(film: (width: 16, height: 9, transfer: Classic), quality: (), camera: (position: {}, view: (1, 0.1, 0.7)), ambient: {}, {fog}
        background: (bottom: {}, top: {}), materials: {{ {materials} }}, entities: [{entities}])"#,
        random.triple(-2.0, 2.0),
        random.triple(0.0, 1.0),
        random.triple(0.0, 255.0),
        random.triple(0.0, 255.0),
    )
}

fn material(random: &mut Random) -> String {
    let mut text = format!("(k_a: {:?}, k_d: {:?}, ", 0.5 * random.number(), 0.5 * random.number());
    let _ = write!(text, "color: {}, ", random.triple(0.0, 255.0));
    if random.chance(0.5) {
        let shininess = random.between(1.0, 99.0);
        let _ = write!(text, "specular: (k_s: {:?}, shininess: {shininess:?}), ", random.number());
    }
    if random.chance(0.2) {
        let _ = write!(text, "emission: {}, ", random.triple(0.0, 2.0));
    }
    if random.chance(0.7) {
        let metallic = random.chance(0.4);
        let _ = write!(text, "reflective: (k_r: {:?}), metallic: {metallic}, ", random.number());
    }
    if random.chance(0.6) {
        let (ior, fresnel) = (random.between(0.6, 2.5), random.chance(0.7));
        let absorption = random.triple(0.0, 1.0);
        let _ = write!(
            text,
            "refractive: (k_t: {:?}, ior: {ior:?}, absorption: {absorption}, fresnel: {fresnel}), ",
            random.number()
        );
    }
    text + ")"
}

fn thing(random: &mut Random, material: u32) -> String {
    let (shape, place) = (random.number(), random.triple(-3.0, 3.0));
    let shape = if shape < 0.3 {
        let ends = [random.triple(-1.0, 0.0), random.triple(0.0, 1.0)];
        let kind = if random.chance(0.5) { "Cylinder" } else { "Capsule" };
        format!("{kind}(radius: {:?}, from: {}, to: {})", random.between(0.1, 0.9), ends[0], ends[1])
    } else if shape < 0.6 {
        format!("Sphere(radius: {:?})", random.between(0.2, 1.5))
    } else if shape < 0.9 {
        format!("Box(size: {})", random.triple(0.2, 3.0))
    } else {
        format!("Plane(normal: {})", random.triple(-1.0, 1.0))
    };
    let turned = random.triple(0.0, 360.0);
    let unseen: String = ["visible", "casts_shadow", "in_reflections"]
        .into_iter()
        .filter(|_| random.chance(0.1))
        .map(|field| format!("{field}: false, "))
        .collect();
    format!(
        r#"(shape: {shape}, {unseen}material: "{material}", transform: (translation: {place}, rotation: Euler{turned})), "#
    )
}

fn light(random: &mut Random) -> String {
    let (intensity, place) = (random.triple(0.0, 1.0), random.triple(-2.5, 2.5));
    let kind = random.number();
    let light = if kind < 0.4 {
        format!("Point(intensity: {intensity})")
    } else if kind < 0.7 {
        format!("Point(intensity: {intensity}, falloff: (0.5, 0.1, {:?}))", random.number())
    } else {
        format!("Area(shape: Sphere(radius: 0.3), intensity: {intensity}, samples: 2)")
    };
    format!("(light: {light}, transform: (translation: {place})), ")
}
