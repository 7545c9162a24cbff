//! Latency from a save to the picture in a browser.
//!
//! `cargo bench --bench preview` edits a scene 50 times by renaming another file over it, and prints the milliseconds until headless
//! Chromium had decoded the coarse and the full picture. It needs chromedriver. `-- SCENE` measures another scene; each edit then changes a
//! comment at its end.
//!
//! `-- drag [SCENE]` prints the milliseconds from a movement of the pointer, which turns the camera, to a picture on the page. `-- play [SCENE]`
//! waits until all frames are finished, plays them twice, and prints how many were left out and the longest time between two.
//!
//! Divan is not used, unlike in other benches. It times calls in one process and reports medians; here a browser reports the times of
//! several events after one edit, and the slowest edits matter, by the 95th percentile.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a bench prints its table, and may fail loudly")]

use std::fs;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use serde_json::Value;

use rayreel::EffectSet;
use rayreel::live::{DEFAULT_CACHE, Server, Session, SessionSettings, Watching};

#[path = "../../tests/page/browser.rs"]
#[expect(dead_code, reason = "tests do more with it")]
mod browser;
#[path = "../../tests/page/http.rs"]
#[expect(dead_code, reason = "tests look at more of it")]
mod http;

use browser::Browser;

const EDITS: u64 = 50;
const CLASSIC: &str = include_str!("classic.ron");

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).peekable();
    let mode = arguments.next_if(|argument| ["drag", "play"].contains(&argument.as_str()));
    match (mode.as_deref(), arguments.next()) {
        (None, own) => saves(own.as_deref()),
        (Some("drag"), own) => drags(&own.map_or_else(|| "scenes/first_light.ron".into(), PathBuf::from)),
        (Some(_), own) => plays(&own.map_or_else(|| "scenes/first_light.ron".into(), PathBuf::from)),
    }
}

/// Shows a scene on a page.
fn show(scene: &Path, cache: usize) -> (Session, Server, Browser) {
    assert!(scene.is_file(), "there is no file {}", scene.display());
    let settings = SessionSettings {
        scene: scene.to_owned(),
        overrides: Vec::new(),
        without: EffectSet::default(),
        allowed: Vec::new(),
        frame: 0,
        watching: Watching::Events,
        finish: false,
        cache,
        cache_folder: None,
        editor: None,
    };
    let session = Session::start(settings, |_| ());
    let server = Server::start(0, session.handle()).unwrap();
    let browser = Browser::start("1500,1000").expect("chromedriver is needed");
    browser.go(&format!("http://{}/", server.address()));
    wait_for_full(&browser, 1);
    (session, server, browser)
}

/// Turns the camera by small movements of the pointer, and waits for a picture after each.
fn drags(scene: &Path) {
    let (_session, _server, browser) = show(scene, 0);
    browser.evaluate(
        "((async () => {
            const view = await currentView(), times = [], show = display;
            if (!view) { window.dragTimes = [NaN]; return; }
            let shown = null;
            display = (image, picture) => { show(image, picture); shown?.(picture); };
            for (let step = 1; step <= 25; step++) {
                const before = state.reloads, start = performance.now();
                const arrived = new Promise(resolve => { shown = picture => { if (picture.reloads > before) resolve(); }; });
                setView(view, movedView(view, 'orbit', 3 * step, step));
                await arrived;
                times.push(performance.now() - start);
                await new Promise(resolve => setTimeout(resolve, 60));
                await settled();
            }
            window.dragTimes = times.sort((one, other) => one - other);
        })(), true)",
    );
    wait_for(&browser, "window.dragTimes !== undefined");
    let times: Vec<Option<f64>> = serde_json::from_value(browser.evaluate("dragTimes")).unwrap();
    match times[times.len() / 2].zip(*times.last().unwrap()) {
        Some((median, most)) => {
            println!("{}: {median:.1} ms in the median, {most:.1} at most", scene.display());
        }
        None => println!("{}: the camera cannot be moved", scene.display()),
    }
}

/// Plays all frames twice.
fn plays(scene: &Path) {
    let (session, _server, browser) = show(scene, DEFAULT_CACHE);
    let start = Instant::now();
    wait_for(&browser, "state.cached.ranges.length === 1 && state.cached.ranges[0][1] === state.frames - 1");
    let filled = start.elapsed().as_secs_f64();
    browser.evaluate(
        "(() => {
            const show = display;
            window.seen = [];
            display = (image, picture) => { if (playing) seen.push([performance.now(), picture.frame]); show(image, picture); };
            play();
            return true;
        })()",
    );
    wait_for(
        &browser,
        "seen.length > 2 * state.frames || performance.now() - seen[0]?.[0] > 3e3 * state.frames / state.rate",
    );
    let seen: Vec<(f64, u32)> = serde_json::from_value(browser.evaluate("seen")).unwrap();
    let frames = session.handle().state().frames;
    let steps = seen.windows(2);
    let left_out: u32 = steps.clone().map(|pair| (pair[1].1 + frames - pair[0].1) % frames - 1).sum();
    let longest = steps.map(|pair| pair[1].0 - pair[0].0).fold(0.0, f64::max);
    let rate = 1e3 * (seen.len() - 1) as f64 / (seen[seen.len() - 1].0 - seen[0].0);
    println!(
        "{}: {} frames finished in {filled:.0} s; {} shown, {left_out} left out, {rate:.2} per second, {longest:.1} ms between two at most",
        scene.display(),
        frames,
        seen.len(),
    );
}

/// Edits a scene, the classic one by default, and waits for its pictures.
fn saves(own: Option<&str>) {
    let text = own.map_or_else(|| CLASSIC.to_owned(), |path| fs::read_to_string(path).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let (scene, other) = (folder.path().join("scene.ron"), folder.path().join("other"));
    fs::write(&scene, &text).unwrap();
    let (session, _server, browser) = show(&scene, 0);
    let mut times: [Vec<f64>; 8] = Default::default();
    for edit in 1..=EDITS {
        fs::write(&other, edited(&text, edit)).unwrap();
        sleep(Duration::from_millis(100));
        let start = SystemTime::now();
        fs::rename(&other, &scene).unwrap();
        let start = 1e3 * start.duration_since(UNIX_EPOCH).unwrap().as_secs_f64();
        wait_for_full(&browser, edit + 1);
        let decoded = |full: bool| {
            let found = browser.evaluate(&format!(
                "performance.getEntriesByName('picture').filter(mark => mark.detail.reloads === {} && mark.detail.full === {full})
                .map(mark => performance.timeOrigin + mark.startTime)[0]",
                edit + 1
            ));
            found.as_f64().unwrap() - start
        };
        let state = session.handle().state();
        let (coarse, full, own) = (decoded(false), decoded(true), state.times);
        let all = [coarse, full, full - own.trace, own.read, own.build, own.prepare, own.trace, own.encode];
        for (times, time) in times.iter_mut().zip(all) {
            times.push(time);
        }
    }
    println!("| milliseconds | median | 95th percentile |\n|---|---|---|");
    let names = [
        "coarse picture",
        "full picture",
        "full picture but for tracing",
        "read",
        "build",
        "prepare",
        "trace",
        "encode",
    ];
    for (name, mut times) in names.into_iter().zip(times) {
        times.sort_by(f64::total_cmp);
        println!("| {name} | {:.1} | {:.1} |", times[times.len() / 2], times[times.len() * 95 / 100]);
    }
}

/// Moves a ball and changes a colour; in any other scene, changes only a comment.
fn edited(text: &str, edit: u64) -> String {
    let moved = text.replacen("3.52823968", &format!("3.{edit:02}"), 1);
    moved.replacen("229.5", &format!("{}", 200 + edit), 1) + format!("// edit {edit}\n").as_str()
}

/// Waits until the full picture after `reloads` reloads is shown.
fn wait_for_full(browser: &Browser, reloads: u64) {
    wait_for(browser, &format!("shown !== null && shown.full && shown.reloads === {reloads}"));
}

/// Waits until an expression is true. Polls rarely, because each poll takes time too.
fn wait_for(browser: &Browser, expression: &str) {
    while browser.evaluate(expression) != Value::Bool(true) {
        sleep(Duration::from_millis(150));
    }
}
