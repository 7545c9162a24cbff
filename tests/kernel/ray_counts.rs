//! Tests that disabled effects cost no rays: counts computed by hand, with every effect and without it, and the plan's reasons.

use rayreel::components::{Material, Pattern, PatternKind, Shape, Transform};
use rayreel::systems::{Effect, Need};
use rayreel::trace::{RayCounts, TreeEnds};
use rayreel::{Engine, Rgb, Scene, World};

/// Number of pixels of every picture here.
const PIXELS: u64 = 48;

/// Renders the first frame of a scene on a film of 8 x 6 pixels, seen from (0, 0, -4) along +z.
fn rendered(body: &str) -> Engine {
    let text = format!(
        "Scene(timeline: (fps: 1, duration: 2), film: (width: 8, height: 6, transfer: Classic),
        camera: (position: (0, 0, -4), view: (0, 0, 1)), {body})"
    );
    rendered_text(&text)
}

fn rendered_text(text: &str) -> Engine {
    let scene = Scene::from_text("test.ron", text.to_owned()).unwrap_or_else(|error| panic!("{error}"));
    let mut engine = Engine::from_scene(scene);
    engine.render_frame(0).unwrap();
    engine
}

/// Renders as [`rendered`], with a wall at z = 0 that fills the view, of material "wall", and a ball far behind it, so that shadows are
/// possible.
fn wall(material: &str, more: &str) -> Engine {
    rendered(&format!(
        r#"materials: {{ "wall": {material}, "black": (k_a: 0) }},
        entities: [
            (name: "wall", shape: Plane(normal: (0, 0, -1)), material: "wall"),
            (shape: Sphere(radius: 1), material: "black", transform: (translation: (0, 0, 9))),
            {more}"#
    ))
}

fn rays(engine: &Engine) -> RayCounts {
    engine.report().rays
}

/// Returns ray counts from numbers per pixel: camera rays, shadow rays, reflected and refracted rays.
fn each(camera: u64, shadow: u64, reflection: u64, refraction: u64) -> RayCounts {
    RayCounts {
        camera: camera * PIXELS,
        shadow: shadow * PIXELS,
        reflection: reflection * PIXELS,
        refraction: refraction * PIXELS,
    }
}

/// Returns counts of tree ends from numbers per pixel: rays at the maximum depth, those of them with at least half of their light, and rays
/// below the cutoff.
fn ends(depth: u64, strong: u64, cutoff: u64) -> TreeEnds {
    TreeEnds { depth: depth * PIXELS, strong: strong * PIXELS, cutoff: cutoff * PIXELS }
}

fn need(engine: &Engine, effect: Effect) -> Need {
    engine.report().plan.as_ref().unwrap().need(effect)
}

const MATTE: &str = "(k_d: 1)";
const LAMP: &str = "(light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 0, -3)))";

#[test]
fn one_shadow_ray_per_light_and_point() {
    for (material, lights, shadow) in [
        (MATTE, "", 0),
        (MATTE, LAMP, 1),
        (MATTE, &[LAMP, LAMP].join(", "), 2),
        ("(k_a: 1)", LAMP, 0),
        ("(k_d: 1, color: (0, 0, 0))", LAMP, 0),
        // N.H is above 0 everywhere, and a dull highlight is as wide as the wall.
        ("(specular: (k_s: 0.5, shininess: 1))", LAMP, 1),
        ("(specular: (k_s: 0, shininess: 1))", LAMP, 0),
        ("(k_d: 1, specular: (k_s: 0.5, shininess: 1))", LAMP, 1),
        // Lights that are off, behind the wall, in its plane, or directed elsewhere.
        (MATTE, "(light: Point(intensity: (0, 0, 0)), transform: (translation: (0, 0, -3)))", 0),
        (MATTE, "(light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 0, 3)))", 0),
        (MATTE, "(light: Point(intensity: (1, 1, 1)), transform: (translation: (90, 0, 0)))", 0),
        (MATTE, "(light: Directional(intensity: (1, 1, 1)))", 1),
        (MATTE, "(light: Directional(intensity: (1, 1, 1), direction: (1, 0, 0)))", 0),
        (MATTE, "(light: Directional(intensity: (1, 1, 1), direction: (1, 0, -0.1)))", 0),
        // Green light on a red wall.
        (
            "(k_d: 1, color: (255, 0, 0))",
            "(light: Point(intensity: (0, 1, 0)), transform: (translation: (0, 0, -3)))",
            0,
        ),
        (
            MATTE,
            "(light: Point(intensity: (1, 1, 1), casts_shadows: false), transform: (translation: (0, 0, -3)))",
            0,
        ),
        // A light with shadows next to a light without, and a highlight far outside the view.
        (MATTE, &format!("{LAMP}, (light: Directional(intensity: (1, 1, 1), casts_shadows: false))"), 1),
        (
            "(specular: (k_s: 1, shininess: 1e6))",
            "(light: Point(intensity: (1, 1, 1)), transform: (translation: (9000, 0, -3)))",
            0,
        ),
    ] {
        let engine = wall(material, &format!("{lights}]"));
        assert_eq!(rays(&engine), each(1, shadow, 0, 0), "{material} {lights}");
        assert_eq!(engine.report().ends, ends(0, 0, 0));
    }
}

#[test]
fn spot_lights_get_shadow_rays_only_in_their_cone() {
    // The view is 45 degrees high and, as pixels are square, less than 60 wide. For a light at the camera, the rim of a cone of 90 degrees
    // lies outside the view, and the rim of a cone of 2 degrees between the four middle pixels.
    let spot = |angle: f64, turned: f64| {
        let engine = wall(
            MATTE,
            &format!(
                "(light: Spot(intensity: (1, 1, 1), angle: {angle:?}),
                transform: (translation: (0, 0, -4), rotation: Euler({turned:?}, 0, 0)))]"
            ),
        );
        assert!(need(&engine, Effect::SpotLights).is_needed());
        rays(&engine).shadow
    };
    assert_eq!(spot(90.0, 0.0), PIXELS);
    assert_eq!(spot(2.0, 0.0), 0);
    assert_eq!(spot(90.0, 180.0), 0);
    // A half-space of light whose boundary passes through the middle of the view: half of the rows.
    assert_eq!(spot(180.0, 90.0), PIXELS / 2);
    assert_eq!(spot(180.0, -90.0), PIXELS / 2);
}

#[test]
fn area_lights_get_one_shadow_ray_per_sample() {
    for samples in [1, 2, 16, 100] {
        for shape in ["Sphere(radius: 0.5)", "Rectangle(width: 1, height: 2)"] {
            let light = |z: f64| {
                format!(
                    "(light: Area(shape: {shape}, intensity: (1, 1, 1), samples: {samples}),
                    transform: (translation: (0, 0, {z:?})))]"
                )
            };
            assert_eq!(rays(&wall(MATTE, &light(-3.0))), each(1, samples, 0, 0), "{shape} {samples}");
            assert_eq!(rays(&wall(MATTE, &light(3.0))), each(1, 0, 0, 0), "{shape} behind");
            assert_eq!(rays(&wall("(k_a: 1)", &light(-3.0))), each(1, 0, 0, 0), "{shape} unanswered");
        }
    }
    // Samples of a rectangle perpendicular to the wall lie on both sides of it, evenly spread.
    let across = wall(
        MATTE,
        "(light: Area(shape: Rectangle(width: 1, height: 2), intensity: (1, 1, 1), samples: 16),
        transform: (rotation: Euler(0, 90, 0)))]",
    );
    assert_eq!(rays(&across), each(1, 8, 0, 0));
}

#[test]
fn misses_spawn_no_shadow_rays() {
    let engine = rendered(&format!(r#"background: (200, 100, 50), entities: [{LAMP}]"#));
    assert_eq!(rays(&engine), each(1, 0, 0, 0));
    // Half of the rows show a floor.
    let engine = rendered(&format!(
        r#"materials: {{ "m": (k_d: 1), "black": (k_a: 0) }}, entities: [
            (shape: Plane(normal: (0, 1, 0)), material: "m", transform: (translation: (0, -1, 0))),
            (shape: Sphere(radius: 1), material: "black", transform: (translation: (0, 0, -9))), {LAMP}]"#
    ));
    assert_eq!(rays(&engine), RayCounts { shadow: PIXELS / 2, ..each(1, 0, 0, 0) });
}

#[test]
fn every_sample_has_a_camera_ray_and_shadow_rays() {
    for samples in [1, 2, 7, 64] {
        let engine = wall(MATTE, &format!("{LAMP}], sampling: (samples: {samples})"));
        assert_eq!(rays(&engine), each(samples, samples, 0, 0));
        assert_eq!(need(&engine, Effect::Antialiasing).is_needed(), samples > 1);
    }
}

/// Renders two mirrors that face each other, in front of the camera and behind it, with as much light beyond the depth limit as before it.
fn facing_mirrors(k_r: f64, quality: &str) -> Engine {
    rendered(&format!(
        r#"quality: ({quality}), background: (200, 200, 200), ambient: (1, 1, 1),
        materials: {{ "m": (reflective: (k_r: {k_r:?})) }}, entities: [
            (shape: Plane(normal: (0, 0, 1)), material: "m", transform: (translation: (0, 0, 5))),
            (shape: Plane(normal: (0, 0, 1)), material: "m", transform: (translation: (0, 0, -5))),
        ]"#
    ))
}

#[test]
fn mirrors_are_followed_to_the_depth_limit() {
    for depth in [1, 2, 5, 40] {
        let engine = facing_mirrors(0.9, &format!("depth: {depth}, cutoff: 0"));
        assert_eq!(rays(&engine), each(1, 0, depth - 1, 0), "{depth}");
        // After six mirrors, 0.9^6 = 0.53 of the light is left.
        assert_eq!(engine.report().ends, ends(1, u64::from(depth <= 6), 0), "{depth}");
    }
    // A single mirror shows the background at any depth limit.
    for depth in [2, 9] {
        let engine = wall(
            "(reflective: (k_r: 0.5))",
            &format!("], quality: (depth: {depth}, cutoff: 0), background: (9, 9, 9)"),
        );
        assert_eq!(rays(&engine), each(1, 0, 1, 0));
        assert_eq!(engine.report().ends, ends(0, 0, 0));
    }
    assert_eq!(rays(&wall("(k_d: 1)", "]")), each(1, 0, 0, 0));
    assert_eq!(rays(&wall("(reflective: (k_r: 0))", "], background: (9, 9, 9)")), each(1, 0, 0, 0));
}

#[test]
fn mirrors_are_followed_until_the_cutoff() {
    // The radiance bound B(n) is 1 for all n: 200/255, rounded up to a power of two. After k mirrors, the throughput is 2^-k; at 16 steps
    // of 255 the fourth is cut, at 0.25 the tenth.
    for (cutoff, followed) in [(16.0, 3), (0.25, 9), (128.0, 0), (127.0, 1)] {
        let engine = facing_mirrors(0.5, &format!("depth: 30, cutoff: {cutoff:?}"));
        assert_eq!(rays(&engine), each(1, 0, followed, 0), "{cutoff}");
        assert_eq!(engine.report().ends, ends(0, 0, 1), "{cutoff}");
    }
    // In the dark every ray is cut, except with a cutoff of 0.
    let dark = |cutoff| wall("(reflective: (k_r: 1))", &format!("], quality: (cutoff: {cutoff})"));
    let (least, none) = (dark("1e-9"), dark("0"));
    assert_eq!((rays(&least), least.report().ends), (each(1, 0, 0, 0), ends(0, 0, 1)));
    assert_eq!((rays(&none), none.report().ends), (each(1, 0, 1, 0), ends(0, 0, 0)));
}

#[test]
fn reflected_surfaces_are_lit() {
    let shown = |material: &str| {
        rays(&rendered(&format!(
            r#"materials: {{ "mirror": (reflective: (k_r: 0.5)), "m": {material} }}, entities: [
                (shape: Plane(normal: (0, 0, -1)), material: "mirror"),
                (shape: Plane(normal: (0, 0, 1)), material: "m", transform: (translation: (0, 0, -9))), {LAMP}]"#
        )))
    };
    assert_eq!(shown("(k_d: 1)"), each(1, 1, 1, 0));
    assert_eq!(shown("(k_a: 1)"), each(1, 0, 0, 0), "in the dark the mirror is not followed");
}

#[test]
fn invisible_mirrors_cost_nothing() {
    let ball = |z: f64, more: &str| {
        rendered(&format!(
            r#"background: (9, 9, 9), materials: {{ "mirror": (reflective: (k_r: 1)), "m": (k_d: 1) }}, entities: [
                (shape: Sphere(radius: 1.5), material: "mirror", transform: (translation: (0, 0, {z:?}))), {more}]"#
        ))
    };
    let reason = "no reflective or transparent surface is in view";
    let behind = ball(-9.0, "");
    assert_eq!(rays(&behind), each(1, 0, 0, 0));
    assert_eq!(need(&behind, Effect::Reflection), Need::Omitted(reason));

    let before = ball(-2.0, "");
    assert_eq!(rays(&before), each(1, 0, 1, 0), "the ball fills the view");
    assert_eq!(need(&before, Effect::Reflection), Need::Needed("k_r is above 0"));

    // In the view, but behind a wall: the effect is planned, and the mirror is never hit.
    let hidden = ball(3.0, r#"(shape: Plane(normal: (0, 0, 1)), material: "m")"#);
    assert_eq!(rays(&hidden), each(1, 0, 0, 0));
    assert!(need(&hidden, Effect::Reflection).is_needed());

    // Out of the view, but visible in a mirror.
    let shown = ball(-9.0, r#"(shape: Plane(normal: (0, 0, 1)), material: "mirror")"#);
    assert!(need(&shown, Effect::Reflection).is_needed());
    assert!(rays(&shown).reflection > PIXELS);
}

/// Renders a glass ball that fills the view, in front of a white background.
fn glass_ball(refractive: &str, depth: u32) -> Engine {
    rendered_text(&format!(
        r#"Scene(film: (width: 8, height: 6, transfer: Classic), camera: (position: (0, 0, -4), view: (0, 0, 1), fov: 20),
        quality: (depth: {depth}, cutoff: 0), background: (255, 255, 255), materials: {{ "glass": (refractive: {refractive}) }},
        entities: [(shape: Sphere(radius: 1), material: "glass")])"#
    ))
}

#[test]
fn glass_spawns_one_ray_in_and_one_out() {
    for (depth, refraction, beyond) in [(1, 0, 1), (2, 1, 1), (3, 2, 0), (9, 2, 0)] {
        for ior in [1.0, 1.5] {
            let engine = glass_ball(&format!("(k_t: 0.9, ior: {ior:?})"), depth);
            assert_eq!(rays(&engine), each(1, 0, 0, refraction), "{depth}");
            assert_eq!(engine.report().ends, ends(beyond, beyond, 0), "{depth}");
            assert!(!need(&engine, Effect::Fresnel).is_needed());
        }
    }
}

#[test]
fn fresnel_glass_splits_every_ray() {
    // The first surface spawns one reflected and one refracted ray. Every ray inside spawns one of each, too, and is never totally
    // reflected, as it meets the sphere at the angle at which it entered.
    for depth in [1, 2, 3, 9] {
        let engine = glass_ball("(k_t: 0.9, ior: 1.5, fresnel: true)", depth);
        let others = u64::from(depth - 1);
        assert_eq!(rays(&engine), each(1, 0, others, others), "{depth}");
        // The refracted rays carry most of the light, inside and, but for the four corners where more is reflected, behind the ball.
        let strong = [PIXELS, PIXELS - 4].get(depth as usize - 1).copied().unwrap_or_default();
        assert_eq!(engine.report().ends, TreeEnds { strong, ..ends(2, 0, 0) }, "{depth}");
        assert!(need(&engine, Effect::Fresnel).is_needed());
        // There is no surface if the index is 1, as in empty space.
        let engine = glass_ball("(k_t: 0.9, ior: 1, fresnel: true)", depth);
        assert_eq!(rays(&engine), each(1, 0, 0, others.min(2)), "{depth}");
    }
}

#[test]
fn total_reflection_keeps_rays_inside() {
    // From inside the half-space, at 45 degrees to its face: above the critical angle of glass, 41.8, but not of water, 48.6.
    let inside = |ior: f64| {
        rendered_text(&format!(
            r#"Scene(film: (width: 8, height: 6, transfer: Classic), quality: (cutoff: 0), background: (255, 255, 255),
            camera: (position: (0, 0, 0), view: (1, 0, 1), fov: 1), materials: {{ "glass": (refractive: (k_t: 1, ior: {ior:?})) }},
            entities: [(shape: Plane(normal: (0, 0, 1)), material: "glass", transform: (translation: (0, 0, 1)))])"#
        ))
    };
    assert_eq!(rays(&inside(1.5)), each(1, 0, 1, 0));
    assert_eq!(rays(&inside(1.33)), each(1, 0, 0, 1));
    let reason = "transparent media can reflect light totally";
    assert_eq!(need(&inside(1.5), Effect::Reflection), Need::Needed(reason));
}

#[test]
fn glass_outside_the_view_only_casts_shadows() {
    let scene = |refractive: &str| {
        rendered(&format!(
            r#"background: (9, 9, 9), materials: {{ "glass": ({refractive}), "m": (k_d: 1) }}, entities: [
                (shape: Plane(normal: (0, 0, 1)), material: "m"),
                (shape: Sphere(radius: 1), material: "glass", transform: (translation: (0, 0, -9))), {LAMP}]"#
        ))
    };
    let glass = scene("refractive: (k_t: 0.5, ior: 1.5, absorption: (1, 0, 0))");
    let needs = |effect| need(&glass, effect).is_needed();
    assert_eq!(rays(&glass), each(1, 1, 0, 0));
    assert!(!needs(Effect::Refraction) && needs(Effect::TransparentShadows) && needs(Effect::Absorption));
    let opaque = scene("k_a: 1");
    assert_eq!(rays(&opaque), each(1, 1, 0, 0));
    assert!(!need(&opaque, Effect::TransparentShadows).is_needed());
}

#[test]
fn every_effect_is_needed_with_and_omitted_without_its_cause() {
    const BLUR: &str = r#"animate: [(target: "wall", channel: Color, track: Keys([(0, (0, 0, 0)), (1, (255, 255, 255))]))],
        sampling: (samples: 4)"#;
    let area = "(light: Area(shape: Sphere(radius: 1), intensity: (1, 1, 1), samples: 4), transform: (translation: (0, 0, -3)))]";
    let spot = "(light: Spot(intensity: (1, 1, 1), angle: 90), transform: (translation: (0, 0, -4)))]";
    let faint =
        "(light: Point(intensity: (1, 1, 1), falloff: (1, 1, 0)), transform: (translation: (0, 0, -3)))]";
    let lamp = &format!("{LAMP}]");
    let light = "], background: (9, 9, 9), quality: (cutoff: 0)";
    let clear = "(k_d: 1, refractive: (k_t: 0.5, ior: 1.5))";
    let tinted = "(k_d: 1, refractive: (k_t: 0.5, ior: 1.5, absorption: (1, 1, 1)))";
    let fresnel = "(k_d: 1, refractive: (k_t: 0.5, ior: 1.5, fresnel: true))";
    let checker = "(k_a: 1, pattern: Checker(color: (9, 9, 9), size: 0.5))";
    for (effect, (material, more, with), (other_material, other_more, without)) in [
        (
            Effect::Ambient,
            ("(k_a: 1)", "], ambient: (1, 1, 1)", each(1, 0, 0, 0)),
            ("(k_a: 1)", "]", each(1, 0, 0, 0)),
        ),
        (
            Effect::AmbientOcclusion,
            (
                "(k_a: 1)",
                "], ambient: (1, 1, 1), ambient_occlusion: (samples: 4, distance: 2)",
                each(1, 4, 0, 0),
            ),
            ("(k_a: 1)", "], ambient: (1, 1, 1)", each(1, 0, 0, 0)),
        ),
        (
            Effect::Emission,
            ("(emission: (1, 1, 1))", "]", each(1, 0, 0, 0)),
            ("(k_a: 1)", "]", each(1, 0, 0, 0)),
        ),
        (Effect::Diffuse, (MATTE, lamp, each(1, 1, 0, 0)), (MATTE, "]", each(1, 0, 0, 0))),
        (
            Effect::Specular,
            ("(specular: (k_s: 1, shininess: 9))", lamp, each(1, 1, 0, 0)),
            ("(k_a: 1)", lamp, each(1, 0, 0, 0)),
        ),
        (Effect::Shadows, (MATTE, lamp, each(1, 1, 0, 0)), (MATTE, "]", each(1, 0, 0, 0))),
        // The light is in front of the glass half-space, so refracted rays reach nothing that it lights.
        (Effect::TransparentShadows, (clear, lamp, each(1, 1, 0, 1)), (MATTE, lamp, each(1, 1, 0, 0))),
        (Effect::AreaLights, (MATTE, area, each(1, 4, 0, 0)), (MATTE, lamp, each(1, 1, 0, 0))),
        (Effect::SpotLights, (MATTE, spot, each(1, 1, 0, 0)), (MATTE, lamp, each(1, 1, 0, 0))),
        (Effect::Falloff, (MATTE, faint, each(1, 1, 0, 0)), (MATTE, lamp, each(1, 1, 0, 0))),
        (
            Effect::Reflection,
            ("(reflective: (k_r: 1))", light, each(1, 0, 1, 0)),
            (MATTE, light, each(1, 0, 0, 0)),
        ),
        (Effect::Refraction, (clear, light, each(1, 0, 0, 1)), (MATTE, light, each(1, 0, 0, 0))),
        (Effect::Fresnel, (fresnel, light, each(1, 0, 1, 1)), (clear, light, each(1, 0, 0, 1))),
        (Effect::Absorption, (tinted, light, each(1, 0, 0, 1)), (clear, light, each(1, 0, 0, 1))),
        (Effect::Patterns, (checker, "]", each(1, 0, 0, 0)), ("(k_a: 1)", "]", each(1, 0, 0, 0))),
        (
            Effect::Fog,
            (MATTE, "], fog: (color: (9, 9, 9), density: 1)", each(1, 0, 0, 0)),
            (MATTE, "]", each(1, 0, 0, 0)),
        ),
        (
            Effect::Gradient,
            (MATTE, "], background: (bottom: (0, 0, 0), top: (9, 9, 9))", each(1, 0, 0, 0)),
            (MATTE, "], background: (9, 9, 9)", each(1, 0, 0, 0)),
        ),
        (
            Effect::Sun,
            (MATTE, "], sun: (direction: (0, 1, 0), intensity: (1, 1, 1))", each(1, 0, 0, 0)),
            (MATTE, "], sun: (direction: (0, 1, 0), intensity: (0, 0, 0))", each(1, 0, 0, 0)),
        ),
        (Effect::Stars, (MATTE, "], stars: ()", each(1, 0, 0, 0)), (MATTE, "]", each(1, 0, 0, 0))),
        (
            Effect::RayVisibility,
            (MATTE, r#"(shape: Sphere(radius: 1), material: "black", visible: false)]"#, each(1, 0, 0, 0)),
            (MATTE, "]", each(1, 0, 0, 0)),
        ),
        (
            Effect::Antialiasing,
            (MATTE, "], sampling: (samples: 3)", each(3, 0, 0, 0)),
            (MATTE, "], sampling: (samples: 1)", each(1, 0, 0, 0)),
        ),
        (
            Effect::MotionBlur,
            (MATTE, &format!("], {BLUR}"), each(4, 0, 0, 0)),
            (MATTE, "], sampling: (samples: 4)", each(4, 0, 0, 0)),
        ),
    ] {
        let measured = |material: &str, more: &str| {
            let engine = if effect == Effect::MotionBlur {
                blurred(material, more)
            } else {
                lonely_wall(material, more)
            };
            (need(&engine, effect).is_needed(), rays(&engine))
        };
        assert_eq!(measured(material, more), (true, with), "with {effect}");
        assert_eq!(measured(other_material, other_more), (false, without), "without {effect}");
    }
    let lens = "lens: (aperture: 1, focus: 4)";
    for (lens, samples, needed) in [(lens, 4, true), ("", 4, false), (lens, 1, false)] {
        let engine = rendered_text(&format!(
            "Scene(film: (width: 8, height: 6, transfer: Classic), camera: (position: (0, 0, -4), view: (0, 0, 1), {lens}), sampling: (samples: {samples}))"
        ));
        assert_eq!(need(&engine, Effect::DepthOfField).is_needed(), needed);
        assert_eq!(rays(&engine), each(samples, 0, 0, 0));
    }
}

/// Renders as [`wall`], with the ball out of sight and not behind the wall.
fn lonely_wall(material: &str, more: &str) -> Engine {
    rendered(&walled(material, more))
}

/// Renders as [`lonely_wall`], with the shutter open, half a second after the start.
fn blurred(material: &str, more: &str) -> Engine {
    let text = format!(
        "Scene(timeline: (fps: 2, duration: 2), film: (width: 8, height: 6, transfer: Classic),
        camera: (position: (0, 0, -4), view: (0, 0, 1), shutter: 0.5), {})",
        walled(material, more)
    );
    let mut engine = rendered_text(&text);
    engine.render_frame(1).unwrap();
    engine
}

fn walled(material: &str, more: &str) -> String {
    format!(
        r#"materials: {{ "wall": {material}, "black": (k_a: 0) }},
        entities: [
            (name: "wall", shape: Plane(normal: (0, 0, -1)), material: "wall"),
            (shape: Sphere(radius: 1), material: "black", transform: (translation: (0, 0, -99))),
            {more}"#
    )
}

/// The text of a scene after the camera, an effect, and the reason for which the first frame does not need it.
const OMITTED: &[(&str, Effect, &str)] = &[
    (
        r#"materials: { "m": (k_a: 1) }, entities: [(shape: Sphere(radius: 1), material: "m")]"#,
        Effect::Ambient,
        "there is no ambient light",
    ),
    (
        r#"ambient: (1, 1, 1), materials: { "m": (k_d: 1) }, entities: [(shape: Sphere(radius: 1), material: "m")]"#,
        Effect::Ambient,
        "k_a is 0 on all surfaces",
    ),
    (
        r#"ambient: (1, 1, 1), materials: { "m": (k_a: 1) }, entities: [(shape: Sphere(radius: 1), material: "m")]"#,
        Effect::AmbientOcclusion,
        "the scene has no `ambient_occlusion`",
    ),
    (
        r#"ambient_occlusion: (distance: 1), materials: { "m": (k_a: 1) },
            entities: [(shape: Sphere(radius: 1), material: "m")]"#,
        Effect::AmbientOcclusion,
        "there is no ambient light",
    ),
    (
        r#"ambient: (1, 1, 1), ambient_occlusion: (distance: 1), materials: { "m": (k_a: 1) },
            entities: [(shape: Plane(normal: (0, 1, 0)), material: "m")]"#,
        Effect::AmbientOcclusion,
        "no surface can occlude another",
    ),
    (
        r#"ambient: (1, 1, 1), ambient_occlusion: (distance: 1), materials: { "m": (k_a: 1) },
            entities: [(shape: Sphere(radius: 1), material: "m", casts_shadow: false)]"#,
        Effect::AmbientOcclusion,
        "no shape casts a shadow",
    ),
    ("", Effect::Diffuse, "there are no lights"),
    ("", Effect::Specular, "there are no lights"),
    ("", Effect::Shadows, "there are no lights"),
    ("", Effect::TransparentShadows, "there are no lights"),
    (OFF, Effect::Diffuse, "all lights are off at this time"),
    (OFF, Effect::Specular, "all lights are off at this time"),
    (OFF, Effect::Shadows, "all lights are off at this time"),
    (OFF, Effect::TransparentShadows, "all lights are off at this time"),
    (BLACK, Effect::Diffuse, "k_d is 0 on all surfaces"),
    (BLACK, Effect::Specular, "no material has `specular`"),
    (BLACK, Effect::Shadows, "k_d and k_s are 0 on all surfaces"),
    (BLACK, Effect::TransparentShadows, "k_d and k_s are 0 on all surfaces"),
    (BLACK, Effect::AreaLights, "k_d and k_s are 0 on all surfaces"),
    (BLACK, Effect::SpotLights, "k_d and k_s are 0 on all surfaces"),
    (BLACK, Effect::Falloff, "k_d and k_s are 0 on all surfaces"),
    (NOT_YET, Effect::Specular, "k_s is 0 at this time"),
    (NOT_YET, Effect::Reflection, "k_r is 0 at this time"),
    (NOT_YET, Effect::Refraction, "k_t is 0 at this time"),
    (NOT_YET, Effect::Fresnel, "k_t is 0 at this time"),
    (NOT_YET, Effect::Absorption, "k_t is 0 at this time"),
    (NOT_YET, Effect::TransparentShadows, "k_t is 0 at this time"),
    (NOT_YET, Effect::AreaLights, "it is off at this time"),
    (NOT_YET, Effect::SpotLights, "it is off at this time"),
    (NOT_YET, Effect::Falloff, "it is off at this time"),
    (NOT_YET, Effect::Emission, "emission is 0 at this time"),
    (PLAIN, Effect::Emission, "no material has `emission`"),
    (PLAIN, Effect::AreaLights, "there are no area lights"),
    (PLAIN, Effect::SpotLights, "no light is a spot light"),
    (PLAIN, Effect::Falloff, "no light has `falloff`"),
    (PLAIN, Effect::Shadows, "no surface can occlude another"),
    (PLAIN, Effect::TransparentShadows, "no material has `refractive`"),
    (PLAIN, Effect::Reflection, "no material has `reflective`"),
    (PLAIN, Effect::Refraction, "no material has `refractive`"),
    (PLAIN, Effect::Fresnel, "no material has `refractive`"),
    (PLAIN, Effect::Absorption, "no material has `refractive`"),
    (PLAIN, Effect::Patterns, "no material has `pattern`"),
    (PLAIN, Effect::Fog, "the scene has no `fog`"),
    (PLAIN, Effect::Gradient, "the background is the same everywhere"),
    (PLAIN, Effect::Sun, "the scene has no `sun`"),
    (PLAIN, Effect::Stars, "the scene has no `stars`"),
    ("sun: (direction: (0, 1, 0), intensity: (0, 0, 0))", Effect::Sun, "it is not seen at this time"),
    ("stars: (intensity: (0, 0, 0))", Effect::Stars, "they are not seen at this time"),
    (PLAIN, Effect::RayVisibility, "all rays see all shapes"),
    (HIDDEN, Effect::RayVisibility, "every shape is seen by all rays or by none at this time"),
    (SHADOWLESS, Effect::Shadows, "no shape casts a shadow"),
    (SHADOWLESS, Effect::TransparentShadows, "no transparent shape casts a shadow"),
    (PLAIN, Effect::Antialiasing, "a pixel has one sample"),
    (PLAIN, Effect::DepthOfField, "the camera has no lens"),
    (PLAIN, Effect::MotionBlur, "the camera has no shutter"),
    ("fog: (color: (9, 9, 9), density: 0)", Effect::Fog, "its density is 0"),
    (
        r#"materials: { "m": (k_d: 1) }, entities: [(shape: Sphere(radius: 1), material: "m"),
            (light: Point(intensity: (1, 1, 1), casts_shadows: false))]"#,
        Effect::Shadows,
        "no light that is on casts shadows",
    ),
    (GLASS, Effect::Shadows, "no surface is opaque"),
    (GLASS, Effect::Absorption, "no medium absorbs"),
    (GLASS, Effect::Fresnel, "no material has `fresnel`"),
    (UNSEEN, Effect::Reflection, "no reflective or transparent surface is in view"),
    (UNSEEN, Effect::Refraction, "no reflective or transparent surface is in view"),
    (UNSEEN, Effect::Fresnel, "no reflective or transparent surface is in view"),
    (UNSEEN, Effect::Absorption, "no reflective or transparent surface is in view"),
];

const OFF: &str = r#"materials: { "m": (k_d: 1) }, entities: [(shape: Sphere(radius: 1), material: "m"),
    (light: Point(intensity: (0, 0, 0)))]"#;
const BLACK: &str = r#"materials: { "m": (k_a: 1) }, entities: [(shape: Sphere(radius: 1), material: "m"),
    (light: Spot(intensity: (1, 1, 1), angle: 9, falloff: (1, 1, 1))),
    (light: Area(shape: Sphere(radius: 1), intensity: (1, 1, 1)))]"#;
const NOT_YET: &str = r#"materials: { "m": (k_d: 1, specular: (k_s: 0.5, shininess: 9), reflective: (k_r: 0.5),
        refractive: (k_t: 0.5, ior: 1.5, absorption: (1, 1, 1), fresnel: true), emission: (0, 0, 0)) },
    entities: [(shape: Sphere(radius: 1), material: "m"), (light: Point(intensity: (1, 1, 1))),
        (name: "spot", light: Spot(intensity: (1, 1, 1), angle: 9, falloff: (1, 1, 1))),
        (name: "area", light: Area(shape: Sphere(radius: 1), intensity: (1, 1, 1)))],
    animate: [(material: "m", channel: Ks, track: Keys([(0, 0), (1, 1)])),
        (material: "m", channel: Kr, track: Keys([(0, 0), (1, 1)])),
        (material: "m", channel: Emission, track: Keys([(0, (0, 0, 0)), (1, (1, 1, 1))])),
        (material: "m", channel: Kt, track: Keys([(0, 0), (1, 1)])),
        (target: "spot", channel: Intensity, track: Keys([(0, (0, 0, 0)), (1, (1, 1, 1))])),
        (target: "area", channel: Intensity, track: Keys([(0, (0, 0, 0)), (1, (1, 1, 1))]))]"#;
const PLAIN: &str = r#"materials: { "m": (k_d: 1) }, entities: [(shape: Plane(normal: (0, 1, 0)), material: "m"),
    (light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 1, 0)))]"#;
const GLASS: &str = r#"materials: { "m": (k_d: 1, refractive: (k_t: 0.5, ior: 1.5)) }, entities: [
    (shape: Sphere(radius: 1), material: "m"), (light: Point(intensity: (1, 1, 1)))]"#;
const UNSEEN: &str = r#"materials: { "m": (reflective: (k_r: 1), refractive: (k_t: 0.5, ior: 1.5, absorption: (1, 1, 1), fresnel: true)) },
    entities: [(shape: Sphere(radius: 1), material: "m", transform: (translation: (0, 0, -99)))]"#;

const HIDDEN: &str = r#"materials: { "m": (k_d: 1) }, entities: [(shape: Sphere(radius: 1), material: "m"),
    (shape: Sphere(radius: 2), material: "m", visible: false, casts_shadow: false, in_reflections: false)]"#;
const SHADOWLESS: &str = r#"materials: { "m": (refractive: (k_t: 0.5, ior: 1.5)), "n": (k_d: 1) }, entities: [
    (shape: Sphere(radius: 1), material: "m", casts_shadow: false), (light: Point(intensity: (1, 1, 1))),
    (shape: Sphere(radius: 9), material: "n", casts_shadow: false)]"#;

#[test]
fn omitted_effects_have_their_reasons() {
    for (body, effect, reason) in OMITTED {
        assert_eq!(need(&rendered(body), *effect), Need::Omitted(reason), "{body}");
    }
    // A scene file with squares of no size is refused, but a world may contain them.
    let mut world = World::new();
    let white = Material { k_a: 1.0, k_d: 0.0, color: Rgb::ONE, ambient_color: None, metallic: false };
    let squares = Pattern { color: Rgb::ZERO, kind: PatternKind::Checker { size: 0.0 } };
    world.spawn((Shape::Sphere { radius: 1.0 }, Transform::default(), white, squares));
    let mut engine = Engine::new(world);
    engine.render_frame(0).unwrap();
    assert_eq!(need(&engine, Effect::Patterns), Need::Omitted("no surface with a pattern is drawn"));
}

#[test]
fn effects_omitted_now_are_needed_later() {
    let mut engine = rendered(NOT_YET);
    engine.render_frame(1).unwrap();
    for effect in [
        Effect::Emission,
        Effect::Specular,
        Effect::Reflection,
        Effect::Refraction,
        Effect::Fresnel,
        Effect::Absorption,
        Effect::TransparentShadows,
        Effect::AreaLights,
        Effect::SpotLights,
        Effect::Falloff,
    ] {
        assert!(need(&engine, effect).is_needed(), "{effect}");
    }
    let later = rays(&engine);
    engine.render_frame(0).unwrap();
    let earlier = rays(&engine);
    assert_eq!((earlier.reflection, earlier.refraction), (0, 0));
    assert!(later.reflection > 0 && later.refraction > 0 && later.shadow > earlier.shadow);
}

#[test]
fn lens_and_shutter_are_omitted_without_an_effect() {
    let scene = |camera: &str, sampling: &str, channel: &str| {
        rendered_text(&format!(
            r#"Scene(timeline: (fps: 1, duration: 2), film: (width: 8, height: 6, transfer: Classic), sampling: ({sampling}),
            camera: (position: (0, 0, -4), view: (0, 0, 1), {camera}), materials: {{ "m": (k_a: 1) }},
            entities: [(name: "ball", shape: Sphere(radius: 1), material: "m")], animate: [{channel}])"#
        ))
    };
    let moves = r#"(target: "ball", channel: Translation, track: Keys([(0, (0, 0, 0)), (1, (1, 0, 0))]))"#;
    let rests = r#"(target: "ball", channel: Translation, track: Keys([(0, (0, 0, 0)), (1, (0, 0, 0))]))"#;
    let later = r#"(target: "ball", channel: Translation, track: Keys([(1, (0, 0, 0)), (2, (1, 0, 0))]))"#;
    for (camera, sampling, channel, effect, expected) in [
        (
            "lens: (aperture: 1, focus: 4)",
            "samples: 1",
            "",
            Effect::DepthOfField,
            Need::Omitted("a pixel has one sample, through the middle of the lens"),
        ),
        (
            "lens: (aperture: 1, focus: 4)",
            "samples: 4",
            "",
            Effect::DepthOfField,
            Need::Needed("the camera has a lens"),
        ),
        (
            "lens: (aperture: 0, focus: 4)",
            "samples: 4",
            "",
            Effect::DepthOfField,
            Need::Omitted("the camera has no lens"),
        ),
        ("", "samples: 4", moves, Effect::MotionBlur, Need::Omitted("the camera has no shutter")),
        (
            "shutter: 1",
            "samples: 1",
            moves,
            Effect::MotionBlur,
            Need::Omitted("all samples are taken at one instant"),
        ),
        (
            "shutter: 1",
            "samples: 4, instants: 1",
            moves,
            Effect::MotionBlur,
            Need::Omitted("all samples are taken at one instant"),
        ),
        (
            "shutter: 1",
            "samples: 4",
            "",
            Effect::MotionBlur,
            Need::Omitted("nothing moves while the shutter is open"),
        ),
        (
            "shutter: 1",
            "samples: 4",
            rests,
            Effect::MotionBlur,
            Need::Omitted("nothing moves while the shutter is open"),
        ),
        (
            "shutter: 1",
            "samples: 4",
            later,
            Effect::MotionBlur,
            Need::Omitted("nothing moves while the shutter is open"),
        ),
        (
            "shutter: 1",
            "samples: 4",
            moves,
            Effect::MotionBlur,
            Need::Needed("something moves while the shutter is open"),
        ),
    ] {
        let engine = scene(camera, sampling, channel);
        assert_eq!(need(&engine, effect), expected, "{camera} {sampling} {channel}");
    }
}
