//! Cost of getting from text to a world: reading a scene, spawning entities with a script, and reloading an edited scene.
//!
//! `cargo bench --bench scene` measures on rayon's default number of threads; `RAYON_NUM_THREADS=1` sets it to one. `-- read`, `-- spawn`
//! and `-- edits` measure one part each; `-- --sample-count 5` is quicker.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::{fmt, fs};

use divan::Bencher;
use divan::counter::{BytesCount, ItemsCount};
use tempfile::TempDir;

use rayreel::scene::Reader;
use rayreel::{Engine, Scene, Time};

#[expect(dead_code, reason = "other benches look at more of it")]
mod shipped;

use shipped::SCENES;

/// Number of entities in the scenes that are not shipped.
const COUNT: usize = 100_000;

fn main() {
    rayon::ThreadPoolBuilder::new().use_current_thread().build_global().expect("there is none");
    divan::main();
}

fn load(file: &str, text: String) -> Scene {
    Scene::from_text(file, text).unwrap_or_else(|error| panic!("{error}"))
}

/// Reading of a scene: parsing, validation and spawning.
mod read {
    use super::*;

    #[divan::bench(args = SCENES)]
    fn shipped(bencher: Bencher<'_, '_>, name: &str) {
        let path = shipped::path(name);
        measure(bencher, path.to_str().unwrap_or(name), &fs::read_to_string(&path).expect("it is there"));
    }

    #[divan::bench(sample_count = 21, sample_size = 1)]
    fn balls(bencher: Bencher<'_, '_>) {
        measure(bencher, "balls.ron", &text(Version::START));
    }

    fn measure(bencher: Bencher<'_, '_>, file: &str, text: &str) {
        let bencher = bencher.counter(BytesCount::of_str(text)).with_inputs(|| text.to_owned());
        bencher.bench_local_values(|text| load(file, text));
    }
}

/// Reads a small scene whose script spawns entities.
#[divan::bench(args = [1000, COUNT], sample_count = 11, sample_size = 1)]
fn spawn(bencher: Bencher<'_, '_>, count: usize) {
    let script = format!(
        "for i in 0..{count} {{ spawn(#{{ shape: sphere(0.1), material: `m`, translation: [i, 0, 0] }}); }}"
    );
    let text = format!(
        "(camera: (position: (0, 0, -9), target: (0, 0, 0)), materials: {{ \"m\": (k_a: 1) }}, spawn: [Script(\"{script}\")])"
    );
    let bencher = bencher.counter(ItemsCount::new(count)).with_inputs(|| text.clone());
    bencher.bench_local_values(|text| load("spawn.ron", text));
}

/// Reloading of an edited scene of 100 000 entities in an engine: from the file to the scene, and from the scene to the kernel's arrays.
mod edits {
    use super::*;

    /// Reads the file again: parses the changed part, then validates and spawns everything.
    #[divan::bench(args = edits(), sample_count = 21, sample_size = 1)]
    fn reading(bencher: Bencher<'_, '_>, edit: &Edit) {
        let (mut file, mut reader) = (SceneFile::new(edit), Reader::new());
        let path = file.path.clone();
        file.write();
        read(&mut reader, &path);
        bencher.with_inputs(|| file.write()).bench_local_values(|()| read(&mut reader, &path));
    }

    /// Replaces the engine's scene with the new one.
    #[divan::bench(args = edits(), sample_count = 21, sample_size = 1)]
    fn reload(bencher: Bencher<'_, '_>, edit: &Edit) {
        let mut session = Session::new(edit);
        let engine = RefCell::new(session.engine());
        let next = || {
            seek(&mut engine.borrow_mut());
            session.next()
        };
        bencher.with_inputs(next).bench_local_values(|scene| engine.borrow_mut().reload(scene));
    }

    /// Advances the new scene and the kernel's arrays to the current time.
    #[divan::bench(args = edits(), sample_count = 21, sample_size = 1)]
    fn to_the_moment(bencher: Bencher<'_, '_>, edit: &Edit) {
        let mut session = Session::new(edit);
        let engine = RefCell::new(session.engine());
        let next = || engine.borrow_mut().reload(session.next());
        bencher.with_inputs(next).bench_local_values(|()| seek(&mut engine.borrow_mut()));
    }

    fn read(reader: &mut Reader, path: &Path) -> Scene {
        reader.load(path).unwrap_or_else(|error| panic!("{error}")).0
    }

    fn seek(engine: &mut Engine) {
        engine.seek(Time::ZERO).expect("nothing in the scene can fail");
    }

    /// A file that is edited, and its reader.
    struct Session {
        file: SceneFile,
        reader: Reader,
    }

    impl Session {
        fn new(edit: &Edit) -> Self {
            Self { file: SceneFile::new(edit), reader: Reader::new() }
        }

        /// Returns the scene after the next edit.
        fn next(&mut self) -> Scene {
            self.file.write();
            read(&mut self.reader, &self.file.path)
        }

        /// Returns an engine with the scene before all edits, already advanced to its time.
        fn engine(&mut self) -> Engine {
            let mut engine = Engine::from_scene(self.next());
            seek(&mut engine);
            engine
        }
    }
}

/// A scene file in a temporary folder, and the number of versions written.
struct SceneFile {
    path: PathBuf,
    edit: Edit,
    versions: usize,
    /// Deletes the folder on drop.
    _folder: TempDir,
}

impl SceneFile {
    fn new(edit: &Edit) -> Self {
        let folder = tempfile::tempdir().expect("there is room");
        Self { path: folder.path().join("balls.ron"), edit: edit.clone(), versions: 0, _folder: folder }
    }

    /// Writes the next version.
    fn write(&mut self) {
        let Edit { named, version, .. } = self.edit;
        let start = Version { named, ..Version::START };
        let version = if self.versions == 0 { start } else { Version { named, ..version(self.versions) } };
        self.versions += 1;
        fs::write(&self.path, text(version)).expect("there is room");
    }
}

/// Function from the number of an edit, 1 or more, to the version after it.
type NextVersion = fn(usize) -> Version;

/// A kind of edit, made repeatedly.
#[derive(Clone)]
struct Edit {
    name: &'static str,
    /// Set if entities have names.
    named: bool,
    version: NextVersion,
}

impl fmt::Display for Edit {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name)?;
        formatter.write_str(if self.named { "" } else { ", no names" })
    }
}

fn edits() -> impl Iterator<Item = Edit> {
    let edits: [(&str, NextVersion); 5] = [
        ("nothing", |_| Version::START),
        ("a material", |at| Version { red: at % 2, ..Version::START }),
        ("a material, after an entity came", |at| Version { red: at % 2, extra: true, ..Version::START }),
        ("an entity that moves", |at| Version { height: at % 2, ..Version::START }),
        ("an entity that comes or goes", |at| Version { extra: at % 2 == 1, ..Version::START }),
    ];
    [true, false]
        .into_iter()
        .flat_map(move |named| edits.map(|(name, version)| Edit { name, named, version }))
}

/// A version of the scene of balls.
#[derive(Clone, Copy)]
struct Version {
    /// Set if entities have names.
    named: bool,
    /// Red channel of the first material's colour.
    red: usize,
    /// Height (y) of the first entity.
    height: usize,
    /// Set if one more entity precedes all others.
    extra: bool,
}

impl Version {
    /// The version before all edits.
    const START: Self = Self { named: true, red: 0, height: 0, extra: false };
}

/// Returns the text of a scene with a field of balls of a hundred materials.
fn text(Version { named, red, height, extra }: Version) -> String {
    let mut text = "Scene(camera: (position: (0, 50, -200), target: (0, 0, 0)), materials: {".to_owned();
    for material in 0..100 {
        let red = if material == 0 { red } else { material };
        text += &format!("\"m{material}\": (k_a: 0.5, k_d: 0.5, color: ({red}, 9, 9)),");
    }
    text += "}, entities: [";
    if extra {
        text += "(name: \"extra\", shape: Sphere(radius: 1), material: \"m1\"),";
    }
    for index in 0..COUNT {
        let (x, y, z) = (index % 300, if index == 0 { height } else { 0 }, index / 300);
        let name = if named { format!("name: \"ball {index}\", ") } else { String::new() };
        let material = index % 100;
        text += &format!(
            "({name}shape: Sphere(radius: 0.5), material: \"m{material}\", transform: (translation: ({x}, {y}, {z}))),\n"
        );
    }
    text + "])"
}
