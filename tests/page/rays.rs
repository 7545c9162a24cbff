//! Tests of the rays of a pixel on the page.

use serde_json::{Value, json};

use crate::browser::Browser;
use crate::{Preview, SCENE, open, settle, until};

const CAMERA: &str = "camera: (position: (0, 0, -5), target: (0, 0, 0))";

/// A scene with a mirror in front of the camera, a ball in the shadow of a plate, and a second sample.
fn scene() -> String {
    SCENE
        .replace("ambient:", "sampling: (samples: 4), ambient:")
        .replace("color: (255, 120, 60)", "color: (255, 120, 60), reflective: (k_r: 0.25)")
        .replace(
            "entities: [",
            "entities: [(name: \"lamp\", light: Area(shape: Sphere(radius: 0.5), intensity: (1, 1, 1), samples: 64), transform: (translation: (-4, 2, -6))),
             (name: \"plate\", shape: Box(size: (1, 1, 0.1)), transform: (translation: (1.5, 2.2, -2.2)), material: \"clay\"),",
        )
}

/// Marks a pixel, and waits for its rays.
fn rows(browser: &Browser, pixel: [u32; 2]) -> Vec<String> {
    browser.evaluate(&format!("(traced = null, at('ray-tree').replaceChildren(), probe({pixel:?}), true)"));
    until(browser, "at('ray-tree').children.length > 0");
    let list = "[...document.querySelectorAll('#ray-tree .row')].map(row => row.innerText)";
    serde_json::from_value(browser.evaluate(list)).unwrap()
}

/// Returns the numbers of an SVG element's attributes.
fn numbers(browser: &Browser, selector: &str, attributes: &[&str]) -> Vec<f64> {
    let text = format!(
        "{attributes:?}.flatMap(name => document.querySelector(`{selector}`).getAttribute(name).match(/-?[\\d.]+/g).map(Number))"
    );
    serde_json::from_value(browser.evaluate(&text)).unwrap()
}

#[test]
fn rays_of_a_pixel_are_listed_and_drawn() {
    let preview = Preview::of(&scene());
    let Some(browser) = open(&preview) else { return };
    let requests =
        "performance.getEntriesByType('resource').filter(entry => entry.name.endsWith('/rays')).length";
    until(&browser, "shown !== null && shown.full && at('rays').hidden");
    browser.evaluate("(probe([80, 45]), true)");
    until(&browser, "!at('rays').hidden && at('spot').innerText.includes('ball')");
    assert_eq!(browser.evaluate(requests), json!(0), "rays are traced on request only");
    browser.click("#rays summary");
    let list = rows(&browser, [80, 45]);
    assert!(list[0].starts_with("camera ray meets ball from outside"), "{list:?}");
    assert!(list[0].contains("distance 4") && list[0].contains("100 % of its light"), "{list:?}");
    assert!(list[1].starts_with("to lamp") && list[1].contains("adds 0."), "{list:?}");
    assert!(list[2].starts_with("to #3: hidden by plate"), "{list:?}");
    assert_eq!(list[3], "reflection 1 sees the background\n25 % of its light");
    assert_eq!(list.len(), 4);
    let depths = browser.evaluate("[...document.querySelectorAll('#ray-tree .row')].map(row => row.parentElement.parentElement.parentElement === at('rays') ? 0 : 1)");
    assert_eq!(depths, json!([0, 1, 1, 1]));

    // The drawing: 8 of 64 samples in two views, an endless reflection that fades, and names.
    let count = |selector: &str| {
        browser.evaluate(&format!("document.querySelectorAll(`#ray-drawing {selector}`).length"))
    };
    let lines = "[...document.querySelectorAll('#ray-drawing path.shadow[data-ray=\"0-0\"]')].filter(path => path.getAttribute('d').split('L').length === 2).length";
    assert_eq!(browser.evaluate(lines), json!(16));
    assert!(
        browser.evaluate("at('ray-notes').innerText").as_str().unwrap().starts_with("8 shadow rays to each")
    );
    assert_eq!(count("path.reflection.fade3"), json!(2));
    assert_eq!(count("path.occluded[data-ray='0-1']:not(.wide)"), json!(4), "lines and arrows");
    let label = browser.evaluate("at('ray-drawing').querySelector('svg').getAttribute('aria-label')");
    assert_eq!(label, json!("The rays of pixel 80, 45 in two views"));

    // Rows and lines highlight each other.
    let over = |selector: &str| {
        browser.evaluate(&format!("(document.querySelector(`{selector}`).dispatchEvent(new PointerEvent('pointerover', {{ bubbles: true }})), [...document.querySelectorAll('#rays .lit')].map(part => part.dataset.ray).filter((key, index, keys) => keys.indexOf(key) === index))"))
    };
    assert_eq!(over("#ray-tree .row[data-ray='0-1']"), json!(["0-1"]));
    assert_eq!(count("path.occluded.lit:not(.wide)"), json!(4));
    assert_eq!(over("#ray-drawing path.reflection"), json!(["1"]));
    assert_eq!(
        browser.evaluate("document.querySelector('#ray-tree .lit').innerText.split('\\n')[0]"),
        json!("reflection 1 sees the background")
    );
    assert_eq!(over("#ray-drawing svg"), json!([]));

    // Another sample has other rays.
    let drawn = browser.evaluate("at('ray-drawing').innerHTML");
    browser.evaluate("(at('ray-sample').value = 3, at('ray-sample').onchange(), true)");
    until(&browser, &format!("at('ray-drawing').innerHTML !== {drawn} && at('ray-sample').max === '3'"));

    // Beside the shapes, and during playback.
    let list = rows(&browser, [2, 2]);
    assert_eq!(list, ["camera ray sees the background\n100 % of its light"]);
    let before = browser.evaluate(requests);
    browser.evaluate("(document.activeElement.blur(), true)");
    browser.press(' ');
    until(&browser, "playing !== null && view.frame > 8");
    assert_eq!(browser.evaluate(requests), before);
    browser.press(' ');
    until(&browser, &format!("playing === null && {requests} > {before}"));
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn drawn_rays_are_those_of_the_space() {
    // In the view from above, each of the two coordinates grows to the right and upwards.
    for (space, camera, above, [right, up]) in [
        ("", CAMERA, "from above: x to the right, z upwards", [0, 2]),
        (
            "space: RightHanded,",
            "camera: (position: (0, 0, -5), target: (0, 0, 0))",
            "from above: z to the right, x upwards",
            [2, 0],
        ),
        (
            "space: RightHanded,",
            "camera: (position: (0, 5, 0), target: (0, 0, 0), up: (0, 0, 1))",
            "from above: x to the right, y upwards",
            [0, 1],
        ),
        (
            "",
            "camera: (position: (0, 5, 0), target: (0, 0, 0), up: (0, 0, 1))",
            "from above: y to the right, x upwards",
            [1, 0],
        ),
    ] {
        let preview = Preview::of(&SCENE.replace(CAMERA, &format!("{space} {camera}")));
        let Some(browser) = open(&preview) else { return };
        settle(&browser);
        browser.evaluate("(at('rays').open = true)");
        rows(&browser, [80, 45]);
        let names = browser.evaluate("[...document.querySelectorAll('#ray-drawing text')].map(text => text.textContent).filter(text => text.includes(':'))");
        assert_eq!(names[0], json!(above), "{names}");
        // The camera ray ends at the ball, and the light is at (4, 6, -4).
        let line = numbers(&browser, "#ray-drawing path.camera", &["d"]);
        let lamp = numbers(&browser, "#ray-drawing circle.lamp", &["cx", "cy"]);
        let eye: Vec<f64> = serde_json::from_value(
            browser.evaluate("(async () => (await (await post('camera')).json()).position)()"),
        )
        .unwrap();
        let light = [4.0, 6.0, -4.0];
        for (axis, page, sign) in [(right, 0, 1.0), (up, 1, -1.0)] {
            let scale = sign * (lamp[page] - line[page]) / (light[axis] - eye[axis]);
            assert!((1.0..100.0).contains(&scale), "{above} {axis} {scale}");
        }
        assert_eq!(browser.console(), json!([]));
    }
}

#[test]
fn many_rays_are_bounded() {
    let walls = "materials: { \"clay\": (k_a: 1, k_d: 0.5, color: (255, 255, 255), refractive: (k_t: 0.5, ior: 1.5), reflective: (k_r: 0.5)),";
    let scene = SCENE
        .replace("materials: { \"clay\": (k_a: 1, k_d: 0.5, color: (255, 120, 60)) }", &format!("quality: (depth: 12), {walls} }}"))
        .replace("entities: [", "entities: [(shape: Sphere(radius: 9), material: \"clay\"), (light: Point(intensity: (1, 1, 1)), transform: (translation: (-4, 2, -4))),");
    let preview = Preview::of(&scene);
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    browser.evaluate("(at('rays').open = true)");
    let list = rows(&browser, [80, 45]);
    let notes = browser.evaluate("at('ray-notes').innerText");
    let notes = notes.as_str().unwrap();
    assert!(
        list.len() == 500
            && notes.contains("more rays are not drawn.")
            && notes.contains("more lines are not listed."),
        "{} {notes}",
        list.len()
    );
    let lines: Value = browser.evaluate("document.querySelectorAll('#ray-drawing path').length");
    assert!(lines.as_u64().unwrap() < 8000, "{lines}");
}

#[test]
fn drawing_is_magnified_and_moved() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    browser.evaluate("(at('rays').open = true, probe([80, 45]), true)");
    // What stands above the drawing, once it is there, moves it.
    until(&browser, "at('ray-drawing').querySelector('svg') !== null && at('values').childElementCount > 0");
    until(&browser, "outline !== null && listing === null");
    browser.evaluate("(at('rays').scrollIntoView(), true)");
    until(&browser, "performance.now() - panelScrolled > 250");
    let seen = || numbers(&browser, "#ray-drawing svg", &["viewBox"]);
    let whole = seen();
    let box_of: [f64; 4] = serde_json::from_value(browser.evaluate(
        "(({ left, top, width, height }) => [left, top, width, height])(at('ray-drawing').getBoundingClientRect())",
    )).unwrap();
    let [left, top, width, height] = box_of;
    let (x, y) = ((left + 0.25 * width).round(), (top + 0.25 * height).round());
    // The unit under the pointer stays there.
    let under =
        |seen: &[f64]| [seen[0] + (x - left) / width * seen[2], seen[1] + (y - top) / height * seen[3]];
    let wheel = |up: f64| {
        until(&browser, "performance.now() - panelScrolled > 250");
        browser.evaluate(&format!("at('ray-drawing').dispatchEvent(new WheelEvent('wheel', {{ deltaY: {}, clientX: {x}, clientY: {y}, bubbles: true, cancelable: true }}))", -up))
    };
    assert_eq!(wheel(-100.0), json!(true), "the panel scrolls");
    assert_eq!(wheel(400.0), json!(false));
    let near = seen();
    assert!((near[2] * std::f64::consts::E - whole[2]).abs() < 0.1, "{near:?} {whole:?}");
    for (before, after) in under(&whole).into_iter().zip(under(&near)) {
        assert!((before - after).abs() < 0.5, "{before} {after}");
    }
    // The numbers of the axes are in view.
    let inside = "(box => [...document.querySelectorAll('#ray-drawing .near text')].map(text => text.getBoundingClientRect()).map(({ left, right, top, bottom }) => left > box.left - 1 && right < box.right + 1 && top > box.top - 1 && bottom < box.bottom + 1))(at('ray-drawing').getBoundingClientRect())";
    let inside: Vec<bool> = serde_json::from_value(browser.evaluate(inside)).unwrap();
    assert!(inside.len() > 2 && inside.iter().all(|inside| *inside), "{inside:?}");
    // A drag moves the drawing with the pointer, and a double click shows all of it.
    let to = |right: f64, down: f64| json!({ "type": "pointerMove", "duration": 50, "x": x + right, "y": y + down });
    let (press, release) =
        (json!({ "type": "pointerDown", "button": 0 }), json!({ "type": "pointerUp", "button": 0 }));
    browser.point(&[to(0.0, 0.0), press.clone(), to(10.0, 8.0), to(20.0, 16.0), release.clone()]);
    let moved = seen();
    assert!((near[0] - moved[0] - 20.0 * near[2] / width).abs() < 0.5, "{near:?} {moved:?}");
    assert!((near[1] - moved[1] - 16.0 * near[3] / height).abs() < 0.5, "{near:?} {moved:?}");
    browser.point(&[to(0.0, 0.0), press.clone(), release.clone(), press, release]);
    assert_eq!(seen(), whole);
    // The keyboard, which does not change the picture or the frame meanwhile.
    browser.evaluate("(at('ray-drawing').focus(), true)");
    browser.press('+');
    browser.press('+');
    assert!((seen()[2] * 2.25 - whole[2]).abs() < 0.1, "{:?}", seen());
    let before = seen();
    browser.press('\u{e014}');
    assert!(seen()[0] > before[0]);
    browser.press('-');
    browser.press('0');
    assert_eq!(seen(), whole);
    assert_eq!(browser.evaluate("[view.zoom, view.frame]"), json!([0, 0]));
    assert_eq!(browser.console(), json!([]));
}
