//! Composition of a scene that extends another, on the level of the text.
//!
//! ```text
//! compose(base, changes):
//!     for each member of the base:
//!         a member of the same name in the changes:  compose both if both are groups of fields, or else take the changed one
//!         a member that is excluded or removed:      nothing
//!         any other:                                 copy
//!     copy the members of the changes that are not in the base
//! ```
//!
//! Members are fields, entries of maps by their keys, and the items of the scene's lists by their names. The brackets are those of the
//! changes, so that a value that both files write is reported where it is changed.
//!
//! Both texts must be valid in their notation; nothing else is assumed. Whatever a composed text says wrongly, its parser and its validation
//! report.

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;

use super::document::SceneDocument;
use super::source_text::{Piece, SourceText};
use super::spans::{
    Bracket, BracketMember, after_comma, bracket, first_item, literal_text, own_name, root, tokens,
};

/// The name of the field with the path of the extended scene.
pub(super) const EXTENDS: &str = "extends";
/// The name of the field with the names that are removed.
pub(super) const WITHOUT: &str = "without";

/// Fields of which only one can be written: each replaces the others.
const EXCLUSIVE: [&[&str]; 5] = [
    &["target", "view", "look_at"],
    &["screen", "fov", "horizontal_fov", "orthographic"],
    &["stops", "bottom"],
    &["stops", "horizon"],
    &["stops", "top"],
];

/// The treatment of a value that both files write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CompositionRule {
    /// The scene itself, whose fields have rules of their own.
    Scene,
    /// Groups and maps are composed; other values are replaced.
    Value,
    /// A map whose entries can be removed by name.
    Cameras,
    /// A list whose items are composed if they have the same name, and can be removed by name.
    Named,
    /// A list whose items are replaced if they are of the same value, and removed with their targets.
    Animations,
    /// A list that is continued.
    Continued,
    /// A value that is replaced.
    Replaced,
}

impl CompositionRule {
    /// Returns the rule for a field of the scene.
    fn of_field(name: &str) -> Self {
        match name {
            "include" | "entities" | "clouds" => Self::Named,
            "cameras" => Self::Cameras,
            "animate" => Self::Animations,
            "spawn" => Self::Continued,
            _ => Self::Value,
        }
    }

    /// Returns the rule for a member.
    fn within(self, key: &str) -> Self {
        match self {
            Self::Scene => Self::of_field(key),
            Self::Animations | Self::Continued | Self::Replaced => Self::Replaced,
            Self::Value | Self::Cameras | Self::Named => Self::Value,
        }
    }

    /// Returns whether two values are composed, as opposed to replaced.
    fn composes(self, old: &Bracket, new: &Bracket) -> bool {
        match (old.opening, new.opening) {
            (b'(', b'(') => is_group(old) && is_group(new),
            (b'[', b'[') => matches!(self, Self::Named | Self::Animations | Self::Continued),
            (old, new) => old == new,
        }
    }

    /// Returns the name by which a member of a bracket is found; `None` if it has none.
    fn key(self, text: &str, opening: u8, member: &BracketMember) -> Option<String> {
        let key = match self {
            Self::Continued | Self::Replaced => None,
            Self::Named => own_name(text, &member.value),
            Self::Animations => animated_value(text, &member.value),
            Self::Scene | Self::Value | Self::Cameras => {
                let name = &text[member.name.clone()?];
                if opening == b'{' { literal_text(name) } else { Some(name.to_owned()) }
            }
        };
        key.filter(|key| !key.is_empty())
    }
}

/// A name in `without` that the base does not have.
#[derive(Debug)]
pub(super) struct MissingName {
    /// The index in the list.
    pub(super) index: usize,
    pub(super) name: String,
    /// The names that can be removed.
    pub(super) known: Vec<String>,
}

/// Returns whether a text is a group of fields, as a scene must be.
pub(super) fn is_scene(text: &str) -> bool {
    bracket(text, root(text)).is_some_and(|scene| is_group(&scene))
}

/// Composes the text of a scene that extends `base` by `changes`, the text of a single file. Both must be groups of fields. Returns the
/// names that should be removed and do not exist.
pub(super) fn extend(base: &SourceText, changes: &SourceText) -> Result<SourceText, Vec<MissingName>> {
    let [base_root, root] = [base, changes].map(|source| root(source.text()));
    let mut composer = Composer {
        base,
        changes,
        text: String::with_capacity(base.text().len() + changes.text().len()),
        pieces: Vec::new(),
        without: Vec::new(),
        known: BTreeSet::new(),
    };
    composer.without = composer.names_to_leave_out(root);
    // Extensions, as `#![enable(implicit_some)]`, precede the scene.
    composer.copy_base(0..base_root);
    composer.copy_change(0..root);
    composer.value(base_root..base.text().len(), Some(root..changes.text().len()), CompositionRule::Scene);
    let Composer { text, pieces, without, known, .. } = composer;
    let is_unknown = |(index, name): (usize, String)| {
        // The parser reports an item that is no text.
        (!name.is_empty() && !known.contains(&name)).then(|| MissingName {
            index,
            name,
            known: known.iter().cloned().collect(),
        })
    };
    let unknown: Vec<MissingName> = without.into_iter().enumerate().filter_map(is_unknown).collect();
    if !unknown.is_empty() {
        return Err(unknown);
    }
    let files = changes.files().iter().chain(base.files()).cloned().collect();
    Ok(SourceText::composed(text, files, pieces))
}

struct Composer<'a> {
    base: &'a SourceText,
    changes: &'a SourceText,
    text: String,
    pieces: Vec<Piece>,
    /// The names to leave out.
    without: Vec<String>,
    /// The names in the base that can be removed.
    known: BTreeSet<String>,
}

impl Composer<'_> {
    fn names_to_leave_out(&self, root: usize) -> Vec<String> {
        let text = self.changes.text();
        let list = bracket(text, root)
            .and_then(|scene| scene.field(text, WITHOUT))
            .and_then(|list| bracket(text, list.start));
        let names = list.into_iter().flat_map(|list| list.members);
        names.map(|name| literal_text(&text[name.value]).unwrap_or_default()).collect()
    }

    fn copy_base(&mut self, range: Range<usize>) {
        if range.is_empty() {
            return;
        }
        let start = self.text.len();
        let pieces = self.base.pieces(&range).into_iter();
        self.pieces.extend(pieces.map(|piece| Piece {
            start: start + piece.start - range.start,
            file: piece.file + 1,
            ..piece
        }));
        self.text += &self.base.text()[range];
    }

    fn copy_change(&mut self, range: Range<usize>) {
        if range.is_empty() {
            return;
        }
        self.pieces.push(Piece { start: self.text.len(), file: 0, at: range.start, length: range.len() });
        self.text += &self.changes.text()[range];
    }

    /// Writes a value of the base with its change, or only without the names to leave out.
    fn value(&mut self, base: Range<usize>, change: Option<Range<usize>>, rule: CompositionRule) {
        let (text, changed_text) = (self.base.text(), self.changes.text());
        let old = bracket(text, base.start).filter(|_| rule != CompositionRule::Replaced);
        let Some(change) = change else {
            if let Some(old) = old {
                self.copy_base(base.start..old.start);
                self.members(&old, &[], rule);
                self.copy_base(old.close(text)..base.end);
            } else {
                self.copy_base(base);
            }
            return;
        };
        let both = old.zip(bracket(changed_text, change.start)).filter(|(old, new)| rule.composes(old, new));
        let Some((old, new)) = both else {
            self.copy_change(change);
            return;
        };
        let (name, new_name) =
            (name(text, base.start..old.start), name(changed_text, change.start..new.start));
        match (name, new_name) {
            (Some(name), Some(new_name)) if text[name.clone()] != changed_text[new_name.clone()] => {
                self.copy_change(change);
                return;
            }
            // `Sphere` of the base, where the change is `(radius: 2)`.
            (Some(name), None) => {
                self.copy_change(change.start..new.start - 1);
                self.copy_base(name);
                self.copy_change(new.start - 1..new.start);
            }
            _ => self.copy_change(change.start..new.start),
        }
        self.members(&old, &new.members, rule);
        self.copy_change(new.close(changed_text)..change.end);
    }

    /// Writes the members of a bracket of the base with their changes, and the other members of the changes after them.
    fn members(&mut self, old: &Bracket, new: &[BracketMember], rule: CompositionRule) {
        let (text, changed_text) = (self.base.text(), self.changes.text());
        let mut changes: HashMap<String, usize> = HashMap::new();
        for (index, member) in new.iter().enumerate() {
            if let Some(key) = rule.key(changed_text, old.opening, member) {
                // A name that is written twice is added twice, and reported by the parser or the validation.
                changes.entry(key).or_insert(index);
            }
        }
        let excluded = if old.opening == b'(' { excluded_fields(changed_text, new) } else { Vec::new() };
        let mut is_added = vec![true; new.len()];
        let (mut copied, mut needs_comma) = (old.start, false);
        for member in &old.members {
            let key = rule.key(text, old.opening, member).unwrap_or_default();
            let change = changes.get(&key).copied().filter(|change| is_added[*change]);
            let is_excluded = change.is_none() && excluded.contains(&key.as_str());
            let is_not_inherited = rule == CompositionRule::Scene
                && change.is_none()
                && [EXTENDS, WITHOUT].contains(&key.as_str());
            let end = after_comma(text, member.value.end);
            if is_excluded || is_not_inherited || self.is_left_out(&key, member, rule) {
                self.copy_base(copied..member.start());
                (copied, needs_comma) = (end, false);
                continue;
            }
            let within = rule.within(&key);
            if change.is_some()
                || rule == CompositionRule::Scene
                    && !self.without.is_empty()
                    && within != CompositionRule::Value
            {
                if let Some(change) = change {
                    is_added[change] = false;
                }
                self.copy_base(copied..member.value.start);
                self.value(member.value.clone(), change.map(|change| new[change].value.clone()), within);
                copied = member.value.end;
            }
            needs_comma = !text[first_item(text, member.value.end)..].starts_with(',');
        }
        self.copy_base(copied..old.close(text));
        for (member, _) in new.iter().zip(is_added).filter(|(_, is_added)| *is_added) {
            if std::mem::replace(&mut needs_comma, true) {
                self.text += ", ";
            }
            self.copy_change(member.start()..member.value.end);
        }
    }

    /// Returns whether a member of the base is removed because of its name, and records the name.
    fn is_left_out(&mut self, key: &str, member: &BracketMember, rule: CompositionRule) -> bool {
        if self.without.is_empty() || key.is_empty() {
            return false;
        }
        match rule {
            CompositionRule::Animations => {
                let target = text_field(self.base.text(), &member.value, "target");
                target.is_some_and(|target| self.without.iter().any(|name| is_part_of(&target, name)))
            }
            CompositionRule::Scene if key != SceneDocument::CAMERA => false,
            CompositionRule::Scene | CompositionRule::Cameras | CompositionRule::Named => {
                self.known.insert(key.to_owned());
                self.without.iter().any(|name| name == key)
            }
            CompositionRule::Value | CompositionRule::Continued | CompositionRule::Replaced => false,
        }
    }
}

/// Returns whether a bracket is a group of fields.
fn is_group(bracket: &Bracket) -> bool {
    bracket.opening == b'(' && bracket.members.iter().all(|member| member.name.is_some())
}

/// Returns whether a name is this one, or in the include of this name.
fn is_part_of(target: &str, name: &str) -> bool {
    target.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// Returns the fields that are excluded by the written ones.
fn excluded_fields(text: &str, written: &[BracketMember]) -> Vec<&'static str> {
    let is_written = |field: &&str| {
        written.iter().any(|member| {
            member.name.as_ref().is_some_and(|name| &text[name.clone()] == *field)
                && &text[member.value.clone()] != "None"
        })
    };
    EXCLUSIVE.into_iter().filter(|fields| fields.iter().any(is_written)).flatten().copied().collect()
}

/// Returns the span of the name before a bracket, as of `Sphere` in `Sphere(` and in `Some(Sphere(`.
fn name(text: &str, before: Range<usize>) -> Option<Range<usize>> {
    let start = before.start;
    let words = tokens(&text[before]).map(|token| start + token.start..start + token.end);
    let is_word = |word: &Range<usize>| text[word.clone()].starts_with(|first: char| first.is_alphabetic());
    words.filter(is_word).last().filter(|word| &text[word.clone()] != "Some")
}

/// Returns the value that an animation drives, in a form of its own.
fn animated_value(text: &str, animation: &Range<usize>) -> Option<String> {
    let channel = bracket(text, animation.start)?.field(text, "channel")?;
    let [target, material] = ["target", "material"].map(|field| text_field(text, animation, field));
    Some(format!("{} of {target:?} {material:?}", &text[channel]))
}

/// Returns the text in a field of a group.
fn text_field(text: &str, group: &Range<usize>, field: &str) -> Option<String> {
    literal_text(&text[bracket(text, group.start)?.field(text, field)?])
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scene::overrides::{Override, Unplaced};

    const FILES: [&str; 3] = [
        "Scene(extends: \"b\", camera: (view: (0, 0, 1)), // here\n entities: [(name: \"ball\", shape: (radius: 3)), (name: \"new\")])",
        "#![enable(implicit_some)]\n(extends: \"c\", film: (width: 9), without: [\"stand\"], materials: {\"clay\": Material(k_d: 1), \"tin\": ()},)",
        "Scene(film: (width: 1, height: 2), camera: (position: (1, 2, 3), target: (0, 0, 0)), materials: {\"clay\": (k_a: 0.5,)},
        entities: [(name: \"stand\"), /* ( */ (name: \"ball\", shape: Sphere(radius: 1)), (),], ambient: (1, 1, 1))",
    ];

    fn composed() -> SourceText {
        let [changes, step, base] = FILES.map(|text| SourceText::new(Path::new("file"), text.to_owned()));
        extend(&extend(&base, &step).unwrap(), &changes).unwrap()
    }

    /// Checks that every token of a text is in the file at its original place, except for added commas.
    fn check_places(source: &SourceText) {
        let mut count = [0; FILES.len()];
        for token in tokens(source.text()) {
            let (file, original) = source.original(&token);
            let (found, expected) = (&source.files()[file].text[original], &source.text()[token]);
            assert!(found == expected || expected == ",", "{found} instead of {expected}: {source:#?}");
            count[file] += 1;
        }
        assert!(count.into_iter().all(|count| count > 10), "{count:?}");
    }

    #[test]
    fn composed_texts_keep_the_changes_and_the_rest() {
        let text = composed();
        assert_eq!(
            text.text().as_str(),
            "#![enable(implicit_some)]\nScene(film: (width: 9, height: 2), camera: (position: (1, 2, 3), view: (0, 0, 1)), \
             materials: {\"clay\": Material(k_a: 0.5,k_d: 1), \"tin\": ()},
        entities: [(name: \"ball\", shape: Sphere(radius: 3)), (),(name: \"new\")], ambient: (1, 1, 1), extends: \"b\", )"
        );
        check_places(&text);
    }

    #[test]
    fn overridden_texts_keep_their_places() {
        let overrides = [
            "film.width=64",
            "film.transfer=Classic",
            "camera.fov=40",
            "camera=(position: (0, 0, 1), view: (1, 1, 1))",
            "materials.clay=(k_d: 1, k_a: 1, color: (1, 2, 3))",
            "materials.tin.k_d=0.5",
            "entities.ball.shape.radius=33",
            "entities.1.name=\"second\"",
            "entities.new.light=Point(intensity: (1, 1, 1))",
            "ambient=(0.25, 0.25, 0.25)",
            "sampling.samples=4",
        ];
        let overrides = overrides.map(|one| one.parse::<Override>().unwrap());
        for first in &overrides {
            for second in &overrides {
                let mut text = composed();
                let mut unplaced = Unplaced::new(&[first.clone(), second.clone()]);
                assert_eq!(unplaced.place(&mut text).len(), 2);
                check_places(&text);
            }
        }
    }
}
