//! The names that a scene defines: the outline, and the places where names are defined.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::scan::{BracketPart, BracketScan, OpenBracket};
use crate::scene::input::{InputKind, LARGEST_FILE, read};
use crate::scene::parse::{Expectation, owner, pending};
use crate::scene::reference::{FieldEntry, section};
use crate::scene::spans::literal_text;

/// The kind of a symbol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SymbolKind {
    /// An included file.
    Include,
    /// A material.
    Material,
    /// A camera.
    Camera,
    /// An entity.
    Entity,
    /// An animated value.
    Animation,
}

/// A part of a scene with a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneSymbol {
    /// The kind.
    pub kind: SymbolKind,
    /// The name. An animation has its target and channel; an unnamed include its file; an unnamed entity none.
    pub name: String,
    /// The bytes of the whole part.
    pub span: Range<usize>,
    /// The bytes of the name, or the first byte.
    pub name_span: Range<usize>,
    /// The file of an include.
    file: Option<String>,
}

/// The place where a name is defined.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Destination {
    /// The file; `None` for the same text.
    pub file: Option<PathBuf>,
    /// The bytes in the text of the file.
    pub span: Range<usize>,
}

/// Returns the symbols of a text, in its order.
#[must_use]
pub fn outline(text: &str) -> Vec<SceneSymbol> {
    let mut symbols = Vec::new();
    BracketScan::whole(text, &mut |open, part| symbols.extend(symbol(text, open, part)));
    symbols
}

fn symbol(text: &str, open: &[OpenBracket<'_>], part: &BracketPart) -> Option<SceneSymbol> {
    let of = |span: &Range<usize>| text.get(span.clone()).unwrap_or_default();
    let list = match open {
        [scene, _list] => of(scene.name.as_ref()?),
        // The members of an item.
        _ => return None,
    };
    let camera = || (SymbolKind::Camera, part.name.clone());
    let (kind, name_span) = match (list, &part.name) {
        ("materials", Some(key)) => (SymbolKind::Material, Some(key.clone())),
        ("cameras", Some(_)) => camera(),
        ("entities" | "clouds", None) => (SymbolKind::Entity, None),
        ("include", None) => (SymbolKind::Include, None),
        ("animate", None) => (SymbolKind::Animation, None),
        _ => return None,
    };
    let fields = if name_span.is_some() { Vec::new() } else { fields(text, part.value.clone()) };
    let field =
        |name: &str| fields.iter().find(|(known, _)| of(known) == name).map(|(_, value)| value.clone());
    let written = |name: &str| literal_text(of(&field(name)?));
    let file = written("file");
    let name = match (kind, &name_span) {
        (_, Some(key)) => literal_text(of(key))?,
        (SymbolKind::Animation, None) => {
            let target = written("target").or_else(|| written("material")).unwrap_or_default();
            format!("{target} {}", field("channel").as_ref().map(of).unwrap_or_default())
        }
        _ => written("name").or_else(|| file.clone()).unwrap_or_default(),
    };
    let first = part.value.start..(part.value.start + 1).min(part.value.end);
    let name_span = name_span.or_else(|| field("name")).unwrap_or(first);
    let span = name_span.start.min(part.value.start)..part.value.end.max(name_span.end);
    Some(SceneSymbol { kind, name, span, name_span, file })
}

/// Returns the fields of the bracket in a part of a text.
fn fields(text: &str, span: Range<usize>) -> Vec<(Range<usize>, Range<usize>)> {
    let mut fields = Vec::new();
    let moved = |inside: &Range<usize>| inside.start + span.start..inside.end + span.start;
    BracketScan::whole(text.get(span.clone()).unwrap_or_default(), &mut |open, part| {
        if let (1, Some(name)) = (open.len(), &part.name) {
            fields.push((moved(name), moved(&part.value)));
        }
    });
    fields
}

/// The meaning of a name at a position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct NamesAsked {
    pub(super) materials: bool,
    pub(super) entities: bool,
    pub(super) cameras: bool,
    pub(super) files: bool,
}

/// Returns which names are asked for at a position, as the reference says.
pub(super) fn asked(scan: &BracketScan<'_>) -> NamesAsked {
    let depth = scan.open.len();
    if let Some(open) = pending(&scan.skeleton(depth, false))
        && open.iter().any(
            |request| matches!(request, Expectation::Values { reader, .. } if reader.starts_with("a shot")),
        )
    {
        return NamesAsked { cameras: true, ..NamesAsked::default() };
    }
    let Some(inner) = (0..depth).rev().find(|index| scan.open[*index].name.is_some()) else {
        // The content of a word, as in `ScriptFile("wave.rhai")`.
        return NamesAsked::default();
    };
    let is_file = scan.open.last().is_some_and(|last| ["File", "ScriptFile"].contains(&last.word));
    let name = scan.open[inner].name.clone().map(|span| &scan.text[span]).unwrap_or_default();
    let meaning = owner(&scan.skeleton(inner + 1, true))
        .and_then(|owner| section(owner.of)?.field(name))
        .map_or("", |FieldEntry { meaning, .. }| meaning);
    let says = |words: &[&str]| words.iter().any(|word| meaning.contains(word));
    NamesAsked {
        materials: says(&["name of a material", "name of a Material"]),
        entities: says(&["name of an entity", "name of the entity", "names of entities"]),
        cameras: says(&["or a camera", "and cameras"]),
        files: is_file || says(&["path of a scene"]),
    }
}

impl NamesAsked {
    pub(super) fn includes(self, kind: SymbolKind) -> bool {
        match kind {
            SymbolKind::Material => self.materials,
            SymbolKind::Camera => self.cameras,
            // An include with a name is an entity.
            SymbolKind::Entity | SymbolKind::Include => self.entities,
            SymbolKind::Animation => false,
        }
    }
}

/// A name that a scene can use.
#[derive(Clone, Debug)]
pub(super) struct KnownName {
    pub(super) kind: SymbolKind,
    pub(super) name: String,
    pub(super) destination: Destination,
}

/// Returns the names of a text, and of the files that it includes and extends. Paths are relative to the folder of `path`.
pub(super) fn known_names(text: &str, path: &Path) -> Vec<KnownName> {
    /// Maximum depth of files, as when they are loaded.
    const DEEPEST: usize = 32;
    /// Maximum number of files that are read.
    const MOST_FILES: usize = 1000;
    let (mut names, mut left) = (Vec::new(), MOST_FILES);
    collect(text, path, None, "", DEEPEST, &mut left, &mut names);
    names
}

fn collect(
    text: &str,
    path: &Path,
    file: Option<&Path>,
    prefix: &str,
    depth: usize,
    left: &mut usize,
    names: &mut Vec<KnownName>,
) {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut further = Vec::new();
    for SceneSymbol { kind, name, name_span, file: included, .. } in outline(text) {
        let own_name = (Some(&name) != included.as_ref()).then_some(&name).filter(|name| !name.is_empty());
        if let Some(included) = included {
            let prefix = own_name.map_or_else(|| prefix.to_owned(), |name| format!("{prefix}{name}/"));
            further.push((included, prefix));
        }
        if let Some(name) = own_name {
            let destination = Destination { file: file.map(Path::to_owned), span: name_span };
            names.push(KnownName { kind, name: format!("{prefix}{name}"), destination });
        }
    }
    let base = fields(text, 0..text.len()).into_iter().find(|(name, _)| &text[name.clone()] == "extends");
    further.extend(base.and_then(|(_, value)| Some((literal_text(&text[value])?, prefix.to_owned()))));
    for (included, prefix) in further {
        if depth == 0 || *left == 0 {
            return;
        }
        *left -= 1;
        let path = folder.join(included);
        let bytes = read(&path, InputKind::Refused, LARGEST_FILE).unwrap_or_default();
        let text = String::from_utf8(bytes).unwrap_or_default();
        collect(&text, &path, Some(&path), &prefix, depth - 1, left, names);
    }
}

/// Returns the place where the name at a position is defined: a material, an entity or a camera, or the start of a file. Paths are relative
/// to the folder of `path`.
#[must_use]
pub fn definition(text: &str, at: usize, path: &Path) -> Option<Destination> {
    let (scan, token) = BracketScan::until(text, text.floor_char_boundary(at + 1));
    let name = literal_text(text.get(token)?)?;
    let asked = asked(&scan);
    if asked.files {
        let file = path.parent().unwrap_or(Path::new("")).join(name);
        return file.is_file().then_some(Destination { file: Some(file), span: 0..0 });
    }
    let mut names = known_names(text, path).into_iter();
    names.find(|known| known.name == name && asked.includes(known.kind)).map(|known| known.destination)
}
