//! Scenes that are hard for adaptive sampling: their important features are smaller than a pixel, rare, bright, out of focus, moving, or
//! transparent.

use std::fmt::Write;

/// A named scene.
pub(crate) struct HardScene {
    pub(crate) name: &'static str,
    /// Set if the scene tests the alpha channel.
    pub(crate) alpha: bool,
    pub(crate) text: String,
}

/// A deterministic pseudo-random generator.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let bits = (self.0 ^ self.0 >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (bits >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, range: f64) -> f64 {
        (2.0 * self.next() - 1.0) * range
    }
}

/// Width in pixels of a picture whose camera at z = -10 sees 32 x 18 units of the plane z = 0.
const COLUMNS: f64 = 128.0;
const PIXEL: f64 = 32.0 / COLUMNS;

/// Returns the text of a scene of 12 frames on a film of 128 x 72 pixels.
fn scene(settings: &str, materials: &str, entities: &str) -> String {
    format!(
        "Scene(timeline: (fps: 24, duration: 0.5), film: (width: 128, height: 72), {settings}\n\
         materials: {{ \"white\": (k_a: 1, color: (255, 255, 255)), {materials} }},\nentities: [{entities}])"
    )
}

const CAMERA: &str =
    "camera: (position: (0, 0, -10), target: (0, 0, 0), screen: (distance: 10, width: 32, height: 18)),";
const AMBIENT: &str = "ambient: (1, 1, 1),";

fn spheres(seed: u64, count: u32, radius: f64, material: &str) -> String {
    let mut random = Random(seed);
    let mut text = String::new();
    for _ in 0..count {
        let (x, y, z) = (random.within(16.0), random.within(9.0), random.within(0.5));
        writeln!(
            text,
            "(shape: Sphere(radius: {radius}), transform: (translation: ({x:.4}, {y:.4}, {z:.4})), material: \"{material}\"),"
        )
        .expect("texts take anything");
    }
    text
}

/// Returns spheres behind the camera, some 30 units from where they were.
fn behind(spheres: &str) -> String {
    spheres.replace(", 0.", ", -30.").replace(", -0.", ", -30.")
}

/// Returns boxes much longer than they are thick, upright or at random angles.
fn needles(seed: u64, count: u32, thickness: f64, length: f64, turned: bool) -> String {
    let mut random = Random(seed);
    let mut text = String::new();
    for _ in 0..count {
        let (x, y) = (random.within(15.0), random.within(8.0));
        let angle = if turned { 360.0 * random.next() } else { 0.0 };
        writeln!(
            text,
            "(shape: Box(size: ({thickness}, {length}, {thickness})), transform: (translation: ({x:.4}, {y:.4}, 0), \
             rotation: Euler(0, 0, {angle:.3})), material: \"white\"),"
        )
        .expect("texts take anything");
    }
    text
}

const FLOOR: &str =
    "(shape: Plane(normal: (0, 1, 0)), transform: (translation: (0, -3, 0)), material: \"floor\"),";
const LAMP: &str = "(light: Point(intensity: (1, 1, 1)), transform: (translation: (-8, 12, -10))),";

pub(crate) fn hard_scenes() -> Vec<HardScene> {
    let plain = |name, entities: &str| HardScene {
        name,
        alpha: false,
        text: scene(&format!("{CAMERA}{AMBIENT}"), "", entities),
    };
    let with = |name, settings: &str, materials: &str, entities: &str| HardScene {
        name,
        alpha: false,
        text: scene(settings, materials, entities),
    };
    // Materials glow by k_a in strong ambient light. All other materials have a k_a near 0.
    let (bright, strong) = ("ambient: (400, 400, 400),", format!("{CAMERA}ambient: (400, 400, 400),"));
    let lit = &strong;
    let lens = "camera: (position: (0, 0, -10), target: (0, 0, 0), screen: (distance: 10, width: 32, height: 18), \
                lens: (aperture: 1, focus: 6)),";
    let open = "camera: (position: (0, 0, -10), target: (0, 0, 0), screen: (distance: 10, width: 32, height: 18), \
                shutter: 1), sampling: (instants: 16),";
    let moving = |entity: &str, track: &str| {
        format!(
            "entities: [{entity}], animate: [(target: \"mover\", channel: Translation, track: Keys([{track}]))]"
        )
    };
    let mover = |name, (light, materials): (&str, &str), entities: &str, track: &str| {
        let head = scene(&format!("{open}{light}"), materials, "");
        HardScene { name, alpha: false, text: head.replace("entities: []", &moving(entities, track)) }
    };
    let glossy = "\"chrome\": (k_a: 0.000025, k_d: 0.1, color: (200, 200, 200), reflective: (k_r: 0.8)), \
                  \"floor\": (k_a: 0.00015, k_d: 0.7, color: (120, 130, 140)), \"spark\": (k_a: 0.1, color: (255, 255, 255)), \
                  \"hot\": (k_a: 1, color: (255, 240, 220)), \"glass\": (k_a: 0.00001, k_d: 0.05, color: (255, 255, 255), \
                  refractive: (k_t: 0.9, ior: 1.5, fresnel: true), reflective: (k_r: 1)), \"shiny\": (k_a: 0.00005, k_d: 0.3, \
                  color: (60, 60, 90), specular: (k_s: 1, shininess: 3000)), \"tiles\": (k_a: 0.0025, color: (230, 230, 230), \
                  pattern: Checker(color: (20, 20, 20), size: 0.5)), \"grey\": (k_a: 0.00125, color: (255, 255, 255)), \"black\": (k_a: 0, color: (0, 0, 0)),";
    let chrome = "(shape: Sphere(radius: 4), transform: (translation: (0, 1, 4)), material: \"chrome\"),";
    let marbles = "(shape: Sphere(radius: 3), transform: (translation: (-4, 0, 3)), material: \"glass\"),\
                   (shape: Sphere(radius: 2), transform: (translation: (3, -1, 1)), material: \"glass\"),";
    let balls: String = (0..12)
        .map(|ball| {
            let (x, z) = (f64::from(ball % 4) * 4.0 - 6.0, f64::from(ball / 4) * 4.0);
            format!(
                "(shape: Sphere(radius: 1.2), transform: (translation: ({x}, -2, {z})), material: \"shiny\"),"
            )
        })
        .collect();
    vec![
        plain("stars", &spheres(1, 200, PIXEL / 2.0, "white")),
        plain("dust", &spheres(2, 400, PIXEL / 6.0, "white")),
        with("bright dust", &strong, glossy, &spheres(3, 200, PIXEL / 15.0, "hot")),
        plain("wires", &needles(4, 40, 0.1 * PIXEL, 14.0, false)),
        plain("thick wires", &needles(5, 40, 0.2 * PIXEL, 14.0, false)),
        plain("needles", &needles(6, 120, 0.1 * PIXEL, 3.0, true)),
        with(
            "sparks on grey",
            &format!("{strong}background: (127, 127, 127),"),
            glossy,
            &spheres(7, 120, PIXEL / 10.0, "spark"),
        ),
        with("beyond white", lit, glossy, &format!("{FLOOR}{LAMP}{}", spheres(8, 60, PIXEL / 3.0, "hot"))),
        // The lamp's light has an upper bound far above what reaches the pebbles.
        with(
            "rare sparks",
            lit,
            glossy,
            &format!(
                "{}{}{}",
                LAMP.replace("(1, 1, 1)", "(40, 40, 40), falloff: (1, 0, 0.5)"),
                spheres(15, 200, PIXEL / 2.0, "floor"),
                spheres(16, 20, PIXEL / 6.0, "spark")
            ),
        ),
        with("bokeh", &format!("{lens}{bright}"), glossy, &spheres(9, 60, PIXEL / 4.0, "hot")),
        with(
            "fireflies",
            lit,
            glossy,
            &format!("{FLOOR}{chrome}{LAMP}{}", behind(&spheres(10, 40, PIXEL / 4.0, "hot"))),
        ),
        with(
            "looking glass",
            lit,
            glossy,
            &format!(
                "(shape: Plane(normal: (0, 0, -1)), transform: (translation: (0, 0, 20)), material: \"chrome\"),{balls}{LAMP}{}",
                behind(&spheres(17, 20, PIXEL, "spark"))
            ),
        ),
        with("glints", lit, glossy, &format!("{FLOOR}{balls}{LAMP}")),
        with(
            "penumbrae",
            lit,
            glossy,
            &format!(
                "{FLOOR}{balls}(light: Area(shape: Sphere(radius: 3), intensity: (1, 1, 1)), transform: (translation: (-8, 12, -10))),"
            ),
        ),
        with(
            "steep sky",
            &format!(
                "{CAMERA}{AMBIENT}background: (stops: [(0.1, (0, 0, 0)), (0.10001, (255, 255, 255)), (0.104, (255, 255, 255)), (0.10401, (0, 0, 0))]),"
            ),
            "",
            &spheres(14, 1, PIXEL, "white"),
        ),
        with("far checker", &strong, glossy, &FLOOR.replace("floor", "tiles")),
        with(
            "glass",
            &format!("{lit}background: (90, 120, 160),"),
            glossy,
            &format!("{}{marbles}{LAMP}", FLOOR.replace("floor", "tiles")),
        ),
        with("mirrors", lit, glossy, &format!("{FLOOR}{chrome}{balls}{LAMP}")),
        mover(
            "fast ball",
            (AMBIENT, ""),
            &format!("(name: \"mover\", shape: Sphere(radius: {PIXEL}), material: \"white\")"),
            "(0, (-15, 2, 0)), (0.5, (15, -3, 0))",
        ),
        mover(
            "fast bar",
            (AMBIENT, ""),
            &format!("(name: \"mover\", shape: Box(size: ({}, 12, 1)), material: \"white\")", 2.0 * PIXEL),
            "(0, (-150, 0, 0)), (0.5, (150, 0, 0))",
        ),
        mover(
            "cannonball",
            (AMBIENT, ""),
            &format!("(name: \"mover\", shape: Sphere(radius: {}), material: \"white\")", 10.0 * PIXEL),
            "(0, (-520, 1, 0)), (0.5, (440, 1, 0))",
        ),
        // The bar is behind the camera.
        mover(
            "fast shadow",
            ("ambient: (0.1, 0.1, 0.1),", "\"matte\": (k_a: 0.5, k_d: 0.8, color: (255, 255, 255))"),
            &format!(
                "(shape: Plane(normal: (0, 0, -1)), transform: (translation: (0, 0, 1)), material: \"matte\"),\
                 (light: Directional(direction: (0, 0, 1), intensity: (1, 1, 1))),\
                 (name: \"mover\", shape: Box(size: ({}, 5, 1)), material: \"matte\")",
                2.0 * PIXEL
            ),
            "(0, (-150, 0, -20)), (0.5, (150, 0, -20))",
        ),
        mover(
            "belt",
            (bright, &glossy.replace("size: 0.5", "size: 2")),
            &format!(
                "{}(name: \"mover\", shape: Box(size: (60, 8, 1)), material: \"tiles\")",
                spheres(15, 40, 3.0 * PIXEL, "grey")
            ),
            "(0, (-5, -4, 2)), (0.5, (5, -4, 2))",
        ),
        HardScene {
            name: "black on black",
            alpha: true,
            text: scene(&strong, glossy, &spheres(11, 60, 3.0 * PIXEL, "black")),
        },
        plain("busy", &(spheres(12, 150, 2.0 * PIXEL, "white") + needles(13, 60, PIXEL, 4.0, true).as_str())),
    ]
}
