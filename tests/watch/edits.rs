//! Tests of values that are changed by hand: tried, written into the files, and taken back.

use std::fs;
use std::sync::mpsc::channel;
use std::time::Instant;

use rayreel::live::{EditState, Event, LookView, PathRequest, Reply, SceneEdit, SessionCommand};
use rayreel::scene::{KeyChange, ScenePart, WrittenValue};
use rayreel::{Engine, Scene};

use crate::AT_MOST;
use crate::session::{Stage, scene};

pub(crate) fn ask<T: Send + 'static>(stage: &Stage, command: impl FnOnce(Reply<T>) -> SessionCommand) -> T {
    let (sender, reply) = channel();
    let send = move |result| sender.send(result).unwrap();
    stage.session().handle().send(command(Reply(Box::new(send))));
    reply.recv_timeout(AT_MOST).unwrap()
}

pub(crate) fn edit(stage: &Stage, edit: SceneEdit) -> Result<(), String> {
    ask(stage, |reply| SessionCommand::Edit(edit, reply))
}

pub(crate) fn attempt(stage: &Stage, values: &[&str]) -> Result<(), String> {
    edit(stage, SceneEdit::Try(values.iter().map(|value| (*value).to_owned()).collect(), Vec::new()))
}

/// Returns the written values of a part, without those of the material of an entity.
fn values(stage: &Stage, part: ScenePart) -> Vec<WrittenValue> {
    let info = ask(stage, |reply| SessionCommand::Part(Some(part), reply));
    let first = info.and_then(|info| info.sections.into_iter().next());
    first.map_or_else(Vec::new, |section| {
        section.values.into_iter().filter(|value| !value.is_default).collect()
    })
}

fn edits(stage: &Stage) -> EditState {
    stage.session().handle().state().edits
}

fn text(stage: &Stage) -> String {
    fs::read_to_string(stage.path("ball.ron")).unwrap()
}

#[test]
fn tried_values_are_shown_and_kept_ones_written() {
    let before = scene(1.0, "// the end");
    let stage = Stage::new(Some(&before));
    let first = stage.matches_a_cold_start();
    for radius in ["1.2", "1.4"] {
        attempt(&stage, &[&format!("entities.ball.shape.radius={radius}")]).unwrap();
    }
    assert_eq!(edits(&stage).tried, ["entities.ball.shape.radius=1.4"]);
    loop {
        match stage.next() {
            Event::Shown(shown) if shown.info.full && shown.info.reloads == 3 => {
                assert!(shown.tried && shown.film != first.film);
                break;
            }
            event => assert!(!matches!(event, Event::Reloaded(_)), "the files are not read: {event:?}"),
        }
    }
    let compared = || stage.session().handle().state().before;
    assert_eq!((text(&stage), compared()), (before.clone(), Some(first.info)), "nothing is written");
    attempt(&stage, &["camera.fov=30", "materials.clay.k_d=0.25"]).unwrap();
    edit(&stage, SceneEdit::Keep).unwrap();
    let edited = before
        .replace("radius: 1.0", "radius: 1.4")
        .replace("target: (0, 0, 0))", "target: (0, 0, 0), fov: 30)")
        .replace("k_d: 0.5", "k_d: 0.25");
    assert_eq!(text(&stage), edited);
    assert_eq!((edits(&stage).tried.len(), edits(&stage).undoable), (0, 1));
    // Pictures of tried values may still arrive.
    let kept = loop {
        match stage.next() {
            Event::Shown(shown) if shown.info.full && !shown.tried => break shown,
            _ => {}
        }
    };
    let mut cold = Engine::load(stage.path("ball.ron")).unwrap();
    assert!(cold.render_frame(0).unwrap() == *kept.film);
    assert_eq!(compared(), Some(first.info), "the picture before the first value was tried");
    edit(&stage, SceneEdit::Undo).unwrap();
    assert_eq!((text(&stage), edits(&stage).undoable), (before.clone(), 0));
    edit(&stage, SceneEdit::Redo).unwrap();
    assert_eq!((text(&stage), edits(&stage).undoable, edits(&stage).redoable), (edited, 1, 0));
    edit(&stage, SceneEdit::Redo).unwrap();
    edit(&stage, SceneEdit::Undo).unwrap();
    assert_eq!((text(&stage), edits(&stage).redoable), (before, 1));
    let undone = stage.converges_to_a_cold_start();
    assert!(undone.info.reloads > first.info.reloads);
}

#[cfg(unix)]
#[test]
fn links_and_permissions_of_files_stay() {
    use std::os::unix::fs::{PermissionsExt, symlink};

    let stage = Stage::new(None);
    let own = stage.path("own.ron");
    fs::write(&own, scene(1.0, "")).unwrap();
    fs::set_permissions(&own, fs::Permissions::from_mode(0o640)).unwrap();
    symlink(&own, stage.path("ball.ron")).unwrap();
    stage.converges_to_a_cold_start();
    attempt(&stage, &["entities.ball.shape.radius=2"]).unwrap();
    edit(&stage, SceneEdit::Keep).unwrap();
    assert!(fs::symlink_metadata(stage.path("ball.ron")).unwrap().is_symlink());
    assert_eq!(fs::metadata(&own).unwrap().permissions().mode() & 0o777, 0o640);
    assert!(fs::read_to_string(&own).unwrap().contains("radius: 2)"));
}

#[test]
fn invalid_values_are_refused_and_change_nothing() {
    let before = scene(1.0, "");
    let stage = Stage::new(Some(&before));
    stage.matches_a_cold_start();
    attempt(&stage, &["entities.ball.shape.radius=2"]).unwrap();
    for (value, reason) in [
        ("entities.ball.shape.radius=-1", "radius"),
        ("entities.ball.shape.radius=(", "is not one value"),
        ("entities.bal.shape.radius=1", "did you mean `ball`?"),
        ("camera", "as in camera.fov=40"),
    ] {
        let error = attempt(&stage, &[value]).unwrap_err();
        assert!(error.contains(reason), "{value}: {error}");
        assert_eq!(edits(&stage).tried, ["entities.ball.shape.radius=2"], "{value}");
        assert_eq!(stage.session().handle().state().mistakes, None, "{value}");
    }
    edit(&stage, SceneEdit::Drop).unwrap();
    assert_eq!((edits(&stage).tried.len(), text(&stage)), (0, before));
}

#[test]
fn file_that_changed_meanwhile_wins() {
    let stage = Stage::new(Some(&scene(1.0, "")));
    stage.matches_a_cold_start();
    // Another value of the file: the try stays, and both are kept.
    attempt(&stage, &["entities.ball.shape.radius=2"]).unwrap();
    let dimmed = scene(1.0, "").replace("k_d: 0.5", "k_d: 0.1");
    stage.save(&dimmed);
    let waits = |what: &str, condition: &dyn Fn(&EditState) -> bool| {
        let start = Instant::now();
        while !condition(&edits(&stage)) {
            assert!(start.elapsed() < AT_MOST, "{what}: {:?}", edits(&stage));
        }
    };
    edit(&stage, SceneEdit::Keep).unwrap();
    assert_eq!(text(&stage), dimmed.replace("radius: 1.0", "radius: 2"));
    // A file with mistakes: nothing is written.
    attempt(&stage, &["camera.fov=40"]).unwrap();
    let broken = dimmed.replace("Scene(", "Scene(nonsense: 1,");
    stage.save(&broken);
    let start = Instant::now();
    while stage.session().handle().state().mistakes.is_none() {
        assert!(start.elapsed() < AT_MOST);
    }
    assert_eq!(edit(&stage, SceneEdit::Keep).unwrap_err(), "the file has mistakes: correct them first");
    assert_eq!(text(&stage), broken);
    assert!(edit(&stage, SceneEdit::Drop).unwrap_err().contains("nonsense"));
    stage.save(&dimmed);
    while stage.session().handle().state().mistakes.is_some() {
        assert!(start.elapsed() < AT_MOST);
    }
    // The same value: the file stays.
    attempt(&stage, &["entities.ball.shape.radius=3"]).unwrap();
    let other = scene(0.5, "");
    stage.save(&other);
    waits("the override ends", &|state| state.tried.is_empty() && state.notice.is_some());
    edit(&stage, SceneEdit::Keep).unwrap();
    assert_eq!(text(&stage), other);
    // What was written before the other program's change is not taken back over it.
    let error = edit(&stage, SceneEdit::Undo).unwrap_err();
    assert!(error.contains("was changed meanwhile: it stays as it is"), "{error}");
    assert_eq!((text(&stage), edits(&stage).undoable), (other, 0));
}

#[test]
fn cameras_that_can_be_moved_are_described() {
    let stage = Stage::new(Some(&scene(1.0, "")));
    stage.matches_a_cold_start();
    let camera = || ask(&stage, SessionCommand::Camera);
    let view = camera().unwrap();
    assert_eq!((view.path.as_str(), view.position, view.target), ("camera", [0.0, 0.0, -5.0], [0.0; 3]));
    assert!(!view.has_direction && !view.right_handed && view.position_key.is_none() && view.look.is_none());
    let save = |camera: &str, more: &str| {
        let text = scene(1.0, "").replace("camera: (position: (0, 0, -5), target: (0, 0, 0))", camera);
        stage.save(&text.replace("animate: [", &format!("animate: [{more}")));
        stage.matches_a_cold_start();
    };
    // The pivot of a camera with a direction is the visible point in the middle.
    save("cameras: {\"near 1.5\": (position: (0, 0, -4), view: (0, 0, 2))}, space: RightHanded", "");
    let view = camera().unwrap();
    assert_eq!((view.path.as_str(), view.target), ("cameras.\"near 1.5\"", [0.0, 0.0, -1.0]));
    assert!(view.has_direction && view.right_handed);
    save(
        "camera: (position: (0, 0, -5), target: (0, 0, 0))",
        "(target: \"camera\", channel: Position, track: Keys([(0, (0, 0, -5)), (2, (0, 0, -6))])),",
    );
    let view = camera().unwrap();
    assert_eq!((view.position_key, view.target_key), (Some(("animate.0.track.0".to_owned(), 0.0)), None));
    // The path of a camera whose name has a dot.
    save("cameras: {\"near 1.5\": (position: (0, 0, -4), view: (0, 0, 2))}", "");
    attempt(&stage, &["cameras.\"near 1.5\".view=(0.1, 0, 2)"]).unwrap();
    edit(&stage, SceneEdit::Keep).unwrap();
    assert!(text(&stage).contains("position: (0, 0, -4), view: (0.1, 0, 2)"));
}

#[test]
fn views_of_tied_cameras_are_only_looked_from() {
    let free = "camera: (position: (0, 0, -5), target: (0, 0, 0))";
    let tied = scene(1.0, "").replace(free, "camera: (position: (0, 0, -5), look_at: \"ball\")");
    let stage = Stage::new(Some(&tied));
    stage.matches_a_cold_start();
    let camera = || ask(&stage, SessionCommand::Camera).unwrap();
    let reason = "`look_at` ties this camera to `ball`";
    assert!(camera().look.unwrap().starts_with(reason));
    assert_eq!((camera().position, camera().target), ([0.0, 0.0, -5.0], [0.0; 3]));
    let view = |x: f64, is_free: bool| {
        let up = [0.0, 1.0, 0.0];
        SceneEdit::Look(LookView { position: [x, 1.0, -5.0], target: [0.0; 3], up, is_free })
    };
    let look = |x: f64| view(x, false);
    let shown = |tried: bool| loop {
        match stage.next() {
            Event::Shown(shown) if shown.info.full && shown.tried == tried => break shown.film,
            event => assert!(!matches!(event, Event::Reloaded(_)) || !tried, "{event:?}"),
        }
    };
    edit(&stage, look(2.0)).unwrap();
    assert_eq!((camera().position, edits(&stage).tried.len()), ([2.0, 1.0, -5.0], 0));
    let there = scene(1.0, "").replace("(0, 0, -5)", "(2, 1, -5)");
    let cold = |text: &str| {
        let scene = Scene::from_text("ball.ron", text.to_owned()).unwrap();
        Engine::from_scene(scene).render_frame(0).unwrap()
    };
    assert!(*shown(true) == cold(&there));
    assert!(edit(&stage, look(f64::NAN)).unwrap_err().contains("must be finite"));
    assert!(edit(&stage, SceneEdit::Keep).unwrap_err().starts_with(reason));
    edit(&stage, SceneEdit::Drop).unwrap();
    assert!(*shown(false) == cold(&tied));
    assert_eq!((camera().position, edits(&stage).look, text(&stage)), ([0.0, 0.0, -5.0], None, tied));
    // A camera that can be moved is not only looked from.
    stage.save(&scene(1.0, ""));
    let start = Instant::now();
    while camera().look.is_some() {
        assert!(start.elapsed() < AT_MOST);
    }
    assert!(edit(&stage, look(2.0)).unwrap_err().starts_with("this camera can be moved"));
    assert!(*shown(false) == cold(&scene(1.0, "")));
    // Its path is seen from elsewhere. Sampling it leaves the world at the shown frame, and the camera is that of the scene.
    edit(&stage, view(2.0, true)).unwrap();
    let request = PathRequest { keys: vec![1] };
    let path = ask(&stage, |reply| SessionCommand::Path(request, reply)).unwrap();
    assert!(path.is_still && path.samples.iter().all(|sample| sample.eye == [0.0, 0.0, -5.0]), "{path:?}");
    assert_eq!(path.samples.last().unwrap().frame, stage.session().handle().state().frames - 1);
    assert!(*shown(true) == cold(&there));
    assert!(edit(&stage, SceneEdit::Keep).unwrap_err().starts_with("the camera stays"));
}

#[test]
fn saved_edits_are_compared_with_each_other_while_the_view_is_moved() {
    let stage = Stage::new(Some(&scene(1.0, "")));
    let first = stage.matches_a_cold_start();
    let full = |reloads: u64| loop {
        if let Event::Shown(shown) = stage.next()
            && shown.info.full
            && shown.info.reloads == reloads
        {
            break shown.info;
        }
    };
    for (step, x) in [(2, 1.0), (3, 2.0)] {
        let (position, target, up) = ([x, 1.0, -5.0], [0.0; 3], [0.0, 1.0, 0.0]);
        edit(&stage, SceneEdit::Look(LookView { position, target, up, is_free: true })).unwrap();
        full(step);
    }
    let compared = || stage.session().handle().state().before;
    assert_eq!(compared(), Some(first.info), "views of a drag are one edit");
    for (step, radius) in [(4, 1.2), (5, 1.4)] {
        let before = stage.session().handle().state().picture;
        stage.save(&scene(radius, ""));
        full(step);
        assert_eq!(compared(), before, "each save is an edit of its own");
    }
}

#[test]
fn keys_and_values_of_a_view_are_one_change() {
    let track =
        "animate: [(target: \"camera\", channel: Position, track: Keys([(0, (0, 0, -5)), (2, (0, 0, -6))])),";
    let before = scene(1.0, "").replace("animate: [", track);
    let stage = Stage::new(Some(&before));
    stage.matches_a_cold_start();
    let try_view = |target: &str, time: f64, position: &str| {
        let key = KeyChange::Set("animate.0.track.0".to_owned(), time, position.to_owned());
        edit(&stage, SceneEdit::Try(vec![format!("camera.target={target}")], vec![key]))
    };
    try_view("(0, 1, 0)", 1.0, "(0, 0, -4)").unwrap();
    try_view("(0, 2, 0)", 1.5, "(0, 0, -3)").unwrap();
    // The places of keys in the file are those of others in the tried list.
    let error = attempt(&stage, &["animate.0.track.0.1.1=(0, 0, 0)"]).unwrap_err();
    assert!(error.contains("keep or discard them first"), "{error}");
    try_view("(0, 2, 0)", 1.0, "(0, 0, )nothing").unwrap_err();
    edit(&stage, SceneEdit::Keep).unwrap();
    let after = before
        .replace("target: (0, 0, 0)", "target: (0, 2, 0)")
        .replace("(2, (0, 0, -6))", "(1, (0, 0, -4)), (1.5, (0, 0, -3)), (2, (0, 0, -6))");
    assert_eq!((text(&stage), edits(&stage).undoable), (after, 1));
    edit(&stage, SceneEdit::Undo).unwrap();
    assert_eq!((text(&stage), edits(&stage).undoable), (before, 0));
}

#[test]
fn written_values_have_kinds_and_limits() {
    let stage = Stage::new(Some(&scene(1.0, "")));
    stage.matches_a_cold_start();
    let listed = |part: ScenePart| -> Vec<(String, String)> {
        let shown = |value: &WrittenValue| {
            let range = format!("{:?} {:?}..{:?}", value.kind, value.least, value.most);
            (format!("{}={}", value.path, value.text), range)
        };
        values(&stage, part).iter().map(shown).collect()
    };
    let of = |text: &str, range: &str| (text.to_owned(), range.to_owned());
    assert_eq!(
        listed(ScenePart::Material("clay".to_owned())),
        [
            of("materials.clay.k_a=1", "Number Some(0.0)..Some(1.0)"),
            of("materials.clay.k_d=0.5", "Number Some(0.0)..Some(1.0)"),
            of("materials.clay.color=(255, 120, 60)", "Color None..None"),
        ]
    );
    assert_eq!(listed(ScenePart::Entity("ball".to_owned())).len(), 1);
    assert_eq!(
        listed(ScenePart::Camera("camera".to_owned())),
        [
            of("camera.position=(0, 0, -5)", "Vector None..None"),
            of("camera.target=(0, 0, 0)", "Vector None..None")
        ]
    );
    assert_eq!(
        listed(ScenePart::Setting("film".to_owned()))[0],
        of("film.width=64", "Whole Some(1.0)..Some(32768.0)")
    );
    for unknown in ["none", "#x", "#9999", "..", ""].map(str::to_owned) {
        assert!(values(&stage, ScenePart::Entity(unknown.clone())).is_empty());
        assert!(values(&stage, ScenePart::Setting(unknown)).is_empty());
    }
    let about = &values(&stage, ScenePart::Material("clay".to_owned()))[1].about;
    assert_eq!(about, "diffuse reflection coefficient, 0 to 1");
}
