//! The preview page in a real browser, and the server for whoever is not one. The former needs chromedriver and Chromium;
//! where they are not there, the tests say so and pass.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

mod page {
    pub(crate) mod browser;
    pub(crate) mod http;
}

use std::fs;
use std::thread::sleep;
use std::time::{Duration, Instant};

use page::browser::Browser;
use page::http::request;
use rayreel::live::{Server, Session, SessionSettings, Watching};
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

/// A scene in a folder of its own, on show.
struct Preview {
    folder: TempDir,
    session: Session,
    server: Option<Server>,
    port: u16,
}

impl Preview {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("ball.ron"), SCENE).unwrap();
        let session = session(&folder);
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
        self.session = session(&self.folder);
        self.server = Some(Server::start(self.port, self.session.handle()).unwrap());
    }
}

fn session(folder: &TempDir) -> Session {
    let scene = folder.path().join("ball.ron");
    Session::start(SessionSettings { scene, frame: 0, watching: Watching::Events, finish: false }, |_| {})
}

/// The page in a browser; `None` without one.
fn open(preview: &Preview) -> Option<Browser> {
    let browser = Browser::start("1000,700");
    if let Some(browser) = &browser {
        browser.go(&format!("http://127.0.0.1:{}/", preview.port));
    } else {
        println!("there is no chromedriver: the page was not tried");
    }
    browser
}

/// Waits until the page says so.
fn until(browser: &Browser, expression: &str) {
    let start = Instant::now();
    while browser.evaluate(expression) != json!(true) {
        assert!(start.elapsed() < AT_MOST, "{expression}\n{}", browser.evaluate("document.body.innerText"));
        sleep(Duration::from_millis(10));
    }
}

#[test]
fn the_page_shows_scrubs_plays_and_recovers() {
    let mut preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && at('now').naturalWidth === 160");

    // Scrub.
    browser.evaluate("(at('scrubber').value = 7, at('scrubber').dispatchEvent(new Event('input')), true)");
    until(
        &browser,
        "shown.full && shown.frame === 7 && at('moment').textContent.includes('frame 7 of 0–19')",
    );
    browser.press('\u{e014}');
    until(&browser, "shown.full && shown.frame === 8");

    // Play, and stop.
    browser.press(' ');
    until(&browser, "playing !== null && shown.frame > 10");
    browser.press(' ');
    until(&browser, "playing === null && shown.full && shown.frame === view.frame");
    browser.press('\u{e011}');
    until(&browser, "shown.full && shown.frame === 0");

    // A mistake, over the last good picture, and then none.
    preview.save(&SCENE.replace("\"clay\"),", "\"caly\"),"));
    until(&browser, "!at('wrong').hidden && at('wrong').innerText.includes('ball.ron:8')");
    until(&browser, "at('wrong').innerText.includes('^^^^^^') && at('now').naturalWidth === 160");
    preview.save(&SCENE.replace("radius: 1", "radius: 1.1"));
    until(&browser, "at('wrong').hidden && shown.full && shown.reloads === 2");

    // Before and after.
    browser.press('w');
    until(&browser, "at('film').classList.contains('wipe') && at('before').naturalWidth === 160");
    browser.press('w');

    // A pixel.
    browser.click("#film");
    until(&browser, "at('spot').innerText.includes('ball') && at('spot').innerText.includes('ball.ron:8')");

    // The server goes and comes back with another scene, and the playhead stays.
    browser.evaluate(PIXEL);
    browser.press('\u{e014}');
    until(&browser, "shown.full && shown.frame === 1");
    preview.server = None;
    until(&browser, "at('status').classList.contains('wrong')");
    let before = browser.evaluate("[state.session, pixel()]");
    preview.save(&SCENE.replace("255, 120, 60", "0, 255, 0"));
    preview.restart();
    // The new session's first pictures have numbers that the old one's had.
    until(
        &browser,
        &format!("state.session !== {} && shown !== null && shown.full && shown.frame === 1", before[0]),
    );
    assert_ne!(browser.evaluate("pixel()"), before[1]);
}

/// For the pixel in the middle of the picture on the screen, as the page shows it.
const PIXEL: &str = "(window.pixel = () => { const canvas = document.createElement('canvas'), image = at('now'); \
    canvas.width = image.naturalWidth; canvas.height = image.naturalHeight; \
    const context = canvas.getContext('2d'); context.drawImage(image, 0, 0); \
    return [...context.getImageData(canvas.width / 2, canvas.height / 2, 1, 1).data].join(); }, true)";

#[test]
fn a_frame_that_fails_can_be_left_again() {
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
    // Playing stops where it fails, and goes on from there.
    browser.evaluate("(seek(10), true)");
    until(&browser, "shown.full && shown.frame === 10");
    browser.press(' ');
    until(&browser, "playing === null && !at('wrong').hidden && view.frame === 12");
    browser.press(' ');
    until(&browser, "at('wrong').hidden && shown.frame > 13");
}

#[test]
fn two_pages_do_not_keep_each_other_waiting() {
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
        until(browser, "asked === null && scrubbed === null && shown.full && shown.frame === state.frame");
    }
    one.evaluate("(seek(2), true)");
    until(&other, "shown.full && shown.frame === 2 && view.frame === 2");
}

#[test]
fn the_page_fits_phones_and_the_dark_and_keeps_its_view() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full");
    let background = || browser.evaluate("getComputedStyle(document.body).backgroundColor");
    let light = background();
    browser.emulate(
        "Emulation.setEmulatedMedia",
        &json!({
            "features": [{ "name": "prefers-color-scheme", "value": "dark" }]
        }),
    );
    assert_ne!(background(), light);

    // Another frame and another size survive that the page is opened again.
    browser.press('\u{e014}');
    browser.press('1');
    until(&browser, "shown.full && shown.frame === 1 && at('film').offsetWidth === 160");
    browser.evaluate("(location.reload(), true)");
    until(&browser, "shown !== null && shown.full && shown.frame === 1 && at('film').offsetWidth === 160");

    // A phone: nothing sticks out, and fingers find what they want.
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

#[test]
fn the_page_needs_nothing_from_elsewhere() {
    let page = include_str!("../src/live/page.html");
    for foreign in ["http://", "https://", "//cdn", "@import", "<script src", "<link rel=\"stylesheet\""] {
        assert!(!page.contains(foreign), "{foreign}");
    }
}
