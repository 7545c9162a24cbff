//! The names defined in the files of a scene.

use hashbrown::HashMap;
use hashbrown::hash_map::Entry;

use super::{Files, Origin, SceneFile};
use crate::scene::document::{EntityDocument, MaterialDocument, SceneDocument};
use crate::scene::validate::ProblemList;

/// The names visible in a file: its own, the names given to its includes, and all names in its unnamed includes.
#[derive(Debug, Default)]
pub(in crate::scene) struct Names<'a> {
    pub(super) entities: NameTable<'a, Meaning<'a>>,
    pub(super) materials: NameTable<'a, &'a MaterialDocument>,
    /// True if some names are unknown, because a file could not be read or because there are too many names.
    pub(super) incomplete: bool,
    pub(super) clashes: Clashes<'a>,
    /// The number of entities, materials and animations in its includes.
    pub(super) included: u64,
    /// `included` plus the number of its own entities, materials and animations.
    size: u64,
}

/// Maximum number of entities, materials and animations from included files.
pub(in crate::scene) const MOST_INCLUDED: u64 = 4_000_000;

/// Names defined in several files. Beyond [`ProblemList::MOST`] they are only counted.
#[derive(Debug, Default)]
pub(in crate::scene) struct Clashes<'a> {
    pub(in crate::scene) listed: Vec<Clash<'a>>,
    pub(in crate::scene) unlisted: usize,
    /// The last reported repetition: the include, and the file that it repeats.
    repeated: Option<(usize, usize)>,
}

/// The object that an entity name refers to.
#[derive(Clone, Copy, Debug)]
pub(super) enum Meaning<'a> {
    /// An entity, and the index of its file.
    Entity(&'a EntityDocument, usize),
    /// The parent of all entities of an include, with the index of the included file; `None` if the file cannot be read.
    Part(Option<usize>),
}

/// A table of names in document order.
#[derive(Debug)]
pub(super) struct NameTable<'a, T> {
    pub(super) names: Vec<&'a str>,
    entries: HashMap<&'a str, (Origin, T)>,
}

impl<T> Default for NameTable<'_, T> {
    fn default() -> Self {
        Self { names: Vec::new(), entries: HashMap::new() }
    }
}

impl<'a, T> NameTable<'a, T> {
    /// Reserves space for `count` more names.
    fn reserve(&mut self, count: usize) {
        self.names.reserve(count);
        self.entries.reserve(count);
    }

    /// Inserts a name. Returns the origin of the existing entry if the name is taken.
    fn insert(&mut self, name: &'a str, origin: Origin, value: T) -> Result<(), Origin> {
        match self.entries.entry(name) {
            Entry::Occupied(taken) => Err(taken.get().0),
            Entry::Vacant(free) => {
                self.names.push(name);
                free.insert((origin, value));
                Ok(())
            }
        }
    }

    pub(super) fn get(&self, name: &str) -> Option<&T> {
        self.entries.get(name).map(|(_, value)| value)
    }
}

/// A name that is defined twice.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene) struct Clash<'a> {
    pub(in crate::scene) name: &'a str,
    /// The origin of the first definition.
    pub(in crate::scene) first: Origin,
    pub(in crate::scene) second: Origin,
    /// The include that contributes the second definition; `None` if the file itself defines it.
    pub(in crate::scene) include: Option<usize>,
}

impl Clash<'_> {
    /// Returns whether the same file is included through several paths.
    pub(in crate::scene) fn is_repeated(&self) -> bool {
        self.first == self.second
    }
}

impl<'a> Clashes<'a> {
    /// Adds a clash. A repeated file counts as one clash, regardless of its content.
    fn add(&mut self, clash: Clash<'a>) {
        if let Some(include) = clash.include.filter(|_| clash.is_repeated()) {
            let repeated = Some((include, clash.first.file));
            if std::mem::replace(&mut self.repeated, repeated) == repeated {
                return;
            }
        }
        if self.listed.len() < ProblemList::MOST {
            self.listed.push(clash);
        } else {
            self.unlisted += 1;
        }
    }
}

impl<'a> Names<'a> {
    fn of_file(index: usize, file: &'a SceneFile, parts: &[Self]) -> Self {
        let Some(document) = &file.document else {
            return Self { incomplete: true, ..Self::default() };
        };
        let mut names = Self::default();
        names.entities.reserve(document.entities.len());
        for (place, (include, part)) in document.include.iter().zip(&file.includes).enumerate() {
            let size = part.map_or(0, |part| parts[part].size);
            names.included = names.included.saturating_add(size).saturating_add(1);
            match (&include.name, part) {
                (Some(name), part) => {
                    let origin = Origin { file: index, list: "include", index: place };
                    names.add_entity(name, origin, Meaning::Part(*part), None);
                }
                (None, Some(part)) if names.included <= MOST_INCLUDED => names.join(&parts[*part], place),
                (None, _) => names.incomplete = true,
            }
        }
        for (place, (name, material)) in document.materials.0.iter().enumerate() {
            let origin = Origin { file: index, list: "materials", index: place };
            names.add_material(name, origin, material, None);
        }
        for (place, entity) in document.entities.iter().enumerate() {
            if let Some(name) = &entity.name {
                let (list, place) = document.place_of(place);
                let origin = Origin { file: index, list, index: place };
                names.add_entity(name, origin, Meaning::Entity(entity, index), None);
            }
        }
        let own = document.materials.0.len() + document.entities.len() + document.animate.len();
        names.size = names.included.saturating_add(own as u64);
        names
    }

    /// Adds the names of an include without a name.
    fn join(&mut self, part: &Self, include: usize) {
        self.incomplete |= part.incomplete;
        for name in &part.entities.names {
            let (origin, meaning) = part.entities.entries[name];
            self.add_entity(name, origin, meaning, Some(include));
        }
        for name in &part.materials.names {
            let (origin, material) = part.materials.entries[name];
            self.add_material(name, origin, material, Some(include));
        }
    }

    fn add_entity(&mut self, name: &'a str, second: Origin, meaning: Meaning<'a>, include: Option<usize>) {
        if let Err(first) = self.entities.insert(name, second, meaning) {
            self.add_clash(Clash { name, first, second, include });
        }
    }

    /// Adds a material. The same material may be included through several paths.
    fn add_material(
        &mut self,
        name: &'a str,
        second: Origin,
        material: &'a MaterialDocument,
        include: Option<usize>,
    ) {
        if let Err(first) = self.materials.insert(name, second, material)
            && first != second
        {
            self.add_clash(Clash { name, first, second, include });
        }
    }

    /// Adds a clash, unless it is within one list of entities, clouds among them, or of materials of the file itself, which involves no
    /// include.
    fn add_clash(&mut self, clash: Clash<'a>) {
        let Clash { first, second, include, .. } = clash;
        let list = |origin: Origin| match origin.list {
            SceneDocument::CLOUDS => SceneDocument::ENTITIES,
            list => list,
        };
        let same_list = (first.file, list(first)) == (second.file, list(second));
        if include.is_some() || !same_list || second.list == "include" {
            self.clashes.add(clash);
        }
    }
}

/// Collects the names of every file.
pub(super) fn of_files(files: &Files) -> Vec<Names<'_>> {
    let mut names: Vec<Names<'_>> = files.files.iter().map(|_| Names::default()).collect();
    for index in &files.parts_first {
        names[*index] = Names::of_file(*index, &files.files[*index], &names);
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Includes two files with the same names, each a hundred times.
    #[test]
    fn clashes_are_counted_and_few_are_listed() {
        let folder = tempfile::tempdir().unwrap();
        let entities = "(name: \"a\"), (name: \"b\"), (name: \"c\"),";
        for file in ["one.ron", "two.ron"] {
            std::fs::write(folder.path().join(file), format!("(entities: [{entities}])")).unwrap();
        }
        let text = format!("(include: [{}])", "(file: \"one.ron\"), (file: \"two.ron\"),".repeat(100));
        let files = Files::from_text(&folder.path().join("scene.ron"), text);
        let names = of_files(&files);
        assert_eq!(names[0].included, 200 * 4);
        let Clashes { listed, unlisted, .. } = &names[0].clashes;
        // Each include of the second file adds three clashes. The first file is repeated 99 times, each time as one clash.
        assert_eq!((listed.len(), listed.len() + unlisted), (ProblemList::MOST, 100 * 3 + 99));
        assert_eq!(listed.iter().filter(|clash| clash.is_repeated()).count(), 12);
    }
}
