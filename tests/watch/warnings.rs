//! Tests of the warnings of a session.

use rayreel::live::{Detail, PictureWarnings, SessionCommand, ViewChange};

use crate::session::{Stage, scene};

fn names(warnings: &PictureWarnings) -> Vec<&'static str> {
    warnings.list.iter().map(|warning| warning.name).collect()
}

#[test]
fn warnings_are_those_of_the_last_full_picture() {
    let pale = |more: &str| scene(1.0, more).replace("(255, 120, 60)", "(1, 0.5, 0.25)");
    let below = "(name: \"below\", light: Point(intensity: (1, 1, 1)), transform: (translation: (0, -9, 0))),
        (shape: Plane(normal: (0, 1, 0)), material: \"clay\", transform: (translation: (0, -2, 0))),";
    let stage = Stage::new(Some(&pale("")));
    let now = |stage: &Stage| stage.session().handle().state().warnings;
    let shown = stage.matches_a_cold_start();
    assert_eq!(names(&shown.warnings), ["dark-color"]);
    assert_eq!(shown.warnings, now(&stage));
    let place = shown.warnings.list[0].place.as_ref().unwrap();
    assert!(place.ends_with("ball.ron:6:52"), "{place}");
    assert_eq!(
        shown.warnings.list[0].help,
        "channels are from 0 to 255: write (255, 128, 64), or (255, 188, 137) for linear light as in POV-Ray"
    );

    stage.save(&pale(below));
    let shown = stage.matches_a_cold_start();
    assert_eq!(names(&shown.warnings), ["dark-color", "idle-light"]);
    let idle = &shown.warnings.list[1];
    assert!(idle.message.starts_with("\"below\" lights nothing in view: "), "{idle:?}");
    assert!(idle.place.as_ref().is_some_and(|place| place.ends_with("ball.ron:10")), "{idle:?}");

    // Mistakes change nothing, because the last good picture stays.
    stage.save("Scene(");
    stage.wait_for("mistakes", |state| state.mistakes.is_some());
    assert_eq!(now(&stage), shown.warnings);
    stage.save(&scene(1.0, ""));
    assert_eq!(stage.converges_to_a_cold_start().warnings, PictureWarnings::default());
    assert_eq!(now(&stage), PictureWarnings::default());

    // Drafts are not checked.
    stage.save(&pale(""));
    stage.matches_a_cold_start();
    stage.session().handle().send(SessionCommand::ViewChange(ViewChange::Detail(Detail::Draft)));
    stage.wait_for("no warnings", |state| state.warnings.list.is_empty());
    stage.session().handle().send(SessionCommand::ViewChange(ViewChange::Finish));
    stage.wait_for("warnings", |state| names(&state.warnings) == ["dark-color"]);
}

#[test]
fn many_warnings_are_counted() {
    let idle = "(light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 0, 0))),".repeat(14);
    let stage = Stage::new(Some(&scene(1.0, &idle)));
    let warnings = stage.matches_a_cold_start().warnings;
    assert_eq!((warnings.list.len(), warnings.unlisted), (10, 4), "{warnings:?}");
}
