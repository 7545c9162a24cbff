//! Tests that every animatable value moves in the world and in the picture, and that its keys show the same as scenes with constant values.

use glam::DVec3;

use rayreel::animation::{Notation, Value};
use rayreel::color::Transfer;
use rayreel::components::Property;
use rayreel::systems::value;
use rayreel::{Effect, Engine, Need, Rgb, Scene, Time};

use crate::named;

/// A scene in which a value can replace each `@word`.
const SCENE: &str = r##"Scene(
    timeline: (fps: 10, duration: 3),
    film: (width: 32, height: 20),
    sampling: (samples: 4, instants: 4),
    camera: (
        position: @position, @view, up: @up, roll: @roll, @projection, @shutter
        lens: (aperture: @aperture, focus: @focus),
    ),
    ambient: @ambient,
    background: @background,
    @fog @sky
    materials: {
        "clay": (
            k_a: @ka, k_d: @kd, color: @color, ambient_color: @ambient_color,
            specular: (k_s: @ks, shininess: @shininess), reflective: (k_r: @kr),
            emission: @emission,
        ),
        "glass": (k_d: 0.1, refractive: (k_t: @kt, ior: @ior, absorption: @absorption)),
        "tiles": (k_a: 0.3, k_d: 0.6, color: (90, 200, 120), pattern: @pattern),
    },
    entities: [
        (name: "floor", shape: Plane(normal: @normal), transform: (translation: (0, -1, 0)), material: "tiles"),
        (
            name: "ball", shape: Sphere(radius: @radius), material: "clay",
            transform: (translation: @translation, rotation: @rotation, scale: @scale),
        ),
        (name: "crate", @visibility shape: Box(size: @size), transform: (translation: (1.5, 0, 0.5)), material: "tiles"),
        (name: "marble", shape: Sphere(radius: 0.6), transform: (translation: (-1.5, 0, -0.5)), material: "glass"),
        (
            name: "lamp", light: Point(intensity: @intensity, falloff: @falloff),
            transform: (translation: (3, 4, -3)),
        ),
        (name: "sun", light: Directional(intensity: (0.2, 0.2, 0.2), direction: @direction)),
        (
            name: "spot", light: Spot(intensity: (0.6, 0.6, 0.6), angle: @angle, softness: @softness),
            transform: (translation: (0, 5, 0), rotation: Euler(90, 0, 0)),
        ),
        (
            name: "globe", light: Area(intensity: (0.3, 0.3, 0.3), shape: Sphere(radius: @light_radius)),
            transform: (translation: (-3, 4, -2)),
        ),
        (
            name: "panel",
            light: Area(intensity: (0.3, 0.3, 0.3), shape: Rectangle(width: @light_width, height: @light_height)),
            transform: (translation: (2, 4, 1), rotation: Euler(90, 0, 0)),
        ),
    ],
    animate: [@animate],
)"##;

/// Default values of the words.
const PLAIN: [(&str, &str); 40] = [
    ("position", "(0, 1.5, -6)"),
    ("view", "target: (0, 0, 0)"),
    ("up", "(0, 1, 0)"),
    ("roll", "0"),
    ("projection", "fov: 45"),
    ("shutter", ""),
    ("aperture", "0.1"),
    ("focus", "6"),
    ("ambient", "(0.4, 0.4, 0.4)"),
    ("background", "(20, 30, 60)"),
    ("fog", ""),
    ("sky", ""),
    ("ka", "0.4"),
    ("kd", "0.5"),
    ("color", "(250, 120, 60)"),
    ("ambient_color", "(100, 120, 60)"),
    ("ks", "0.4"),
    ("shininess", "20"),
    ("kr", "0.2"),
    ("emission", "(0.1, 0, 0.05)"),
    ("kt", "0.8"),
    ("ior", "1.5"),
    ("absorption", "(0.1, 0.2, 0.3)"),
    ("pattern", "Checker(color: (30, 30, 30), size: 0.4)"),
    ("normal", "(0, 1, 0)"),
    ("radius", "1"),
    ("translation", "(0, 0, 0)"),
    ("rotation", "Euler(0, 0, 0)"),
    ("scale", "(1, 0.8, 1)"),
    ("size", "(1, 1.2, 1)"),
    ("intensity", "(1, 1, 1)"),
    ("falloff", "(1, 0, 0.02)"),
    ("direction", "(1, -1, 1)"),
    ("angle", "40"),
    ("softness", "0.3"),
    ("light_radius", "0.4"),
    ("light_width", "1"),
    ("light_height", "1"),
    ("visibility", ""),
    ("animate", ""),
];

/// The animation target and the notation of a property. `{}` in `written` is the value; the result replaces a word of the scene.
struct Case {
    target: &'static str,
    /// Name of the entity that has the value.
    owner: &'static str,
    word: &'static str,
    written: &'static str,
    values: [&'static str; 2],
}

fn case(property: Property) -> Case {
    let entity = |owner: &'static str, word, values| Case {
        target: match owner {
            "camera" => "target: \"camera\"",
            "scene" => "target: \"scene\"",
            "floor" => "target: \"floor\"",
            "ball" => "target: \"ball\"",
            "crate" => "target: \"crate\"",
            "lamp" => "target: \"lamp\"",
            "sun" => "target: \"sun\"",
            "spot" => "target: \"spot\"",
            "globe" => "target: \"globe\"",
            _ => "target: \"panel\"",
        },
        owner,
        word,
        written: "{}",
        values,
    };
    let material = |name, owner, word, values| Case { target: name, owner, word, written: "{}", values };
    let written = |written, case: Case| Case { written, ..case };
    let (clay, glass, tiles) = ("material: \"clay\"", "material: \"glass\"", "material: \"tiles\"");
    let screen = "screen: (distance: 1, width: 1.6, height: {})";
    match property {
        Property::Translation => entity("ball", "translation", ["(0, 0.5, 0)", "(1, 0, -1)"]),
        Property::Rotation => entity("ball", "rotation", ["Euler(20, 0, 30)", "AxisAngle((1, 1, 0), 70)"]),
        Property::Scale => entity("ball", "scale", ["0.7", "(1, 2, 0.5)"]),
        Property::Radius => entity("ball", "radius", ["0.5", "1.5"]),
        Property::Size => entity("crate", "size", ["(1, 1, 1)", "(2, 0.5, 1.5)"]),
        Property::Normal => entity("floor", "normal", ["(0, 1, -0.2)", "(0.3, 1, 0)"]),
        Property::Visible => written("visible: {},", entity("crate", "visibility", ["true", "false"])),
        Property::CastsShadow => {
            written("casts_shadow: {},", entity("crate", "visibility", ["true", "false"]))
        }
        Property::InReflections => {
            written("in_reflections: {},", entity("crate", "visibility", ["true", "false"]))
        }
        Property::Ka => material(clay, "ball", "ka", ["0.1", "0.9"]),
        Property::Kd => material(clay, "ball", "kd", ["0.1", "0.9"]),
        Property::Color => material(clay, "ball", "color", ["(10, 20, 200)", "\"#ffee00\""]),
        Property::AmbientColor => entity("ball", "ambient_color", ["(10, 20, 200)", "\"#ffee00\""]),
        Property::Ks => material(clay, "ball", "ks", ["0.1", "0.9"]),
        Property::Shininess => entity("ball", "shininess", ["5", "300"]),
        Property::Kr => material(clay, "ball", "kr", ["0", "0.9"]),
        Property::Kt => material(glass, "marble", "kt", ["0.3", "0.95"]),
        Property::Ior => material(glass, "marble", "ior", ["1.1", "2"]),
        Property::Absorption => material(glass, "marble", "absorption", ["(0, 0, 0)", "(2, 1, 0)"]),
        Property::PatternColor => written(
            "Checker(color: {}, size: 0.4)",
            material(tiles, "floor", "pattern", ["(255, 0, 0)", "(0, 0, 255)"]),
        ),
        Property::PatternSize => written(
            "Checker(color: (30, 30, 30), size: {})",
            material(tiles, "crate", "pattern", ["0.3", "0.9"]),
        ),
        Property::PatternDirection => written(
            "Stripes(color: (30, 30, 30), size: 0.4, direction: {})",
            material(tiles, "floor", "pattern", ["(1, 0, 1)", "(0, 1, 1)"]),
        ),
        Property::PatternOffset => written(
            "Stripes(color: (30, 30, 30), size: 0.4, offset: {})",
            material(tiles, "floor", "pattern", ["0.1", "-0.25"]),
        ),
        Property::StripeRatio => written(
            "Stripes(color: (30, 30, 30), size: 0.4, ratio: {})",
            material(tiles, "crate", "pattern", ["0.25", "0.9"]),
        ),
        Property::BrickSize => written(
            "Bricks(color: (30, 30, 30), size: {}, mortar: 0.1)",
            material(tiles, "floor", "pattern", ["(0.5, 0.3, 0.4)", "(1, 1, 1)"]),
        ),
        Property::Mortar => written(
            "Bricks(color: (30, 30, 30), size: (0.5, 0.3, 0.4), mortar: {})",
            material(tiles, "floor", "pattern", ["0", "0.2"]),
        ),
        Property::NoiseContrast => written(
            "Noise(color: (30, 30, 30), size: 0.4, contrast: {})",
            material(tiles, "floor", "pattern", ["0", "5"]),
        ),
        Property::Emission => material(clay, "ball", "emission", ["(0, 0.2, 0)", "(0.5, 0.4, 0.3)"]),
        Property::Intensity => entity("lamp", "intensity", ["(0.2, 0.3, 0.4)", "(1.5, 1, 1)"]),
        Property::Direction => entity("sun", "direction", ["(1, -1, 0)", "(-1, -2, 1)"]),
        Property::Angle => entity("spot", "angle", ["20", "50"]),
        Property::Softness => entity("spot", "softness", ["0", "1"]),
        Property::Falloff => entity("lamp", "falloff", ["(1, 0, 0)", "(1, 0.2, 0.1)"]),
        Property::LightRadius => entity("globe", "light_radius", ["0.1", "1.5"]),
        Property::LightWidth => entity("panel", "light_width", ["0.1", "2"]),
        Property::LightHeight => entity("panel", "light_height", ["0.1", "2"]),
        Property::Position => entity("camera", "position", ["(0, 1, -6)", "(2, 3, -5)"]),
        Property::Target => written("target: {}", entity("camera", "view", ["(0, 0.5, 0)", "(1, -0.5, 0)"])),
        Property::View => written("view: {}", entity("camera", "view", ["(0, -0.2, 1)", "(0.2, -0.3, 1)"])),
        Property::Up => entity("camera", "up", ["(0.1, 1, 0)", "(-0.5, 1, 0)"]),
        Property::Roll => entity("camera", "roll", ["10", "-100"]),
        Property::Fov => written("fov: {}", entity("camera", "projection", ["30", "60"])),
        Property::Orthographic => written("orthographic: {}", entity("camera", "projection", ["4", "6"])),
        Property::HorizontalFov => {
            written("horizontal_fov: {}", entity("camera", "projection", ["40", "80"]))
        }
        Property::ScreenDistance => {
            let written_so = "screen: (distance: {}, width: 1.6, height: 1)";
            written(written_so, entity("camera", "projection", ["1", "1.5"]))
        }
        Property::ScreenWidth => {
            let written_so = "screen: (distance: 1, width: {}, height: 1)";
            written(written_so, entity("camera", "projection", ["1.6", "1"]))
        }
        Property::ScreenHeight => written(screen, entity("camera", "projection", ["1", "1.5"])),
        Property::Aperture => entity("camera", "aperture", ["0", "0.5"]),
        Property::Focus => entity("camera", "focus", ["2", "9"]),
        Property::Ambient => entity("scene", "ambient", ["(0, 0.1, 0.2)", "(0.9, 0.9, 0.5)"]),
        Property::Background => entity("scene", "background", ["(200, 0, 0)", "\"#0000ff\""]),
        Property::BackgroundBottom => {
            let sky = "(bottom: {}, top: (10, 20, 90))";
            written(sky, entity("scene", "background", ["(200, 0, 0)", "\"#0000ff\""]))
        }
        Property::BackgroundHorizon => {
            let sky = "(bottom: (90, 90, 90), horizon: {}, top: (10, 20, 90))";
            written(sky, entity("scene", "background", ["(200, 0, 0)", "\"#0000ff\""]))
        }
        Property::BackgroundTop => {
            let sky = "(bottom: (90, 90, 90), top: {})";
            written(sky, entity("scene", "background", ["(200, 0, 0)", "\"#0000ff\""]))
        }
        Property::SunDirection => {
            let sun = "sun: (direction: {}, intensity: (9, 9, 9), size: 20, glow: 0.1),";
            written(sun, entity("scene", "sky", ["(0, 0.1, 1)", "(-0.4, 0.3, 1)"]))
        }
        Property::SunIntensity => {
            let sun = "sun: (direction: (0.2, 0.1, 1), intensity: {}, size: 20),";
            written(sun, entity("scene", "sky", ["(0.1, 0.2, 0.3)", "(1, 1.5, 0.5)"]))
        }
        Property::SunSize => {
            let sun = "sun: (direction: (0.2, 0.1, 1), intensity: (1, 1, 1), size: {}),";
            written(sun, entity("scene", "sky", ["5", "40"]))
        }
        Property::SunGlow => {
            let sun = "sun: (direction: (0.2, 0.1, 1), intensity: (1, 1, 1), glow: {}),";
            written(sun, entity("scene", "sky", ["0.1", "1"]))
        }
        Property::SunGlowSize => {
            let sun = "sun: (direction: (0.2, 0.1, 1), intensity: (1, 1, 1), glow: 0.5, glow_size: {}),";
            written(sun, entity("scene", "sky", ["5", "30"]))
        }
        Property::StarsIntensity => {
            let stars = "stars: (count: 900, size: 3, intensity: {}),";
            written(stars, entity("scene", "sky", ["(0.1, 0.2, 0.3)", "(1, 1.5, 0.5)"]))
        }
        Property::StarsSize => written("stars: (count: 900, size: {}),", entity("scene", "sky", ["1", "4"])),
        Property::FogColor => {
            let fog = "fog: (color: {}, density: 0.1),";
            written(fog, entity("scene", "fog", ["(200, 0, 0)", "\"#0000ff\""]))
        }
        Property::FogDensity => {
            let fog = "fog: (color: (90, 90, 90), density: {}),";
            written(fog, entity("scene", "fog", ["0.01", "0.2"]))
        }
        Property::FogHeight => {
            let fog = "fog: (color: (90, 90, 90), density: 0.1, height: {}),";
            written(fog, entity("scene", "fog", ["0.5", "4"]))
        }
        Property::FogLevel => {
            let fog = "fog: (color: (90, 90, 90), density: 0.1, height: 2, level: {}),";
            written(fog, entity("scene", "fog", ["-1", "3"]))
        }
    }
}

fn scene(words: &[(&str, String)]) -> String {
    // Longer words come first, because a word may begin with another.
    let mut plain: Vec<_> = PLAIN.iter().collect();
    plain.sort_by_key(|(word, _)| std::cmp::Reverse(word.len()));
    plain.iter().fold(SCENE.to_owned(), |text, (word, default)| {
        let value = words.iter().find(|(name, _)| name == word).map_or(*default, |(_, value)| value);
        text.replace(&format!("@{word}"), value)
    })
}

fn engine(words: &[(&str, String)]) -> Engine {
    let text = scene(words);
    match Scene::from_text("case.ron", text) {
        Ok(scene) => Engine::from_scene(scene),
        Err(error) => panic!("{error}"),
    }
}

fn seconds(seconds: u64) -> Time {
    Time::from_ratio(seconds, 1).unwrap()
}

/// Returns a scene with the last value written, and with keys from the first to the last in two seconds.
fn moving(property: Property, case: &Case, shutter: &str) -> Engine {
    let [first, last] = case.values;
    let keys = format!("Keys([(0, {first}), (2, {last})])");
    let animation = format!("({}, channel: {}, track: {keys})", case.target, property.name());
    let written = (case.word, case.written.replace("{}", last));
    engine(&[written, ("animate", animation), ("shutter", shutter.to_owned())])
}

#[test]
fn every_channel_animates_the_world_and_the_picture() {
    for property in Property::ALL {
        let name = property.name();
        let case = case(property);
        let mut moving = moving(property, &case, "");
        let owner = named(&moving, case.owner);
        let mut shown = Vec::new();
        // Going back updates only changed values.
        for time in [0, 2, 0, 1] {
            let film = moving.render(seconds(time)).unwrap().film;
            let value = value(moving.world(), owner, property).unwrap();
            assert_eq!(value.kind(), property.kind(), "{name}");
            shown.push((film, value));
        }
        assert_ne!(shown[0].1, shown[1].1, "{name}: the value");
        assert!(shown[0].0 != shown[1].0, "{name}: the picture");
        if property.notation() == Notation::Flag {
            assert!(shown[3] == shown[0], "{name}: it holds until the next key");
        } else {
            assert!(shown[3].0 != shown[0].0 && shown[3].0 != shown[1].0, "{name}: the picture half-way");
        }
        assert!(shown[0] == shown[2], "{name}: there and back");
        for (index, text) in case.values.into_iter().enumerate() {
            let mut still = engine(&[(case.word, case.written.replace("{}", text))]);
            let film = still.render(seconds(0)).unwrap().film;
            assert!(film == shown[index].0, "{name} of {text} is not what is written");
            assert_eq!(
                value(still.world(), named(&still, case.owner), property),
                Some(shown[index].1),
                "{name}"
            );
        }
    }
}

/// Checks that values that move while the shutter is open cause motion blur, and that motion blur is disabled if nothing moves.
#[test]
fn every_channel_animates_during_the_shutter() {
    for property in Property::ALL {
        let case = case(property);
        let mut moving = moving(property, &case, "shutter: 0.5,");
        let mut verdict = |time| {
            let plan = moving.plan(time).unwrap().plan.clone().unwrap();
            plan.need(Effect::MotionBlur)
        };
        let changing = if property.notation() == Notation::Flag { 2 } else { 1 };
        assert!(verdict(seconds(changing)).is_needed(), "{}", property.name());
        let still = Need::Omitted("nothing moves while the shutter is open");
        assert_eq!(verdict(Time::from_ratio(5, 2).unwrap()), still, "{}", property.name());
    }
}

/// Checks values of tracks and of scripts, read by a script at another moment and at the same one.
#[test]
fn every_channel_is_read_at_other_moments() {
    for property in Property::ALL {
        let (case, name) = (case(property), property.name());
        let [first, last] = case.values;
        let written = (case.word, case.written.replace("{}", last));
        let (parts, script) = match property.notation() {
            Notation::Number | Notation::Degrees => ("[v, 0, 0]", "base * (1 - t / 16)"),
            Notation::Rotation => ("[v[0], v[1], v[2]]", "[0, 30 * t, 0]"),
            Notation::Flag => ("if v { [1, 0, 0] } else { [0, 0, 0] }", "t < 0.5"),
            _ => ("[v[0], v[1], v[2]]", "base * (1 - t / 16)"),
        };
        // Flags hold until the next key.
        let end = if property.notation() == Notation::Flag { 1 } else { 2 };
        for track in [format!("Keys([(0, {first}), ({end}, {last})])"), format!("Script(\"{script}\")")] {
            let read = |moment: &str, at| {
                let script = format!("let v = value(`{}`, `{name}`{moment}); {parts}", case.owner);
                let animate = format!(
                    "({}, channel: {name}, track: {track}), (target: \"marble\", channel: Translation, track: Script(\"{script}\"))",
                    case.target
                );
                let mut engine = engine(&[written.clone(), ("animate", animate)]);
                engine.seek(seconds(at)).unwrap();
                value(engine.world(), named(&engine, "marble"), Property::Translation).unwrap()
            };
            let now = read("", 1);
            assert_eq!(read(", t - 1", 2), now, "{name}: {track}");
            assert_eq!(read(", 1", 5), now, "{name}: {track}");
            assert_ne!(read("", 0), now, "{name}: {track}");
        }
    }
}

fn half_way(transfer: Transfer, keys: &str) -> Value {
    let animation = format!("(target: \"ball\", channel: Color, track: Keys([{keys}]))");
    let text = scene(&[("animate", animation)]);
    let film = format!("film: (transfer: {transfer:?}, ");
    let mut engine =
        Engine::from_scene(Scene::from_text("half.ron", text.replace("film: (", &film)).unwrap());
    engine.seek(seconds(1)).unwrap();
    value(engine.world(), named(&engine, "ball"), Property::Color).unwrap()
}

#[test]
fn colours_blend_as_light() {
    let keys = "(0, (0, 0, 0)), (2, (255, 188, 0))";
    let light = Transfer::Srgb.decode([255.0, 188.0, 0.0]);
    assert_eq!(half_way(Transfer::Srgb, keys), Value::Color(light * 0.5));
    let Value::Color(classic) = half_way(Transfer::Classic, keys) else { panic!() };
    assert!((classic - Rgb::new(0.5, 94.0 / 255.0, 0.0)).length() < 1e-7);
}

/// Checks tracks that would leave their range: `OutBack` overshoots an end near the bound.
#[test]
fn swinging_curves_stay_in_range() {
    for (property, target, word, written, keys, lowest) in [
        (Property::Radius, "ball", "", "", ["1", "0.01"], 1e-60),
        (Property::PatternSize, "floor", "", "", ["1", "0.01"], 1e-60),
        (Property::Angle, "spot", "", "", ["90", "1"], 1e-60),
        (Property::LightRadius, "globe", "", "", ["1", "0.01"], 1e-60),
        (Property::Fov, "camera", "", "", ["90", "1"], 1e-60),
        (Property::HorizontalFov, "camera", "projection", "horizontal_fov: 90", ["90", "1"], 1e-60),
        (
            Property::ScreenDistance,
            "camera",
            "projection",
            "screen: (distance: 1, height: 1)",
            ["1", "0.01"],
            1e-60,
        ),
        (Property::Aperture, "camera", "", "", ["1", "0"], 0.0),
        (Property::FogDensity, "scene", "fog", "fog: (color: (0, 0, 0), density: 1),", ["1", "0"], 0.0),
        (Property::Ka, "ball", "", "", ["1", "0"], 0.0),
    ] {
        let [from, to] = keys;
        let name = property.name();
        let keys = format!("Keys([(0, {from}, OutBack), (2, {to})])");
        let animation = format!("(target: \"{target}\", channel: {name}, track: {keys})");
        let mut engine = engine(&[("animate", animation), (word, written.to_owned())]);
        engine.seek(seconds(1)).unwrap();
        let found = value(engine.world(), named(&engine, target), property);
        assert_eq!(found, Some(Value::Number(lowest)), "{name}");
        engine.render(seconds(1)).unwrap();
    }
}

#[test]
fn handles_have_the_units_of_their_values() {
    let at_one = |target: &str, channel: &str, keys: &str| {
        let animation = format!("(target: \"{target}\", channel: {channel}, track: Keys([{keys}]))");
        let mut engine = engine(&[("animate", animation)]);
        engine.seek(seconds(1)).unwrap();
        let property = Property::ALL.into_iter().find(|property| property.name() == channel).unwrap();
        value(engine.world(), named(&engine, target), property).unwrap()
    };
    // Half-way, 3/8 of each handle is added to the mean of the keys.
    let radius = at_one("ball", "Radius", "(0, 1, Handles(2, 4)), (2, 2)");
    assert_eq!(radius, Value::Number(1.5 + 0.375 * 6.0));
    let place =
        at_one("ball", "Translation", "(0, (0, 0, 0), Handles((1, 0, 0), (-3, 8, 0))), (2, (2, 0, 0))");
    assert_eq!(place, Value::Vector(DVec3::new(1.0 - 0.75, 3.0, 0.0)));
    let Value::Number(roll) = at_one("camera", "Roll", "(0, 0, Handles(80, 0)), (2, 60)") else { panic!() };
    assert!((roll.to_degrees() - 60.0).abs() < 1e-12);
    let color =
        at_one("ball", "Color", "(0, (0, 0, 0), Handles((0, 0, 0), (0, -255, 0))), (2, (0, 255, 255))");
    let Value::Color(color) = color else { panic!() };
    assert!((color - Rgb::new(0.0, 0.125, 0.5)).length() < 1e-6);
}

/// Checks rotations by more than half a turn against the rotation that they reach.
#[test]
fn turns_rotate_the_whole_angle() {
    let film = |rotation: &str, track: &str| {
        let animation = format!("(target: \"ball\", channel: Rotation, track: {track})");
        let animate = if track.is_empty() { String::new() } else { animation };
        let mut engine = engine(&[("rotation", rotation.to_owned()), ("animate", animate)]);
        engine.render(seconds(1)).unwrap().film
    };
    let turned = |track| film("Euler(0, 0, 0)", track);
    for (track, angle) in [
        ("Turns(axis: (1, 2, 0), turns: 1.5, duration: 2)", 270),
        ("Turns(axis: (1, 2, 0), turns: -5, from: 30, duration: 2)", -150),
        ("Turns(axis: (1, 2, 0), turns: 9, from: 30, duration: 1)", 30),
    ] {
        assert!(turned(track) == film(&format!("AxisAngle((1, 2, 0), {angle})"), ""), "{track}");
        assert!(turned(track) != film("Euler(0, 0, 0)", ""));
    }
}

/// Returns true if a track is accepted, by the reader and at the first frame.
fn is_taken(property: Property, case: &Case, track: &str) -> bool {
    let animation = format!("({}, channel: {}, track: {track})", case.target, property.name());
    let written = (case.word, case.written.replace("{}", case.values[0]));
    let scene = Scene::from_text("case.ron", scene(&[written, ("animate", animation)]));
    scene.is_ok_and(|scene| Engine::from_scene(scene).seek(seconds(0)).is_ok())
}

/// Returns true for light, colours and coefficients, which are clamped to their ranges instead.
fn is_held(property: Property) -> bool {
    use Property::{Ka, Kd, Kr, Ks, Kt, Shininess, Softness, StripeRatio, SunGlow};
    matches!(property.notation(), Notation::Light | Notation::Color)
        || matches!(property, Ka | Kd | Ks | Kr | Kt | Shininess | Softness | StripeRatio | SunGlow)
}

#[test]
fn script_values_have_the_limits_of_keys() {
    let numbers = [
        "-1", "0", "1e-70", "1e-59", "0.001", "0.5", "1", "100", "179.9", "180", "180.1", "1001", "1e60",
        "1e61",
    ];
    let is_of_numbers =
        |property: &Property| !matches!(property.notation(), Notation::Rotation | Notation::Flag);
    for property in Property::ALL.into_iter().filter(is_of_numbers) {
        let case = case(property);
        let (mut taken, mut refused) = (0, 0);
        for number in numbers {
            let values = match property.notation() {
                Notation::Number | Notation::Degrees => vec![number.to_owned()],
                Notation::Scale => vec![number.to_owned(), format!("(1, {number}, 1)")],
                _ => vec![
                    format!("({number}, {number}, {number})"),
                    format!("({number}, 0, 0)"),
                    format!("(1, {number}, 1)"),
                ],
            };
            for value in values {
                let script = value.replace('(', "[").replace(')', "]");
                let by_script = is_taken(property, &case, &format!("Script(\"{script}\")"));
                let by_keys = is_taken(property, &case, &format!("Keys([(0, {value})])"));
                let is_huge = number == "1e61" && property.notation() != Notation::Color;
                let expected = if is_held(property) { !is_huge } else { by_keys };
                assert_eq!(by_script, expected, "{} of {script}", property.name());
                *(if by_script { &mut taken } else { &mut refused }) += 1;
            }
        }
        assert!(taken > 0, "{}", property.name());
        assert!(refused > 0 || property.notation() == Notation::Color, "{}", property.name());
    }
}
