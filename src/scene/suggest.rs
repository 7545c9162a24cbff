//! "Did you mean": the nearest of the known names.

/// The known name that is most like a mistyped one, if any is like it at all.
pub(super) fn nearest<'a>(found: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let alike = |name: &str| {
        let (found, name) = (found.to_lowercase(), name.to_lowercase());
        if found == name { 2.0 } else { strsim::jaro_winkler(&found, &name) }
    };
    let best =
        known.into_iter().map(|name| (alike(name), name)).max_by(|left, right| left.0.total_cmp(&right.0));
    best.filter(|(likeness, _)| *likeness > 0.75).map(|(_, name)| name)
}

/// A remedy for an unknown name: the nearest known one, or all of them.
pub(super) fn remedy(found: &str, known: &[&str], kind: &str) -> String {
    match nearest(found, known.iter().copied()) {
        Some(name) => format!("did you mean `{name}`?"),
        None if known.is_empty() => format!("there are no {kind} here"),
        None => {
            /// More names than this are of no help.
            const MOST: usize = 12;
            let names: Vec<String> = known.iter().take(MOST).map(|name| format!("`{name}`")).collect();
            let more = if known.len() > MOST { ", .." } else { "" };
            format!("the {kind} are {}{more}", names.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn likely_names_are_suggested_and_unlikely_ones_are_not() {
        assert_eq!(remedy("raduis", &["radius", "normal"], "fields"), "did you mean `radius`?");
        assert_eq!(remedy("COLOUR", &["k_a", "color"], "fields"), "did you mean `color`?");
        assert_eq!(remedy("xyz", &["radius", "normal"], "fields"), "the fields are `radius`, `normal`");
        assert_eq!(remedy("xyz", &[], "materials"), "there are no materials here");
    }
}
