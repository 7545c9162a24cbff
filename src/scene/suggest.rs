//! "Did you mean" suggestions from known names.

use super::quote::short;

/// Returns the known name most similar to a mistyped one, if any is similar enough.
#[must_use]
pub fn nearest<'a>(found: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    /// Maximum length of compared names, in bytes. The comparison time grows with both lengths; no mistyped name is longer.
    const LONGEST: usize = 100;
    if found.len() > LONGEST {
        return None;
    }
    let known = known.into_iter().filter(|name| name.len() <= LONGEST);
    let alike = |name: &str| {
        let (found, name) = (found.to_lowercase(), name.to_lowercase());
        if found == name { 2.0 } else { strsim::jaro_winkler(&found, &name) }
    };
    let best = known.map(|name| (alike(name), name)).max_by(|left, right| left.0.total_cmp(&right.0));
    best.filter(|(likeness, _)| *likeness > 0.75).map(|(_, name)| name)
}

/// Returns the remedy for an unknown name: the most similar known name, or a list of the known names.
pub(super) fn remedy(found: &str, known: &[&str], kind: &str) -> String {
    match nearest(found, known.iter().copied()) {
        Some(name) => format!("did you mean `{}`?", short(name)),
        None if known.is_empty() => format!("there are no {kind} here"),
        None if known.len() == 1 => format!("there is only {}", listed(known)),
        None => format!("the {kind} are {}", listed(known)),
    }
}

/// Lists names for a message.
pub(super) fn listed(known: &[&str]) -> String {
    /// Maximum number of listed names; more are of no help.
    const MOST: usize = 12;
    let names: Vec<String> = known.iter().take(MOST).map(|name| format!("`{}`", short(name))).collect();
    let more = if known.len() > MOST { ", .." } else { "" };
    names.join(", ") + more
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn similar_names_alone_are_suggested() {
        assert_eq!(remedy("raduis", &["radius", "normal"], "fields"), "did you mean `radius`?");
        assert_eq!(remedy("COLOUR", &["k_a", "color"], "fields"), "did you mean `color`?");
        assert_eq!(remedy("xyz", &["radius", "normal"], "fields"), "the fields are `radius`, `normal`");
        assert_eq!(remedy("xyz", &["radius"], "fields"), "there is only `radius`");
        assert_eq!(remedy("xyz", &[], "materials"), "there are no materials here");
        let long = "x".repeat(50_000_000);
        assert_eq!(nearest(&long, ["x"; 1000]), None);
    }
}
