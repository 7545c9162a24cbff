//! Tests of pictures in a session of which parts are taken from the picture before an edit.

use rayreel::live::Shown;

use crate::session::{Stage, scene};

/// Returns a scene that takes long, with a ball of a colour far from everything else.
fn text(color: &str, radius: f64) -> String {
    let mark = format!(
        "(name: \"mark\", shape: Sphere(radius: {radius:?}), color: \"{color}\", casts_shadow: false, \
         transform: (translation: (-3, 1.5, 0))),"
    );
    scene(1.0, &mark).replace("width: 64, height: 36", "width: 320, height: 180").replacen(
        "Scene(",
        "Scene(sampling: (samples: 64),",
        1,
    )
}

/// Returns the next full picture after a reload, which is compared with a cold start.
fn full(stage: &Stage, reloads: u64) -> Shown {
    loop {
        let shown = stage.matches_a_cold_start();
        if shown.info.reloads == reloads {
            return shown;
        }
    }
}

#[test]
fn edits_trace_what_they_can_reach() {
    let stage = Stage::new(Some(&text("#ff0000", 0.3)));
    let first = full(&stage, 1);
    assert_eq!(first.times.reused, 0.0);
    let lit = text("#0000ff", 0.2).replace("(4, 6, -4)", "(4, 7, -4)");
    for (reloads, edit, least, most) in [
        (2, text("#0000ff", 0.3), 0.5, 1.0),
        (3, text("#0000ff", 0.2), 0.5, 1.0),
        // Another light reaches everything.
        (4, lit, 0.0, 0.0),
    ] {
        stage.save(&edit);
        let shown = full(&stage, reloads);
        assert!((least..=most).contains(&shown.times.reused), "{reloads}: {}", shown.times.reused);
        let picture = stage.session().handle().picture(shown.info.id).unwrap();
        let of_tiles: Vec<u64> = picture.tile_stats.iter().map(|tile| tile.rays.total()).collect();
        assert_eq!((of_tiles.len(), of_tiles.iter().sum()), (20 * 12, shown.rays));
        assert!(shown.rays > 64 * 320 * 180, "the rays of the whole picture: {}", shown.rays);
    }
}
