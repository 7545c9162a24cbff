//! Tests of files that are saved in quick succession, saved slowly, or unreadable for a while.

use std::fs;
use std::io::Write;
use std::thread::sleep;
use std::time::{Duration, Instant};

use rayreel::live::Event;

use crate::session::{Stage, scene};

/// Time between saves, for some 60 saves per second.
const OFTEN: Duration = Duration::from_millis(16);
const FOR: Duration = Duration::from_secs(3);

/// Saves as often as a simulation writes its frames. Returns the number of reloads that were shown, and of errors.
fn saved_often(save: impl Fn(&Stage, &str)) -> (usize, usize) {
    let stage = Stage::new(Some(&scene(1.0, "")));
    stage.matches_a_cold_start();
    let start = Instant::now();
    let mut radius = 0.5;
    while start.elapsed() < FOR {
        radius += 0.001;
        save(&stage, &scene(radius, ""));
        sleep(OFTEN);
    }
    let mut events = stage.events_within(Duration::from_secs(1));
    // The last picture shows the last save, also on a busy machine.
    let last = rayreel::Engine::load(stage.path("ball.ron")).unwrap().render_frame(0).unwrap();
    let is_current = |events: &[Event]| {
        let full = events.iter().rev().find_map(|event| match event {
            Event::Shown(shown) if shown.info.full => Some(&shown.film),
            _ => None,
        });
        full.is_some_and(|film| **film == last)
    };
    while !is_current(&events) && start.elapsed() < FOR + Duration::from_secs(10) {
        events.extend(stage.events_within(Duration::from_millis(250)));
    }
    assert!(is_current(&events));
    let broken = events.iter().filter(|event| matches!(event, Event::Broken(_))).count();
    let mut shown: Vec<u64> = events
        .iter()
        .filter_map(|event| if let Event::Shown(shown) = event { Some(shown.info.reloads) } else { None })
        .collect();
    shown.dedup();
    (shown.len(), broken)
}

#[test]
fn continuous_saves_in_place_are_shown_without_mistakes() {
    let (shown, broken) = saved_often(|stage, text| fs::write(stage.path("ball.ron"), text).unwrap());
    assert!(shown > 6 && broken == 0, "{shown} shown, {broken} reported as mistakes");
}

#[test]
fn continuous_renames_are_shown_several_times_a_second() {
    let (shown, broken) = saved_often(Stage::save);
    assert!(shown > 9 && broken == 0, "{shown} shown, {broken} reported as mistakes");
}

/// Checks files that are written in pieces of several sizes, with several pauses.
#[test]
fn partially_written_files_are_not_reported() {
    let stage = Stage::new(Some(&scene(1.0, "")));
    stage.matches_a_cold_start();
    for (radius, (pieces, pause)) in
        [0.5, 0.6, 0.7, 0.8].into_iter().zip([(2, 60), (5, 60), (12, 40), (30, 8)])
    {
        let text = scene(radius, "");
        stage.events_within(Duration::from_millis(200));
        let (mut last, mut longest) = (Instant::now(), Duration::ZERO);
        let mut file = fs::File::create(stage.path("ball.ron")).unwrap();
        for piece in text.as_bytes().chunks(text.len().div_ceil(pieces)) {
            sleep(Duration::from_millis(pause));
            file.write_all(piece).unwrap();
            file.flush().unwrap();
            longest = longest.max(last.elapsed());
            last = Instant::now();
        }
        if longest < Duration::from_millis(90) {
            stage.matches_a_cold_start();
        } else {
            // The machine was busy, and the file did not change for too long.
            stage.converges_to_a_cold_start();
        }
    }
    // A lasting error is reported, and only once.
    fs::write(stage.path("ball.ron"), "Scene(").unwrap();
    let events = stage.events_within(Duration::from_secs(3));
    assert_eq!(events.iter().filter(|event| matches!(event, Event::Broken(_))).count(), 1, "{events:?}");
}
