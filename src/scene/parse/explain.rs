//! Conversion of parser errors to diagnostics: cause, position and remedy.

use std::ops::Range;

use ron::Error;
use ron::error::SpannedError;

use super::characters::{is_known, strange};
use super::examples;
use super::expectations::{Expectation, Trail, VariantContent};
use super::expected::{Expected, counted, is_word};
use super::foreign::foreign_remedy;
use super::general_parser::read_general;
use super::token_context::TokenContext;
use crate::scene::document::SurfaceDocument;
use crate::scene::quote::short;
use crate::scene::spans::{bracket, open_comment, root, tokens};
use crate::scene::suggest::remedy;
use crate::scene::{Diagnostic, SourcePosition};

/// Converts a parser error to a diagnostic.
pub(super) fn explain(text: &str, error: &SpannedError, trail: &Trail) -> Diagnostic {
    let case =
        Case { text, code: &error.code, context: TokenContext::error(text, error), open: trail.open() };
    let fulfilled = trail.fulfilled();
    case.of_comments_and_texts()
        .or_else(|| case.of_extensions())
        .or_else(|| case.of_brackets())
        .or_else(|| case.of_characters())
        .or_else(|| case.of_ranges())
        .or_else(|| case.of_names())
        .or_else(|| case.of_numbers_of_values())
        .or_else(|| case.of_separators(fulfilled.as_ref()))
        .unwrap_or_else(|| case.of_values())
}

/// The extension that makes the names of structs mandatory.
const EXPLICIT_NAMES: &str = "explicit_struct_names";

/// A parser error with its context.
struct Case<'a> {
    text: &'a str,
    code: &'a Error,
    context: TokenContext<'a>,
    /// The pending requests, innermost last.
    open: Vec<Expectation>,
}

fn error(
    message: impl Into<String>,
    label: impl Into<String>,
    help: impl Into<String>,
    span: Range<usize>,
) -> Diagnostic {
    Diagnostic::new(message, label, Some(help.into()), Some(span))
}

impl Case<'_> {
    fn of_comments_and_texts(&self) -> Option<Diagnostic> {
        const OPENED: &str = "opened here";
        let (context, word) = (&self.context, self.context.word());
        let is_text = word.contains(['"', '\'']);
        match self.code {
            Error::UnclosedBlockComment => {
                let start = open_comment(self.text)?;
                Some(error("this comment is never closed", OPENED, "close it with */", start..start + 2))
            }
            Error::ExpectedStringEnd | Error::Eof if is_text => {
                let start = context.found.start;
                let help = "write a \" where the text is to end";
                Some(error("this text is never closed", OPENED, help, start..start + 1))
            }
            Error::InvalidEscape(_) | Error::Utf8Error(_) => {
                let end = context.stopped.clamp(context.found.start, context.found.end);
                let start = self.text[context.found.start..end].rfind('\\')? + context.found.start;
                let message = format!("`{}` stands for no character", short(&self.text[start..end]));
                let help =
                    "write \\\\ for a backslash; \\\" is a quote, \\n a new line, \\u{e9} an é by its number";
                Some(error(message, "here", help, start..end))
            }
            Error::ExpectedAttribute | Error::ExpectedAttributeEnd | Error::NoSuchExtension(_) => {
                let start = tokens(self.text)
                    .map(|token| token.start)
                    .find(|at| self.text[*at..].starts_with('#'))?;
                if self.text[start..].starts_with("#!") {
                    return None;
                }
                let help = "comments start with //";
                Some(error("a # starts no comment", "not read as a comment", help, start..start + 1))
            }
            _ => self.of_quotes(),
        }
    }

    /// Explains an attribute (`#!`) that enables no extension, and the absence of a scene after it.
    fn of_extensions(&self) -> Option<Diagnostic> {
        let (start, scene) = (tokens(self.text).next()?.start, root(self.text));
        let is_cut = tokens(&self.text[scene..]).next().is_none();
        let is_extension_error = matches!(
            self.code,
            Error::ExpectedAttribute | Error::ExpectedAttributeEnd | Error::NoSuchExtension(_)
        );
        if !self.text[start..].starts_with("#!")
            || !(is_cut || is_extension_error || self.context.found.start < scene)
        {
            return None;
        }
        let span = start..start + 2;
        if is_cut && self.text[..scene].trim_end().ends_with(']') && !is_extension_error {
            let help = "write the scene after it, as ( .. ), with its fields in the brackets";
            return Some(error("there is no scene after the extensions", "extensions only", help, span));
        }
        Some(if let Error::NoSuchExtension(name) = self.code {
            let help = "the extensions are implicit_some, unwrap_newtypes, unwrap_variant_newtypes and explicit_struct_names";
            error(format!("there is no extension called `{}`", short(name)), "enabled here", help, span)
        } else {
            let help = "write it with all its brackets, as #![enable(implicit_some)]";
            error("this attribute is incomplete", "begins here", help, span)
        })
    }

    /// Returns the innermost bracket with field names added to its unnamed values. `None` if a value is named already, or if the result
    /// cannot be parsed.
    fn with_names(&self) -> Option<String> {
        /// Maximum length of a suggested bracket, in bytes.
        const LONGEST: usize = 120;
        let (span, _) = self.context.in_bracket()?;
        let members = bracket(self.text, span.start)?.members;
        if members.iter().any(|member| member.name.is_some()) {
            return None;
        }
        let (word, fields) = self.open.iter().rev().find_map(|expectation| match expectation {
            Expectation::Fields { fields, .. } => Some(("", fields.to_vec())),
            Expectation::VariantContent { of, word, content: VariantContent::Fields(fields) } => {
                Some((word.as_str(), examples::of(of).ordered(word, fields)))
            }
            _ => None,
        })?;
        let values: Vec<&str> = members.into_iter().map(|member| &self.text[member.value]).collect();
        let each: Vec<String> =
            fields.iter().zip(&values).map(|(field, value)| format!("{field}: {value}")).collect();
        // All values as a tuple in the first field, such as the numbers of a single field.
        let as_one = fields.first().map(|field| format!("({field}: ({}))", values.join(", ")));
        let as_each = (values.len() <= fields.len()).then(|| format!("({})", each.join(", ")));
        let can_be_read = |named: &String| {
            let text = [&self.text[..span.start], named, &self.text[span.end..]].concat();
            read_general(&text).err().is_none_or(|error| {
                TokenContext::error(&text, &error).found.start >= span.start + named.len()
            })
        };
        let named = as_each.into_iter().chain(as_one).find(can_be_read)?;
        (named.len() <= LONGEST && !named.contains('\n')).then(|| format!("{word}{named}"))
    }

    /// Explains a string directly followed by another token: a quote is missing or superfluous.
    fn of_quotes(&self) -> Option<Diagnostic> {
        let (context, text) = (&self.context, self.context.word_before());
        let continues = !context.is_end() && !")]},:".contains(context.word());
        if !(text.starts_with('"') && context.is_adjacent() && continues) {
            return None;
        }
        let span = context.previous.clone()?;
        let end = SourcePosition::of(self.text, span.end - 1);
        let help = "write a \" where the text is to end, and \\\" for a quote within a text";
        Some(if text.contains([',', ':', '\n']) {
            let label = format!("it ends only in line {}, column {}", end.line, end.column);
            error("this text has no closing quote", label, help, span)
        } else {
            let label = format!("ends before {}", context.describe());
            error("there is a quote within this text", label, help, span)
        })
    }

    /// Explains an unclosed or mismatched bracket.
    fn of_brackets(&self) -> Option<Diagnostic> {
        let (at, bracket) = (&self.context, self.context.bracket()?);
        let open = &self.text[bracket..=bracket];
        if at.is_end() {
            let close = closing(open);
            let help = format!("write a `{close}` where it is to end");
            return Some(error(
                format!("this `{open}` is never closed"),
                "opened here",
                help,
                bracket..bracket + 1,
            ));
        }
        let (found, close) = (at.word(), closing(open));
        (")]}".contains(found) && found != close).then(|| {
            let label =
                format!("the `{open}` of line {} is still open", SourcePosition::of(self.text, bracket).line);
            let help = format!("close it with a `{close}` first");
            error(format!("expected `{close}`, found `{found}`"), label, help, at.found.clone())
        })
    }

    fn of_characters(&self) -> Option<Diagnostic> {
        let first = self.context.word().chars().next().filter(|first| !is_known(*first))?;
        let (message, label, help) = strange(first);
        let start = self.context.found.start;
        Some(error(message, label, help, start..start + first.len_utf8()))
    }

    /// Explains a range, which scenes do not support.
    fn of_ranges(&self) -> Option<Diagnostic> {
        let (found, before) = (self.context.word(), &self.text[..self.context.found.start]);
        let is_range = !found.contains(['"', '\''])
            && (found.contains("..") || before.ends_with("..") || before.ends_with("..="));
        is_range.then(|| {
            error("there are no ranges in scenes", "here", "write a single value", self.context.found.clone())
        })
    }

    /// Returns the type whose fields are being read. `outer` is the innermost type whose name the parser knows: it knows none for a material
    /// in an entity, whose type depends on the text.
    fn owner<'a>(&self, outer: Option<&'a str>) -> Option<&'a str> {
        let mut open = self.open.iter().rev().filter(|kind| **kind != Expectation::FieldName);
        match open.next() {
            Some(Expectation::Any { reader }) if reader.starts_with(SurfaceDocument::NOUN) => {
                Some("Material")
            }
            _ => outer,
        }
    }

    /// Explains an unknown, missing or repeated name, and errors with a message of their own.
    fn of_names(&self) -> Option<Diagnostic> {
        let of = |outer: &Option<String>| {
            self.owner(outer.as_deref()).map_or_else(String::new, |outer| format!(" of `{outer}`"))
        };
        let (message, label, help) = match self.code {
            Error::NoSuchStructField { expected, found, outer } => (
                format!("unknown field `{}`{}", short(found), of(outer)),
                "no such field".to_owned(),
                self.with_names().map_or_else(
                    || name_remedy(self.owner(outer.as_deref()), found, expected, "fields"),
                    |named| format!("write it as {named}"),
                ),
            ),
            Error::NoSuchEnumVariant { expected, found, outer } => (
                format!(
                    "unknown {} `{}`",
                    examples::of(outer.as_deref().unwrap_or_default()).kind(),
                    short(found)
                ),
                "not known here".to_owned(),
                name_remedy(outer.as_deref(), found, expected, "possibilities"),
            ),
            Error::MissingStructField { field, outer } => (
                format!("missing field `{field}`{}", of(outer)),
                format!("`{field}` should have been written by here"),
                format!("add `{field}: ..`; the scene reference says what it takes"),
            ),
            Error::DuplicateStructField { field, outer } => (
                format!("field `{field}`{} is written twice", of(outer)),
                "again here".to_owned(),
                "remove one of the two".to_owned(),
            ),
            Error::ExpectedDifferentStructName { expected, found } => (
                format!("expected `{expected}`, found `{}`", short(found)),
                "wrong name".to_owned(),
                if self.text[..root(self.text)].contains(EXPLICIT_NAMES) {
                    format!("write `{expected}( .. )`")
                } else {
                    format!("write `{expected}( .. )`, or just `( .. )`")
                },
            ),
            Error::ExpectedStructName(name) => (
                format!("expected the name `{name}` before its bracket"),
                format!("found {}", self.context.describe()),
                format!("write `{name}( .. )`: {EXPLICIT_NAMES}, above the scene, requires names"),
            ),
            Error::Message(message) => {
                let (message, help) = message.split_once('\n')?;
                (message.to_owned(), "here".to_owned(), help.to_owned())
            }
            Error::ExceededRecursionLimit => (
                "brackets are nested more than 128 deep".to_owned(),
                "here".to_owned(),
                "no scene needs this: is a bracket written too often?".to_owned(),
            ),
            Error::TrailingCharacters => (
                "there is text after the end of the scene".to_owned(),
                "the scene is already complete here".to_owned(),
                "a file holds one scene: is a bracket closed too early?".to_owned(),
            ),
            _ => return None,
        };
        Some(error(message, label, help, self.context.found.clone()))
    }

    /// Explains a bracket with too few or too many values.
    fn of_numbers_of_values(&self) -> Option<Diagnostic> {
        let is_number = match self.code {
            Error::ExpectedDifferentLength { .. } => true,
            Error::ExpectedStructLikeEnd => !self.context.is_within,
            _ => false,
        };
        let (span, count) = self.context.in_bracket().filter(|_| is_number)?;
        let Expected { message, help } = Expected::of(self.open.last()?, &self.open, &self.context);
        Some(error(message, format!("found {}", counted(count, "value")), help, span))
    }

    /// Explains a missing comma or colon, or a token that was read only in part.
    fn of_separators(&self, fulfilled: Option<&Expectation>) -> Option<Diagnostic> {
        let context = &self.context;
        let (message, separator, help) = match self.code {
            Error::ExpectedComma | Error::ExpectedStructLikeEnd | Error::ExpectedOptionEnd
                if context.is_within =>
            {
                let Expected { message, help } = Expected::of(fulfilled?, &self.open, context);
                return Some(error(
                    message,
                    format!("found {}", context.describe()),
                    help,
                    context.found.clone(),
                ));
            }
            Error::ExpectedComma if context.word() == ":" => {
                let help = "a colon stands between a field's name and its value, and nowhere else";
                return Some(error("there is no field for this colon", "here", help, context.found.clone()));
            }
            Error::ExpectedComma if context.word() == "(" && is_word(context.word_before()) => {
                let word = context.word_before();
                let message = format!("`{}` takes nothing in brackets", short(word));
                return Some(error(
                    message,
                    "one bracket too many",
                    format!("write {} alone", short(word)),
                    context.value(),
                ));
            }
            Error::ExpectedComma => ("expected a comma", "a comma is", "values are separated by commas"),
            Error::ExpectedMapColon => (
                "expected a colon",
                "a colon is",
                "a name and its value are separated by a colon, as in `radius: 1`",
            ),
            Error::ExpectedOptionEnd => {
                ("expected `)`", "a `)` is", "`Some` takes one value, and can be omitted")
            }
            _ => return None,
        };
        let label = format!("{separator} missing after this");
        Some(error(message, label, help, context.previous.clone()?))
    }

    /// Returns the remedy for values as other programs have them in a field of this name.
    fn remedy_of_field(&self) -> Option<&'static str> {
        let before = self.text[..self.context.found.start].trim_end().strip_suffix(':')?.trim_end();
        let outside = before.trim_end_matches(|last: char| last.is_alphanumeric() || last == '_');
        match &before[outside.len()..] {
            "look_at" if self.context.word() == "(" => {
                Some("`look_at` takes an entity's name: write a point as `target: (0, 1, 0)`")
            }
            "metallic" => {
                Some("write `metallic: true, reflective: (k_r: 0.8)` for a metal; other materials omit it")
            }
            _ => None,
        }
    }

    /// Explains a value of another type than requested.
    fn of_values(&self) -> Diagnostic {
        let context = &self.context;
        let Some(expectation) = self.open.last() else {
            let help = "a scene is written as ( .. ), with its fields in the brackets";
            return error("this is no scene", format!("found {}", context.describe()), help, context.value());
        };
        let Expected { message, mut help } = Expected::of(expectation, &self.open, context);
        if *expectation == Expectation::FieldName
            && let Some(named) = self.with_names()
        {
            help = format!("write it as {named}");
        }
        if let Some(remedy) = self.remedy_of_field() {
            help = remedy.to_owned();
        }
        let lacks_bracket = matches!(expectation, Expectation::VariantContent { .. })
            && matches!(self.code, Error::ExpectedStructLike);
        match &context.previous {
            Some(word) if lacks_bracket => error(message, "without brackets", help, word.clone()),
            _ => error(message, format!("found {}", context.describe()), help, context.value()),
        }
    }
}

/// Returns the remedy for an unknown name among the fields or choices of `owner`.
fn name_remedy(owner: Option<&str>, found: &str, known: &[&str], kind: &str) -> String {
    foreign_remedy(owner.unwrap_or_default(), found).map_or_else(|| remedy(found, known, kind), str::to_owned)
}

fn closing(bracket: &str) -> &'static str {
    match bracket {
        "(" => ")",
        "[" => "]",
        _ => "}",
    }
}
