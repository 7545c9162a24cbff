//! What it costs to go on with an edited scene of 100 000 entities: from the file to the scene, and from that to the arrays that rays
//! need.
//!
//! `cargo bench --bench reload` prints medians of 21 reloads in milliseconds, on the threads that rayon takes. The first reading of each
//! scene, of which nothing is known yet, is in a column of its own.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a bench prints its table, and may fail loudly")]

use std::fmt::Write;
use std::fs;
use std::time::Instant;

use rayreel::scene::Reader;
use rayreel::{Engine, Time};

const RELOADS: usize = 21;
const COUNT: usize = 100_000;

/// The scene after an edit.
#[derive(Clone, Copy)]
struct Version {
    /// Have entities names?
    named: bool,
    /// Of the first material.
    red: usize,
    /// How high the first entity lies.
    height: usize,
    /// Is there one more entity, before all others?
    extra: bool,
}

/// The version that the edit with this number leads to.
type Edit = fn(usize) -> Version;

fn main() {
    println!("| milliseconds | first reading | reading | reload | to the moment | both | trees |");
    println!("|---|---|---|---|---|---|---|");
    for named in [true, false] {
        let start = Version { named, red: 0, height: 0, extra: false };
        let edits: [(&str, Edit); 5] = [
            ("nothing", |_| Version { named: true, red: 0, height: 0, extra: false }),
            ("a material", |at| Version { named: true, red: at % 2, height: 0, extra: false }),
            ("a material, after an entity came", |at| Version {
                named: true,
                red: at % 2,
                height: 0,
                extra: true,
            }),
            ("an entity that moves", |at| Version { named: true, red: 0, height: at % 2, extra: false }),
            ("an entity that comes or goes", |at| Version {
                named: true,
                red: 0,
                height: 0,
                extra: at % 2 == 1,
            }),
        ];
        for (name, edit) in edits {
            let whose = if named { "" } else { ", no names" };
            row(&format!("{name}{whose}"), start, |at| Version { named, ..edit(at) });
        }
    }
}

fn row(name: &str, start: Version, edit: impl Fn(usize) -> Version) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bench.ron");
    let mut reader = Reader::new();
    fs::write(&path, text(start)).unwrap();
    let begin = Instant::now();
    let (scene, _) = reader.load(&path).unwrap();
    let first = milliseconds(begin);
    let mut engine = Engine::from_scene(scene);
    engine.seek(Time::ZERO).unwrap();
    let mut times = [vec![], vec![], vec![], vec![]];
    let mut builds = 0;
    for at in 1..=RELOADS {
        fs::write(&path, text(edit(at))).unwrap();
        let begin = Instant::now();
        let (scene, _) = reader.load(&path).unwrap();
        times[0].push(milliseconds(begin));
        let begin = Instant::now();
        engine.reload(scene);
        times[1].push(milliseconds(begin));
        let reloaded = Instant::now();
        engine.seek(Time::ZERO).unwrap();
        times[2].push(milliseconds(reloaded));
        times[3].push(milliseconds(begin));
        builds = engine.report().bvh_builds;
    }
    let [reading, reload, seek, together] = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    });
    println!("| {name} | {first:.0} | {reading:.0} | {reload:.1} | {seek:.1} | {together:.1} | {builds} |");
}

fn milliseconds(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

/// A field of balls of a hundred materials.
fn text(Version { named, red, height, extra }: Version) -> String {
    let mut text = "Scene(camera: (position: (0, 50, -200), target: (0, 0, 0)), materials: {".to_owned();
    for material in 0..100 {
        let red = if material == 0 { red } else { material };
        write!(text, "\"m{material}\": (k_a: 0.5, k_d: 0.5, color: ({red}, 9, 9)),").unwrap();
    }
    text += "}, entities: [";
    if extra {
        text += "(name: \"extra\", shape: Sphere(radius: 1), material: \"m1\"),";
    }
    for index in 0..COUNT {
        let (x, y, z) = (index % 300, if index == 0 { height } else { 0 }, index / 300);
        let name = if named { format!("name: \"ball {index}\", ") } else { String::new() };
        let material = index % 100;
        writeln!(
            text,
            "({name}shape: Sphere(radius: 0.5), material: \"m{material}\", transform: (translation: ({x}, {y}, {z}))),"
        )
        .unwrap();
    }
    text + "])"
}
