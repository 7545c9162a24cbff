//! Insertion of a value into the text of a scene.

use std::ops::Range;

use super::{NAMED, Override};
use crate::scene::quote::short;
use crate::scene::spans::{Bracket, bracket, literal_text, own_name, root};
use crate::scene::suggest::{listed, remedy};

/// An error in resolving the path of an override.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::scene) enum PathError {
    /// No element of this kind in the list has the name. `known` holds the existing names.
    Unknown { kind: &'static str, list: String, name: String, known: Vec<String> },
    /// The path has a step that does not exist.
    NoParts { message: String, help: String },
}

impl PathError {
    /// Adds the known names of another file.
    pub(super) fn or_in(&mut self, other: Self) {
        if let (Self::Unknown { known, .. }, Self::Unknown { known: others, .. }) = (self, other) {
            known.extend(others);
        }
    }

    /// Returns the cause and the remedy.
    pub(super) fn explain(&self) -> (String, String) {
        match self {
            Self::Unknown { kind, list, name, known } => {
                let known: Vec<&str> = known.iter().map(String::as_str).collect();
                // An unquoted name ends at its first dot.
                let cut =
                    known.iter().find(|known| known.split_once('.').is_some_and(|(start, _)| start == name));
                let help = match cut {
                    Some(full) => {
                        format!(
                            "put a name with dots in quotes, and all in others for the shell: '{list}.\"{}\"...'",
                            short(full)
                        )
                    }
                    None => remedy(name, &known, list),
                };
                (format!("there is no {kind} called `{}`", short(name)), help)
            }
            Self::NoParts { message, help } => (message.clone(), help.clone()),
        }
    }
}

/// A replacement of a part of a text.
#[derive(Clone, Debug)]
pub(super) struct Edit {
    pub(super) range: Range<usize>,
    pub(super) text: String,
}

/// Returns the edit that puts the overriding value at its path in the text of a scene. `None` for a text that is not a scene.
pub(super) fn edit_for(text: &str, overriding: &Override) -> Result<Option<Edit>, PathError> {
    let Override { path, value } = overriding;
    if let Some(step) = path.first().filter(|step| ["extends", "without"].contains(&step.as_str())) {
        let message = format!("`{step}` applies before values are set");
        return Err(PathError::NoParts { message, help: "write it in the file".to_owned() });
    }
    let mut place = root(text)..text.len();
    for (depth, step) in path.iter().enumerate() {
        let Some(parts) = bracket(text, place.start) else {
            return if depth == 0 { Ok(None) } else { Err(no_parts(&path[..depth], &text[place])) };
        };
        let kind = if depth == 1 { named_kind(path) } else { None };
        place = match parts.find(text, step, kind.is_some()) {
            Some(found) => found,
            None if depth == 0 && overriding.is_named() => {
                return Err(unknown(path, Vec::new(), named_kind(path).unwrap_or_default()));
            }
            None if depth == 0
                && step == "camera"
                && path.len() > 1
                && parts.find(text, "cameras", false).is_some() =>
            {
                return Err(parts.many_cameras(text, &path[1..]));
            }
            None if parts.takes_field(step) => return Ok(Some(parts.with_field(&path[depth..], value))),
            None => return Err(parts.unknown(text, &path[..=depth], kind)),
        };
    }
    Ok(Some(Edit { range: place, text: value.clone() }))
}

/// Returns the span of the value at a path in the text of a scene.
pub(super) fn value_at(text: &str, path: &[String]) -> Option<Range<usize>> {
    let mut place = root(text)..text.len();
    for (depth, step) in path.iter().enumerate() {
        place = bracket(text, place.start)?.find(text, step, depth == 1 && named_kind(path).is_some())?;
    }
    Some(place)
}

/// Returns whether a path has the index of an entity of a scene that extends another: the index then counts the entities of both.
pub(super) fn counts_other_files(text: &str, path: &[String]) -> bool {
    let has_index =
        named_kind(path).is_some() && path.get(1).is_some_and(|step| step.parse::<usize>().is_ok());
    let scene = || bracket(text, root(text));
    has_index && scene().is_some_and(|scene| scene.find(text, "extends", false).is_some())
}

impl Edit {
    /// Returns the edit with as many newlines as the replaced text of a scene, so that the following text stays on its line.
    pub(super) fn on_its_lines(self, scene: &str) -> Self {
        let lines = |text: &str| text.matches('\n').count();
        let missing = lines(&scene[self.range.clone()]).saturating_sub(lines(&self.text));
        Self { text: [self.text.as_str(), &"\n".repeat(missing)].concat(), ..self }
    }
}

impl Bracket {
    /// Returns the value of a field or an entry, or the value at an index. With `by_name`, an entity is also found by its name.
    fn find(&self, text: &str, step: &str, by_name: bool) -> Option<Range<usize>> {
        let named = self.members.iter().find(|member| match &member.name {
            Some(name) if self.opening == b'{' => literal_text(&text[name.clone()]).as_deref() == Some(step),
            Some(name) => &text[name.clone()] == step,
            None => by_name && own_name(text, &member.value).as_deref() == Some(step),
        });
        let at_index =
            || self.members.get(step.parse::<usize>().ok()?).filter(|member| member.name.is_none());
        Some(named.or_else(at_index)?.value.clone())
    }

    /// Returns whether the bracket can take a field of this name.
    fn takes_field(&self, step: &str) -> bool {
        let is_name = step.chars().all(|character| character.is_alphanumeric() || character == '_')
            && !step.starts_with(|first: char| first.is_numeric());
        self.opening == b'(' && is_name && self.members.iter().all(|member| member.name.is_some())
    }

    /// Returns the edit that adds a field for the path. Later steps of the path become nested fields.
    fn with_field(&self, path: &[String], value: &str) -> Edit {
        let leading: String = path.iter().map(|step| format!("{step}: (")).collect();
        let (leading, closing) = (leading.trim_end_matches('('), ")".repeat(path.len() - 1));
        let (at, comma) = self.members.last().map_or((self.start, ""), |last| (last.value.end, ", "));
        Edit { range: at..at, text: format!("{comma}{leading}{value}{closing}") }
    }

    /// Returns the error for a scene with `cameras` instead of `camera`. The remedy shows how to refer to one of them.
    fn many_cameras(&self, text: &str, path: &[String]) -> PathError {
        let cameras = self.find(text, "cameras", false).and_then(|list| bracket(text, list.start));
        let names = cameras.map_or_else(Vec::new, |cameras| cameras.names(text));
        let first = names.first().map_or("main", String::as_str);
        let example = Override {
            path: [&["cameras".to_owned(), first.to_owned()], path].concat(),
            value: "..".to_owned(),
        };
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        PathError::NoParts {
            message: "the scene has `cameras` and no `camera`".to_owned(),
            help: format!(
                "name one of them, as in {}; the cameras are {}",
                short(&example.to_string()),
                listed(&names)
            ),
        }
    }

    /// Returns the keys of a map.
    fn names(&self, text: &str) -> Vec<String> {
        self.members.iter().filter_map(|member| literal_text(&text[member.name.clone()?])).collect()
    }

    /// Returns the error for an unknown last step of a path. `kind` is the noun for named elements of the bracket, if it has any.
    fn unknown(&self, text: &str, path: &[String], kind: Option<&'static str>) -> PathError {
        let names: Vec<String> = match self.opening {
            b'{' => self.names(text),
            _ => self.members.iter().filter_map(|member| own_name(text, &member.value)).collect(),
        };
        if let Some(kind) = kind {
            return unknown(path, names, kind);
        }
        let help = match self.members.len() {
            0 => "it is empty".to_owned(),
            1 => "it holds 1 value, 0".to_owned(),
            count => format!("it holds {count} values, 0 to {}", count - 1),
        };
        let (step, before) = path.split_last().map_or(("", path), |(step, before)| (step.as_str(), before));
        let message = format!("there is nothing called `{}` in `{}`", short(step), short(&before.join(".")));
        PathError::NoParts { message, help }
    }
}

/// Returns the noun for the named elements of the list with which a path begins.
fn named_kind(path: &[String]) -> Option<&'static str> {
    NAMED.iter().find(|(list, _)| path.first().is_some_and(|first| first == list)).map(|(_, one)| *one)
}

/// Returns the error for an unknown name in the second step of a path.
fn unknown(path: &[String], known: Vec<String>, kind: &'static str) -> PathError {
    PathError::Unknown { kind, list: path[0].clone(), name: path[1].clone(), known }
}

fn no_parts(path: &[String], found: &str) -> PathError {
    PathError::NoParts {
        message: format!("`{}` is `{}`, which has no parts", short(&path.join(".")), short(found)),
        help: "end the path there".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "#![enable(implicit_some)]
Scene( // a scene
    film: (width: 1280, /* not */ height: 720,),
    camera: (position: (0, 2, -8),
        target: (0,
            1, 0)),
    quality: (),
    fog: Some((color: (1, 2, 3), density: 0.1)),
    materials: { \"clay\": (k_d: 1), \"a \\\"b\\\"\": (k_d: 0.5) },
    entities: [
        (name: \"ball\", shape: Sphere(radius: 1)), // ball
        (shape: Box(size: (1, 1, 1))),
    ],
)";

    fn put(text: &str, overriding: &Override) -> Result<String, PathError> {
        let mut text = text.to_owned();
        if let Some(edit) = edit_for(&text, overriding)? {
            let Edit { range, text: with } = edit.on_its_lines(&text);
            text.replace_range(range, &with);
        }
        Ok(text)
    }

    fn with(overridden: &str) -> Result<String, PathError> {
        put(SCENE, &overridden.parse().unwrap())
    }

    #[test]
    fn values_are_replaced() {
        for (overridden, before, after) in [
            ("film.width=64", "1280", "64"),
            ("camera.position.1=3", "(0, 2, -8)", "(0, 3, -8)"),
            ("fog.density=2", "0.1", "2"),
            ("fog=None", "Some((color: (1, 2, 3), density: 0.1))", "None"),
            ("materials.clay.k_d=2", "1), \"a", "2), \"a"),
            ("materials.\"clay\"=(k_a: 1)", "\"clay\": (k_d: 1)", "\"clay\": (k_a: 1)"),
            ("entities.ball.shape.radius=2", "radius: 1", "radius: 2"),
            ("entities.0.shape.radius=2", "radius: 1", "radius: 2"),
            ("entities.1.shape=Sphere(radius: 3)", "Box(size: (1, 1, 1))", "Sphere(radius: 3)"),
        ] {
            assert_eq!(with(overridden).unwrap(), SCENE.replace(before, after), "{overridden}");
        }
    }

    #[test]
    fn omitted_fields_are_added() {
        for (overridden, before, after) in [
            ("film.transfer=Classic", "720,", "720, transfer: Classic,"),
            ("quality.depth=3", "quality: ()", "quality: (depth: 3)"),
            ("camera.lens.aperture=0.1", "1, 0))", "1, 0), lens: (aperture: 0.1))"),
            ("sampling.samples=4", "    ],\n)", "    ], sampling: (samples: 4),\n)"),
            ("entities.1.name=\"crate\"", "(1, 1, 1)))", "(1, 1, 1)), name: \"crate\")"),
        ] {
            assert_eq!(with(overridden).unwrap(), SCENE.replace(before, after), "{overridden}");
        }
        assert_eq!(put("()", &"a.b=1".parse().unwrap()).unwrap(), "(a: (b: 1))");
    }

    #[test]
    fn positions_after_an_override_stay_in_their_line() {
        let moved = with("camera.target=(0, 0, 0)").unwrap();
        let line = |text: &str| text[..text.find("quality").unwrap()].matches('\n').count();
        assert_eq!(line(&moved), line(SCENE));
        assert!(moved.contains("target: (0, 0, 0)\n)"));
    }

    #[test]
    fn unknown_paths_are_reported() {
        let text = |overridden: &str| {
            let (message, help) = with(overridden).unwrap_err().explain();
            format!("{message}: {help}")
        };
        assert_eq!(text("entities.bal.name=\"b\""), "there is no entity called `bal`: did you mean `ball`?");
        assert_eq!(text("materials.clya.k_d=1"), "there is no material called `clya`: did you mean `clay`?");
        assert_eq!(
            text("camera.position.3=1"),
            "there is nothing called `3` in `camera.position`: it holds 3 values, 0 to 2"
        );
        assert_eq!(
            text("cameras.side.fov=40"),
            "there is no camera called `side`: there are no cameras here"
        );
        let many = put(
            "(cameras: {\"near 1.5\": (fov: 40), \"far\": (fov: 30)})",
            &"camera.fov=50".parse().unwrap(),
        );
        assert_eq!(
            many.unwrap_err().explain(),
            (
                "the scene has `cameras` and no `camera`".to_owned(),
                "name one of them, as in cameras.\"near 1.5\".fov=..; the cameras are `near 1.5`, `far`"
                    .to_owned()
            )
        );
        for field in ["extends=\"a.ron\"", "without.0=\"a\""] {
            let name = field.split(['=', '.']).next().unwrap();
            assert_eq!(text(field), format!("`{name}` applies before values are set: write it in the file"));
        }
        assert_eq!(
            text("film.width.pixels=1"),
            "`film.width` is `1280`, which has no parts: end the path there"
        );
    }

    #[test]
    fn invalid_scenes_are_passed_to_the_parser() {
        let broken =
            ["", "Scene", "(a: (", "[1, 2", "# # #", "#ß", "{\"a\" 1", "(a: ]", "\"(\"", "(a: Some("];
        let cuts = SCENE.char_indices().map(|(end, _)| &SCENE[..end]);
        for text in broken.into_iter().chain(cuts) {
            for overridden in
                ["a.b.0.c=1", "film.width=2", "materials.clay.k_d=2", "entities.ball.shape.radius=2"]
            {
                // The parser reports what is wrong; `put` must not panic.
                let _ = put(text, &overridden.parse().unwrap());
            }
        }
        assert_eq!(put("(film: (width: 1", &"film.width=2".parse().unwrap()).unwrap(), "(film: (width: 1");
    }
}
