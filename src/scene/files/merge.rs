//! Merges the documents of several files into one.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use super::{Files, Origin};
use crate::components::Property;
use crate::scene::document::{
    AnimationDocument, EntityDocument, IncludeDocument, MaterialDocument, SceneDocument,
};
use crate::scene::sources::{Run, Sources};

/// A scene with its includes resolved. Included content precedes the content of the including file; the content of each include is
/// contiguous.
#[derive(Debug)]
pub(in crate::scene) struct Merged {
    pub(in crate::scene) document: SceneDocument,
    /// Pairs of an entity and a parent that the files do not name, by document index.
    pub(in crate::scene) parents: Vec<(usize, usize)>,
    /// The uses of scripts: the index of the script, and the prefix of the names in its file. Animations refer to this list by index.
    pub(in crate::scene) uses: Vec<(usize, String)>,
}

impl Files {
    /// Merges the files, which must be free of errors, into one scene.
    pub(in crate::scene) fn merge(self) -> (Merged, Sources) {
        let mut parts = Vec::new();
        let mut texts = Vec::new();
        for file in self.files {
            parts.extend(file.document.map(|document| (document, file.includes)));
            texts.push(file.source);
        }
        let mut parts = parts.into_iter();
        let scene = parts.next().map(|(document, includes)| (document, flat(includes)));
        let parts: Vec<ParsedPart> = parts.map(|(document, includes)| (document, flat(includes))).collect();
        let (merged, runs) = match scene {
            Some((scene, includes)) => Merger::new(&parts).merge(scene, &includes),
            None => Merger::new(&[]).merge(SceneDocument::default(), &[]),
        };
        let cameras = merged.document.cameras.0.iter().map(|(name, _)| name.clone()).collect();
        (merged, Sources::new(texts, runs, cameras))
    }
}

fn flat(includes: Vec<Option<usize>>) -> Vec<usize> {
    includes.into_iter().flatten().collect()
}

/// A document, and the file indices of its includes.
type ParsedPart = (SceneDocument, Vec<usize>);

/// The target, the material and the property of an animation.
type AnimatedValue = (Option<String>, Option<String>, Property);

struct Merger<'a> {
    /// All files except the first.
    parts: &'a [ParsedPart],
    materials: Vec<(String, MaterialDocument)>,
    known_materials: HashSet<String>,
    entities: Vec<Arc<EntityDocument>>,
    animate: Vec<AnimationDocument>,
    animated: HashMap<AnimatedValue, usize>,
    parents: Vec<(usize, usize)>,
    uses: Vec<(usize, String)>,
    runs: Vec<Run>,
}

impl<'a> Merger<'a> {
    fn new(parts: &'a [ParsedPart]) -> Self {
        Self {
            parts,
            materials: Vec::new(),
            known_materials: HashSet::new(),
            entities: Vec::new(),
            animate: Vec::new(),
            animated: HashMap::new(),
            parents: Vec::new(),
            uses: Vec::new(),
            runs: Vec::new(),
        }
    }

    fn merge(mut self, mut scene: SceneDocument, includes: &[usize]) -> (Merged, Vec<Run>) {
        self.add_includes(0, &scene.include, includes, "", None);
        self.start_run(0, "entities", 0);
        self.start_clouds(0, &scene);
        if !includes.is_empty() {
            self.materials.append(&mut scene.materials.0);
            self.entities.append(&mut scene.entities);
            for animation in std::mem::take(&mut scene.animate) {
                self.add_animation(animation, "");
            }
            scene.materials.0 = self.materials;
            scene.entities = self.entities;
            scene.animate = self.animate;
        } else {
            for animation in &mut scene.animate {
                use_script(animation, "", &mut self.uses);
            }
        }
        (Merged { document: scene, parents: self.parents, uses: self.uses }, self.runs)
    }

    fn add_includes(
        &mut self,
        file: usize,
        includes: &[IncludeDocument],
        parts: &[usize],
        prefix: &str,
        parent: Option<usize>,
    ) {
        for (index, (include, part)) in includes.iter().zip(parts).enumerate() {
            let (mut prefix, mut parent) = (prefix.to_owned(), parent);
            let name = include.name.as_ref().map(|name| format!("{prefix}{name}"));
            if name.is_some() || include.transform.is_some() {
                self.start_run(file, "include", index);
                let transform = include.transform.clone().unwrap_or_default();
                let own = EntityDocument { name: name.clone(), transform, ..EntityDocument::default() };
                parent = Some(self.add_entity(own, parent));
            }
            if let Some(name) = name {
                prefix = name + "/";
            }
            self.add_part(*part, &prefix, parent);
        }
    }

    fn add_part(&mut self, file: usize, prefix: &str, parent: Option<usize>) {
        let Some((part, includes)) = file.checked_sub(1).and_then(|index| self.parts.get(index)) else {
            return;
        };
        let prefixed = |name: &String| format!("{prefix}{name}");
        let boxed = |name: &Option<Box<String>>| name.as_deref().map(|name| Box::new(prefixed(name)));
        self.add_includes(file, &part.include, includes, prefix, parent);
        for (name, material) in &part.materials.0 {
            let name = format!("{prefix}{name}");
            // The same file may be included through several paths.
            if self.known_materials.insert(name.clone()) {
                self.materials.push((name, material.clone()));
            }
        }
        self.start_run(file, "entities", 0);
        self.start_clouds(file, part);
        for entity in &part.entities {
            let renamed = EntityDocument {
                name: entity.name.as_ref().map(prefixed),
                parent: boxed(&entity.parent),
                look_at: boxed(&entity.look_at),
                material: entity.material.as_ref().map(|material| material.prefixed(prefix)),
                ..EntityDocument::clone(entity)
            };
            self.add_entity(renamed, parent.filter(|_| entity.parent.is_none()));
        }
        // Animations of cameras and of the whole scene are dropped.
        let stays_out = |name: &str| {
            [SceneDocument::CAMERA, SceneDocument::SCENE].contains(&name)
                || part.named_cameras().any(|(own, _)| own == name)
        };
        for animation in &part.animate {
            if !animation.target.as_deref().is_some_and(stays_out) {
                let [target, material] =
                    [&animation.target, &animation.material].map(|name| name.as_ref().map(prefixed));
                self.add_animation(AnimationDocument { target, material, ..animation.clone() }, prefix);
            }
        }
    }

    /// Adds an entity and returns its document index.
    fn add_entity(&mut self, entity: EntityDocument, parent: Option<usize>) -> usize {
        let index = self.entities.len();
        self.parents.extend(parent.map(|parent| (index, parent)));
        self.entities.push(Arc::new(entity));
        index
    }

    /// Adds an animation. It replaces an animation of the same value from an include.
    fn add_animation(&mut self, mut animation: AnimationDocument, prefix: &str) {
        use_script(&mut animation, prefix, &mut self.uses);
        let what = (animation.target.clone(), animation.material.clone(), animation.channel.0);
        let index = *self.animated.entry(what).or_insert(self.animate.len());
        match self.animate.get_mut(index) {
            Some(former) => *former = animation,
            None => self.animate.push(animation),
        }
    }

    fn start_run(&mut self, file: usize, list: &'static str, index: usize) {
        self.runs.push(Run { first: self.entities.len(), origin: Origin { file, list, index } });
    }

    /// Starts the run of a document's clouds, which follow its other entities.
    fn start_clouds(&mut self, file: usize, document: &SceneDocument) {
        if let Some(first) = document.first_cloud() {
            let origin = Origin { file, list: SceneDocument::CLOUDS, index: 0 };
            self.runs.push(Run { first: self.entities.len() + first, origin });
        }
    }
}

/// Adds a use of the animation's script, if it has one, and stores the index of the use in the animation.
fn use_script(animation: &mut AnimationDocument, prefix: &str, uses: &mut Vec<(usize, String)>) {
    if let Some(script) = &mut animation.script {
        uses.push((*script, prefix.to_owned()));
        *script = uses.len() - 1;
    }
}
