//! Tests of the finished frames that a session keeps in a folder for the next one and for `render`.

use std::fs;
use std::io::Cursor;
use std::ops::ControlFlow::Continue;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use rayreel::Engine;
use rayreel::live::{Event, SceneEdit, State};
use rayreel::output::{FrameFormat, Sequence, encode};
use rayreel::sequence::{SequenceReport, render_sequence};
use rayreel::time::FrameList;

use crate::cache::{FRAMES, ROOM, resting, until_all_are_kept};
use crate::edits::{attempt, edit};
use crate::session::Stage;

/// Starts a session with the folder `frames`.
fn storing(text: Option<&str>) -> Stage {
    Stage::storing(text, false, ROOM, |folder| Some(folder.join("frames")))
}

fn sequence(stage: &Stage) -> Sequence {
    Sequence::new(stage.path("frames"), "ball", FRAMES - 1, FrameFormat::default())
}

/// Renders the scene into the folder, as the command `render` does.
fn render(stage: &Stage) -> SequenceReport {
    let mut engine = Engine::load(stage.path("ball.ron")).unwrap();
    let frames = FrameList::all(FRAMES);
    render_sequence(&mut engine, &frames, &sequence(stage), |_| Continue(())).unwrap()
}

fn file(stage: &Stage, frame: u32) -> PathBuf {
    sequence(stage).frame(frame)
}

fn files(stage: &Stage) -> Vec<Vec<u8>> {
    (0..FRAMES).map(|frame| fs::read(file(stage, frame)).unwrap()).collect()
}

/// Checks that pictures have the pixels of a cold start.
fn assert_cold(stage: &Stage, pictures: &[Arc<[u8]>]) {
    let mut cold = Engine::load(stage.path("ball.ron")).unwrap();
    for (frame, png) in (0..).zip(pictures) {
        let film = cold.render_frame(frame).unwrap();
        let pixels = image::load(Cursor::new(png), image::ImageFormat::Png).unwrap().to_rgb8().into_raw();
        assert!(pixels == film.encoded(cold.effective_settings().film.transfer).bytes(), "frame {frame}");
    }
}

fn is_full(state: &State) -> bool {
    state.picture.is_some_and(|picture| picture.full) && !state.rendering
}

/// Checks that a session shows the frames of the folder, and traces nothing.
fn assert_untraced(stage: &Stage) {
    let state = stage.wait_for("a picture from the folder", is_full);
    assert_eq!((state.rays, state.times.trace, state.reloads), (0, 0.0, 1));
    assert!(state.plan.iter().any(|planned| planned.needed));
    let kept = until_all_are_kept(stage, 1);
    assert_cold(stage, &kept);
    assert!(kept.iter().zip(files(stage)).all(|(kept, file)| **kept == file), "a frame was traced");
    let traced = |event: &Event| !matches!(event, Event::Reloaded(_));
    assert!(!stage.events_within(Duration::ZERO).iter().any(traced));
}

#[test]
fn second_session_and_render_use_the_frames_of_the_first() {
    let mut stage = storing(Some(&resting(1.0)));
    until_all_are_kept(&stage, 1);
    stage.restart();
    assert_untraced(&stage);
    // Equal frames have files of their own.
    assert_eq!(render(&stage).to_string(), "0 frames rendered, 20 kept");
    assert_eq!(fs::read_dir(stage.path("frames")).unwrap().count(), FRAMES as usize);
}

#[test]
fn session_shows_the_frames_that_render_has_written() {
    let mut stage = storing(None);
    stage.save(&resting(1.0));
    stage.end();
    fs::remove_dir_all(stage.path("frames")).unwrap();
    fs::create_dir(stage.path("frames")).unwrap();
    assert_eq!(render(&stage).written, FRAMES as usize);
    let before = files(&stage);
    stage.restart();
    assert_untraced(&stage);
    stage.end();
    assert!(files(&stage) == before);
}

#[test]
fn edit_replaces_only_the_frames_that_it_changes() {
    let mut stage = storing(Some(&resting(1.0)));
    until_all_are_kept(&stage, 1);
    stage.restart();
    until_all_are_kept(&stage, 1);
    let times = |stage: &Stage| -> Vec<_> {
        (0..FRAMES).map(|frame| fs::metadata(file(stage, frame)).unwrap().modified().unwrap()).collect()
    };
    let (before, written) = (files(&stage), times(&stage));
    stage.save(&resting(2.0));
    let edited = until_all_are_kept(&stage, 2);
    assert_cold(&stage, &edited);
    stage.end();
    let (after, rewritten) = (files(&stage), times(&stage));
    for frame in 0..FRAMES as usize {
        assert_eq!(before[frame] == after[frame], frame <= 10, "{frame}");
        assert_eq!(written[frame] == rewritten[frame], frame <= 10, "{frame}");
    }
    stage.restart();
    assert_untraced(&stage);
    assert_eq!(render(&stage).kept, FRAMES as usize);
}

#[test]
fn torn_and_foreign_files_are_neither_shown_nor_replaced() {
    let mut stage = storing(Some(&resting(1.0)));
    until_all_are_kept(&stage, 1);
    stage.end();
    let good = files(&stage);
    let torn = &good[3][..good[3].len() / 2];
    let mut engine = Engine::load(stage.path("ball.ron")).unwrap();
    let film = engine.render_frame(19).unwrap();
    let foreign = encode(&film, engine.effective_settings().film.transfer, FrameFormat::default()).unwrap();
    fs::write(file(&stage, 3), torn).unwrap();
    fs::write(file(&stage, 4), &foreign).unwrap();
    fs::write(file(&stage, 5), &good[15]).unwrap();
    fs::remove_file(file(&stage, 6)).unwrap();
    stage.restart();
    assert_cold(&stage, &until_all_are_kept(&stage, 1));
    stage.end();
    let after = files(&stage);
    assert!(after[3] == torn && after[4] == foreign, "files that are no frames were replaced");
    let others = (0..FRAMES as usize).filter(|frame| ![3, 4].contains(frame));
    others.for_each(|frame| assert!(after[frame] == good[frame], "{frame}"));
    let SequenceReport { written, kept, .. } = render(&stage);
    assert_eq!((written, kept), (2, 18));
}

#[test]
fn values_that_are_tried_are_not_stored() {
    let mut stage = storing(Some(&resting(1.0)));
    until_all_are_kept(&stage, 1);
    stage.restart();
    until_all_are_kept(&stage, 1);
    let before = files(&stage);
    attempt(&stage, &["entities.ball.shape.radius=0.5"]).unwrap();
    let tried = until_all_are_kept(&stage, 2);
    edit(&stage, SceneEdit::Drop).unwrap();
    until_all_are_kept(&stage, 3);
    stage.restart();
    assert!(files(&stage) == before);
    until_all_are_kept(&stage, 1);
    attempt(&stage, &["entities.ball.shape.radius=0.5"]).unwrap();
    until_all_are_kept(&stage, 2);
    // All pictures are finished before their values are in the file.
    edit(&stage, SceneEdit::Keep).unwrap();
    let kept = until_all_are_kept(&stage, 3);
    assert!(kept.iter().zip(&tried).all(|(kept, tried)| kept == tried));
    stage.end();
    assert!(files(&stage).iter().zip(&before).all(|(after, before)| after != before));
    assert_eq!(render(&stage).kept, FRAMES as usize);
}

#[test]
fn undone_edits_are_undone_in_the_folder() {
    let original = resting(1.0);
    let edited = original.replace("radius: 1.0", "radius: 0.5");
    assert_ne!(edited, original);
    let mut stage = storing(Some(&original));
    until_all_are_kept(&stage, 1);
    stage.save(&edited);
    until_all_are_kept(&stage, 2);
    stage.save(&original);
    until_all_are_kept(&stage, 3);
    stage.end();
    assert_eq!(render(&stage).kept, FRAMES as usize);
}

#[test]
fn two_sessions_share_a_folder() {
    let shared = tempfile::tempdir().unwrap();
    let start =
        |height| Stage::storing(Some(&resting(height)), false, ROOM, |_| Some(shared.path().join("frames")));
    let mut stages = [start(1.0), start(1.0), start(2.0)];
    for stage in &stages {
        assert_cold(stage, &until_all_are_kept(stage, 1));
    }
    stages.iter_mut().for_each(Stage::end);
    let frames = Sequence::new(shared.path().join("frames"), "ball", FRAMES - 1, FrameFormat::default());
    let mut engine = Engine::load(stages[0].path("ball.ron")).unwrap();
    let report = render_sequence(&mut engine, &FrameList::all(FRAMES), &frames, |_| Continue(())).unwrap();
    // Each file is that of one of the two scenes, which share the first frames.
    assert!(report.kept >= 11 && report.kept + report.written == FRAMES as usize, "{report}");
    assert_eq!(fs::read_dir(shared.path().join("frames")).unwrap().count(), FRAMES as usize);
}

#[test]
fn folder_that_cannot_be_written_is_reported_once_and_the_preview_continues() {
    let stage =
        Stage::storing(Some(&resting(1.0)), false, ROOM, |folder| Some(folder.join("ball.ron/frames")));
    let error = stage.wait_for("the error", |state| state.cache_error.is_some()).cache_error.unwrap();
    assert!(error.starts_with("cannot make the folder `") && error.contains("frames"), "{error}");
    assert_cold(&stage, &until_all_are_kept(&stage, 1));

    let mut stage = storing(None);
    stage.wait_for("the session", |state| state.mistakes.is_some());
    fs::remove_dir_all(stage.path("frames")).unwrap();
    stage.save(&resting(1.0));
    let error = stage.wait_for("the error", |state| state.cache_error.is_some()).cache_error.unwrap();
    assert!(error.starts_with("cannot write `") && error.contains("ball.00"), "{error}");
    assert_cold(&stage, &until_all_are_kept(&stage, 1));
    assert_eq!(stage.session().handle().state().cache_error, Some(error));
    stage.end();
    assert!(!stage.path("frames").exists());
}
