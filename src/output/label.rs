//! Labels below pictures, in the bitmap font of the crate `font8x8`.

use font8x8::UnicodeFonts;

/// Number of rows of a line of text. The last of them is empty.
pub(super) const HEIGHT: u32 = 9;
/// Number of columns from one character to the next.
const ADVANCE: usize = 8;

/// Returns the number of columns of a text.
pub(super) fn width(text: &str) -> u32 {
    u32::try_from(text.chars().count() * ADVANCE).unwrap_or(u32::MAX)
}

/// Returns the column and row of every dot of a text, relative to its top left.
pub(super) fn dots(text: &str) -> impl Iterator<Item = (u32, u32)> {
    (0..)
        .step_by(ADVANCE)
        .zip(text.chars())
        .flat_map(|(left, character)| glyph(character).map(move |(column, row)| (left + column, row)))
}

/// Returns the column and row of every dot of a character. Characters that are not ASCII have no dots.
fn glyph(character: char) -> impl Iterator<Item = (u32, u32)> {
    // The lowest bit of a row is its leftmost dot.
    (0..).zip(font8x8::BASIC_FONTS.get(character).into_iter().flatten()).flat_map(|(row, dots)| {
        (0..u8::BITS).filter(move |column| dots >> column & 1 == 1).map(move |column| (column, row))
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_printable_character_has_a_glyph_of_its_own() {
        let glyphs: BTreeSet<Vec<_>> = ('!'..='~').map(|character| glyph(character).collect()).collect();
        assert_eq!(glyphs.len(), 94);
        for glyph in glyphs {
            assert!(!glyph.is_empty());
            assert!(glyph.iter().all(|(column, row)| *column < 8 && *row < HEIGHT));
        }
    }

    #[test]
    fn letters_stand_upright_and_some_have_descenders() {
        let drawn = |text: &str| {
            let dots: BTreeSet<_> = dots(text).collect();
            let row = |row| {
                (0..width(text)).map(|column| if dots.contains(&(column, row)) { '#' } else { '.' }).collect()
            };
            (0..HEIGHT).map(row).collect::<Vec<String>>()
        };
        let rows = [
            "#######.........",
            ".##...#.........",
            ".##.#...##.###..",
            ".####....##..##.",
            ".##.#....##..##.",
            ".##......#####..",
            "####.....##.....",
            "........####....",
            "................",
        ];
        assert_eq!(drawn("Fp"), rows);
    }

    #[test]
    fn text_width_matches_its_dots() {
        assert_eq!((width(""), width("8"), width("88")), (0, 8, 16));
        assert_eq!(dots("8_").map(|(column, _)| column).max(), Some(width("8_") - 1));
        assert_eq!(dots(" \u{e4}\n").count(), 0);
    }
}
