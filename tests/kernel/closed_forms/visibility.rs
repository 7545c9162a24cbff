//! Tests of shapes that only some kinds of rays see.

use glam::DVec3;

use rayreel::components::Visibility;
use rayreel::{Engine, Film, RenderSettings, Rgb, Time};

use super::{assert_near, engine, film, seen};

/// The emission of the ball of [`room`], which no other light reaches by chance.
const LAMP: Rgb = Rgb::new(0.5, 7.0, 3.0);

const NO_SHADOW: &str = "casts_shadow: false";
const UNREFLECTED: &str = "in_reflections: false";
const HIDDEN: &str = "visible: false, casts_shadow: false, in_reflections: false";

/// Returns a scene with a lit floor and a mirror behind, and these entities.
fn room(entities: &str, more: &str) -> String {
    format!(
        r#"film: (width: 48, height: 32), camera: (position: (3.5, 2.4, -6), target: (0, 0.8, 0), fov: 45), {more}
        ambient: (0.2, 0.2, 0.2), background: (90, 120, 200),
        materials: {{
            "clay": (k_a: 1, k_d: 0.7, color: (220, 170, 130)),
            "lamp": (emission: (0.5, 7, 3)),
            "mirror": (reflective: (k_r: 0.9)),
            "glass": (refractive: (k_t: 0.5, ior: 1.5, absorption: (0.3, 0.1, 0.2))),
        }},
        entities: [
            (shape: Plane(normal: (0, 1, 0)), material: "clay"),
            (shape: Box(size: (9, 6, 0.2)), material: "mirror", transform: (translation: (0, 3, 3))),
            (light: Point(intensity: (1, 1, 1)), transform: (translation: (-3, 6, -4))),
            {entities}
        ]"#
    )
}

/// A ball that gives off light, with fields that hide it from some rays.
fn ball(fields: &str) -> String {
    format!(
        r#"(name: "ball", shape: Sphere(radius: 0.8), material: "lamp", transform: (translation: (0, 1, 0)), {fields})"#
    )
}

fn pictured(entities: &str) -> Film {
    film(&room(entities, ""))
}

/// Returns the pixels that show the ball itself.
fn shows_ball() -> Vec<bool> {
    let direct = pictured(&ball(&format!("{NO_SHADOW}, {UNREFLECTED}")));
    direct.pixels().iter().map(|pixel| *pixel == LAMP).collect()
}

#[test]
fn a_ball_without_shadow_and_reflection_leaves_the_other_pixels_alone() {
    let (covered, empty) = (shows_ball(), pictured(""));
    let both = pictured(&ball(&format!("{NO_SHADOW}, {UNREFLECTED}")));
    let (whole, no_shadow) = (pictured(&ball("")), pictured(&ball(NO_SHADOW)));
    assert!(covered.iter().filter(|covered| **covered).count() > 50);
    let (mut shaded, mut mirrored) = (0, 0);
    for (index, covered) in covered.into_iter().enumerate() {
        let at = |film: &Film| film.pixels()[index];
        assert_eq!(at(&both), if covered { LAMP } else { at(&empty) });
        assert_eq!(covered, at(&whole) == LAMP);
        // Only pixels in the mirror show the ball besides.
        mirrored += u32::from(at(&no_shadow) != at(&both));
        shaded += u32::from(at(&whole) != at(&no_shadow));
    }
    assert!(shaded > 20 && mirrored > 20, "{shaded} {mirrored}");
}

/// Compares the shadow of a ball that is not visible with the closed form: the floor is in its shadow where the way to the light passes
/// nearer to its centre than its radius.
#[test]
fn an_invisible_ball_casts_its_shadow() {
    let (center, light, radius) = (DVec3::new(0.0, 1.0, 0.0), DVec3::new(-3.0, 6.0, -4.0), 0.8);
    let mut shaded = engine(&room(&ball(&format!("visible: false, {UNREFLECTED}")), ""));
    let (shadow, empty) = (shaded.render_frame(0).unwrap(), pictured(""));
    let ambient = Rgb::splat(0.2);
    let (mut dark, mut lit) = (0, 0);
    for (index, (found, alone)) in shadow.pixels().iter().zip(empty.pixels()).enumerate() {
        let index = u32::try_from(index).unwrap();
        let tree = shaded.probe(Time::ZERO, (index % 48, index / 48), 0).unwrap().unwrap();
        let rayreel::trace::RayEnd::Surface(hit) = &tree.rays[0].end else {
            assert_eq!(found, alone);
            continue;
        };
        let point = hit.surface.point;
        if point.y.abs() > 1e-9 {
            continue;
        }
        let way = (light - point).normalize();
        let distance = (center - point).reject_from(way).length();
        if distance < radius - 1e-9 {
            // The floor's colour is the same in both terms, which differ by light alone.
            assert_eq!(*found, hit.ambient);
            assert!(found.cmplt(*alone).all() && hit.ambient.x <= ambient.x);
            dark += 1;
        } else if distance > radius + 1e-9 {
            assert_eq!(found, alone);
            lit += 1;
        }
    }
    assert!(dark > 20 && lit > 100, "{dark} {lit}");
}

#[test]
fn a_ball_that_no_ray_sees_is_not_there() {
    let empty = pictured("");
    for shape in ["Sphere(radius: 1)", "Box(size: (2, 2, 2))", "Plane(normal: (0, 1, 0))"] {
        for material in ["clay", "lamp", "mirror", "glass"] {
            let hidden = format!(r#"(shape: {shape}, material: "{material}", {HIDDEN})"#);
            assert!(pictured(&hidden) == empty, "{shape} of {material}");
        }
    }
    let parent = format!(r#"(name: "group", shape: Sphere(radius: 9), material: "clay", {HIDDEN})"#);
    let part = r#"(parent: "group", shape: Sphere(radius: 1), material: "lamp")"#;
    let alone = part.replace(r#"parent: "group", "#, "");
    assert!(pictured(&format!("{parent}, {part}")) == pictured(&alone), "visibility is not inherited");
}

#[test]
fn a_mirror_shows_what_only_reflections_show() {
    let mirror = r#""mirror": (reflective: (k_r: 0.5))"#;
    let lamp =
        r#"(shape: Sphere(radius: 1), material: "lamp", transform: (translation: (0, 0, -5)), FIELDS)"#;
    let ahead = |fields: &str, towards: DVec3| {
        let lamp = lamp.replace("FIELDS", fields);
        let wall =
            r#"(shape: Plane(normal: (0, 0, -1)), material: "mirror", transform: (translation: (0, 0, 2)))"#;
        let body = format!(
            r#"materials: {{ "lamp": (emission: (1, 2, 4)), {mirror} }}, entities: [{wall}, {lamp}], quality: (cutoff: 0)"#
        );
        seen(DVec3::ZERO, towards, &body)
    };
    let light = Rgb::new(1.0, 2.0, 4.0);
    assert_eq!([DVec3::Z, DVec3::NEG_Z].map(|way| ahead("", way)), [light * 0.5, light]);
    assert_eq!([DVec3::Z, DVec3::NEG_Z].map(|way| ahead(UNREFLECTED, way)), [Rgb::ZERO, light]);
    assert_eq!([DVec3::Z, DVec3::NEG_Z].map(|way| ahead("visible: false", way)), [light * 0.5, Rgb::ZERO]);
}

/// Returns the red light of a white floor under light from straight above, seen from above through these entities.
fn lit_from_above(entities: &str) -> f64 {
    let body = format!(
        r#"materials: {{ "white": (k_d: 1, color: (255, 255, 255)),
            "glass": (refractive: (k_t: 0.5, ior: 1.5, absorption: (0.25, 0, 0))) }},
        entities: [(shape: Plane(normal: (0, 1, 0)), material: "white"),
            (light: Directional(intensity: (1, 1, 1), direction: (0, -1, 0))), {entities}], quality: (cutoff: 0)"#
    );
    f64::from(seen(DVec3::new(0.0, 9.0, 0.0), DVec3::NEG_Y, &body).x)
}

/// Checks glass that only shadow rays see: a pane above the floor, and a block on the floor, whose lower face lies in it.
#[test]
fn invisible_glass_tints_its_shadow() {
    let unseen = "visible: false, in_reflections: false";
    let block = |middle: f64| {
        format!(
            r#"(shape: Box(size: (2, 2, 2)), material: "glass", transform: (translation: (0, {middle:?}, 0)), {unseen})"#
        )
    };
    assert_near(lit_from_above(""), 1.0, 0.0);
    assert_near(lit_from_above(&block(4.0)), 0.25 * libm::exp(-0.5), 1e-6);
    assert_near(lit_from_above(&block(1.0)), 0.5 * libm::exp(-0.5), 1e-6);
    // The floor is inside, and its point is lit through the upper half.
    assert_near(lit_from_above(&block(0.0)), 0.5 * libm::exp(-0.25), 1e-6);
    // The upper face lies in the floor.
    assert_near(lit_from_above(&block(-1.0)), 1.0, 0.0);
}

/// Checks a surface that is lit from behind: it weakens its own light only if it casts a shadow.
#[test]
fn light_from_behind_passes_a_surface_without_shadow() {
    let lit = |fields: &str| {
        let body = format!(
            r#"materials: {{ "milk": (k_d: 1, color: (255, 255, 255), refractive: (k_t: 0.5, ior: 1)) }},
            entities: [(shape: Plane(normal: (0, 0, -1)), material: "milk", {fields}),
                (light: Directional(intensity: (1, 1, 1), direction: (0, 0, -1)))], quality: (cutoff: 0)"#
        );
        f64::from(seen(DVec3::new(0.0, 0.0, -3.0), DVec3::Z, &body).x)
    };
    assert_near(lit(""), 0.5, 0.0);
    assert_near(lit(NO_SHADOW), 1.0, 0.0);
}

/// Checks a camera inside glass that it does not see, before a mirror that does.
#[test]
fn invisible_glass_around_the_camera_is_no_medium() {
    let ahead = |fields: &str, material: &str| {
        let body = format!(
            r#"materials: {{ "lamp": (emission: (1, 1, 1)), "mirror": (reflective: (k_r: 1)),
                "glass": (refractive: (k_t: 0.5, ior: 1, absorption: (0.25, 0.25, 0.25))) }},
            entities: [(shape: Sphere(radius: 5), material: "glass", {fields}),
                (shape: Plane(normal: (0, 0, -1)), material: "{material}", transform: (translation: (0, 0, 2))),
                (shape: Plane(normal: (0, 0, -1)), material: "lamp", transform: (translation: (0, 0, -6)))],
            quality: (cutoff: 0)"#
        );
        f64::from(seen(DVec3::ZERO, DVec3::Z, &body).x)
    };
    assert_near(ahead("", "lamp"), libm::exp(-0.5), 1e-6);
    assert_near(ahead("visible: false", "lamp"), 1.0, 0.0);
    // The mirrored ray starts inside, 7 from where it leaves the glass.
    assert_near(ahead("", "mirror"), 0.5 * libm::exp(-0.25 * 9.0), 1e-6);
    assert_near(ahead("visible: false", "mirror"), 0.5 * libm::exp(-0.25 * 7.0), 1e-6);
    assert_near(ahead(UNREFLECTED, "mirror"), libm::exp(-0.5), 1e-6);
}

/// Returns the frames in which the ball differs from a ball that all rays see, while a channel is driven by a track.
fn hidden_frames(channel: &str, track: &str) -> Vec<u32> {
    let room = |animate: &str| {
        let more = format!("timeline: (fps: 4, duration: 3), animate: [{animate}],");
        engine(&room(&ball(""), &more))
    };
    let mut changing = room(&format!(r#"(target: "ball", channel: {channel}, track: {track})"#));
    let shown = room("").render_frame(0).unwrap();
    (0..12).filter(|frame| changing.render_frame(*frame).unwrap() != shown).collect()
}

#[test]
fn things_disappear_and_appear_at_the_frame_asked_for() {
    for channel in ["Visible", "CastsShadow", "InReflections"] {
        let keys = "Keys([(0.5, true), (1, false), (2.25, true)])";
        assert_eq!(hidden_frames(channel, keys), [4, 5, 6, 7, 8], "{channel}");
        assert_eq!(hidden_frames(channel, r#"Script("t < 0.5 || t >= 2")"#), [2, 3, 4, 5, 6, 7], "{channel}");
        assert_eq!(hidden_frames(channel, r#"Script("base")"#), [0; 0], "{channel}");
    }
}

#[test]
fn a_ball_that_appears_while_the_shutter_is_open_is_blurred() {
    let more = r#"timeline: (fps: 1, duration: 3), sampling: (samples: 16, instants: 16),
        animate: [(target: "ball", channel: Visible, track: Keys([(0, false), (1, true)]))],"#;
    let open =
        room(&ball(&format!("{NO_SHADOW}, {UNREFLECTED}")), more).replace("fov: 45", "fov: 45, shutter: 1");
    let film = engine(&open).render_frame(1).unwrap();
    // Half of the instants are before the key.
    let half = engine(&open.replace("(1, true)", "(1, false)")).render_frame(1).unwrap();
    let (middle, behind) = (film.pixel(24, 16), half.pixel(24, 16));
    // The samples of a pixel see slightly different parts of what is behind.
    assert!((middle - (LAMP + behind) * 0.5).length() < 0.05, "{middle} {behind}");
}

/// Checks that an adaptive picture does not depend on a shape that no ray sees, and that a visible change is a change of the fingerprint.
#[test]
fn hidden_shapes_take_no_samples_and_change_no_fingerprint() {
    let adaptive = |entities: &str| {
        let mut engine = engine(&room(entities, ""));
        engine.settings =
            RenderSettings { samples: Some(32), max_error: Some(2.0), ..RenderSettings::default() };
        let film = engine.render_frame(0).unwrap();
        (film, engine.report().rays, engine.report().fingerprint)
    };
    let ghosts: String = (0..9).map(|_| ball(HIDDEN).replace(r#"name: "ball", "#, "") + ", ").collect();
    assert!(adaptive(&ghosts) == adaptive(""));
    let prints = ["", NO_SHADOW, UNREFLECTED, "visible: false"].map(|fields| adaptive(&ball(fields)).2);
    assert!((1..prints.len()).all(|index| !prints[..index].contains(&prints[index])));
    let visible = ball("visible: true, casts_shadow: true, in_reflections: true");
    assert_eq!(adaptive(&visible).2, prints[0]);
}

/// Checks that rays cast from outside, as for picking, see what the camera sees.
#[test]
fn cast_rays_see_what_the_camera_sees() {
    let body = room(&ball("visible: false"), "");
    let mut engine: Engine = engine(&body);
    engine.render_frame(0).unwrap();
    let down = rayreel::Ray { origin: DVec3::new(0.0, 9.0, 0.0), direction: DVec3::NEG_Y };
    assert_eq!(engine.cast(down).unwrap().distance, 9.0);
    for visibility in engine.world_mut().query_mut::<&mut Visibility>() {
        *visibility = Visibility { camera: true, ..Visibility::NONE };
    }
    engine.render_frame(0).unwrap();
    assert_near(engine.cast(down).unwrap().distance, 7.2, 1e-12);
}
