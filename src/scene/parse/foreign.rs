//! Names from the notations of other programs, and what to write in their place.

/// The table of names.
const NAMES: &str = include_str!("foreign_names.txt");

/// Returns what to write in place of a name of another program, found among the fields or choices of `owner`.
pub(super) fn foreign_remedy(owner: &str, found: &str) -> Option<&'static str> {
    let found = found.to_lowercase();
    entries().find_map(|(owners, names, remedy)| {
        let is_it =
            owners.split(", ").any(|name| name == owner) && names.split(", ").any(|name| name == found);
        is_it.then_some(remedy)
    })
}

/// Returns the owners, names and remedies of the table.
fn entries() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    let lines = NAMES.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.filter_map(|line| {
        let (place, remedy) = line.split_once(" => ")?;
        let (owners, names) = place.split_once(": ")?;
        Some((owners, names, remedy))
    })
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn each_line_of_the_table_is_an_entry_and_each_name_has_one_remedy() {
        let lines = NAMES.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
        assert_eq!(lines.count(), entries().count());
        let mut seen = HashSet::new();
        for (owners, names, _) in entries() {
            for (owner, name) in
                owners.split(", ").flat_map(|owner| names.split(", ").map(move |name| (owner, name)))
            {
                assert!(seen.insert((owner, name)), "{owner}: {name}");
                assert_eq!(name, name.to_lowercase());
            }
        }
        assert_eq!(foreign_remedy("Shape", "CUBE"), Some("write `Box(size: (1, 1, 1))`"));
        assert_eq!(foreign_remedy("Camera", "cube"), None);
    }
}
