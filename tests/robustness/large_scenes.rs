//! Scenes with a very large number of something: in long lists, in chains, in rings, and nested.

use std::fmt::Write;

use proptest::prelude::*;

use super::files::Files;

/// The kind of item in a large number.
#[derive(Clone, Copy, Debug)]
enum Mass {
    /// Entities, each the parent of the next; in a ring, the last is the parent of the first.
    Parents {
        is_ring: bool,
    },
    /// Shapes at one position.
    Coincident,
    /// Entities of one name.
    Namesakes,
    /// References to missing materials.
    Missing,
    Cameras,
    Shots,
    Keys,
    /// Tracks of the same value.
    Tracks,
    /// Files that include the next one; in a ring, the last includes the first.
    Includes {
        is_ring: bool,
    },
    /// One file, included many times.
    Copies,
    /// Paths that are no scenes, as includes and as scripts.
    Paths,
    /// Scripts that read each other.
    Scripts {
        is_ring: bool,
    },
    /// Scripts that spawn entities.
    Spawns,
    /// Nested lists in a script.
    Lists,
    /// A long name, used several times.
    LongName,
    Lamps,
}

const SPHERE: &str = "shape: Sphere(radius: 1), material: \"m\"";

/// The scene itself, folders, no name, an empty file, missing files, a device, and names that no file can have.
const PATHS: [&str; 12] = [
    "scene.ron",
    "./scene.ron",
    ".",
    "..",
    "/",
    "",
    "part0.ron",
    "no/such.ron",
    "part0.ron/x",
    "/dev/null",
    "a\\u{0}b",
    "\\n",
];

/// Generates scenes with up to `most` items.
pub(crate) fn large_scenes(most: usize) -> impl Strategy<Value = Files> {
    let ring = [false, true];
    let kinds: Vec<Mass> = [
        Mass::Coincident,
        Mass::Namesakes,
        Mass::Missing,
        Mass::Cameras,
        Mass::Shots,
        Mass::Keys,
        Mass::Tracks,
        Mass::Copies,
        Mass::Paths,
        Mass::Spawns,
        Mass::Lists,
        Mass::LongName,
        Mass::Lamps,
    ]
    .into_iter()
    .chain(ring.map(|is_ring| Mass::Parents { is_ring }))
    .chain(ring.map(|is_ring| Mass::Includes { is_ring }))
    .chain(ring.map(|is_ring| Mass::Scripts { is_ring }))
    .collect();
    // Small numbers are as frequent as large ones.
    let count = (1..=most, 0..=most.ilog2()).prop_map(|(count, halved)| (count >> halved).max(1));
    (prop::sample::select(kinds), count).prop_map(|(kind, count)| files(kind, count))
}

/// Joins items, each made from its index.
fn list(count: usize, item: impl Fn(usize) -> String) -> String {
    (0..count).fold(String::new(), |mut list, index| {
        let _ = writeln!(list, "{},", item(index));
        list
    })
}

/// Returns a scene with additional fields.
fn scene(fields: &str) -> String {
    format!(
        "Scene(timeline: (fps: 5, duration: 2), ambient: (1, 1, 1), materials: {{ \"m\": (k_a: 1, k_d: 1) }},\n{fields})"
    )
}

const CAMERA: &str = "camera: (position: (0, 0, -9), target: (0, 0, 0)),";

fn files(mass: Mass, count: usize) -> Files {
    let entities =
        |item: &dyn Fn(usize) -> String| scene(&format!("{CAMERA} entities: [{}]", list(count, item)));
    let animate = |entities: &str, item: &dyn Fn(usize) -> String| {
        scene(&format!("{CAMERA} entities: [{entities}], animate: [{}]", list(count, item)))
    };
    let next = |index: usize| (index + 1) % count;
    let text = match mass {
        Mass::Parents { is_ring } => entities(&|index| {
            let parent = if index > 0 || is_ring {
                format!("parent: \"e{}\", ", (index + count - 1) % count)
            } else {
                String::new()
            };
            format!("(name: \"e{index}\", {parent}{SPHERE})")
        }),
        Mass::Coincident => entities(&|_| format!("({SPHERE})")),
        Mass::Namesakes => entities(&|_| format!("(name: \"e\", {SPHERE})")),
        Mass::Missing => entities(&|index| format!("(shape: Sphere(radius: 1), material: \"m{index}\")")),
        Mass::Lamps => entities(&|index| {
            let shape = if index == 0 {
                SPHERE
            } else {
                "light: Point(intensity: (1, 1, 1)), transform: (translation: (9, 9, -9))"
            };
            format!("({shape})")
        }),
        Mass::Cameras => {
            let camera = |index| format!("\"c{index}\": (position: (0, 0, -9), look_at: \"e\")");
            scene(&format!("cameras: {{ {} }}, entities: [(name: \"e\", {SPHERE})]", list(count, camera)))
        }
        Mass::Shots => {
            scene(&format!("{CAMERA} shots: [{}]", list(count, |index| format!("({index}, \"camera\")"))))
        }
        Mass::Keys => {
            let keys = list(count, |index| format!("({index}, (0, {}, 0), CatmullRom)", index % 7));
            let track = format!("(target: \"e\", channel: Translation, track: Keys([{keys}]))");
            scene(&format!("{CAMERA} entities: [(name: \"e\", {SPHERE})], animate: [{track}]"))
        }
        Mass::Tracks => animate(&format!("(name: \"e\", {SPHERE})"), &|_| {
            "(target: \"e\", channel: Radius, track: Keys([(0, 1), (1, 2)]))".to_owned()
        }),
        Mass::Scripts { is_ring } => {
            let names = list(count, |index| format!("(name: \"e{index}\", {SPHERE})"));
            animate(&names, &|index| {
                let read = if is_ring || next(index) > 0 {
                    format!("value(\"e{}\", \"Radius\")", next(index))
                } else {
                    "1".to_owned()
                };
                format!("(target: \"e{index}\", channel: Radius, track: Script(r#\"{read}\"#))")
            })
        }
        Mass::Spawns => {
            let script =
                "spawn(#{ shape: sphere(1), material: \"m\" }); for i in 0..9 { spawn(#{ name: `a${i}` }) }";
            scene(&format!("{CAMERA} spawn: [{}]", list(count, |_| format!("Script(r#\"{script}\"#)"))))
        }
        Mass::Lists => {
            let script = format!("{}1{}", "[".repeat(count), "]".repeat(count));
            animate(&format!("(name: \"e\", {SPHERE})"), &|index| {
                let script = if index == 0 { &script } else { "[1, 2, 3]" };
                format!("(target: \"e\", channel: Translation, track: Script(\"{script}\"))")
            })
        }
        Mass::LongName => {
            let name = "n".repeat(count);
            scene(&format!(
                "{CAMERA} entities: [(name: \"{name}\", material: \"{name}\", parent: \"{name}{name}\")], animate: [(target: \"{name}a\", channel: Radius, track: Keys([(0, 1)]))]"
            ))
        }
        Mass::Paths => {
            let path = |index: usize| PATHS[index % PATHS.len()];
            let includes = list(count, |index| format!("(file: \"{}\", name: \"p{index}\")", path(index)));
            let scripts = list(count, |index| format!("File(\"{}\")", path(index)));
            return with_parts(
                scene(&format!("{CAMERA} include: [{includes}], spawn: [{scripts}]")),
                vec![String::new()],
            );
        }
        Mass::Copies => {
            let copies = list(count, |index| format!("(file: \"part0.ron\", name: \"p{index}\")"));
            let text = scene(&format!("{CAMERA} include: [{copies}]"));
            return with_parts(text, vec![scene(&format!("entities: [(name: \"e\", {SPHERE})]"))]);
        }
        Mass::Includes { is_ring } => {
            // Writing more files than this takes too long.
            let count = count.min(300);
            let include = |index: usize| {
                format!("include: [(file: \"part{index}.ron\", name: \"p\")], entities: [({SPHERE})]")
            };
            let part = |index| {
                if is_ring || index + 1 < count { scene(&include((index + 1) % count)) } else { scene("") }
            };
            return with_parts(scene(&format!("{CAMERA} {}", include(0))), (0..count).map(part).collect());
        }
    };
    Files::of_text(text)
}

/// Returns a scene with parts, named part0.ron and so on.
fn with_parts(text: String, parts: Vec<String>) -> Files {
    let mut files = Files::of_text(text);
    let parts = parts.into_iter().enumerate();
    files.0.extend(parts.map(|(index, part)| (format!("part{index}.ron").into(), part.into_bytes())));
    files
}
