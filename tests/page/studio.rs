//! A scene is opened, played, seen from elsewhere, changed and rendered on the page; afterwards, its file is as if it had been edited by hand.
//!
//! With `RAYREEL_RECORDING=studio.mp4`, the page is recorded meanwhile.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::thread::sleep;
use std::time::{Duration, Instant};

use rayreel::output::MovieWriter;
use rayreel::time::FrameRate;
use rayreel::trace::EncodedFilm;
use serde_json::{Value, json};

use crate::browser::Browser;
use crate::moving::{grip_of, number_in_place_of, rested};
use crate::{AT_MOST, Preview, open, until};

const SCENE: &str = include_str!("studio.ron");
/// Frames per second of the recording, and its largest number of frames: two minutes.
const RATE: u32 = 10;
const MOST_FRAMES: u32 = 120 * RATE;

/// A person who works with the page, in view of a camera if there is a recording.
struct Person<'a> {
    browser: &'a Browser,
    recording: Option<MovieWriter>,
    start: Instant,
    recorded: u32,
}

impl<'a> Person<'a> {
    fn new(browser: &'a Browser) -> Self {
        let movie = std::env::var_os("RAYREEL_RECORDING").map(PathBuf::from);
        let rate = FrameRate::new(RATE, 1).unwrap();
        let recording = movie.map(|movie| MovieWriter::create(&movie, MOST_FRAMES, rate).unwrap());
        if recording.is_some() {
            // Screenshots have no pointer.
            browser.evaluate(
                "(() => {
                    const mark = document.body.appendChild(document.createElement('div'));
                    Object.assign(mark.style, { position: 'fixed', width: '18px', height: '18px', borderRadius: '50%', zIndex: 9,
                        background: '#e0402099', border: '2px solid #fff', pointerEvents: 'none', transform: 'translate(-50%, -50%)' });
                    addEventListener('pointermove', event => Object.assign(mark.style, { left: event.clientX + 'px', top: event.clientY + 'px' }), true);
                    return true;
                })()",
            );
        }
        Self { browser, recording, start: Instant::now(), recorded: 0 }
    }

    /// Takes the pictures that are due.
    fn record(&mut self) {
        let Some(recording) = &mut self.recording else { return };
        let due = u32::try_from(self.start.elapsed().as_millis()).unwrap() * RATE / 1000;
        if due <= self.recorded {
            return;
        }
        let picture = image::load_from_memory(&self.browser.screenshot()).unwrap().to_rgb8();
        let film = EncodedFilm::from_bytes(picture.width(), picture.height(), picture.as_raw()).unwrap();
        while self.recorded < due.min(MOST_FRAMES) {
            recording.add(film.clone(), &AtomicBool::new(false)).unwrap();
            self.recorded += 1;
        }
    }

    /// Looks at the page for some seconds, if there is a recording.
    fn look(&mut self, seconds: f64) {
        let start = Instant::now();
        while self.recording.is_some() && start.elapsed().as_secs_f64() < seconds {
            self.record();
            sleep(Duration::from_millis(5));
        }
    }

    fn until(&mut self, expression: &str) {
        let start = Instant::now();
        while self.browser.evaluate(expression) != json!(true) {
            self.record();
            assert!(start.elapsed() < AT_MOST, "{expression}");
            sleep(Duration::from_millis(10));
        }
    }

    /// Drags from a place of the page by some pixels, in steps.
    fn drag(&mut self, [x, y]: [f64; 2], [right, down]: [f64; 2]) {
        const STEPS: u32 = 12;
        let to = |step: u32| {
            let share = f64::from(step) / f64::from(STEPS);
            let [x, y] = [x + share * right, y + share * down].map(f64::round);
            json!({ "type": "pointerMove", "duration": 20, "x": x, "y": y })
        };
        self.browser.point(&[to(0), json!({ "type": "pointerDown", "button": 0 })]);
        for step in 1..=STEPS {
            self.browser.point(&[to(step)]);
            self.record();
            sleep(Duration::from_millis(20));
        }
        self.browser.point(&[json!({ "type": "pointerUp", "button": 0 })]);
    }

    /// Returns the middle of an element.
    fn middle(&self, selector: &str) -> [f64; 2] {
        let place = format!(
            "(({{ left, top, width, height }}) => [left + width / 2, top + height / 2])(document.querySelector('{selector}').getBoundingClientRect())"
        );
        serde_json::from_value(self.browser.evaluate(&place)).unwrap()
    }

    /// Changes the input of a value in steps, as by a slider, and releases it.
    fn set(&mut self, label: &str, values: &[&str]) {
        let input = format!(
            "[...document.querySelectorAll('#values input')].find(input => input.getAttribute('aria-label').endsWith('{label}'))"
        );
        self.until(&format!("{input} !== undefined"));
        self.browser.evaluate(&format!("({input}.scrollIntoView({{ block: 'center' }}), true)"));
        // The panel is drawn anew after every picture.
        let tell = |value: &str, event: &str| {
            format!(
                "(() => {{ const input = {input}; if (!input) return false; input.value = '{value}'; input.dispatchEvent(new Event('{event}')); return true; }})()"
            )
        };
        for value in values {
            self.until(&tell(value, "input"));
            self.look(0.15);
        }
        let undoable: Value = self.browser.evaluate("state.edits.undoable + 1");
        self.until(&tell(values.last().unwrap(), "change"));
        self.until(&format!("state.edits.undoable === {undoable} && trying === null && shown.full"));
    }

    fn finish(self) {
        if let Some(recording) = self.recording {
            recording.finish(&AtomicBool::new(false)).unwrap();
        }
    }
}

#[test]
fn film_is_made_on_the_page() {
    let preview = Preview::of(SCENE);
    let Some(browser) = open(&preview) else { return };
    let file = || fs::read_to_string(preview.folder.path().join("ball.ron")).unwrap();
    let mut person = Person::new(&browser);
    person.until("shown !== null && shown.full");
    person.look(3.0);

    // Play, once all frames are finished.
    person.until("state.cached.ranges.length === 1 && state.cached.ranges[0][1] === state.frames - 1");
    browser.press(' ');
    person.until("playing !== null && playing.local && view.frame > 40");
    person.look(6.0);
    browser.press(' ');
    person.until("playing === null && shown.full");
    person.look(1.0);

    // Turn the camera and keep the view.
    let middle = person.middle("#film");
    person.drag(middle, [-140.0, -30.0]);
    person.until("!at('unsaved').hidden && shown.full && trying === null");
    person.look(2.0);
    browser.click("#keep");
    person.until("at('unsaved').hidden && state.edits.undoable === 1 && shown.full");
    person.look(2.0);
    let turned = file();
    let position = turned.split("position: (").nth(1).and_then(|rest| rest.split(')').next()).unwrap();
    let placed = SCENE.replace("position: (0, 2.2, -7)", &format!("position: ({position})"));
    assert_eq!(turned, placed);

    // Change the radius and the colour of the ball.
    browser.evaluate("(seek(24), true)");
    person.until("shown.full && shown.frame === 24");
    browser.evaluate("(probe(film().map(size => size >> 1)), true)");
    person.until("document.querySelectorAll('#values .value').length > 2");
    let names = browser.evaluate(
        "[...document.querySelectorAll('#values section > .value span')].map(name => name.innerText)",
    );
    assert_eq!(names, json!(["radius", "k_a", "k_d", "color", "k_s", "shininess"]));
    person.look(2.0);
    person.set("shape.radius", &["0.95", "0.9", "0.85", "0.8", "0.75", "0.7", "0.65", "0.7", "0.75"]);
    person.look(1.5);
    person.set("color", &["#d03060", "#b03880", "#9040a0", "#6050b8", "#3060d0"]);
    let painted = placed.replace("radius: 1)", "radius: 0.75)").replace("(230, 90, 40)", "(48, 96, 208)");
    assert_eq!(file(), painted);
    person.look(2.0);

    // Drag the last key of the ball to two seconds.
    let keys = browser.evaluate("document.querySelectorAll('.key').length").as_u64().unwrap();
    let last = format!(".key[data-key=\"animate.0.track.0.{}\"]", keys - 1);
    let place = person.middle(&last);
    let per_frame =
        browser.evaluate("document.querySelector('.lane').clientWidth / lastFrame()").as_f64().unwrap();
    person.drag(place, [-12.0 * per_frame, 0.0]);
    person.until("state.edits.undoable === 4 && trying === null && moving === null");
    let moved = painted.replace("(2.5, (0, 1, 0))", "(2, (0, 1, 0))");
    assert_eq!(file(), moved);
    person.look(2.0);

    // Play it as it is now, and go back to where the ball was.
    browser.press(' ');
    person.until("playing !== null");
    person.look(3.0);
    browser.press(' ');
    person.until("playing === null && shown.full");
    browser.evaluate("(seek(24), true)");
    person.until("shown.full && shown.frame === 24");

    // Pull the crate by its arrow, look at where the samples and the rays go, and at the way of the camera.
    browser.evaluate("(select({ entity: 'crate' }), true)");
    rested(&browser, "crate");
    person.look(1.5);
    let arrow = grip_of(&browser, "x").map(f64::from);
    person.drag(arrow, [70.0, 0.0]);
    person.until("state.edits.undoable === 5 && state.edits.tried.length === 0");
    rested(&browser, "crate");
    let pulled = file();
    let right = number_in_place_of(&moved, "2.3", &pulled);
    assert!(right > 2.4, "{pulled}");
    person.look(2.0);
    for kind in ["rays", "error"] {
        browser.evaluate(&format!(
            "(view.heat || setHeat(), at('heat-kind').value = '{kind}', at('heat-kind').onchange({{ target: at('heat-kind') }}), true)"
        ));
        if kind == "error" {
            browser.click("#heat-measure");
        }
        person.until("heat !== null && !at('heat-map').hidden && !state.rendering");
        person.look(3.0);
    }
    browser.press('h');
    browser.press('c');
    person.until("!at('path-view').hasAttribute('hidden')");
    person.look(2.5);
    browser.press('c');
    let moved = pulled;

    // Render a part of it into a movie.
    browser.evaluate("(setRange('first', 30), setRange('last', 53), true)");
    browser.press('R');
    person.until("at('export-dialog').open");
    let movie = preview.folder.path().join("ball.gif");
    browser.evaluate(&format!("(at('export-target').value = {:?}, true)", movie.display().to_string()));
    person.look(2.5);
    browser.click("#export-start");
    person.until("state.export?.end === 'complete'");
    person.look(3.0);
    assert!(movie.is_file() && file() == moved);
    assert_eq!(browser.console(), json!([]));
    person.finish();
    until(&browser, "shown.full");
}
