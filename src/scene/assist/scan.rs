//! Follows the brackets of a text, which may be malformed.

use std::ops::Range;
use std::sync::LazyLock;

use crate::scene::format::SceneFormat;
use crate::scene::reference::{ManualSection, sections};
use crate::scene::spans::tokens;

/// Maximum number of open brackets, beyond the 128 of the parser. The time for a closing bracket grows with it.
const DEEPEST: usize = 200;

/// An open bracket, and the member of it that is being read.
#[derive(Clone, Debug)]
pub(super) struct OpenBracket<'t> {
    /// The word before the bracket; empty if there is none.
    pub(super) word: &'t str,
    /// The bracket: `(`, `[` or `{`.
    pub(super) bracket: &'t str,
    /// The name of the current field, or the key of the current entry.
    pub(super) name: Option<Range<usize>>,
    /// The start of the current value.
    value: Option<usize>,
    /// The members before the current one. Those of lists and maps, which can be many, are not kept.
    pub(super) before: Vec<BracketPart>,
}

/// A member of a bracket.
#[derive(Clone, Debug)]
pub(super) struct BracketPart {
    pub(super) name: Option<Range<usize>>,
    pub(super) value: Range<usize>,
}

/// The brackets that are open at a position.
#[derive(Debug)]
pub(super) struct BracketScan<'t> {
    pub(super) text: &'t str,
    pub(super) open: Vec<OpenBracket<'t>>,
    previous: Range<usize>,
}

impl<'t> BracketScan<'t> {
    /// Reads a whole text, and calls `found` for each member at its end, with the brackets around it, outermost first.
    pub(super) fn whole(text: &'t str, found: &mut dyn FnMut(&[OpenBracket<'t>], &BracketPart)) {
        let mut scan = Self { text, open: Vec::new(), previous: 0..0 };
        for token in tokens(text) {
            scan.token(token, found);
        }
        while !scan.open.is_empty() {
            scan.end_member(found);
            scan.open.pop();
        }
    }

    /// Reads a text up to a position. Returns also the token at the position, which is not read: a word, a number or a string literal.
    pub(super) fn until(text: &'t str, at: usize) -> (Self, Range<usize>) {
        let mut scan = Self { text, open: Vec::new(), previous: 0..0 };
        for token in tokens(text) {
            if token.start >= at {
                break;
            }
            let is_punctuation = "()[]{},:".contains(&text[token.clone()]);
            if token.end > at || token.end == at && !is_punctuation {
                // A text that is being typed has no end yet, and would go on to the next quote.
                let is_open = text[token.clone()].starts_with('"') && text[token.clone()].contains('\n');
                return (scan, if is_open { token.start..at } else { token });
            }
            scan.token(token, &mut |_, _| {});
        }
        (scan, at..at)
    }

    fn token(&mut self, token: Range<usize>, found: &mut dyn FnMut(&[OpenBracket<'t>], &BracketPart)) {
        let text = self.text;
        match &text[token.clone()] {
            bracket @ ("(" | "[" | "{") => {
                let mut word = "";
                if let Some(outer) = self.open.last_mut() {
                    let start = *outer.value.get_or_insert(token.start);
                    if start == self.previous.start && bracket == "(" {
                        word = &text[self.previous.clone()];
                    }
                }
                if self.open.len() < DEEPEST {
                    self.open.push(OpenBracket {
                        word,
                        bracket,
                        name: None,
                        value: None,
                        before: Vec::new(),
                    });
                }
            }
            closing @ (")" | "]" | "}") => self.close(closing, found),
            "," => self.end_member(found),
            ":" => {
                let previous = self.previous.clone();
                if self.open.len() > 1 && is_of_scene_alone(&text[previous.clone()]) {
                    self.return_to_scene(found);
                }
                if let Some(inner) = self.open.last_mut()
                    && inner.name.is_none()
                    && inner.value == Some(previous.start)
                {
                    (inner.name, inner.value) = (Some(previous), None);
                }
            }
            _ => {
                if let Some(inner) = self.open.last_mut() {
                    inner.value.get_or_insert(token.start);
                }
            }
        }
        self.previous = token;
    }

    /// Closes all brackets but that of the scene before a field of the scene: those that are being typed have no end yet.
    fn return_to_scene(&mut self, found: &mut dyn FnMut(&[OpenBracket<'t>], &BracketPart)) {
        let name = self.previous.clone();
        // The name is not a part of the member before it.
        if let Some(inner) = self.open.last_mut().filter(|inner| inner.value == Some(name.start)) {
            inner.value = None;
        }
        self.previous = name.start..name.start;
        while self.open.len() > 1 {
            self.end_member(found);
            self.open.pop();
        }
        self.end_member(found);
        if let Some(scene) = self.open.last_mut() {
            scene.value = Some(name.start);
        }
    }

    /// Closes the innermost bracket of a kind, and all in it. A bracket that closes none is ignored.
    fn close(&mut self, closing: &str, found: &mut dyn FnMut(&[OpenBracket<'t>], &BracketPart)) {
        let closes =
            |open: &OpenBracket<'_>| matches!((open.bracket, closing), ("(", ")") | ("[", "]") | ("{", "}"));
        let Some(index) = self.open.iter().rposition(closes) else { return };
        while self.open.len() > index {
            self.end_member(found);
            self.open.pop();
        }
    }

    /// Ends the current member of the innermost bracket, before the current token.
    fn end_member(&mut self, found: &mut dyn FnMut(&[OpenBracket<'t>], &BracketPart)) {
        let end = self.previous.end;
        let Some(inner) = self.open.last_mut() else { return };
        let (name, start) = (inner.name.take(), inner.value.take());
        if name.is_none() && start.is_none() {
            return;
        }
        let part = BracketPart { name, value: start.unwrap_or(end)..end };
        found(&self.open, &part);
        if let Some(inner) = self.open.last_mut().filter(|inner| inner.bracket == "(") {
            inner.before.push(part);
        }
    }

    /// Returns the shortest text that is cut off in the same place as this one, with the first `depth` open brackets; `true` also cuts off
    /// the name of the innermost field.
    pub(super) fn skeleton(&self, depth: usize, before_name: bool) -> String {
        let mut skeleton = String::new();
        for (index, OpenBracket { word, bracket, name, before, .. }) in self.open[..depth].iter().enumerate()
        {
            skeleton += word;
            skeleton += bracket;
            if before_name && index + 1 == depth {
                break;
            }
            let of = |span: &Range<usize>| &self.text[span.clone()];
            match (name, *bracket) {
                (Some(name), _) => {
                    // The channel determines the type of the track.
                    let is_channel = |part: &&BracketPart| part.name.as_ref().map(of) == Some("channel");
                    if of(name) == "track"
                        && let Some(channel) = before.iter().find(is_channel)
                    {
                        skeleton += &format!("channel: {}, ", of(&channel.value));
                    }
                    skeleton += &format!("{}: ", of(name));
                }
                (None, "(") => {
                    for part in before.iter().filter(|part| part.name.is_none()) {
                        skeleton += &format!("{}, ", of(&part.value));
                    }
                }
                (None, _) => {}
            }
        }
        skeleton
    }

    /// Returns whether a position after all that was read is in a comment.
    pub(super) fn is_in_comment(&self, at: usize) -> bool {
        let gap = self.text.get(self.previous.end..at).unwrap_or_default();
        let last_line = gap.rsplit('\n').next().unwrap_or_default();
        last_line.contains("//") || gap.matches("/*").count() > gap.matches("*/").count()
    }

    /// Returns the names of the innermost bracket's fields before the current one.
    pub(super) fn names_before(&self) -> impl Iterator<Item = &'t str> {
        let before = self.open.last().into_iter().flat_map(|inner| &inner.before);
        before.filter_map(|part| Some(&self.text[part.name.clone()?]))
    }
}

/// Returns whether a name is the name of a field in scenes, and in no other type.
fn is_of_scene_alone(name: &str) -> bool {
    static NAMES: LazyLock<Vec<&str>> = LazyLock::new(|| {
        let is_scene = |section: &&ManualSection| section.name == SceneFormat::SCENE;
        let is_alone = |name: &&str| {
            !sections()
                .iter()
                .filter(|section| !is_scene(section))
                .any(|section| section.field(name).is_some())
        };
        let fields = sections().iter().filter(is_scene).flat_map(|section| &section.fields);
        fields.map(|field| field.name).filter(is_alone).collect()
    });
    NAMES.contains(&name)
}

/// Returns the names of the fields from a position to the end of the bracket around it.
pub(super) fn names_after(text: &str, at: usize) -> Vec<&str> {
    let (mut depth, mut names, mut previous) = (0_usize, Vec::new(), "");
    for token in tokens(&text[at..]) {
        let token = &text[at..][token];
        match token {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" if depth == 0 => break,
            ")" | "]" | "}" => depth -= 1,
            ":" if depth == 0 => names.push(previous),
            _ => {}
        }
        previous = token;
    }
    names
}
