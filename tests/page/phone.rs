//! Tests of the page on a phone.

use std::fs;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::browser::Browser;
use crate::{AT_MOST, Preview, SCENE, open, until};

fn open_on_phone(preview: &Preview) -> Option<Browser> {
    let browser = open(preview)?;
    let phone = json!({ "width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": true });
    browser.emulate("Emulation.setDeviceMetricsOverride", &phone);
    browser.emulate("Emulation.setTouchEmulationEnabled", &json!({ "enabled": true }));
    until(&browser, "shown !== null && shown.full && innerWidth === 390");
    Some(browser)
}

/// Touches the page with fingers at these places.
fn touch(browser: &Browser, kind: &str, places: &[[f64; 2]]) {
    let point = |(id, [x, y]): (usize, &[f64; 2])| json!({ "x": x, "y": y, "id": id });
    let points: Vec<Value> = places.iter().enumerate().map(point).collect();
    browser.emulate("Input.dispatchTouchEvent", &json!({ "type": kind, "touchPoints": points }));
}

fn middle(browser: &Browser, selector: &str) -> [f64; 2] {
    let place = format!(
        "(({{ left, top, width, height }}) => [left + width / 2, top + height / 2])(document.querySelector('{selector}').getBoundingClientRect())"
    );
    serde_json::from_value(browser.evaluate(&place)).unwrap()
}

#[test]
fn phone_shows_picture_and_values_together_with_large_targets() {
    let preview = Preview::new();
    let Some(browser) = open_on_phone(&preview) else { return };
    let fits = || {
        assert_eq!(browser.evaluate("document.documentElement.scrollWidth"), json!(390));
        let small = "[...document.querySelectorAll('button, select, input, summary, #gizmo g')]
            .map(one => [one.outerHTML, (one.querySelector('circle') ?? one).getBoundingClientRect()])
            .filter(([, box]) => box.width > 0 && Math.min(box.width, box.height) < 40)";
        assert_eq!(browser.evaluate(small), json!([]));
    };
    let header = || browser.evaluate("document.querySelector('header').offsetHeight").as_u64().unwrap();
    assert!(header() < 60, "one row: {}", header());
    fits();
    browser.click("#tools");
    until(&browser, "at('fit').offsetHeight > 0 && at('tools').getAttribute('aria-expanded') === 'true'");
    browser.evaluate("(setHeat(), view.heatKind = 'error', draw(), drawHeat(), true)");
    until(&browser, "heat !== null && !at('heat-measure').hidden");
    fits();
    browser.evaluate("(setHeat(), true)");
    browser.click("#tools");
    browser.click("#more");
    until(
        &browser,
        "at('export-open').offsetHeight > 0 && at('more').getAttribute('aria-expanded') === 'true'",
    );
    fits();
    browser.click("#more");
    browser.evaluate("(at('keyed').click(), probe([80, 45]), true)");
    until(&browser, "at('values').children.length > 0 && !at('lanes').hidden");
    fits();
    // At every value the picture is visible, above it. Scrolling rounds to pixels.
    let together = "[...document.querySelectorAll('#values input')].map(input => {
        input.scrollIntoView({ block: 'start' });
        const picture = at('now').getBoundingClientRect(), box = input.getBoundingClientRect();
        return picture.top >= 0 && picture.height > 150 && picture.bottom < box.top + 1 && box.bottom < at('transport').getBoundingClientRect().top + 1; })";
    let together: Vec<bool> = serde_json::from_value(browser.evaluate(together)).unwrap();
    assert!(together.len() > 3 && together.iter().all(|together| *together), "{together:?}");
    // Playing and undoing are at hand wherever the page is scrolled to.
    for place in [0, 100_000] {
        browser.evaluate(&format!("(scrollTo(0, {place}), true)"));
        let hidden = "['play', 'undo', 'redo', 'scrubber'].filter(id => { const box = at(id).getBoundingClientRect();
            return box.top < 0 || box.bottom > innerHeight || document.elementFromPoint(box.left + box.width / 2, box.top + box.height / 2)?.closest('button, input') !== at(id); })";
        assert_eq!(browser.evaluate(hidden), json!([]));
    }
    assert_eq!(browser.evaluate("[at('time-panel').open, at('plan-panel').open]"), json!([false, false]));
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn fingers_move_the_selected_entity() {
    let scene = format!("{})", SCENE.split("    animate").next().unwrap());
    let preview = Preview::of(&scene);
    let Some(browser) = open_on_phone(&preview) else { return };
    browser.evaluate("(select({ entity: 'ball' }), true)");
    until(&browser, "placement?.anchor && !document.querySelector('.handle.x').hasAttribute('hidden')");
    let widths = "[...document.querySelectorAll('.handle .touch')].map(touch => parseFloat(getComputedStyle(touch).strokeWidth))";
    let widths: Vec<f64> = serde_json::from_value(browser.evaluate(widths)).unwrap();
    assert!(widths.len() == 4 && widths.iter().all(|width| *width >= 40.0), "{widths:?}");
    // The end of an arrow is taken from 18 pixels beside it, and the page does not scroll.
    let place = "((box, touch) => { const { x, y } = touch.getPointAtLength(touch.getTotalLength()); return [box.left + x, box.top + y + 18]; })(at('film').getBoundingClientRect(), document.querySelector('.handle.x .touch'))";
    let [x, y]: [f64; 2] = serde_json::from_value(browser.evaluate(place)).unwrap();
    touch(&browser, "touchStart", &[[x, y]]);
    touch(&browser, "touchMove", &[[x - 10.0, y + 5.0]]);
    touch(&browser, "touchMove", &[[x - 40.0, y + 30.0]]);
    until(&browser, "state.edits.tried.length === 1 && trying === null");
    assert_eq!(browser.evaluate("scrollY"), json!(0));
    touch(&browser, "touchEnd", &[]);
    until(&browser, "state.edits.undoable === 1 && state.edits.tried.length === 0");
    let kept = fs::read_to_string(preview.folder.path().join("ball.ron")).unwrap();
    let (_, translation) = kept.split_once("transform: (translation: (").unwrap();
    let x: f64 = translation.split(',').next().unwrap().parse().unwrap();
    let expected = scene.replace(
        "material: \"clay\"),",
        &format!("material: \"clay\", transform: (translation: ({x}, 0, 0))),"),
    );
    assert!(kept == expected && x < -0.2, "{kept}");
    // The page learns the place with the next picture.
    until(&browser, &format!("placement.position[0] === {x}"));
    assert_eq!(browser.evaluate("[view.selected.entity, view.spot]"), json!(["ball", null]));
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn fingers_drag_keys_and_magnify_the_drawing_of_rays() {
    let preview = Preview::new();
    let Some(browser) = open_on_phone(&preview) else { return };
    browser.click("#more");
    browser.click("#keyed");
    until(&browser, "document.querySelectorAll('.key').length === 2");
    let [x, y] = middle(&browser, ".key");
    let frame =
        browser.evaluate("document.querySelector('.lane').clientWidth / lastFrame()").as_f64().unwrap();
    touch(&browser, "touchStart", &[[x, y]]);
    touch(&browser, "touchMove", &[[x + 4.0 * frame, y]]);
    touch(&browser, "touchMove", &[[x + 8.0 * frame, y]]);
    until(&browser, "at('key-time').textContent === '0.80 s · frame 8' && !at('key-time').hidden");
    touch(&browser, "touchEnd", &[]);
    let start = Instant::now();
    let wanted = SCENE.replace("(0, (0, 0, 0))", "(0.8, (0, 0, 0))");
    while fs::read_to_string(preview.folder.path().join("ball.ron")).unwrap() != wanted {
        assert!(start.elapsed() < AT_MOST);
        sleep(Duration::from_millis(10));
    }

    browser.evaluate("(at('rays').open = true, probe([80, 45]), true)");
    until(&browser, "at('ray-drawing').querySelector('svg') !== null && trying === null");
    browser.evaluate("(at('rays').scrollIntoView(), true)");
    let [x, y] = middle(&browser, "#ray-drawing .camera");
    touch(&browser, "touchStart", &[[x - 30.0, y], [x + 30.0, y]]);
    touch(&browser, "touchMove", &[[x - 40.0, y], [x + 40.0, y]]);
    touch(&browser, "touchMove", &[[x - 60.0, y], [x + 60.0, y]]);
    until(&browser, "Math.abs(rayMagnifier.part.zoom - 2) < 0.05");
    touch(&browser, "touchEnd", &[]);
    // What was between the fingers is still there.
    let [now_x, now_y] = middle(&browser, "#ray-drawing .camera");
    assert!((now_x - x).abs() < 4.0 && (now_y - y).abs() < 4.0, "{now_x} {now_y} {x} {y}");
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn notices_leave_the_middle_of_the_picture_free() {
    let preview = Preview::new();
    let Some(browser) = open_on_phone(&preview) else { return };
    browser.click("#tools");
    browser.evaluate("(setHeat(), orient(), attempt(['materials.clay.k_d=0.6']), true)");
    until(
        &browser,
        "!at('unsaved').hidden && !at('heat-legend').hidden && !at('gizmo').hasAttribute('hidden') && shown.full && trying === null",
    );
    let covering = "['unsaved', 'heat-legend', 'gizmo', 'refused'].filter(id => at(id).getBoundingClientRect().height > 0).filter(id => {
        const box = at(id).getBoundingClientRect(), picture = at('film').getBoundingClientRect();
        const [left, right, top, bottom] = [picture.left + picture.width / 3, picture.right - picture.width / 3, picture.top + picture.height / 3, picture.bottom - picture.height / 3];
        return box.left < right && box.right > left && box.top < bottom && box.bottom > top; })";
    assert_eq!(browser.evaluate(covering), json!([]));
    browser.evaluate("(write(at('refused'), 'a reason that takes more than the width of a phone to be told, and then some'), true)");
    assert_eq!(browser.evaluate("at('refused').offsetHeight > 20"), json!(true));
    assert_eq!(browser.evaluate(covering), json!([]));
    let notice = browser.evaluate("at('unsaved').firstChild.textContent");
    assert_eq!(notice, json!("Not in the file yet: clay: k_d"));
    assert_eq!(browser.console(), json!([]));
}
