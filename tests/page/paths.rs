//! The path of the camera over the picture and on a map.

use std::fmt::Write as _;
use std::fs;
use std::time::{Duration, Instant};

use rayreel::Engine;
use serde_json::json;

use crate::browser::Browser;
use crate::{Preview, SCENE, open, until};

const CAMERA: &str = "camera: (position: (0, 0, -5), target: (0, 0, 0))";
/// Moves the camera for a second to the right, then for a second towards the ball.
const KEYS: &str = "animate: [(target: \"camera\", channel: Position, track: Keys([(0, (0, 0, -5)), (1, (2, 0, -5)), (2, (2, 0, -3))])),";
/// A small ball at the second key of the camera.
const MARK: &str = "entities: [(name: \"there\", shape: Sphere(radius: 0.2), material: \"clay\", transform: (translation: (2, 0, -5))),";

fn moving() -> String {
    SCENE.replace("animate: [", KEYS).replace("entities: [", MARK)
}

fn file(preview: &Preview) -> String {
    fs::read_to_string(preview.folder.path().join("ball.ron")).unwrap()
}

/// Shows the path of the camera, and waits for it.
fn show_path(browser: &Browser) {
    until(browser, "shown !== null && shown.full && tracks !== null");
    browser.click("#camera-path");
    until(browser, "path !== null && fetchingPath === null && path.of === `${reload()} ${tracks.of}`");
}

/// Looks from a place to another one, without a change of the file.
fn look(browser: &Browser, position: [f64; 3], target: [f64; 3]) {
    browser.evaluate(&format!(
        "(currentView().then(view => setView(view, {{ position: {position:?}, target: {target:?} }})), true)"
    ));
    until(
        browser,
        &format!(
            "JSON.stringify(seenFrom?.camera.position) === JSON.stringify({position:?}) && trying === null && shown.full"
        ),
    );
    until(
        browser,
        "state.edits.look !== null && path.of === `${reload()} ${tracks.of}` && fetchingPath === null",
    );
}

/// Clicks a place of the page.
fn click(browser: &Browser, place: &str) {
    let [x, y]: [f64; 2] = serde_json::from_value(browser.evaluate(place)).unwrap();
    let to = json!({ "type": "pointerMove", "duration": 20, "x": x.round(), "y": y.round() });
    browser.point(&[
        to,
        json!({ "type": "pointerDown", "button": 0 }),
        json!({ "type": "pointerUp", "button": 0 }),
    ]);
}

/// The place on the page of the camera in frame 5, seen from the current view.
const FIFTH: &str = "(([[[[x, y]]], box]) => [box.left + x * scale(), box.top + y * scale()])([throughView(seenFrom.camera)([sampleAt(5).eye]), at('film').getBoundingClientRect()])";

#[test]
fn path_is_seen_from_elsewhere_and_leads_to_its_frames() {
    let preview = Preview::of(&moving());
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && at('path-panel').hidden");
    let requests =
        "performance.getEntriesByType('resource').filter(entry => entry.name.endsWith('/path')).length";
    assert_eq!(browser.evaluate(requests), json!(0), "the path is sampled on request only");
    show_path(&browser);
    assert_eq!(browser.evaluate("[at('path-panel').hidden, at('path-panel').open]"), json!([false, true]));

    // The samples are those of the engine.
    let samples: Vec<(u32, [f64; 3], [[f64; 3]; 3])> = serde_json::from_value(
        browser.evaluate("path.samples.map(({ frame, eye, axes }) => [frame, eye, axes])"),
    )
    .unwrap();
    assert_eq!(samples.len(), 20);
    let mut engine = Engine::load(preview.folder.path().join("ball.ron")).unwrap();
    for (frame, eye, axes) in samples {
        engine.seek(engine.timeline.time_of(frame)).unwrap();
        let camera = engine.prepared().unwrap().camera();
        assert_eq!(camera.position().to_array(), eye, "frame {frame}");
        for (own, axis) in camera.axes().iter().zip(axes) {
            assert!(own.distance(axis.into()) < 1e-6, "frame {frame}: {own} {axis:?}");
        }
    }
    assert_eq!(browser.evaluate("path.keys.map(({ sample }) => sample.frame)"), json!([0, 10]));

    // A drag looks from elsewhere: nothing is tried, and the file stays.
    browser.drag("#film", (60, -40));
    until(
        &browser,
        "state.edits.look !== null && trying === null && shown.full && !at('path-view').hasAttribute('hidden')",
    );
    assert_eq!(browser.evaluate("state.edits.tried"), json!([]));
    look(&browser, [1.0, 5.0, -14.0], [1.0, 0.0, -4.0]);
    assert_eq!(file(&preview), moving());

    // The key is drawn where the picture has the ball that is at the same place.
    until(&browser, "document.querySelectorAll('#path-view .path-key').length === 2");
    let there = "(async () => { const dot = document.querySelector('#path-view [data-frame=\"10\"]'), pixel = ['cx', 'cy'].map(name => Math.floor(Number(dot.getAttribute(name)))); return (await (await post('probe', pixel)).json()).surface?.entity; })()";
    assert_eq!(browser.evaluate(there), json!("there"));
    let frustum = browser.evaluate("document.querySelector('#path-view .view').getAttribute('d')");

    // A click on a key, and one on the path, show their frames; no pixel is marked.
    browser.click("#path-view [data-frame='10']");
    until(&browser, "view.frame === 10 && shown.frame === 10 && shown.full");
    assert_ne!(browser.evaluate("document.querySelector('#path-view .view').getAttribute('d')"), frustum);
    click(&browser, FIFTH);
    until(&browser, "view.frame === 5 && shown.frame === 5 && shown.full");
    assert_eq!(browser.evaluate("view.spot"), json!(null));

    // From the middle of the path along it, what is behind the eye is cut off.
    look(&browser, [1.0, 0.1, -5.0], [5.0, 0.0, -5.0]);
    until(&browser, "document.querySelectorAll('#path-view .path-key').length === 1");
    let drawn = browser.evaluate("document.querySelector('#path-view .eye').getAttribute('d')");
    let drawn = drawn.as_str().unwrap();
    assert!(!drawn.contains("NaN") && drawn.matches('L').count() > 5, "{drawn}");
    browser.click("#drop");
    until(&browser, "state.edits.look === null && shown.full");
    assert_eq!(file(&preview), moving());
    browser.press('c');
    until(&browser, "at('path-panel').hidden && at('path-view').hasAttribute('hidden') && !view.path");
    // Without the path, a drag moves the camera again.
    browser.drag("#film", (60, 0));
    until(&browser, "state.edits.tried.length > 0 && state.edits.look === null");
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn map_shows_the_path_to_scale_and_leads_to_its_keys() {
    let preview = Preview::of(&moving());
    let Some(browser) = open(&preview) else { return };
    show_path(&browser);
    let views = "viewsOf(at('path-drawing')).map(({ across, upwards, x, y, scale }) => [across, upwards, x, y, scale])";
    let views: Vec<(usize, usize, f64, f64, f64)> = serde_json::from_value(browser.evaluate(views)).unwrap();
    assert_eq!(views.iter().map(|view| (view.0, view.1)).collect::<Vec<_>>(), [(0, 2), (2, 1)]);
    for (index, (across, upwards, x, y, scale)) in views.into_iter().enumerate() {
        let dots = format!(
            "[...document.querySelectorAll('#path-drawing .path-{index} .path-key')].map(dot => ['cx', 'cy'].map(name => Number(dot.getAttribute(name))))"
        );
        let dots: Vec<[f64; 2]> = serde_json::from_value(browser.evaluate(&dots)).unwrap();
        for (dot, eye) in dots.iter().zip([[0.0, 0.0, -5.0], [2.0, 0.0, -5.0]]) {
            let expected = [x + scale * eye[across], y - scale * eye[upwards]];
            assert!((0..2).all(|axis| (dot[axis] - expected[axis]).abs() < 0.01), "{dots:?} {expected:?}");
        }
        // The grid of the drawing is that of the scale: the numbers are where the view has them.
        assert!(dots.len() == 2 && scale > 1.0);
    }
    assert_eq!(browser.evaluate("document.querySelectorAll('#path-drawing .view').length"), json!(2));
    let label = browser.evaluate("document.querySelector('#path-drawing svg').getAttribute('aria-label')");
    assert!(
        label.as_str().unwrap().starts_with("Path of camera in two views: 20 frames, a path of"),
        "{label}"
    );

    // The keyboard reaches the keys of one view, and the focus stays where it is.
    assert_eq!(
        browser.evaluate("document.querySelectorAll('#path-drawing [tabindex=\"0\"]').length"),
        json!(2)
    );
    browser.evaluate("(document.querySelector('#path-drawing [data-frame=\"10\"]').focus(), true)");
    browser.press('\u{e007}');
    until(&browser, "view.frame === 10 && shown.frame === 10 && shown.full");
    until(&browser, "document.activeElement.dataset.frame === '10'");
    let label = browser.evaluate("document.activeElement.getAttribute('aria-label')");
    assert_eq!(label, json!("Key of camera at frame 10, 1.00 s: Position"));

    // A magnified map keeps its numbers: each is at its place.
    browser.evaluate("(at('path-drawing').focus(), true)");
    browser.press('+');
    browser.press('+');
    let numbers = "(({ x, scale }) => [...document.querySelectorAll('#path-drawing .near text[text-anchor]')].slice(0, 2).map(text => [Number(text.getAttribute('x')), x + scale * Number(text.textContent)]))(viewsOf(at('path-drawing'))[0])";
    let numbers: Vec<[f64; 2]> = serde_json::from_value(browser.evaluate(numbers)).unwrap();
    assert!(
        !numbers.is_empty() && numbers.iter().all(|[own, expected]| (own - expected).abs() < 0.1),
        "{numbers:?}"
    );
    browser.press('0');
    until(&browser, "document.querySelector('#path-drawing .near') === null");
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn shots_have_paths_of_their_own() {
    let shots = "cameras: { \"side\": (position: (-5, 1, 0), target: (0, 0, 0)) }, shots: [(0, \"side\"), (1, \"camera\")]";
    let preview = Preview::of(&moving().replace(CAMERA, &format!("{CAMERA}, {shots}")));
    let Some(browser) = open(&preview) else { return };
    show_path(&browser);
    assert_eq!(browser.evaluate("[path.camera, path.frames, path.is_still]"), json!(["side", [0, 9], true]));
    let about = browser.evaluate("at('path-about').innerText");
    assert!(about.as_str().unwrap().starts_with("The camera stands still: there is no path."), "{about}");
    browser.evaluate("(seek(12), true)");
    until(&browser, "path.camera === 'camera' && shown.frame === 12");
    assert_eq!(browser.evaluate("[path.frames, path.is_still]"), json!([[10, 19], false]));
    // An edit of a key moves the path.
    preview.save(&file(&preview).replace("(2, (2, 0, -3))", "(2, (2, 4, -3))"));
    until(&browser, "path.samples.at(-1).eye[1] > 2");
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn paths_of_large_scenes_are_bounded() {
    let mut many = String::new();
    for index in 0..20_000 {
        writeln!(many, "(parent: \"ball\", shape: Sphere(radius: 0.1), material: \"clay\", transform: (translation: ({index}, -9, 99))),").unwrap();
    }
    let scene = moving().replace("duration: 2", "duration: 100");
    let preview = Preview::of(&scene.replace("entities: [", &format!("entities: [\n{many}")));
    let Some(browser) = open(&preview) else { return };
    let start = Instant::now();
    show_path(&browser);
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
    let counts = browser.evaluate("[path.samples.length > 1 && path.samples.length <= 250, path.frames, path.notes.includes('400 of 20002 shapes are outlined.')]");
    assert_eq!(counts, json!([true, [0, 999], true]));
    let took =
        "performance.getEntriesByType('resource').findLast(entry => entry.name.endsWith('/path')).duration";
    let took = browser.evaluate(took).as_f64().unwrap();
    println!("the path took {took} ms");
    assert!(took < 5000.0, "{took}");
    assert_eq!(browser.console(), json!([]));
}
