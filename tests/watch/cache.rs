//! Tests of the finished frames that a session keeps for playback and for edits that are undone.

use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::Instant;

use rayreel::Engine;
use rayreel::live::{Detail, Event, Handle, Reply, SessionCommand, State, ViewChange};
use rayreel::output::encode_quickly;
use rayreel::trace::TileStats;

use crate::AT_MOST;
use crate::session::{Stage, scene};

pub(crate) const ROOM: usize = 1 << 24;
pub(crate) const FRAMES: u32 = 20;

/// Returns the test's scene, whose ball rests for a second and then rises to `height`.
pub(crate) fn resting(height: f64) -> String {
    let keys = format!("Keys([(0, (0, 0, 0)), (1, (0, 0, 0)), (2, (0, {height:?}, 0))])");
    let text = scene(1.0, "").replace("Keys([(0, (0, 0, 0)), (2, (0, 1, 0))])", &keys);
    assert!(text.contains(&keys));
    text
}

/// Waits for a state that satisfies a condition.
fn until(stage: &Stage, what: &str, condition: impl Fn(&State) -> bool) -> State {
    let (start, handle) = (Instant::now(), stage.session().handle());
    loop {
        let state = handle.state();
        if condition(&state) {
            return state;
        }
        assert!(start.elapsed() < AT_MOST, "{what}: {state:?}");
        std::thread::yield_now();
    }
}

pub(crate) fn until_all_are_kept(stage: &Stage, reloads: u64) -> Vec<Arc<[u8]>> {
    let is_filled = |state: &State| {
        state.reloads == reloads && state.cached.ranges == [(0, FRAMES - 1)] && !state.rendering
    };
    let state = until(stage, "all frames are kept", is_filled);
    frames(&stage.session().handle(), state.cached.generation)
}

fn frames(handle: &Handle, generation: u64) -> Vec<Arc<[u8]>> {
    (0..FRAMES).map(|frame| handle.frame(generation, frame).unwrap()).collect()
}

/// Compares pictures with those of a cold start.
fn assert_cold(stage: &Stage, pictures: &[Arc<[u8]>]) {
    let mut cold = Engine::load(stage.path("ball.ron")).unwrap();
    for (frame, png) in (0..).zip(pictures) {
        let film = cold.render_frame(frame).unwrap();
        assert!(**png == *encode_quickly(&film, cold.effective_settings().film.transfer).unwrap(), "{frame}");
    }
}

fn seek(stage: &Stage, frame: u32, playing: bool) {
    stage.session().handle().send(SessionCommand::ViewChange(ViewChange::Seek { frame, playing }));
}

#[test]
fn idle_session_finishes_all_frames_and_an_edit_keeps_the_unchanged_ones() {
    let stage = Stage::caching(Some(&resting(1.0)), false, ROOM);
    let first = until_all_are_kept(&stage, 1);
    assert_cold(&stage, &first);
    // Equal frames share a picture.
    assert!(Arc::ptr_eq(&first[0], &first[10]) && first[10] != first[11]);

    stage.save(&resting(2.0));
    let edited = until_all_are_kept(&stage, 2);
    assert_cold(&stage, &edited);
    for frame in 0..FRAMES as usize {
        assert_eq!(Arc::ptr_eq(&first[frame], &edited[frame]), frame <= 10, "{frame}");
    }
    let generation = stage.session().handle().state().cached.generation;
    assert!(stage.session().handle().frame(generation - 1, 0).is_none(), "of the scene before the edit");

    stage.save(&resting(1.0));
    let undone = until_all_are_kept(&stage, 3);
    assert!(first.iter().zip(&undone).all(|(first, undone)| Arc::ptr_eq(first, undone)));
}

#[test]
fn kept_frames_are_shown_at_once_and_described_exactly() {
    let stage = Stage::caching(Some(&resting(1.0)), false, ROOM);
    until_all_are_kept(&stage, 1);
    stage.matches_a_cold_start();
    assert!(stage.events_within(std::time::Duration::from_millis(10)).is_empty(), "nothing is shown");
    for (frame, playing) in [(15, true), (16, true), (12, false)] {
        seek(&stage, frame, playing);
        let is_shown = |state: &State| state.picture.is_some_and(|picture| picture.frame == frame);
        let state = until(&stage, "the frame is shown", is_shown);
        let picture = state.picture.unwrap();
        assert!(picture.full && !picture.coarse && (picture.width, picture.height) == (64, 36));
        assert!(
            !state.rendering && state.plan.iter().any(|planned| planned.needed) && state.times.trace > 0.0
        );
        let shown = stage.session().handle().picture(picture.id).unwrap();
        assert!(Arc::ptr_eq(
            &shown.png,
            &stage.session().handle().frame(state.cached.generation, frame).unwrap()
        ));
    }
    // A description needs the film, which is rendered for it.
    let probe = || {
        let (sender, reply) = channel();
        let send = move |info| sender.send(info).unwrap();
        stage.session().handle().send(SessionCommand::Probe((32, 18), Reply(Box::new(send))));
        reply.recv_timeout(AT_MOST).unwrap().unwrap()
    };
    probe();
    let shown = stage.matches_a_cold_start();
    assert_eq!((shown.info.frame, probe().linear), (12, shown.film.pixel(32, 18).to_array()));
}

#[test]
fn drafts_are_kept_apart_from_full_pictures() {
    let stage = Stage::caching(Some(&resting(1.0)), false, ROOM);
    let full = until_all_are_kept(&stage, 1);
    let set = |detail| stage.session().handle().send(SessionCommand::ViewChange(ViewChange::Detail(detail)));
    set(Detail::Half);
    // The frames of another quality are another generation.
    let begins = |generation: u64| {
        until(&stage, "another quality", |state| state.cached.generation == generation);
    };
    begins(2);
    let half = until_all_are_kept(&stage, 1);
    assert!(half.iter().zip(&full).all(|(half, full)| half != full));
    let info = until(&stage, "a draft", |state| state.picture.is_some_and(|picture| !picture.coarse)).picture;
    assert!(info.is_some_and(|info| !info.full && info.width == 32));
    set(Detail::Full);
    begins(3);
    until(&stage, "full", |state| state.picture.is_some_and(|picture| picture.full));
    let again = until_all_are_kept(&stage, 1);
    assert!(again.iter().zip(&full).all(|(again, full)| Arc::ptr_eq(again, full)));
}

#[test]
fn size_is_bounded_and_frames_ahead_are_kept() {
    let whole = Stage::caching(Some(&scene(1.0, "")), false, ROOM);
    let all = until_all_are_kept(&whole, 1);
    let most = all.iter().map(|png| png.len()).max().unwrap();
    // The statistics of the 4 by 3 tiles are kept, too.
    let size = most + 4 * 3 * size_of::<TileStats>();
    let stage = Stage::caching(Some(&scene(1.0, "")), false, 6 * size);
    let is_filled =
        |state: &State| state.cached.ranges.first().is_some_and(|(first, last)| last - first >= 5);
    let near = until(&stage, "some frames are kept", is_filled);
    assert!(near.cached.ranges[0].0 == 0 && near.cached.ranges[0].1 < FRAMES - 1, "{:?}", near.cached);
    seek(&stage, 10, false);
    let follows = |state: &State| state.cached.ranges.iter().any(|(first, last)| *first <= 10 && *last >= 15);
    let state = until(&stage, "the frames ahead are kept", follows);
    let count: u32 = state.cached.ranges.iter().map(|(first, last)| last - first + 1).sum();
    assert!(count < FRAMES, "{:?}", state.cached);
}

#[test]
fn film_of_every_still_frame_is_rendered_for_a_file() {
    let stage = Stage::caching(Some(&resting(1.0)), true, ROOM);
    stage.matches_a_cold_start();
    until_all_are_kept(&stage, 1);
    seek(&stage, 15, false);
    assert_eq!(stage.matches_a_cold_start().info.frame, 15);
    stage.save(&resting(2.0));
    stage.matches_a_cold_start();
    stage.save(&resting(1.0));
    loop {
        match stage.next() {
            Event::Shown(shown) if shown.info.full && shown.info.reloads == 3 => break,
            _ => {}
        }
    }
}

#[test]
fn frame_that_fails_is_skipped() {
    let fails_at_7 = r#"Script("if frame == 7 { throw `no` } [0, 0.1 * t, 0]")"#;
    let text = scene(1.0, "").replace("Keys([(0, (0, 0, 0)), (2, (0, 1, 0))])", fails_at_7);
    let stage = Stage::caching(Some(&text), false, ROOM);
    until(&stage, "the others are kept", |state| state.cached.ranges == [(0, 6), (8, FRAMES - 1)]);
    seek(&stage, 7, true);
    until(&stage, "the reason is shown", |state| state.frame_mistakes.is_some());
    seek(&stage, 8, true);
    until(&stage, "the next frame is shown", |state| {
        state.frame_mistakes.is_none()
            && state.picture.is_some_and(|picture| picture.full && picture.frame == 8)
    });
}
