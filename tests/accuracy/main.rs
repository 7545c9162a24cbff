//! Tests of error targets on scenes that are hard to sample, against references of many samples.

#![allow(clippy::unwrap_used, reason = "tests")]

mod hard_scenes;

use std::sync::{LazyLock, OnceLock};

use hard_scenes::{HardScene, hard_scenes};
use rayreel::accuracy::FilmError;
use rayreel::trace::{EstimatedError, Film};
use rayreel::{Engine, RenderRequest, RenderSettings, Rgb, Scene, Time};

fn engine(scene: &HardScene) -> Engine {
    Engine::from_scene(Scene::from_text(scene.name, scene.text.clone()).unwrap())
}

fn moment() -> Time {
    "0.25".parse().unwrap()
}

/// Renders a picture with these settings: its alpha, as light, where that is what is hard.
fn render(engine: &mut Engine, settings: RenderSettings, alpha: bool) -> Film {
    engine.settings = settings;
    if !alpha {
        return engine.render(moment()).unwrap().film;
    }
    let picture = engine.render(RenderRequest { alpha: true, ..RenderRequest::at(moment()) });
    let alpha = picture.unwrap().alpha.unwrap();
    let transfer = engine.effective_settings().film.transfer;
    let light = |alpha: &f32| transfer.decode([255.0 * f64::from(*alpha); 3]);
    let pixels: Vec<Rgb> = alpha.pixels().iter().map(light).collect();
    Film::from_pixels(alpha.width(), alpha.height(), pixels.into_iter())
}

/// The hard scenes by name, and their pictures with equally many samples in all pixels and another seed, rendered when first needed.
static SCENES: LazyLock<Vec<(HardScene, OnceLock<Film>)>> =
    LazyLock::new(|| hard_scenes().into_iter().map(|scene| (scene, OnceLock::new())).collect());

/// Returns the reference picture of a scene.
fn reference((scene, film): &'static (HardScene, OnceLock<Film>)) -> &'static Film {
    let settings = RenderSettings {
        samples: Some(2048),
        max_error: Some(0.0),
        seed: Some(99),
        instants: Some(256),
        ..RenderSettings::default()
    };
    film.get_or_init(|| render(&mut engine(scene), settings, scene.alpha))
}

/// Returns the true error of a picture for a target, and the estimate.
fn errors(hard: &'static (HardScene, OnceLock<Film>), target: f32) -> (f64, EstimatedError) {
    let settings =
        RenderSettings { samples: Some(65_536), max_error: Some(target), ..RenderSettings::default() };
    let mut engine = engine(&hard.0);
    let film = render(&mut engine, settings, hard.0.alpha);
    let found = FilmError::between(&film, reference(hard), engine.effective_settings().film.transfer).rms;
    (found, engine.report().error.unwrap())
}

/// Returns the scenes of these names.
fn named(names: &[&str]) -> Vec<&'static (HardScene, OnceLock<Film>)> {
    let find = |name: &&str| SCENES.iter().find(|(scene, _)| scene.name == *name).unwrap();
    names.iter().map(find).collect()
}

#[test]
fn error_targets_are_met() {
    for hard in named(&[
        "stars",
        "dust",
        "wires",
        "thick wires",
        "needles",
        "steep sky",
        "far checker",
        "busy",
        "black on black",
        "rare sparks",
        "fireflies",
        "sparks on grey",
        "looking glass",
        "glints",
        "penumbrae",
        "mirrors",
        "fast ball",
        "fast bar",
        "belt",
    ]) {
        let name = hard.0.name;
        for target in [4.0, 2.0] {
            let (found, estimate) = errors(hard, target);
            // The reference has an error, too.
            let most = 1.1 * f64::from(target);
            assert!(found <= most, "{name}: {found:.2} for {target}, estimated {estimate:?}");
            assert!(estimate.value <= f64::from(target), "{name}: {estimate:?}");
            // Nothing bright is mirrored where geometry does not find it.
            assert!(estimate.hidden < estimate.value, "{name}: {estimate:?}");
        }
    }
}

/// Checks targets between the usual ones: estimates include the pixels that fast shapes cross between two instants.
#[test]
fn motion_meets_all_targets() {
    for hard in named(&["fast ball", "fast bar", "cannonball", "fast shadow", "belt"]) {
        for target in [24.0, 16.0, 12.0, 10.0, 8.0, 6.0, 3.0] {
            let (found, estimate) = errors(hard, target);
            let name = hard.0.name;
            assert!(found <= 1.1 * f64::from(target), "{name}: {found:.2} for {target}, {estimate:?}");
            assert!(estimate.value >= 0.8 * found, "{name}: {found:.2} for {target}, {estimate:?}");
        }
    }
}

/// Checks scenes that may miss their target, if the estimate reports it: audits alone find their noise.
#[test]
fn errors_are_at_most_the_target_or_the_estimate() {
    for hard in named(&["glass", "beyond white"]) {
        for target in [4.0, 2.0] {
            let (found, estimate) = errors(hard, target);
            let EstimatedError { value, deviation, hidden } = estimate;
            let most = f64::from(target).max((value + 2.0 * deviation).hypot(hidden));
            assert!(found <= 1.1 * most, "{}: {found:.2} for {target}, {estimate:?}", hard.0.name);
            assert!(hidden < value, "{}: {estimate:?}", hard.0.name);
        }
    }
}

/// Checks the estimates of the first round, by which deadlines distribute the time. Most small features were missed, and their radiance is only
/// known to lie below a bound.
#[test]
fn first_estimates_are_near_the_measured_error() {
    for hard in SCENES.iter() {
        let HardScene { name, alpha, .. } = hard.0;
        // The first round knows too little of moving shapes; blurred and bright dots need a longer reference.
        if alpha
            || ["bokeh", "bright dust", "fireflies", "fast ball", "fast bar", "cannonball"].contains(&name)
        {
            continue;
        }
        let (found, estimate) = errors(hard, 255.0);
        let ratio = estimate.value / found;
        // Sparks are so bright that any part of a pixel is white.
        let most = if name == "rare sparks" { 5.5 } else { 2.7 };
        assert!((0.9..most).contains(&ratio), "{name}: {found:.2}, estimated {estimate:?}");
    }
}

/// Checks that a frame has the same bits alone and after others.
#[test]
fn frames_with_an_error_target_do_not_depend_on_other_frames() {
    for (scene, _) in named(&["fast ball", "stars"]) {
        let settings =
            RenderSettings { samples: Some(64), max_error: Some(2.0), ..RenderSettings::default() };
        let mut alone = engine(scene);
        let mut after = engine(scene);
        for frame in [0, 3, 7] {
            after.settings = settings;
            let _ = after.render_frame(frame).unwrap();
        }
        assert!(render(&mut alone, settings, false) == render(&mut after, settings, false), "{}", scene.name);
    }
}
