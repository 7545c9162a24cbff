//! Descriptions of what is written.

use std::ops::Range;

use super::scan::BracketScan;
use crate::scene::parse::{Expectation, owner, pending};
use crate::scene::reference::{about_field, section};
use crate::scene::spans::{first_item, tokens};

/// A description of a part of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Description {
    /// The bytes of the described word.
    pub span: Range<usize>,
    /// The field, as `k_d` of `Material`, or the word.
    pub title: String,
    /// The description in the reference: meaning, unit, range and default.
    pub about: String,
}

/// Describes the field or the word at a position of a text, or else the field whose value is there.
///
/// ```
/// use rayreel::scene::assist::describe;
///
/// let text = "(materials: { \"clay\": (k_d: 0.7) })";
/// let described = describe(text, text.find("k_d").unwrap()).unwrap();
/// assert_eq!((described.title.as_str(), described.span), ("k_d of Material", 23..26));
/// assert_eq!(described.about, "diffuse reflection coefficient, 0 to 1");
/// ```
#[must_use]
pub fn describe(text: &str, at: usize) -> Option<Description> {
    let (scan, span) = BracketScan::until(text, text.floor_char_boundary(at + 1));
    let written = &text[span.clone()];
    let (depth, inner) = (scan.open.len(), scan.open.last()?);
    let is_name =
        inner.bracket == "(" && inner.name.is_none() && text[first_item(text, span.end)..].starts_with(':');
    if is_name {
        return describe_field(&scan, depth, written, span);
    }
    if let Some(Expectation::Choice { name, words }) = pending(&scan.skeleton(depth, false))?.pop()
        && words.contains(&written)
    {
        let section = section(name)?;
        let inside = section.variant(written).map_or("", |variant| variant.inside);
        let content = if inside.is_empty() { String::new() } else { format!("({inside})") };
        let about = section.about_variant(written);
        return Some(Description { span, title: format!("{written}{content} of {name}"), about });
    }
    // A space has no description.
    tokens(written).next()?;
    let field = (1..=depth).rev().find(|depth| scan.open[depth - 1].name.is_some())?;
    let name = &text[scan.open[field - 1].name.clone()?];
    describe_field(&scan, field, name, span)
}

/// Describes a field of the bracket at a depth.
fn describe_field(
    scan: &BracketScan<'_>,
    depth: usize,
    name: &str,
    span: Range<usize>,
) -> Option<Description> {
    let owner = owner(&scan.skeleton(depth, true))?;
    let about = about_field(owner.of, owner.variant.as_deref(), name);
    let of = owner.variant.as_deref().unwrap_or(owner.of);
    (owner.fields.contains(&name)).then(|| Description { span, title: format!("{name} of {of}"), about })
}
