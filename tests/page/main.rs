//! Tests of the preview page in a real browser, and of the server with other clients. The page tests need chromedriver and Chromium;
//! without them, they print a message and pass.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

mod browser;
mod camera;
mod examples;
mod export;
mod gallery;
mod heat;
mod http;
mod lanes;
mod mistakes;
mod moving;
mod outline;
mod paths;
mod phone;
mod pixels;
mod rays;
mod studio;
mod warnings;

use std::fs;
use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::thread::{self, sleep};
use std::time::{Duration, Instant};

use browser::Browser;
use http::request;
use rayreel::EffectSet;
use rayreel::live::{DEFAULT_CACHE, Server, Session, SessionSettings, Watching};
use serde_json::json;
use tempfile::TempDir;

const AT_MOST: Duration = Duration::from_secs(60);

const SCENE: &str = r#"Scene(
    timeline: (fps: 10, duration: 2),
    film: (width: 160, height: 90),
    camera: (position: (0, 0, -5), target: (0, 0, 0)),
    ambient: (0.4, 0.4, 0.4),
    materials: { "clay": (k_a: 1, k_d: 0.5, color: (255, 120, 60)) },
    entities: [
        (name: "ball", shape: Sphere(radius: 1), material: "clay"),
        (light: Point(intensity: (1, 1, 1)), transform: (translation: (4, 6, -4))),
    ],
    animate: [(target: "ball", channel: Translation, track: Keys([(0, (0, 0, 0)), (2, (0, 0.5, 0))]))],
)"#;

/// A scene in a temporary folder, with a session and a server that show it.
struct Preview {
    folder: TempDir,
    session: Session,
    server: Option<Server>,
    port: u16,
}

impl Preview {
    fn new() -> Self {
        Self::of(SCENE)
    }

    fn of(text: &str) -> Self {
        Self::allowing(text, Vec::new())
    }

    /// Shows a scene without these warnings.
    fn allowing(text: &str, allowed: Vec<&'static str>) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("ball.ron"), text).unwrap();
        let session = session(&folder, allowed);
        let server = Server::start(0, session.handle()).unwrap();
        let port = server.address().port();
        Self { folder, session, server: Some(server), port }
    }

    fn save(&self, text: &str) {
        let path = |file| self.folder.path().join(file);
        fs::write(path("new"), text).unwrap();
        fs::rename(path("new"), path("ball.ron")).unwrap();
    }

    fn restart(&mut self) {
        self.server = None;
        self.session = session(&self.folder, Vec::new());
        self.server = Some(Server::start(self.port, self.session.handle()).unwrap());
    }
}

fn session(folder: &TempDir, allowed: Vec<&'static str>) -> Session {
    let scene = folder.path().join("ball.ron");
    Session::start(
        SessionSettings {
            scene,
            overrides: Vec::new(),
            without: EffectSet::default(),
            allowed,
            frame: 0,
            watching: Watching::Events,
            finish: false,
            cache: DEFAULT_CACHE,
            cache_folder: None,
            editor: None,
        },
        |_| {},
    )
}

/// Opens the page in a browser. Returns `None` without one.
fn open(preview: &Preview) -> Option<Browser> {
    open_at(preview.port)
}

/// Opens the page of a server in a browser. Returns `None` without one.
fn open_at(port: u16) -> Option<Browser> {
    let browser = Browser::start("1000,700");
    if let Some(browser) = &browser {
        browser.go(&format!("http://127.0.0.1:{port}/"));
    } else {
        println!("there is no chromedriver: the page was not tried");
    }
    browser
}

/// Waits until an expression in the page is true.
fn until(browser: &Browser, expression: &str) {
    let start = Instant::now();
    while browser.evaluate(expression) != json!(true) {
        assert!(start.elapsed() < AT_MOST, "{expression}\n{}", page_state(browser));
        sleep(Duration::from_millis(10));
    }
}

/// Waits until a picture is finished and, because they take space from it, the lanes of keys are there.
fn settle(browser: &Browser) {
    until(browser, "shown !== null && shown.full && (tracks !== null || !state.edits.possible)");
}

/// Returns what the page shows and what it waits for.
fn page_state(browser: &Browser) -> String {
    let variables = "JSON.stringify({ edits: state?.edits, reloads: state?.reloads, trying, changing, moving, unsaved, shown, view })";
    format!("{}\n{}", browser.evaluate("document.body.innerText"), browser.evaluate(variables))
}

#[test]
fn kept_frames_play_at_full_rate() {
    let preview = Preview::of(&SCENE.replace("fps: 10, duration: 2", "fps: 24, duration: 2"));
    let Some(browser) = open(&preview) else { return };
    until(&browser, "state !== null && state.cached.ranges.length === 1 && state.cached.ranges[0][1] === 47");
    let bar = browser.evaluate("getComputedStyle(at('kept')).backgroundImage + at('kept').title");
    assert!(bar.as_str().unwrap().contains("48 of 48 frames are finished"), "{bar}");
    // Every picture that is displayed during two rounds.
    browser.evaluate(
        "(window.seen = [], window.real = display, display = (image, picture) => {
            if (playing) seen.push([performance.now(), picture.frame, picture.full, image.naturalWidth]);
            real(image, picture);
        }, true)",
    );
    browser.press(' ');
    until(&browser, "seen.length >= 97");
    browser.press(' ');
    let seen = browser.evaluate("seen.slice(1, 97)");
    let seen: Vec<(f64, u32, bool, u32)> = serde_json::from_value(seen).unwrap();
    assert!(seen.iter().all(|(_, _, full, width)| *full && *width == 160));
    let steps = seen.windows(2).filter(|pair| (pair[0].1 + 1) % 48 == pair[1].1).count();
    // A busy machine may drop frames, but not most of them.
    assert!(steps > 47, "{seen:?}");
    until(&browser, "playing === null && shown.full && shown.frame === view.frame && requested === null");

    // An edit of the second half keeps the first.
    let edited = "(1, (0, 0.25, 0)), (2, (0, 1, 0))";
    let text =
        SCENE.replace("fps: 10, duration: 2", "fps: 24, duration: 2").replace("(2, (0, 0.5, 0))", edited);
    preview.save(&text);
    until(
        &browser,
        "state.reloads === 2 && state.cached.ranges.length === 1 && state.cached.ranges[0][1] === 47",
    );
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn values_and_views_are_changed_by_hand() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    let file = || fs::read_to_string(preview.folder.path().join("ball.ron")).unwrap();
    settle(&browser);

    // A drag turns the camera, and `Keep` writes the view.
    browser.drag("#film", (60, 25));
    until(
        &browser,
        "!at('unsaved').hidden && state.edits.tried.length === 2 && shown.full && shown.reloads > 1",
    );
    let notice = browser.evaluate("at('unsaved').firstChild.textContent");
    assert_eq!(notice, json!("Not in the file yet: camera: position, target"));
    assert_eq!(file(), SCENE);
    browser.click("#keep");
    until(&browser, "at('unsaved').hidden && state.edits.undoable === 1 && shown.full");
    let kept = file();
    let position = kept.split("position: (").nth(1).and_then(|rest| rest.split(')').next()).unwrap();
    let position: Vec<f64> = position.split(", ").map(|number| number.parse().unwrap()).collect();
    let distance = position.iter().map(|number| number * number).sum::<f64>().sqrt();
    assert!((distance - 5.0).abs() < 1e-5 && position[0].abs() > 0.5 && position[1] > 0.2, "{position:?}");
    assert_eq!(kept.split("target:").nth(1), SCENE.split("target:").nth(1));
    assert_eq!(browser.evaluate("view.spot"), json!(null), "a drag is not a click");

    // A click lists the values of the thing and of its material; sliders try them, and their release writes them.
    browser.click("#film");
    until(&browser, "document.querySelectorAll('#values .value').length >= 4");
    let set = |label: &str, text: &str, event: &str| {
        let found = format!(
            "[...document.querySelectorAll('#values input')].find(input => input.getAttribute('aria-label').endsWith('{label}'))"
        );
        browser.evaluate(&format!("(() => {{ const input = {found}; input.value = '{text}'; input.dispatchEvent(new Event('{event}')); return true; }})()"));
    };
    set("shape.radius", "1.5", "input");
    until(&browser, "state.edits.tried.length === 1 && shown.full");
    assert_eq!(file(), kept);
    set("shape.radius", "1.5", "change");
    until(&browser, "state.edits.tried.length === 0 && state.edits.undoable === 2 && shown.full");
    assert_eq!(file(), kept.replace("radius: 1)", "radius: 1.5)"));
    until(&browser, "[...document.querySelectorAll('#values input')].some(input => input.type === 'color')");
    set("color", "#00ff00", "input");
    set("color", "#00ff00", "change");
    until(&browser, "state.edits.undoable === 3 && shown.full && trying === null");
    let colored = kept.replace("radius: 1)", "radius: 1.5)").replace("(255, 120, 60)", "(0, 255, 0)");
    assert_eq!(file(), colored);

    // Discarding leaves the file, and undoing restores it to the byte.
    browser.drag("#film", (-40, 10));
    until(&browser, "!at('unsaved').hidden && shown.full");
    browser.click("#drop");
    until(&browser, "at('unsaved').hidden");
    assert_eq!(file(), colored);
    for left in (0..3).rev() {
        browser.click("#undo");
        until(&browser, &format!("state.edits.undoable === {left} && shown.full"));
    }
    assert_eq!(file(), SCENE);
    until(&browser, "at('undo').disabled");
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn values_of_included_files_are_not_changed() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    let list = "(async () => { await probe([80, 45]); await new Promise(done => setTimeout(done, 300)); return at('values').innerText; })()";
    let text = browser.evaluate(list);
    assert!(text.as_str().unwrap().contains("entity ball"), "{text}");
    // A ball of the same name in an included file hides the scene's own.
    let part = r#"(entities: [(name: "ball", shape: Sphere(radius: 0.9), transform: (translation: (0, 0, -2)), color: (0, 0, 255))])"#;
    fs::create_dir(preview.folder.path().join("parts")).unwrap();
    fs::write(preview.folder.path().join("parts/front.ron"), part).unwrap();
    preview.save(&SCENE.replacen(
        "Scene(",
        "Scene(include: [(file: \"parts/front.ron\", name: \"front\")],",
        1,
    ));
    until(&browser, "state.reloads === 2 && shown.full && shown.reloads === 2");
    let text = browser.evaluate(list);
    assert_eq!(text, json!("entity front/ball parts/front.ron:1\n\nIts values are changed in its own file."));
}

#[test]
fn page_shows_scrubs_plays_and_recovers() {
    let mut preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && at('now').naturalWidth === 160");

    // Scrubbing.
    browser.evaluate("(at('scrubber').value = 7, at('scrubber').dispatchEvent(new Event('input')), true)");
    until(
        &browser,
        "shown.full && shown.frame === 7 && at('moment').textContent.includes('frame 7 of 0–19')",
    );
    browser.press('\u{e014}');
    until(&browser, "shown.full && shown.frame === 8");

    // Playing, and stopping.
    browser.press(' ');
    until(&browser, "playing !== null && shown.frame > 10");
    browser.press(' ');
    until(&browser, "playing === null && shown.full && shown.frame === view.frame");
    browser.press('\u{e011}');
    until(&browser, "shown.full && shown.frame === 0");

    // A mistake over the last good picture, and its correction.
    preview.save(&SCENE.replace("\"clay\"),", "\"caly\"),"));
    until(&browser, "!at('wrong').hidden && at('wrong').innerText.includes('ball.ron:8')");
    until(&browser, "at('wrong').innerText.includes('^^^^^^') && at('now').naturalWidth === 160");
    preview.save(&SCENE.replace("radius: 1", "radius: 1.1"));
    until(&browser, "at('wrong').hidden && shown.full && shown.reloads === 2");

    // Comparison with the previous picture.
    browser.press('w');
    until(&browser, "at('film').classList.contains('wipe') && at('before').naturalWidth === 160");
    browser.press('w');

    // The panel of a pixel.
    browser.click("#film");
    until(&browser, "at('spot').innerText.includes('ball') && at('spot').innerText.includes('ball.ron:8')");

    // The costs of effects, and the error by the number of samples.
    browser.press('m');
    until(&browser, "at('needed').innerText.includes(' %') && !state.rendering");
    until(&browser, "!at('curve').hidden && at('plot').querySelectorAll('circle').length > 4");
    until(
        &browser,
        "/^As it is, with .* the frame is off by about .* of 255 steps/.test(at('worth').innerText)",
    );

    // The server stops and restarts with another scene, and the playhead stays.
    browser.evaluate(PIXEL);
    browser.press('\u{e014}');
    until(&browser, "shown.full && shown.frame === 1");
    preview.server = None;
    until(&browser, "at('status').classList.contains('wrong')");
    let before = browser.evaluate("[state.session, pixel()]");
    preview.save(&SCENE.replace("255, 120, 60", "0, 255, 0"));
    preview.restart();
    // The new session's first pictures have the numbers of the old session's.
    until(
        &browser,
        &format!("state.session !== {} && shown !== null && shown.full && shown.frame === 1", before[0]),
    );
    assert_ne!(browser.evaluate("pixel()"), before[1]);
}

/// Defines a function that reads a pixel, by default the middle one, of the picture on the page.
const PIXEL: &str = "(window.pixel = (right = 0.5, down = 0.5) => { const canvas = document.createElement('canvas'), image = at('now'); \
    canvas.width = image.naturalWidth; canvas.height = image.naturalHeight; \
    const context = canvas.getContext('2d'); context.drawImage(image, 0, 0); \
    return [...context.getImageData(Math.round(canvas.width * right), Math.round(canvas.height * down), 1, 1).data].join(); }, true)";

#[test]
fn failed_frames_can_be_left() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    let keys = "Keys([(0, (0, 0, 0)), (2, (0, 0.5, 0))])";
    preview.save(&SCENE.replace(keys, "Script(\"[0, 0.1 / (12 - frame), 0]\")"));
    until(&browser, "shown !== null && shown.full && shown.reloads === 2");
    browser.evaluate("(seek(11), true)");
    until(&browser, "shown.full && shown.frame === 11");
    browser.press('\u{e014}');
    until(&browser, "!at('wrong').hidden && state.frame === 12 && shown.frame === 11");
    browser.press('\u{e012}');
    until(&browser, "at('wrong').hidden && state.frame === 11 && view.frame === 11");
    browser.evaluate("(seek(12), seek(13), seek(15), true)");
    until(&browser, "at('wrong').hidden && shown.full && shown.frame === 15");
    // Playing stops at the failing frame, and continues from there.
    browser.evaluate("(seek(10), true)");
    until(&browser, "shown.full && shown.frame === 10");
    browser.press(' ');
    until(&browser, "playing === null && !at('wrong').hidden && view.frame === 12");
    browser.press(' ');
    until(&browser, "at('wrong').hidden && shown.frame > 13");
}

#[test]
fn two_pages_do_not_block_each_other() {
    let preview = Preview::new();
    let (Some(one), Some(other)) = (open(&preview), open(&preview)) else { return };
    for browser in [&one, &other] {
        until(browser, "shown !== null && shown.full");
    }
    for frame in 1..15 {
        one.evaluate(&format!("(seek({frame}), true)"));
        other.evaluate(&format!("(seek({}), true)", 19 - frame));
    }
    one.evaluate("(seek(17), true)");
    for browser in [&one, &other] {
        until(
            browser,
            "requested === null && scrubbed === null && shown.full && shown.frame === state.frame",
        );
    }
    one.evaluate("(seek(2), true)");
    until(&other, "shown.full && shown.frame === 2 && view.frame === 2");
}

/// Checks more pages than connections: a browser opens at most six connections to a server.
#[test]
fn many_pages_share_one_event_stream() {
    for kind in ["tab", "window"] {
        let preview = Preview::new();
        let Some(browser) = open(&preview) else { return };
        settle(&browser);
        let mut pages = Vec::new();
        for _ in 0..9 {
            pages.push(browser.open_another(kind));
            browser.go(&format!("http://127.0.0.1:{}/", preview.port));
            until(&browser, "state !== null");
        }
        preview.save(&SCENE.replace("radius: 1", "radius: 1.2"));
        for (frame, page) in (1..).zip(&pages) {
            browser.switch_to(page);
            until(&browser, "shown !== null && shown.full && shown.reloads === 2");
            browser.evaluate(&format!("(seek({frame}), true)"));
            until(&browser, &format!("shown.full && shown.frame === {frame} && requested === null"));
            browser.evaluate("(probe([80, 45]), true)");
            until(&browser, "at('spot').innerText.includes('clay')");
        }
    }
}

#[test]
fn panels_are_empty_before_the_first_picture() {
    let preview = Preview::of("Scene(");
    let Some(browser) = open(&preview) else { return };
    until(&browser, "!at('wrong').hidden && at('status').textContent === 'nothing to show yet'");
    let text = browser.evaluate("document.body.innerText");
    for hollow in ["rays", "0 k", "omitted", "0.00 ms"] {
        assert!(!text.as_str().unwrap().contains(hollow), "{hollow}: {text}");
    }
    preview.save(SCENE);
    browser.click("#time-panel summary");
    browser.click("#plan-panel summary");
    until(&browser, "shown !== null && shown.full && at('times').innerText.includes('rays')");
    until(&browser, "document.body.innerText.includes('others are omitted')");
}

#[test]
fn keys_do_not_hide_a_lost_server() {
    let mut preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    preview.server = None;
    until(&browser, "at('status').textContent === 'the server is away'");
    for key in ['w', 'b', 'l', 'f', '1', ' ', '\u{e014}', '\u{e012}', 'r', 'm', '.', ' '] {
        browser.press(key);
        browser.evaluate("(draw(), true)");
        assert_eq!(browser.evaluate("at('status').textContent"), json!("the server is away"), "{key:?}");
    }
    preview.restart();
    until(&browser, "at('status').textContent === '160 × 90'");
}

#[test]
fn another_scene_begins_with_its_own_frame() {
    let mut preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    browser.evaluate("(seek(7), probe([80, 45]), true)");
    until(&browser, "shown.full && shown.frame === 7 && view.spot !== null");
    // Restarting the same scene keeps the frame.
    preview.server = None;
    preview.restart();
    until(&browser, "shown !== null && shown.full && shown.frame === 7 && !away");
    preview.server = None;
    let scene = preview.folder.path().join("other.ron");
    fs::write(&scene, SCENE).unwrap();
    let settings = SessionSettings {
        scene,
        overrides: Vec::new(),
        without: EffectSet::default(),
        allowed: Vec::new(),
        frame: 5,
        watching: Watching::Events,
        finish: false,
        cache: DEFAULT_CACHE,
        cache_folder: None,
        editor: None,
    };
    preview.session = Session::start(settings, |_| {});
    preview.server = Some(Server::start(preview.port, preview.session.handle()).unwrap());
    until(&browser, "state.scene.endsWith('other.ron') && shown !== null && shown.full && !away");
    assert_eq!(browser.evaluate("[shown.frame, view.frame, view.spot]"), json!([5, 5, null]));
}

#[test]
fn pictures_keep_their_aspect_ratio() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    for (index, (width, height)) in [(90, 160), (200, 50), (60, 60), (60, 60)].into_iter().enumerate() {
        preview.save(
            &SCENE
                .replace("width: 160, height: 90", &format!("width: {width}, height: {height}"))
                .replace("radius: 1", &format!("radius: 1.{index}")),
        );
        until(&browser, &format!("shown.full && shown.reloads === {} && compared !== null", index + 2));
        for press in ["w", "b"] {
            browser.evaluate(&format!("(at({press:?} === 'w' ? 'wipe' : 'swap').click(), true)"));
            until(&browser, "at('before').complete && at('before').naturalWidth > 0");
            let shapes =
                "['now', 'before'].map(id => { const image = at(id), box = image.getBoundingClientRect();
                return Math.abs(box.width / box.height / (image.naturalWidth / image.naturalHeight) - 1); })";
            let off: Vec<f64> = serde_json::from_value(browser.evaluate(shapes)).unwrap();
            assert!(off.iter().all(|off| *off < 0.02), "{width} x {height}: {off:?}");
            // The previous picture lies within the film.
            let within = "(() => { const [film, before] = ['film', 'before'].map(id => at(id).getBoundingClientRect());
                return before.left > film.left - 1 && before.right < film.right + 1 && before.top > film.top - 1
                    && before.bottom < film.bottom + 1; })()";
            assert_eq!(browser.evaluate(within), json!(true));
        }
    }
}

#[test]
fn pixel_panel_describes_the_picture() {
    let preview = Preview::of(&SCENE.replacen("Scene(", "Scene(sampling: (samples: 16),", 1));
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    browser.evaluate(PIXEL);
    // Across the ball's edge, where samples differ.
    for i in (20..140).step_by(3) {
        browser.evaluate(&format!("(probe([{i}, 45]), true)"));
        until(&browser, &format!("at('spot').innerText.includes('{i}, 45')"));
        let bytes = browser.evaluate(&format!("pixel({i} / 160, 0.5).split(',').slice(0, 3).join(', ')"));
        let text = browser.evaluate("at('spot').innerText");
        assert!(text.as_str().unwrap().contains(bytes.as_str().unwrap()), "{i}: {bytes} {text}");
        assert!(text.as_str().unwrap().contains("mean of 16 samples"), "{text}");
    }
    browser.click("#film");
    until(&browser, "at('spot').innerText.includes('clay')");
}

#[test]
fn slow_pictures_show_their_progress() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && at('progress').hidden");
    let slow = SCENE.replace("width: 160, height: 90", "width: 1600, height: 900");
    preview.save(&slow.replacen("Scene(", "Scene(sampling: (samples: 24),", 1));
    until(&browser, "shown.reloads === 2 && shown.coarse && !at('progress').hidden");
    let mut seen = Vec::new();
    let start = Instant::now();
    while browser.evaluate("shown.full") != json!(true) {
        assert!(start.elapsed() < AT_MOST);
        seen.push(browser.evaluate("[at('progress').value, at('percent').textContent]"));
    }
    let values: Vec<f64> = seen.iter().filter_map(|seen| seen[0].as_f64()).collect();
    assert!(values.is_sorted() && values.last() > values.first(), "{values:?}");
    assert!(seen.iter().any(|seen| seen[1].as_str().unwrap().ends_with(" %")), "{seen:?}");
    until(&browser, "at('progress').hidden && at('percent').textContent === ''");
    let times = browser.evaluate("[0.031, 45.3, 999.6, 13533].map(duration)");
    assert_eq!(times, json!(["0.03 ms", "45.3 ms", "1.00 s", "13.53 s"]));
    // An edit interrupts the work after the picture.
    preview.save(SCENE);
    until(&browser, "shown.full && shown.reloads === 3");
}

#[test]
fn page_fits_phones_and_dark_mode_and_keeps_its_view() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    let background = || browser.evaluate("getComputedStyle(document.body).backgroundColor");
    let light = background();
    browser.emulate(
        "Emulation.setEmulatedMedia",
        &json!({
            "features": [{ "name": "prefers-color-scheme", "value": "dark" }]
        }),
    );
    assert_ne!(background(), light);

    // The frame and the size survive a reload of the page.
    browser.press('\u{e014}');
    browser.press('1');
    until(&browser, "shown.full && shown.frame === 1 && at('film').offsetWidth === 160");
    browser.evaluate("(location.reload(), true)");
    until(&browser, "shown !== null && shown.full && shown.frame === 1 && at('film').offsetWidth === 160");

    // On a phone nothing sticks out, and buttons are large enough for fingers.
    let phone = json!({ "width": 360, "height": 640, "deviceScaleFactor": 2, "mobile": true });
    browser.emulate("Emulation.setDeviceMetricsOverride", &phone);
    until(&browser, "innerWidth === 360 && document.documentElement.scrollWidth === 360");
    until(
        &browser,
        "[...document.querySelectorAll('button, select')].every(b => !b.offsetHeight || b.offsetHeight > 31)",
    );
    let sticks_out = "[...document.querySelectorAll('header *, #transport *')].some(e => e.getBoundingClientRect().right > 361)";
    assert_eq!(browser.evaluate(sticks_out), json!(false));
}

#[test]
fn only_this_machines_own_pages_are_served() {
    let preview = Preview::new();
    let host = format!("127.0.0.1:{}", preview.port);
    let get = |path: &str, headers: &[(&str, &str)]| request(preview.port, "GET", path, headers, "");
    let page = get("/", &[("Host", &host)]);
    assert_eq!(page.status, 200);
    assert!(page.head.contains("content-security-policy: default-src 'none'"), "{}", page.head);
    for stranger in [
        &[("Host", "elsewhere.example")][..],
        &[("Host", &host), ("Origin", "http://elsewhere.example")],
        &[("Host", &host), ("Sec-Fetch-Site", "cross-site")],
    ] {
        for path in ["/", "/state", "/events", "/picture/1"] {
            assert_eq!(get(path, stranger).status, 403, "{path} {stranger:?}");
        }
    }
    assert_eq!(get("/../Cargo.toml", &[("Host", &host)]).status, 404);
    assert_eq!(get("/picture/99", &[("Host", &host)]).status, 404);
    let post = |path: &str, body: &str| request(preview.port, "POST", path, &[("Host", &host)], body).status;
    assert_eq!(post("/view", r#"{"seek":{"frame":3}}"#), 204);
    assert_eq!(post("/view", r#"{"seek":{"frame":-3}}"#), 400);
    assert_eq!(post("/view", "\"everything\""), 400);
    assert_eq!(post("/probe", "[80, 45]"), 200);
    let start = Instant::now();
    while preview.session.handle().state().picture.is_none_or(|picture| picture.frame != 3) {
        assert!(start.elapsed() < AT_MOST);
        sleep(Duration::from_millis(10));
    }
}

/// Checks incomplete requests, which end in the head, in the body, or before any byte.
#[test]
fn incomplete_requests_time_out() {
    let preview = Preview::new();
    let host = format!("127.0.0.1:{}", preview.port);
    let head = format!("POST /view HTTP/1.1\r\nHost: {host}\r\nContent-Length: 20\r\n\r\n");
    let visitors: Vec<_> = ["", "GET", &head[..30], &head, &(head.clone() + "{")]
        .into_iter()
        .map(|begun| {
            let mut stream = TcpStream::connect(("127.0.0.1", preview.port)).unwrap();
            stream.write_all(begun.as_bytes()).unwrap();
            stream.set_read_timeout(Some(AT_MOST)).unwrap();
            thread::spawn(move || {
                let mut answer = Vec::new();
                // The connection ends, with or without a response.
                let end = stream.read_to_end(&mut answer);
                assert!(end.is_ok() || end.is_err_and(|error| error.kind() == ErrorKind::ConnectionReset));
            })
        })
        .collect();
    // A page's event stream stays open without a time limit.
    let mut page = TcpStream::connect(("127.0.0.1", preview.port)).unwrap();
    write!(page, "GET /events HTTP/1.1\r\nHost: {host}\r\n\r\n").unwrap();
    for visitor in visitors {
        visitor.join().unwrap();
    }
    sleep(Duration::from_secs(6));
    preview.save(&SCENE.replace("radius: 1", "radius: 1.3"));
    let mut received = String::new();
    let mut lines = BufReader::new(page);
    while !received.contains("\"reloads\":2") {
        received.clear();
        assert!(lines.read_line(&mut received).unwrap() > 0);
    }
    let large = "x".repeat(1 << 20);
    assert_eq!(request(preview.port, "POST", "/view", &[("Host", &host)], &large).status, 408);
}

#[test]
fn page_loads_nothing_from_other_hosts() {
    let preview = Preview::new();
    let host = format!("127.0.0.1:{}", preview.port);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/live/page");
    for file in fs::read_dir(folder).unwrap() {
        let file = file.unwrap();
        let (name, text) =
            (file.file_name().into_string().unwrap(), fs::read_to_string(file.path()).unwrap());
        for foreign in ["://", "//cdn", "@import"] {
            assert!(!text.contains(foreign), "{name}: {foreign}");
        }
        // Every file is served, with its content type.
        let path = if name == "page.html" { "/".to_owned() } else { format!("/{name}") };
        let answer = request(preview.port, "GET", &path, &[("Host", &host)], "");
        let kind = match name.rsplit_once('.').unwrap().1 {
            "html" => "text/html",
            "css" => "text/css",
            _ => "text/javascript",
        };
        assert!(answer.status == 200 && answer.body == text, "{name}: {}", answer.status);
        assert!(answer.head.contains(&format!("content-type: {kind}; charset=utf-8")), "{}", answer.head);
    }
}
