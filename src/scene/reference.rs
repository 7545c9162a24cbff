//! The scene reference as data: the rows of its tables, which describe fields, and the items of its lists, which describe variants.

use std::sync::LazyLock;

use super::manual::MANUAL;

/// A section of the reference.
#[derive(Debug)]
pub(super) struct ManualSection {
    pub(super) name: &'static str,
    /// The text under the heading, with its tables and lists.
    pub(super) body: &'static str,
    pub(super) fields: Vec<FieldEntry>,
    pub(super) variants: Vec<VariantEntry>,
}

/// A row of a table: a field.
#[derive(Debug)]
pub(super) struct FieldEntry {
    pub(super) name: &'static str,
    pub(super) meaning: &'static str,
    /// The default value; an example if the field is required.
    pub(super) value: &'static str,
    pub(super) is_required: bool,
}

/// An item of a list: a variant.
#[derive(Debug)]
pub(super) struct VariantEntry {
    pub(super) name: &'static str,
    /// The content of its parentheses.
    pub(super) inside: &'static str,
    pub(super) meaning: String,
}

static SECTIONS: LazyLock<Vec<ManualSection>> =
    LazyLock::new(|| MANUAL.split("\n## ").skip(1).map(ManualSection::new).collect());

/// Returns all sections.
pub(super) fn sections() -> &'static [ManualSection] {
    &SECTIONS
}

/// Returns the section of a type.
pub(super) fn section(name: &str) -> Option<&'static ManualSection> {
    sections().iter().find(|section| section.name == name)
}

impl ManualSection {
    fn new(part: &'static str) -> Self {
        let (name, body) = part.split_once('\n').unwrap_or((part, ""));
        let (mut fields, mut variants) = (Vec::new(), Vec::<VariantEntry>::new());
        let mut is_item = false;
        for line in body.lines() {
            if let Some(item) = line.strip_prefix("- `") {
                let (code, meaning) = item.split_once('`').unwrap_or((item, ""));
                let (name, inside) = code.trim_end_matches(')').split_once('(').unwrap_or((code, ""));
                let meaning = meaning.trim_start_matches(':').trim().to_owned();
                variants.push(VariantEntry { name, inside, meaning });
                is_item = true;
            } else if let (Some(rest), Some(last), true) =
                (line.strip_prefix("  "), variants.last_mut(), is_item)
            {
                last.meaning = format!("{} {}", last.meaning, rest.trim());
            } else {
                is_item = false;
                fields.extend(FieldEntry::of_row(line));
            }
        }
        Self { name, body, fields, variants }
    }

    pub(super) fn field(&self, name: &str) -> Option<&FieldEntry> {
        self.fields.iter().find(|field| field.name == name)
    }

    pub(super) fn variant(&self, name: &str) -> Option<&VariantEntry> {
        self.variants.iter().find(|variant| variant.name == name)
    }

    /// Returns the first paragraph, if it is neither a table nor a list.
    pub(super) fn about(&self) -> String {
        self.paragraphs().next().unwrap_or_default()
    }

    /// Returns the paragraphs, each in one line.
    fn paragraphs(&self) -> impl Iterator<Item = String> {
        let is_prose = |part: &&str| !part.starts_with(['|', '-', '`', '[']) || part.starts_with("`Turns`");
        let parts = self.body.split("\n\n").map(str::trim).filter(|part| !part.is_empty());
        parts.filter(is_prose).map(|part| part.lines().collect::<Vec<_>>().join(" "))
    }

    /// Returns the description of a variant. A meaning that refers to the previous variant is followed by the meaning of that one.
    pub(super) fn about_variant(&self, name: &str) -> String {
        let Some(index) = self.variants.iter().position(|variant| variant.name == name) else {
            return String::new();
        };
        let VariantEntry { meaning, .. } = &self.variants[index];
        let refers = |variant: &VariantEntry| {
            ["likewise", "the same reversed", "both, for half"]
                .iter()
                .any(|word| variant.meaning.contains(word))
        };
        let full = self.variants[..index].iter().rev().find(|variant| !refers(variant));
        match full.filter(|_| refers(&self.variants[index])) {
            Some(full) => format!("{meaning} {}: {}", full.name, full.meaning),
            None => meaning.clone(),
        }
    }

    /// Returns the description of a field of a variant: the sentences that name the field, of the variant or else of the whole section, or
    /// else the description of the variant.
    pub(super) fn about_field_of(&self, variant: &str, field: &str) -> String {
        let named = format!("`{field}`");
        let starts = [format!("A `{variant}`"), format!("An `{variant}`"), format!("`{variant}`")];
        let sentences = |text: &str| {
            let found: Vec<&str> = text.split_inclusive(". ").filter(|part| part.contains(&named)).collect();
            (!found.is_empty()).then(|| found.concat().trim().to_owned())
        };
        let about = self.about_variant(variant);
        let own = self.paragraphs().filter(|text| starts.iter().any(|start| text.starts_with(start)));
        let all: Vec<String> = [about.clone()].into_iter().chain(own).chain(self.paragraphs()).collect();
        all.iter().find_map(|text| sentences(text)).unwrap_or(about)
    }
}

impl FieldEntry {
    fn of_row(line: &'static str) -> Option<Self> {
        let row = line.strip_prefix("| `")?;
        let (name, rest) = row.trim_end_matches(" |").split_once("` | ")?;
        let (meaning, value) = rest.rsplit_once(" | ")?;
        let is_required = value.starts_with("required: ");
        let value = value.trim_start_matches("required: ").trim_matches('`');
        Some(Self { name, meaning, value, is_required })
    }

    /// Returns the meaning, and the default.
    pub(super) fn about(&self) -> String {
        let Self { meaning, value, .. } = self;
        match (self.is_required, *value) {
            (true, _) => format!("{meaning}. Required, as {value}"),
            (false, "None") => meaning.to_string(),
            (false, _) => format!("{meaning}. Default: {value}"),
        }
    }
}

/// Returns the description of a field of a type, or of one of its variants.
pub(super) fn about_field(of: &str, variant: Option<&str>, field: &str) -> String {
    let Some(section) = section(of) else { return String::new() };
    match variant {
        Some(variant) => section.about_field_of(variant, field),
        None => section.field(field).map(FieldEntry::about).unwrap_or_default(),
    }
}
