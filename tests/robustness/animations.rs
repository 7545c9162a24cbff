//! Values over time, often extreme or degenerate.

use proptest::prelude::*;

use super::entities::falloff;
use super::values::{
    absorption, coefficient, color, intensity, ior, number, point, rotation, scale, shininess, size,
};

fn easing() -> impl Strategy<Value = &'static str> {
    prop::sample::select(vec![
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
    ])
}

fn keys(value: impl Strategy<Value = String>) -> impl Strategy<Value = String> {
    let gap =
        prop_oneof![6 => 0.1..1.0f64, 1 => prop::sample::select(vec![5e-324, 1e-300, 1e-16, 1e-9, 1e9])];
    prop::collection::vec((gap, value, easing()), 1..5).prop_map(|keys| {
        let mut time = -0.5;
        let mut text = String::new();
        for (gap, value, easing) in keys {
            time += gap;
            text += &format!("({time:?}, {value}, {easing}), ");
        }
        format!("Keys([{text}])")
    })
}

/// Generates tracks of positions.
fn way() -> impl Strategy<Value = String> {
    let path = (prop::collection::vec(point(), 1..6), any::<bool>(), number(), size(), easing()).prop_map(
        |(points, closed, start, duration, ease)| {
            let points = points.join(", ");
            format!("Path(points: [{points}], closed: {closed}, start: {start:?}, duration: {duration}, ease: {ease})")
        },
    );
    let orbit = (point(), size(), point(), (number(), number(), number()), size()).prop_map(
        |(center, radius, axis, (height, from, turns), duration)| {
            format!("Orbit(center: {center}, radius: {radius}, axis: {axis}, height: {height:?}, from: {from:?}, turns: {turns:?}, duration: {duration})")
        },
    );
    prop_oneof![2 => keys(point()), 1 => path, 1 => orbit]
}

fn turns() -> impl Strategy<Value = String> {
    (point(), number(), number(), size()).prop_map(|(axis, turns, from, duration)| {
        format!("Turns(axis: {axis}, turns: {turns:?}, from: {from:?}, duration: {duration})")
    })
}

/// Generates scripts whose value is a number.
fn number_script() -> impl Strategy<Value = String> {
    script(vec![
        "abs(sin(t)) + 0.1",
        "base",
        "random(index)",
        "0.5 + noise(7 * t, index)",
        "1 / (t - 0.4)",
        "value('e0', 'Radius')",
        "value('e1', 'Kd') * 2",
        "exp(300 * t)",
        "-1",
        "(t - 1) * 1e60",
        "let s = 0; for i in 0..1000 { s += 1 / (i + 1) } s",
        "if frame % 2 == 0 { 1e-60 } else { 1e60 }",
        "fn f(x) { if x < 1 { 1 } else { x * f(x - 1) } } f(floor(t * 10))",
        "duration / fps + len(name)",
    ])
}

/// Generates scripts whose value is three numbers.
fn triple_script() -> impl Strategy<Value = String> {
    script(vec![
        "[t, sin(t), noise(t)]",
        "base * t",
        "base / length(base)",
        "value('e0', 'Translation') + 1",
        "value('e1', 'Translation') * value('e2', 'Scale')",
        "[0, 0, 0]",
        "[1e60, -1e60, 0] * t",
        "normalize(cross([1, t, 0], [0, 1, t]))",
        "let l = []; for i in 0..3 { l.push(hypot(i, t)) } l",
        "[random(frame), random(frame, 1), mod(-t, 0.3)]",
        "mix(base, [1, 2, 3], smoothstep(0, 1, t))",
    ])
}

fn script(scripts: Vec<&'static str>) -> impl Strategy<Value = String> {
    let script = prop::sample::select(scripts);
    script.prop_map(|script| format!("Script(r#\"{}\"#)", script.replace('\'', "\"")))
}

/// Generates scripts that spawn entities.
pub(crate) fn spawning() -> impl Strategy<Value = String> {
    script(vec![
        "for i in 0..30 { spawn(#{ shape: sphere(0.1 + 0.2 * random(i)), material: 'm0', translation: [i / 5 - 3, noise(i), 0] }) }",
        "for i in 0..9 { spawn(#{ name: `s${i}`, parent: if i > 0 { `s${i - 1}` } else { 'e0' }, scale: 0.5, rotation: [0, 90 * i, 0] }) }",
        "spawn(#{ light: point(#{ intensity: [1, 1, 1] * random(1), falloff: [1, 0, 1e30] }), translation: [0, 9, 0] })",
        "for i in 0..3 { spawn(#{ shape: box([1, 10 ** -i, 10 ** i]), material: `m${i}`, translation: [1e30 * i, 0, 0] }) }",
        "spawn(#{ shape: plane([0, random(0) - 0.5, 0]), material: 'm1' })",
    ])
}

fn tracks(
    value: impl Strategy<Value = String> + 'static,
    script: impl Strategy<Value = String> + 'static,
) -> BoxedStrategy<String> {
    prop_oneof![3 => keys(value), 1 => script].boxed()
}

fn numbers(value: impl Strategy<Value = String> + 'static) -> BoxedStrategy<String> {
    tracks(value, number_script())
}

fn triples(value: impl Strategy<Value = String> + 'static) -> BoxedStrategy<String> {
    tracks(value, triple_script())
}

fn flags() -> BoxedStrategy<String> {
    let times = prop::collection::btree_set(0..40_u32, 1..4);
    let keys = (times, any::<bool>()).prop_map(|(times, first)| {
        let key = |(time, number): (u32, usize)| format!("({time}e-1, {})", (number % 2 == 0) == first);
        format!("Keys([{}])", times.into_iter().zip(0..).map(key).collect::<Vec<_>>().join(", "))
    });
    prop_oneof![3 => keys, 1 => script(vec!["base", "t < 1.5", "index % 2 == 0"])].boxed()
}

/// Returns the channels of entities, of materials, of cameras and of the scene, with generators of their tracks.
fn channels() -> [Vec<(&'static str, BoxedStrategy<String>)>; 4] {
    let any = || number().prop_map(|number| format!("{number:?}"));
    let angle = || prop_oneof![0.001..180.0f64, number()].prop_map(|angle| format!("{angle:?}"));
    let sizes = || (size(), size(), size()).prop_map(|(x, y, z)| format!("({x}, {y}, {z})"));
    let surface = || {
        vec![
            ("Ka", numbers(coefficient())),
            ("Kd", numbers(coefficient())),
            ("Ks", numbers(coefficient())),
            ("Kr", numbers(coefficient())),
            ("Kt", numbers(coefficient())),
            ("Shininess", numbers(shininess())),
            ("Ior", numbers(ior())),
            ("Absorption", triples(absorption())),
            ("Color", triples(color())),
            ("AmbientColor", triples(color())),
            ("PatternColor", triples(color())),
            ("PatternSize", numbers(size())),
            ("PatternDirection", triples(point())),
            ("PatternOffset", numbers(any())),
            ("StripeRatio", numbers(coefficient())),
            ("BrickSize", triples((size(), size(), size()).prop_map(|(x, y, z)| format!("({x}, {y}, {z})")))),
            ("Mortar", numbers(size())),
            ("NoiseContrast", numbers(size())),
            ("Emission", triples(intensity())),
        ]
    };
    let place = || prop_oneof![3 => way(), 1 => triple_script()].boxed();
    let mut entity = surface();
    // Translations, rotations and scales are the most frequent.
    for _ in 0..4 {
        entity.extend([
            ("Translation", place()),
            ("Rotation", prop_oneof![3 => triples(rotation()), 1 => turns()].boxed()),
            ("Scale", triples(scale())),
        ]);
    }
    entity.extend([
        ("Radius", numbers(size())),
        ("Size", triples(sizes())),
        ("Normal", triples(point())),
        ("Visible", flags()),
        ("CastsShadow", flags()),
        ("InReflections", flags()),
        ("Intensity", triples(intensity())),
        ("Direction", triples(point())),
        ("Angle", numbers(angle())),
        ("Softness", numbers(coefficient())),
        ("Falloff", triples(falloff().prop_map(|text| text.replace(", falloff: ", "")))),
        ("LightRadius", numbers(size())),
        ("LightWidth", numbers(size())),
        ("LightHeight", numbers(size())),
    ]);
    let camera = vec![
        ("Position", place()),
        ("Target", place()),
        ("View", triples(point())),
        ("Up", triples(point())),
        ("Roll", numbers(any())),
        ("Fov", numbers(angle())),
        ("HorizontalFov", numbers(angle())),
        ("Orthographic", numbers(size())),
        ("ScreenDistance", numbers(size())),
        ("ScreenWidth", numbers(size())),
        ("ScreenHeight", numbers(size())),
        ("Aperture", numbers(size())),
        ("Focus", numbers(size())),
    ];
    let scene = vec![
        ("Ambient", triples(intensity())),
        ("Background", triples(color())),
        ("BackgroundBottom", triples(color())),
        ("BackgroundHorizon", triples(color())),
        ("BackgroundTop", triples(color())),
        ("SunDirection", triples(point())),
        ("SunIntensity", triples(intensity())),
        ("SunSize", numbers(angle())),
        ("SunGlow", numbers(any())),
        ("SunGlowSize", numbers(angle())),
        ("StarsIntensity", triples(intensity())),
        ("StarsSize", numbers(angle())),
        ("FogColor", triples(color())),
        ("FogDensity", numbers(size())),
        ("FogHeight", numbers(size())),
        ("FogLevel", numbers(any())),
    ];
    [entity, surface(), camera, scene]
}

pub(crate) fn animation() -> impl Strategy<Value = String> {
    let targets = ["target: \"e#\"", "material: \"m#\"", "target: \"#\"", "target: \"scene\""];
    let animations = channels().into_iter().zip(targets).map(|(channels, target)| {
        let channels: Vec<_> = channels
            .into_iter()
            .map(|(channel, track)| {
                track.prop_map(move |track| format!("channel: {channel}, track: {track}")).boxed()
            })
            .collect();
        (0..6usize, proptest::strategy::Union::new(channels)).prop_map(move |(index, channel)| {
            let name = match target {
                "target: \"#\"" => ["camera", "c0", "c1"][index % 3].to_owned(),
                _ => index.to_string(),
            };
            let played = match index {
                // Scripts accept no such option.
                _ if channel.contains("track: Script") => "",
                1 => ", repeat: Loop",
                2 => ", repeat: PingPong, speed: -1e60",
                3 => ", repeat: Loop, offset: 0.3, speed: 7",
                _ => "",
            };
            format!("({}, {channel}{played})", target.replace('#', &name))
        })
    });
    proptest::strategy::Union::new_weighted([6, 4, 3, 1].into_iter().zip(animations).collect::<Vec<_>>())
}
