//! The source locations of scene elements.

use super::files::Origin;
use super::source_text::{SourceLine, SourceText};
use super::spans::{PathStep, locate};

/// The texts of all files of a scene, for looking up the locations of its elements.
///
/// ```
/// use rayreel::Scene;
///
/// let text = "(\n  materials: { \"clay\": (k_d: 1) }, camera: (position: (0, 0, -5), view: (0, 0, 1)),\n  entities: [\n    (name: \"a\", shape: Sphere(radius: 1), material: \"clay\"), (),\n    (),\n  ],\n)";
/// let (_, sources) = Scene::from_text_with_sources("three.ron", text.to_owned())?;
/// let lines = sources.entities(&[2, 0, 1]).map(|place| place.to_string());
/// assert_eq!(lines.collect::<Vec<_>>(), ["three.ron:5", "three.ron:4", "three.ron:4"]);
/// assert_eq!(sources.camera("camera").line, 2);
/// assert_eq!((sources.material(0).as_deref(), sources.material(1)), (Some("clay"), None));
/// # Ok::<(), rayreel::scene::LoadError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Sources {
    /// The texts; the first is that of the scene file.
    files: Vec<SourceText>,
    /// The runs of entities, in document order.
    runs: Vec<Run>,
    /// The camera names in the map `cameras`.
    cameras: Vec<String>,
}

/// A run of entities that are contiguous both in the scene and in a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    /// The document index of the first entity.
    pub(super) first: usize,
    pub(super) origin: Origin,
}

impl Sources {
    pub(super) fn new(files: Vec<SourceText>, runs: Vec<Run>, cameras: Vec<String>) -> Self {
        Self { files, runs, cameras }
    }

    /// Returns the lines on which entities start. `entities` holds indices in document order, from 0, as in
    /// [`Order`](crate::components::Order). Each file is scanned once for all entities. The parent entity created for an include with a
    /// name or a transform starts at the include.
    ///
    /// An entity that is not in the files gets the line of the list it would belong to.
    pub fn entities(&self, entities: &[usize]) -> impl Iterator<Item = SourceLine<'_>> {
        let origins: Vec<Origin> = entities.iter().map(|index| self.origin(*index)).collect();
        let mut found: Vec<Option<SourceLine<'_>>> = vec![None; entities.len()];
        for file in 0..self.files.len() {
            let (places, paths): (Vec<usize>, Vec<Vec<PathStep>>) = origins
                .iter()
                .enumerate()
                .filter(|(_, origin)| origin.file == file)
                .map(|(place, origin)| {
                    (place, vec![PathStep::Field(origin.list), PathStep::Index(origin.index)])
                })
                .unzip();
            if !paths.is_empty() {
                for (place, line) in places.into_iter().zip(self.lines(file, &paths)) {
                    found[place] = Some(line);
                }
            }
        }
        found.into_iter().flatten()
    }

    /// Returns the line on which a camera starts: the entry of `cameras` with this name, or else the field `camera`.
    #[must_use]
    pub fn camera(&self, name: &str) -> SourceLine<'_> {
        let path = match self.cameras.iter().position(|known| known == name) {
            Some(index) => vec![PathStep::Field("cameras"), PathStep::Key(index)],
            None => vec![PathStep::Field("camera")],
        };
        let found = self.lines(0, &[path]).next();
        found.unwrap_or(SourceLine { file: "", line: 1 })
    }

    /// Returns the name of an entity's material as written in its file; `None` for an entity without a material.
    #[must_use]
    pub fn material(&self, entity: usize) -> Option<String> {
        let origin = self.origin(entity);
        let text = self.file(origin.file)?.text();
        let path =
            vec![PathStep::Field(origin.list), PathStep::Index(origin.index), PathStep::Field("material")];
        let written = locate(text, &[path]).pop()?;
        // Without a `material` field the span covers the whole entity, which is not a string.
        ron::from_str(text.get(written)?).ok()
    }

    /// Returns the text of a file.
    pub(super) fn file(&self, file: usize) -> Option<&SourceText> {
        self.files.get(file)
    }

    pub(super) fn origin(&self, entity: usize) -> Origin {
        let after = self.runs.partition_point(|run| run.first <= entity);
        match after.checked_sub(1).and_then(|last| self.runs.get(last)) {
            Some(run) => Origin { index: run.origin.index + (entity - run.first), ..run.origin },
            None => Origin { file: 0, list: "entities", index: entity },
        }
    }

    /// Returns the document index of the first entity that comes from an element of a list.
    #[cfg(feature = "live")]
    pub(super) fn order_of(&self, file: usize, list: &str, index: usize) -> Option<usize> {
        let run = self.runs.iter().find(|Run { origin, .. }| {
            (origin.file, origin.list) == (file, list)
                && origin.index <= index
                && (list != "include" || origin.index == index)
        })?;
        Some(run.first + index - run.origin.index)
    }

    fn lines(&self, file: usize, paths: &[Vec<PathStep>]) -> impl Iterator<Item = SourceLine<'_>> {
        let found = self.files.get(file);
        let spans =
            found.map(|source| locate(source.text(), paths).into_iter().map(|span| source.line(&span)));
        spans.into_iter().flatten()
    }
}
