//! Random scenes as texts, and random edits of them.

use super::random::Random;

/// The files of a scene.
#[derive(Clone)]
pub(crate) struct Model {
    scene: Document,
    part: Document,
    /// The changes of a scene that extends the main file.
    change: Option<Document>,
    /// Number of entities that the script spawns.
    row: usize,
    names: usize,
}

#[derive(Clone, Default)]
struct Document {
    /// Fields and their values.
    settings: Vec<(&'static str, String)>,
    cameras: Vec<(String, String)>,
    shots: Vec<String>,
    materials: Vec<String>,
    things: Vec<Thing>,
    animate: Vec<String>,
    includes: Vec<(&'static str, String)>,
    spawns: bool,
}

#[derive(Clone, Default)]
struct Thing {
    name: Option<String>,
    /// Texts of the fields transform, parent, shape with material, light, and target or `look_at`.
    fields: [String; 5],
}

const SETTINGS: [&str; 12] = [
    "timeline",
    "film",
    "quality",
    "sampling",
    "camera",
    "ambient",
    "ambient_occlusion",
    "background",
    "space",
    "sun",
    "stars",
    "fog",
];

impl Model {
    pub(crate) fn new(random: &mut Random) -> Self {
        let mut model = Self {
            scene: Document::default(),
            part: Document::default(),
            change: None,
            row: random.index(4),
            names: 0,
        };
        model.scene.settings = SETTINGS.map(|field| (field, setting(field, &[], random))).into();
        for _ in 0..random.index(8) {
            model.insert(random, false);
        }
        for _ in 0..random.index(4) {
            model.insert(random, true);
        }
        for document in [&mut model.scene, &mut model.part] {
            document.materials = (0..3).map(|_| material(random)).collect();
        }
        model
    }

    /// Returns the text of the main file, and the names and texts of the other files: the included `part.ron` and `row.rhai`, and
    /// `base.ron` if the main file extends it.
    pub(crate) fn files(&self) -> (String, Vec<(&'static str, String)>) {
        let row = format!(
            "for i in 0..{} {{ spawn(#{{ shape: sphere(0.5), material: `m0`, translation: [i, 2 * i, 1] }}); }}",
            self.row
        );
        let mut files = vec![("part.ron", self.part.text()), ("row.rhai", row)];
        let Some(change) = &self.change else { return (self.scene.text(), files) };
        files.push(("base.ron", self.scene.text()));
        (change.text(), files)
    }

    /// Makes a random edit. The result may be an invalid scene.
    pub(crate) fn edit(&mut self, random: &mut Random) {
        let in_part = random.once_in(4);
        match random.index(20) {
            16..=19 => self.change_extension(random),
            0 | 1 => self.insert(random, in_part),
            2 => self.rename(random, in_part),
            3 => self.row = random.index(5),
            4 => change_settings(&mut self.scene, random),
            5 => change_cameras(&mut self.scene, random),
            6 => change_shots(&mut self.scene, random),
            7 => change_includes(&mut self.scene, random),
            kind => {
                let document = if in_part { &mut self.part } else { &mut self.scene };
                match kind {
                    8 => document.delete(random),
                    9 => document.reorder(random),
                    10..=12 => document.change(random),
                    13 => {
                        let index = random.index(document.materials.len());
                        document.materials[index] = material(random);
                    }
                    _ => document.change_animations(random),
                }
            }
        }
    }

    /// Adds, changes or removes the changes of a scene that extends the main file.
    fn change_extension(&mut self, random: &mut Random) {
        let names = self.scene.names();
        let fresh = self.fresh_name();
        if random.once_in(8) {
            self.change = None;
            return;
        }
        let change = self.change.get_or_insert_with(|| Document {
            settings: vec![("extends", "\"base.ron\"".to_owned())],
            ..Document::default()
        });
        match random.index(6) {
            0 => {
                let field = SETTINGS[random.index(SETTINGS.len())];
                change.settings.retain(|(known, _)| *known != field);
                change.settings.push((field, setting(field, &names, random)));
            }
            1 => change.materials = (0..random.index(4)).map(|_| material(random)).collect(),
            2 => change.change_animations(random),
            3 if !names.is_empty() => {
                change.settings.retain(|(known, _)| *known != "without");
                let name = &names[random.index(names.len())];
                change.settings.push(("without", format!("[\"{name}\"]")));
            }
            4 => change.settings.retain(|(known, _)| *known == "extends"),
            _ => {
                let known = (!names.is_empty() && !random.once_in(4))
                    .then(|| names[random.index(names.len())].clone());
                let name = known.unwrap_or(fresh);
                change.things.retain(|thing| thing.name.as_ref() != Some(&name));
                let mut fields: [String; 5] = Default::default();
                let which = random.index(5);
                fields[which] = field(which, &names, random);
                change.things.push(Thing { name: Some(name), fields });
            }
        }
    }

    fn insert(&mut self, random: &mut Random, in_part: bool) {
        let name = (!random.once_in(3)).then(|| self.fresh_name());
        let document = if in_part { &mut self.part } else { &mut self.scene };
        let names = document.names();
        let fields = [0, 1, 2, 3, 4].map(|which| field(which, &names, random));
        let at = random.index(document.things.len() + 1);
        document.things.insert(at, Thing { name, fields });
    }

    fn fresh_name(&mut self) -> String {
        self.names += 1;
        format!("n{}_", self.names)
    }

    /// Renames an entity, mostly along with the references to it, removes its name, or exchanges the names of two entities.
    fn rename(&mut self, random: &mut Random, in_part: bool) {
        let fresh = self.fresh_name();
        let document = if in_part { &mut self.part } else { &mut self.scene };
        if document.things.is_empty() {
            return;
        }
        let (one, other) = (random.index(document.things.len()), random.index(document.things.len()));
        let name = document.things[one].name.take();
        document.things[one].name = match (name, random.index(4)) {
            (name, 0) if one != other => std::mem::replace(&mut document.things[other].name, name),
            (_, 1) => None,
            (Some(name), 2 | 3) => {
                document.replace(&name, &fresh);
                Some(fresh)
            }
            _ => Some(fresh),
        };
    }
}

impl Document {
    fn text(&self) -> String {
        let list = |items: &[String]| items.join(", ");
        let mut text = "Scene(\n".to_owned();
        for (field, value) in self.settings.iter().filter(|(_, value)| !value.is_empty()) {
            text += &format!("  {field}: {value},\n");
        }
        let pairs = |pairs: &[(String, String)]| -> Vec<String> {
            pairs.iter().map(|(name, value)| format!("\"{name}\": {value}")).collect()
        };
        let materials: Vec<(String, String)> =
            self.materials.iter().enumerate().map(|(at, text)| (format!("m{at}"), text.clone())).collect();
        let things: Vec<String> = self.things.iter().map(Thing::text).collect();
        let includes: Vec<String> = self.includes.iter().map(|(name, rest)| include(name, rest)).collect();
        text += &format!("  include: [{}],\n", list(&includes));
        text += &format!("  cameras: {{{}}},\n", list(&pairs(&self.cameras)));
        if !self.shots.is_empty() {
            text += &format!("  shots: [{}],\n", list(&self.shots));
        }
        text += &format!("  materials: {{{}}},\n", list(&pairs(&materials)));
        text += &format!("  entities: [\n    {}\n  ],\n", things.join(",\n    "));
        text += &format!("  spawn: [{}],\n", if self.spawns { "File(\"row.rhai\")" } else { "" });
        text += &format!("  animate: [\n    {}\n  ],\n)\n", self.animate.join(",\n    "));
        text
    }

    fn names(&self) -> Vec<String> {
        self.things.iter().filter_map(|thing| thing.name.clone()).collect()
    }

    /// Returns all texts that may contain names.
    fn texts(&mut self) -> impl Iterator<Item = &mut String> {
        let fields = self.things.iter_mut().flat_map(|thing| &mut thing.fields);
        let cameras = self.cameras.iter_mut().map(|(_, camera)| camera);
        let settings = self.settings.iter_mut().map(|(_, setting)| setting);
        fields.chain(cameras).chain(settings).chain(&mut self.animate)
    }

    fn replace(&mut self, name: &str, other: &str) {
        for text in self.texts() {
            *text = text.replace(name, other);
        }
    }

    /// Deletes an entity, along with most references to it.
    fn delete(&mut self, random: &mut Random) {
        if self.things.is_empty() {
            return;
        }
        let removed = self.things.remove(random.index(self.things.len()));
        if let Some(name) = removed.name {
            self.animate.retain(|animation| !animation.contains(&name));
            for thing in &mut self.things {
                for link in [1, 4] {
                    if thing.fields[link].contains(&name) {
                        thing.fields[link].clear();
                    }
                }
            }
        }
    }

    fn reorder(&mut self, random: &mut Random) {
        if !self.things.is_empty() {
            let thing = self.things.remove(random.index(self.things.len()));
            let at = random.index(self.things.len() + 1);
            self.things.insert(at, thing);
        }
    }

    fn change(&mut self, random: &mut Random) {
        if !self.things.is_empty() {
            let (at, which) = (random.index(self.things.len()), random.index(5));
            self.things[at].fields[which] = field(which, &self.names(), random);
        }
    }

    fn change_animations(&mut self, random: &mut Random) {
        if !self.animate.is_empty() && random.once_in(3) {
            self.animate.remove(random.index(self.animate.len()));
        } else {
            let at = random.index(self.animate.len() + 1);
            self.animate.insert(at, animation(&self.names(), self.settings.is_empty(), random));
        }
    }
}

impl Thing {
    fn text(&self) -> String {
        let name = self.name.iter().map(|name| format!("name: \"{name}\""));
        let fields = self.fields.iter().filter(|field| !field.is_empty()).cloned();
        format!("({})", name.chain(fields).collect::<Vec<_>>().join(", "))
    }
}

fn include(name: &str, rest: &str) -> String {
    match name {
        "" => format!("(file: \"part.ron\"{rest})"),
        name => format!("(file: \"part.ron\", name: \"{name}\"{rest})"),
    }
}

fn change_settings(scene: &mut Document, random: &mut Random) {
    let names = scene.names();
    let at = random.index(SETTINGS.len());
    scene.settings[at].1 = setting(SETTINGS[at], &names, random);
}

fn change_cameras(scene: &mut Document, random: &mut Random) {
    let name = random.pick(&["close", "far", "apart"]);
    scene.cameras.retain(|(known, _)| known != name);
    if random.once_in(4) {
        scene.shots.retain(|shot| !shot.contains(name));
    } else {
        let at = random.index(scene.cameras.len() + 1);
        scene.cameras.insert(at, (name.to_owned(), camera(&scene.names(), random)));
    }
    // The default camera is optional if there are others.
    if random.once_in(4) && !scene.cameras.is_empty() {
        scene.settings[4].1.clear();
    }
}

fn change_shots(scene: &mut Document, random: &mut Random) {
    let cameras: Vec<&str> = scene.cameras.iter().map(|(name, _)| name.as_str()).chain(["camera"]).collect();
    scene.shots = (0..random.index(4))
        .map(|at| format!("({:?}, \"{}\")", at as f64 * 0.75 + random.share() / 4.0, random.pick(&cameras)))
        .collect();
}

fn change_includes(scene: &mut Document, random: &mut Random) {
    match random.index(4) {
        0 => scene.spawns = !scene.spawns,
        1 if !scene.includes.is_empty() => {
            scene.includes.remove(random.index(scene.includes.len()));
        }
        _ => {
            let name = ["p", "q"][random.index(2)];
            scene.includes.retain(|(known, _)| *known != name);
            let place = if random.once_in(2) { format!(", {}", transform(random)) } else { String::new() };
            scene.includes.push((name, place));
        }
    }
}

fn setting(field: &str, names: &[String], random: &mut Random) -> String {
    match field {
        "timeline" => format!("(fps: {}, duration: 2.5)", random.pick(&["2", "24", "(30000, 1001)"])),
        "film" => {
            let transfer = random.pick(&["Classic", "Srgb"]);
            format!("(width: {}, height: {}, transfer: {transfer})", 8 + random.index(9), 6 + random.index(5))
        }
        "quality" => format!("(depth: {}, cutoff: {})", 1 + random.index(4), random.index(3)),
        "sampling" => format!(
            "(samples: {}, min_samples: {}, max_error: {}, norm: {}, instants: {}, seed: {}, noise: {})",
            1 + random.index(4),
            1 + random.index(4),
            random.index(2),
            random.pick(&["Rms", "Max", "P99"]),
            1 + random.index(3),
            random.index(3),
            random.pick(&["Fixed", "PerFrame"])
        ),
        "camera" => camera(names, random),
        "ambient" => random.light(),
        "space" => random.pick(&["LeftHanded", "RightHanded", ""]).to_owned(),
        "background" if random.once_in(4) => {
            let height = 0.5 * random.share();
            format!(
                "(stops: [(-0.5, {}), ({height:?}, {}), (1, {})])",
                random.color(),
                random.color(),
                random.color()
            )
        }
        "background" if random.once_in(2) => {
            let horizon =
                if random.once_in(2) { format!("horizon: {}, ", random.color()) } else { String::new() };
            format!("(bottom: {}, {horizon}top: {})", random.color(), random.color())
        }
        "background" => random.color(),
        "sun" | "stars" | "ambient_occlusion" if random.once_in(2) => String::new(),
        "ambient_occlusion" => {
            format!("(samples: {}, distance: {:?})", 1 + random.index(3), 0.1 + 5.0 * random.share())
        }
        "sun" => {
            let rest = random.pick(&["", ", size: 20", ", glow: 0.5", ", size: 9, glow: 0.2, glow_size: 20"]);
            format!("(direction: ({:?}, 0.5, 1), intensity: {}{rest})", random.number(), random.light())
        }
        "stars" => {
            let rest = random.pick(&["", "size: 4", "seed: 7", "intensity: (2, 1, 1)"]);
            format!("(count: {}, {rest})", 1 + random.index(900))
        }
        _ if random.once_in(2) => {
            let rest =
                random.pick(&["", ", hides_background: false", ", height: 3", ", height: 0.5, level: -2"]);
            format!("(color: {}, density: {:?}{rest})", random.color(), random.share() / 8.0)
        }
        _ => String::new(),
    }
}

fn camera(names: &[String], random: &mut Random) -> String {
    let (x, y) = (random.number(), random.number());
    let mut text = format!("(position: ({x:?}, {y:?}, -9)");
    let name = |random: &mut Random| {
        (!names.is_empty() && random.once_in(4)).then(|| names[random.index(names.len())].clone())
    };
    match (name(random), random.once_in(2)) {
        (Some(name), _) => text += &format!(", look_at: \"{name}\""),
        (None, true) => text += &format!(", target: ({:?}, 0, 0)", random.number()),
        (None, false) => text += &format!(", view: ({:?}, 0.25, 8)", random.number()),
    }
    for link in ["parent", "follow"] {
        if let Some(name) = name(random) {
            text += &format!(", {link}: \"{name}\"");
        }
    }
    match random.index(5) {
        3 => text += &format!(", orthographic: {}", 3 + random.index(9)),
        0 => text += ", screen: (distance: 1, height: 1)",
        2 => text += &format!(", horizontal_fov: {}", 50 + random.index(60)),
        1 => text += &format!(", fov: {}", 30 + random.index(40)),
        _ => {}
    }
    if random.once_in(3) {
        text += &format!(", lens: (aperture: {:?}, focus: 8)", random.share());
        if let Some(name) = name(random) {
            text += &format!(", focus_on: \"{name}\"");
        }
    }
    if random.once_in(3) {
        text += ", shutter: 0.5";
    }
    if random.once_in(3) {
        text += &format!(", roll: {}", random.index(90));
    }
    text + ")"
}

fn material(random: &mut Random) -> String {
    let mut text = format!("(color: {}", random.color());
    if !random.once_in(4) {
        text += &format!(", k_a: {:?}, k_d: {:?}", random.share(), random.share());
    }
    if random.once_in(4) {
        text += &format!(", ambient_color: {}", random.color());
    }
    if random.once_in(3) {
        text += &format!(", specular: (k_s: {:?}, shininess: {})", random.share(), random.index(50));
    }
    if random.once_in(3) {
        let k_r = random.share();
        text += &format!(", reflective: (k_r: {k_r:?}), metallic: {}", k_r > 0.5);
    }
    if random.once_in(4) {
        let rest = random.pick(&["", ", fresnel: true", ", absorption: (0.5, 0, 0.25)"]);
        text += &format!(", refractive: (k_t: 0.75, ior: {:?}{rest})", 1.0 + random.share());
    }
    if random.once_in(6) {
        text += &format!(", emission: {}", random.light());
    }
    if random.once_in(6) {
        let size = 0.5 + random.share();
        let kind = match random.index(5) {
            0 => format!("Checker(size: {size:?}"),
            1 => format!("Stripes(size: {size:?}, ratio: 0.25, direction: (1, 2, 0), offset: 0.5"),
            2 => format!("Bricks(size: ({size:?}, 0.25, 0.5), mortar: 0.1"),
            3 => format!("Gradient(size: {size:?}"),
            _ => format!("Noise(size: {size:?}, octaves: 2"),
        };
        text += &format!(", pattern: {kind}, color: {})", random.color());
    }
    text + ")"
}

fn transform(random: &mut Random) -> String {
    let mut text = format!("transform: (translation: {}", random.triple());
    if random.once_in(3) {
        text += &format!(", rotation: Euler{}", random.triple());
    }
    if random.once_in(3) {
        text += random.pick(&[", scale: 2", ", scale: (1, 2, 0.5)", ", scale: -1"]);
    }
    text + ")"
}

fn field(which: usize, names: &[String], random: &mut Random) -> String {
    match which {
        0 if random.once_in(8) => String::new(),
        0 => transform(random),
        1 if names.is_empty() || !random.once_in(3) => String::new(),
        1 => format!("parent: \"{}\"", names[random.index(names.len())]),
        2 => {
            let shape = match random.index(8) {
                0 => return String::new(),
                6 => {
                    let to = 0.5 + random.share();
                    format!(
                        "Cylinder(radius: {:?}, from: (0, 0, 0), to: (0.5, {to:?}, 0))",
                        0.1 + random.share()
                    )
                }
                7 => format!("Capsule(radius: {:?}, height: 1)", 0.1 + random.share()),
                1 => format!("Plane(normal: (0, 1, {:?}))", random.number()),
                2 | 3 => format!("Box(size: (1, {:?}, 2))", 0.5 + random.share()),
                _ => format!("Sphere(radius: {:?})", 0.25 + random.share()),
            };
            let surface = match random.index(5) {
                0 => format!("color: {}", random.color()),
                1 => format!("material: \"m{}\", color: {}", random.index(3), random.color()),
                2 => format!("material: {}", material(random)),
                _ => format!("material: \"m{}\"", random.index(3)),
            };
            let unseen = random.pick(&["visible", "casts_shadow", "in_reflections"]);
            let unseen = if random.once_in(3) { format!(", {unseen}: false") } else { String::new() };
            format!("shape: {shape}, {surface}{unseen}")
        }
        4 => match random.index(12) {
            0 => format!("target: {}", random.triple()),
            1 | 2 if !names.is_empty() => format!("look_at: \"{}\"", names[random.index(names.len())]),
            _ => String::new(),
        },
        _ => {
            let intensity = random.light();
            match random.index(10) {
                8 => format!("light: Point(intensity: {intensity}, casts_shadows: false)"),
                9 => format!(
                    "light: Area(shape: Rectangle(width: 1, height: {:?}), intensity: {intensity}, samples: 3)",
                    0.5 + random.share()
                ),
                0 => format!("light: Point(intensity: {intensity}, falloff: (1, 0, 0.125))"),
                1 => {
                    format!("light: Spot(intensity: {intensity}, angle: 90, softness: {:?})", random.share())
                }
                2 => format!("light: Directional(intensity: {intensity})"),
                3 => format!("light: Area(shape: Sphere(radius: 0.5), intensity: {intensity}, samples: 2)"),
                _ => String::new(),
            }
        }
    }
}

fn animation(names: &[String], in_part: bool, random: &mut Random) -> String {
    let keys = |from: String, to: String| format!("Keys([(0, {from}), (2, {to}, InOutSine)])");
    let name = if names.is_empty() { String::new() } else { names[random.index(names.len())].clone() };
    let (target, channel, track) = match random.index(if in_part { 8 } else { 12 }) {
        0 => (name, "Translation", keys(random.triple(), random.triple())),
        1 if random.once_in(3) => {
            (name, "Rotation", format!("Turns(axis: {}, turns: 2, duration: 1.5)", random.triple()))
        }
        1 => (name, "Rotation", keys(format!("Euler{}", random.triple()), "Euler(0, 90, 0)".to_owned())),
        2 => (
            name,
            random.pick(&["Radius", "Scale"]),
            keys("1".to_owned(), format!("{:?}", 0.5 + random.share())),
        ),
        3 if random.once_in(2) => {
            let channel = random.pick(&["Visible", "CastsShadow", "InReflections"]);
            (name, channel, "Keys([(0, false), (1.25, true)])".to_owned())
        }
        3 => (name, "Intensity", keys(random.light(), random.light())),
        4 => {
            let channel = random.pick(&["Ka", "Kd", "Kr", "Ks", "Color", "Emission"]);
            let keys = match channel {
                "Emission" => keys(random.light(), random.light()),
                "Color" => keys(random.color(), random.color()),
                _ => keys(format!("{:?}", random.share()), format!("{:?}", random.share())),
            };
            return format!("(material: \"m{}\", channel: {channel}, track: {keys})", random.index(3));
        }
        5 => {
            let other = if names.is_empty() { "camera" } else { &names[random.index(names.len())] };
            let script = match random.index(5) {
                0 => "base + [0, sin(t), index]".to_owned(),
                1 => "[floor(t), 0, 0]".to_owned(),
                2 => format!("value(`{other}`, `Translation`, t - 0.5) + [1, t, 0]"),
                3 => format!(
                    "if t <= 0 {{ base }} else {{ value(`{name}`, `Translation`, t - 0.25) + value(`{other}`, `Translation`, t / 2) }}"
                ),
                _ => format!("value(`{other}`, `Translation`) + [1, t, 0]"),
            };
            (name, "Translation", format!("Script(\"{script}\")"))
        }
        6 => {
            let track =
                format!("Path(points: [{}, {}, (0, 1, 0)], duration: 2)", random.triple(), random.triple());
            let rest = random.pick(&["", ", repeat: Loop", ", offset: 0.25, speed: 2"]);
            return format!("(target: \"{name}\", channel: Translation, track: {track}{rest})");
        }
        7 => (name, "Translation", format!("Orbit(center: {}, radius: 1, duration: 1.5)", random.triple())),
        8 if random.once_in(2) => {
            let path = format!("Path(points: [(0, 1, -8), {}, (2, 1, -8)], duration: 2)", random.triple());
            return format!(
                "(target: \"camera\", channel: View, track: Along), (target: \"camera\", channel: Position, track: {path})"
            );
        }
        8 => ("camera".to_owned(), "Position", keys("(0, 1, -8)".to_owned(), "(2, 1, -8)".to_owned())),
        9 => ("close".to_owned(), "Position", "Script(\"base + [t, index, 0]\")".to_owned()),
        10 => ("scene".to_owned(), "Ambient", keys(random.light(), random.light())),
        _ => ("scene".to_owned(), "FogDensity", keys("0".to_owned(), format!("{:?}", random.share()))),
    };
    format!("(target: \"{target}\", channel: {channel}, track: {track})")
}
