//! Tests of left-handed and right-handed spaces.

use glam::DVec3;

use rayreel::{Engine, Film, Scene, Time};

/// The scene, in which `@` stands before the z of positions and directions, `#` before angles about x and y, and `$` before the own z of
/// entities and their size along z. Numbers after them have parentheses to be negated.
const SCENE: &str = r##"Scene(
    space: &, timeline: (fps: 10, duration: 2),
    film: (width: 40, height: 30), sampling: (samples: 4, instants: 4), quality: (cutoff: 0),
    camera: (position: (1, 2, @6), target: (0.2, 0, @0.5), roll: 25, up: (0.1, 1, @0.2), ?),
    ambient: (0.2, 0.3, 0.4), background: (bottom: (90, 80, 70), top: (20, 30, 90)),
    fog: (color: (100, 90, 80), density: 0.02),
    materials: {
        "clay": (k_a: 0.4, k_d: 0.5, color: (250, 120, 60), specular: (k_s: 0.4, shininess: 20)),
        "mirror": (k_d: 0.2, reflective: (k_r: 0.7)),
        "glass": (k_d: 0.1, refractive: (k_t: 0.8, ior: 1.5, absorption: (0.1, 0.2, 0.3), fresnel: true)),
    },
    entities: [
        (shape: Plane(normal: (0.1, 1, @0.2)), material: "clay", transform: (translation: (0, -1, @1))),
        (name: "ball", shape: Sphere(radius: 1), material: "mirror", transform: (translation: (-0.5, 0.3, @-0.7), scale: (1, 0.7, 1.2), rotation: Euler(#30, #20, 10))),
        (name: "arm", transform: (translation: (1, 0, @0.3), rotation: AxisAngle((#1, #2, 3), 40), scale: (1, 2, 1))),
        (shape: Box(size: (0.8, 0.5, 0.7)), material: "glass", parent: "arm", transform: (translation: (0.4, 0.1, @1.1), rotation: Quat(#0.1, #0.2, 0.3, 0.9))),
        (shape: Box(size: (0.3, 3, 0.3)), material: "clay", transform: (translation: (-2, 0, @-1))),
        (shape: Cylinder(radius: 0.3, from: (1, 1, @0.5), to: (1.6, 2, @-0.4)), material: "clay"),
        (shape: Capsule(radius: 0.2, from: (0, 0, @0.3), to: (0.3, 0.6, @0)), material: "glass", parent: "arm"),
        (light: Point(intensity: (0.8, 0.7, 0.6)), transform: (translation: (3, 4, @3))),
        (light: Directional(intensity: (0.2, 0.2, 0.3), direction: (0.3, -1, @0.4))),
        (light: Spot(intensity: (0.9, 0.6, 0.9), angle: 40), transform: (translation: (-3, 3, @2)), look_at: "ball"),
        (light: Area(shape: Rectangle(width: 1, height: 0.5), intensity: (0.4, 0.5, 0.3), samples: 4), parent: "arm", transform: (translation: (0, 3, @0.2), rotation: Euler(#80, #10, 0))),
    ],
    animate: [
        (target: "ball", channel: Translation, track: Keys([(0, (-0.5, 0.3, @-0.7)), (2, (0, 0, @1), EaseInOut)])),
        (target: "arm", channel: Rotation, track: Keys([(0, Euler(#10, #20, 30)), (2, Euler(#40, #50, 60))])),
    ],
)"##;

/// Returns the scene in a space, with another part of the camera.
fn scene(is_right_handed: bool, camera: &str) -> String {
    let (space, sign) = if is_right_handed { ("RightHanded", "-") } else { ("LeftHanded", "") };
    let text = SCENE.replace('&', space).replace('?', camera);
    text.replace(['@', '#'], sign).replace("--", "")
}

fn engine(text: String) -> Engine {
    Engine::from_scene(Scene::from_text("space.ron", text).unwrap_or_else(|error| panic!("{error}")))
}

/// Checks that a scene with mirrored coordinates shows the same picture in the other space, to the last bit.
#[test]
fn mirrored_scenes_have_the_same_bits_in_the_other_space() {
    for camera in
        ["fov: 50", "orthographic: 5", "horizontal_fov: 70, lens: (aperture: 0.3, focus: 5), shutter: 0.5"]
    {
        let [mut left, mut right] = [false, true].map(|right| engine(scene(right, camera)));
        let mut unconverted = engine(scene(false, camera).replace("LeftHanded", "RightHanded"));
        for tenths in [0, 7, 19] {
            let time = Time::from_ratio(tenths, 10).unwrap();
            let expected = left.render(time).unwrap().film;
            assert!(right.render(time).unwrap().film == expected, "{camera}, {tenths}");
            assert!(unconverted.render(time).unwrap().film != expected, "{camera}, {tenths}");
        }
    }
}

fn mirrored(film: &Film, i: u32, j: u32) -> rayreel::Rgb {
    film.pixel(film.width() - 1 - i, j)
}

/// Checks that the same numbers show the mirror image.
#[test]
fn the_same_numbers_show_the_mirror_image() {
    let film = |space: &str| {
        let text = format!(
            "(space: {space}, film: (width: 8, height: 6), camera: (position: (0, 0, -3), view: (0, 0, 1), fov: 60),
            ambient: (1, 1, 1), materials: {{ \"m\": (k_a: 1) }},
            entities: [(shape: Sphere(radius: 0.5), material: \"m\", transform: (translation: (1, 0.5, 0)))])"
        );
        engine(text).render_frame(0).unwrap()
    };
    let (left, right) = (film("LeftHanded"), film("RightHanded"));
    assert!(left != right);
    for (i, j) in (0..8).flat_map(|i| (0..6).map(move |j| (i, j))) {
        assert_eq!(left.pixel(i, j), mirrored(&right, i, j));
    }
}

#[test]
fn right_is_view_cross_up_and_roll_tilts_to_the_left() {
    let axes = |space: &str, roll: f64| {
        let text = format!("(space: {space}, camera: (position: (0, 0, 5), view: (0, 0, -1), roll: {roll}))");
        let mut engine = engine(text);
        engine.seek(Time::ZERO).unwrap();
        engine.prepared().unwrap().camera().axes()
    };
    assert_eq!(axes("RightHanded", 0.0), [DVec3::X, DVec3::Y, DVec3::NEG_Z]);
    assert_eq!(axes("LeftHanded", 0.0), [DVec3::NEG_X, DVec3::Y, DVec3::NEG_Z]);
    for space in ["RightHanded", "LeftHanded"] {
        let [[right, ..], [_, up, ahead]] = [axes(space, 0.0), axes(space, 90.0)];
        assert!(up.distance(-right) < 1e-15 && ahead.distance(DVec3::NEG_Z) < 1e-15, "{space}");
    }
}

#[test]
fn parts_of_another_space_are_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let check = |scene: &str, part: &str| {
        let camera =
            "camera: (position: (0, 0, 5), target: (0, 0, 0)), include: [(file: \"part.ron\", name: \"a\")]";
        std::fs::write(folder.path().join("scene.ron"), format!("({scene} {camera})")).unwrap();
        std::fs::write(folder.path().join("part.ron"), format!("({part} entities: [])")).unwrap();
        Scene::load(&folder.path().join("scene.ron")).map(|_| ()).map_err(|error| error.to_string())
    };
    let (left, right) = ("space: LeftHanded,", "space: RightHanded,");
    for (scene, part) in [("", ""), (right, ""), (right, right), (left, left), ("", left)] {
        assert_eq!(check(scene, part), Ok(()));
    }
    for (scene, part) in [("", right), (left, right), (right, left)] {
        let error = check(scene, part).unwrap_err();
        assert!(error.contains("would be mirrored") && error.contains("part.ron:1:9"), "{error}");
    }
}
