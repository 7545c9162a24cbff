//! Help while a scene is typed: completions, descriptions, definitions and the outline.
//!
//! Texts are usually incomplete. `scan` follows the brackets up to the cursor, whatever else is in the text. The open brackets alone, without
//! the values beside the cursor, are a short scene that is cut off where the cursor is, and the parser reports what it expects there:
//!
//! ```text
//! (film: (width: 8), entities: [(name: "a"), (shape: Sphere(radius: 1, |      the text up to the cursor
//! (entities: [(shape: Sphere(                                                 the open brackets: a field of a sphere
//! ```
//!
//! Positions are byte offsets.

mod complete;
mod hover;
mod names;
mod scan;

pub use complete::{Suggestion, SuggestionKind, Suggestions, complete};
pub use hover::{Description, describe};
pub use names::{Destination, SceneSymbol, SymbolKind, definition, outline};

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scene::spans::tokens;

    const SCENE: &str = include_str!("../../../tests/hard_cases/every_number.ron");

    #[test]
    fn what_is_written_is_suggested_and_described() {
        let tokens: Vec<_> = tokens(SCENE).collect();
        let mut count = 0;
        for pair in tokens.windows(2) {
            let (word, start) = (&SCENE[pair[0].clone()], pair[0].start);
            let is_field = word.starts_with(char::is_lowercase) && &SCENE[pair[1].clone()] == ":";
            let is_variant = word.starts_with(char::is_uppercase) && word != "Scene";
            if !(is_field || is_variant) {
                continue;
            }
            for (text, at) in [(&SCENE[..start], start), (&SCENE[..=start], start + 1), (SCENE, start + 1)] {
                let suggestions = complete(text, at, Path::new("a.ron"));
                let is_suggested = suggestions.items.iter().any(|item| item.label == word);
                assert!(is_suggested, "{word} at {at} of {}: {suggestions:?}", text.len());
            }
            let Description { title, about, span } = describe(SCENE, start).unwrap();
            assert!(
                title.starts_with(word) && !about.is_empty() && span == pair[0],
                "{word}: {title}: {about}"
            );
            count += 1;
        }
        assert!(count > 100, "{count}");
    }

    #[test]
    fn incomplete_texts_do_no_harm() {
        let without = tokens(SCENE).map(|token| SCENE[..token.start].to_owned() + &SCENE[token.end..]);
        let cut = tokens(SCENE).map(|token| SCENE[..token.start + 1].to_owned());
        let mut at = 0;
        for text in without.chain(cut).chain([["(", "]"].map(|bracket| bracket.repeat(100_000)).concat()]) {
            at = (at + 71) % (text.len() + 2);
            let path = Path::new("a.ron");
            let found = complete(&text, at, path);
            assert!(text.get(found.span).is_some());
            assert!(describe(&text, at).is_none_or(|found| text.get(found.span).is_some()));
            assert!(definition(&text, at, path).is_none_or(|found| text.get(found.span).is_some()));
            assert!(outline(&text).into_iter().all(|symbol| text.get(symbol.span).is_some()));
        }
    }
}
