//! The names that a file can refer to.

use std::borrow::Cow;

use super::names::{Clashes, Meaning, Names};
use super::{Origin, SceneFile};
use crate::scene::document::{
    CloudDocument, EntityDocument, LightDocument, MaterialDocument, ShapeDocument, SpaceDocument,
    SurfaceDocument, parse_particle_name,
};

/// The result of looking up a name.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene) enum Lookup<T> {
    Found(T),
    Missing,
    /// The name may exist in a file that was not read.
    Unread,
}

impl<T> Lookup<T> {
    pub(in crate::scene) fn is_missing(&self) -> bool {
        matches!(self, Self::Missing)
    }

    pub(in crate::scene) fn found(self) -> Option<T> {
        match self {
            Self::Found(found) => Some(found),
            Self::Missing | Self::Unread => None,
        }
    }
}

/// The parts of an entity that other elements depend on.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::scene) struct KnownEntity<'a> {
    pub(in crate::scene) shape: Option<&'a ShapeDocument>,
    pub(in crate::scene) light: Option<&'a LightDocument>,
    pub(in crate::scene) material: Option<&'a MaterialDocument>,
    /// True if it points to a point.
    pub(in crate::scene) has_target: bool,
    /// True if it points to an entity.
    pub(in crate::scene) looks_at: bool,
    /// The cloud, if it is one.
    pub(in crate::scene) cloud: Option<&'a CloudDocument>,
}

/// The names visible in one file. A name in a named include is written `part/name`.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene) struct Scope<'a> {
    names: &'a [Names<'a>],
    files: &'a [SceneFile],
    file: usize,
}

impl<'a> Scope<'a> {
    pub(super) fn new(names: &'a [Names<'a>], files: &'a [SceneFile], file: usize) -> Self {
        Self { names, files, file }
    }

    /// Returns whether the file is the scene's own.
    pub(in crate::scene) fn is_scene(self) -> bool {
        self.file == 0
    }

    /// Returns the space of the whole scene.
    pub(in crate::scene) fn space(self) -> SpaceDocument {
        let scene = self.files.first().and_then(|scene| scene.document.as_ref());
        scene.and_then(|scene| scene.space).unwrap_or_default()
    }

    /// Returns whether the file extends another one.
    pub(in crate::scene) fn is_extended(self) -> bool {
        self.files[self.file].source.is_composed()
    }

    pub(in crate::scene) fn entity(self, name: &str) -> Lookup<KnownEntity<'a>> {
        match self.own().entities.get(name) {
            Some(Meaning::Entity(entity, file)) => {
                let material = match &entity.material {
                    Some(SurfaceDocument::Named(name)) => self.of(*file).material(name).found(),
                    Some(SurfaceDocument::Inline(material)) => Some(&**material),
                    None => None,
                };
                let (shape, light) = (entity.shape.as_ref(), entity.light.as_deref());
                let (has_target, looks_at) = (entity.target.is_some(), entity.look_at.is_some());
                let cloud = self.of(*file).cloud(entity);
                Lookup::Found(KnownEntity { shape, light, material, has_target, looks_at, cloud })
            }
            Some(Meaning::Part(_)) => Lookup::Found(KnownEntity::default()),
            None => match parse_particle_name(name).and_then(|(cloud, _)| self.own().entities.get(cloud)) {
                Some(Meaning::Entity(entity, file)) if self.of(*file).cloud(entity).is_some() => {
                    Lookup::Found(KnownEntity::default())
                }
                _ => self.in_part(name, Self::entity),
            },
        }
    }

    /// Returns the cloud that an entity of the file is, if it is one.
    fn cloud(self, entity: &EntityDocument) -> Option<&'a CloudDocument> {
        let mut clouds = self.files[self.file].document.iter().flat_map(|document| &document.clouds);
        clouds.find(|cloud| cloud.name.is_some() && cloud.name == entity.name)
    }

    pub(in crate::scene) fn material(self, name: &str) -> Lookup<&'a MaterialDocument> {
        match self.own().materials.get(name) {
            Some(material) => Lookup::Found(material),
            None => self.in_part(name, Self::material),
        }
    }

    /// Looks up a name written `part/name`.
    fn in_part<T>(self, name: &str, look_up: impl Fn(Self, &str) -> Lookup<T>) -> Lookup<T> {
        let part = name.split_once('/').and_then(|(part, rest)| Some((self.own().entities.get(part)?, rest)));
        match part {
            Some((Meaning::Part(Some(file)), rest)) => look_up(self.of(*file), rest),
            Some((Meaning::Part(None), _)) => Lookup::Unread,
            _ if self.own().incomplete => Lookup::Unread,
            _ => Lookup::Missing,
        }
    }

    pub(in crate::scene) fn entity_names(self) -> Vec<Cow<'a, str>> {
        let mut names = Vec::new();
        self.collect("", &|names| &names.entities.names, &mut names);
        names
    }

    pub(in crate::scene) fn material_names(self) -> Vec<Cow<'a, str>> {
        let mut names = Vec::new();
        self.collect("", &|names| &names.materials.names, &mut names);
        names
    }

    /// Collects the file's own names, and the names in its named includes up to a limit.
    fn collect(
        self,
        prefix: &str,
        select: &impl Fn(&'a Names<'a>) -> &'a Vec<&'a str>,
        into: &mut Vec<Cow<'a, str>>,
    ) {
        /// The number of names after which no further includes are visited.
        const MOST: usize = 10_000;
        let own = self.own();
        let prefixed = |name: &&'a str| match prefix {
            "" => Cow::Borrowed(*name),
            _ => Cow::Owned(format!("{prefix}{name}")),
        };
        into.extend(select(own).iter().map(prefixed));
        for name in &own.entities.names {
            if into.len() > MOST {
                return;
            }
            if let Some(Meaning::Part(Some(file))) = own.entities.get(name) {
                self.of(*file).collect(&format!("{prefix}{name}/"), select, into);
            }
        }
    }

    /// Returns the names defined in several files.
    pub(in crate::scene) fn clashes(self) -> &'a Clashes<'a> {
        &self.own().clashes
    }

    /// Returns the number of entities, materials and animations from included files.
    pub(in crate::scene) fn included(self) -> u64 {
        self.own().included
    }

    /// Returns whether a condition holds for any directly included file.
    pub(in crate::scene) fn any_part(self, is_so: impl Fn(Self) -> bool) -> bool {
        self.files[self.file].includes.iter().flatten().any(|part| is_so(self.of(*part)))
    }

    /// Returns the name of an origin's file, for example `parts/car.ron`.
    pub(in crate::scene) fn file_name(self, origin: Origin) -> &'a str {
        self.files[origin.file].source.name()
    }

    /// Returns the file and line of an origin, for example `parts/car.ron:12`.
    pub(in crate::scene) fn file_and_line(self, origin: Origin) -> String {
        self.files[origin.file].source.line_of(&origin.path()).to_string()
    }

    fn own(self) -> &'a Names<'a> {
        &self.names[self.file]
    }

    fn of(self, file: usize) -> Self {
        Self { file, ..self }
    }
}
