//! Quotes from scenes in messages: names, numbers and lists, truncated to a readable length.

pub(super) use crate::components::Figure;

/// Formats a name or another text on one line: truncated, and with control characters escaped.
pub(super) fn short(text: &str) -> String {
    /// Maximum number of characters, more than in typical names.
    const LONGEST: usize = 60;
    let mut shown = String::new();
    for (count, character) in text.chars().enumerate() {
        if count == LONGEST {
            shown.push('…');
            break;
        }
        if character.is_control() {
            shown.extend(character.escape_default());
        } else {
            shown.push(character);
        }
    }
    shown
}

/// Joins the links of a chain. A long chain keeps only its first and last links.
pub(super) fn linked(links: &[String], joint: &str) -> String {
    /// The number of links shown at each end.
    const MOST: usize = 4;
    let omitted = links.len().saturating_sub(2 * MOST);
    if omitted < 2 {
        return links.join(joint);
    }
    let between = format!("({omitted} more)");
    let (first, last) = (&links[..MOST], &links[links.len() - MOST..]);
    [first.join(joint), between, last.join(joint)].join(joint)
}

/// Truncates a message whose parts may be of any length.
pub(super) fn bounded(message: String) -> String {
    /// Maximum length in bytes, more than in any message that quotes a few names.
    const LONGEST: usize = 800;
    if message.len() <= LONGEST {
        return message;
    }
    let mut cut = message;
    cut.truncate(cut.floor_char_boundary(LONGEST));
    cut.push('…');
    cut
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_and_unprintable_names_are_escaped() {
        assert_eq!(short("ball"), "ball");
        assert_eq!(short("a\nb\u{1b}[31m"), "a\\nb\\u{1b}[31m");
        assert_eq!(short(&"ß".repeat(60)), "ß".repeat(60));
        assert_eq!(short(&"ß".repeat(61)), "ß".repeat(60) + "…");
    }

    #[test]
    fn shortened_chains_keep_their_ends() {
        let links = |count: usize| (1..=count).map(|link| link.to_string()).collect::<Vec<_>>();
        assert_eq!(linked(&links(9), " -> "), "1 -> 2 -> 3 -> 4 -> 5 -> 6 -> 7 -> 8 -> 9");
        assert_eq!(linked(&links(10), "-"), "1-2-3-4-(2 more)-7-8-9-10");
    }

    #[test]
    fn messages_are_cut_between_characters() {
        assert_eq!(bounded("short".to_owned()), "short");
        assert!(bounded("ß".repeat(10_000)).len() < 810);
    }
}
