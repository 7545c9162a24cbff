#![doc = include_str!("reference.md")]

/// The reference itself, as Markdown.
pub const REFERENCE: &str = include_str!("reference.md");
