//! Labels below pictures, in a font of a few bitmap glyphs.

/// Characters with glyphs; any other character is drawn as a space.
const CHARACTERS: &str = "0123456789.s#";

/// Glyphs side by side, in the order of [`CHARACTERS`].
const GLYPHS: [&str; HEIGHT as usize] = [
    " ####    ##    ####   ####      ## ######  ####  ######  ####   ####                 #  #  ",
    "##  ##  ###   ##  ## ##  ##    ### ##     ##  ##     ## ##  ## ##  ##                #  #  ",
    "##  ## ####       ##     ##   #### ##     ##         ## ##  ## ##  ##               ###### ",
    "##  ##   ##       ##     ##  ## ## #####  ##        ##  ##  ## ##  ##                #  #  ",
    "##  ##   ##      ##    ###  ##  ##     ## #####     ##   ####   #####         #####  #  #  ",
    "##  ##   ##     ##       ## ######     ## ##  ##   ##   ##  ##     ##        ##      #  #  ",
    "##  ##   ##    ##        ##     ##     ## ##  ##   ##   ##  ##     ##         ####  ###### ",
    "##  ##   ##   ##     ##  ##     ## ##  ## ##  ##  ##    ##  ## ##  ##   ##       ##  #  #  ",
    " ####  ###### ######  ####      ##  ####   ####   ##     ####   ####    ##   #####   #  #  ",
];

/// Number of rows of a line of text.
pub(super) const HEIGHT: u32 = 9;
/// Number of columns from one character to the next. The last of them is empty.
const ADVANCE: u32 = 7;

/// Returns the number of columns of a text, without the empty one at its end.
pub(super) fn width(text: &str) -> u32 {
    (0..).zip(text.chars()).last().map_or(0, |(index, _): (u32, char)| index * ADVANCE + ADVANCE - 1)
}

/// Returns the column and row of every dot of a text, relative to its top left.
pub(super) fn dots(text: &str) -> impl Iterator<Item = (u32, u32)> {
    (0..)
        .step_by(ADVANCE as usize)
        .zip(text.chars())
        .flat_map(|(left, character)| glyph(character).map(move |(column, row)| (left + column, row)))
}

/// Returns the column and row of every dot of a character.
fn glyph(character: char) -> impl Iterator<Item = (u32, u32)> {
    let start = CHARACTERS.find(character).map(|index| index * ADVANCE as usize);
    start.into_iter().flat_map(|start| {
        (0..).zip(GLYPHS).flat_map(move |(row, dots)| {
            let dots = dots.bytes().skip(start).take(ADVANCE as usize);
            (0..).zip(dots).filter(|(_, dot)| *dot == b'#').map(move |(column, _)| (column, row))
        })
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_character_has_a_glyph_of_its_own_and_stays_in_its_columns() {
        let glyphs: BTreeSet<Vec<_>> =
            CHARACTERS.chars().map(|character| glyph(character).collect()).collect();
        assert_eq!(glyphs.len(), CHARACTERS.len());
        for glyph in glyphs {
            assert!(!glyph.is_empty());
            assert!(glyph.iter().all(|(column, row)| *column < ADVANCE - 1 && *row < HEIGHT));
        }
        assert!(GLYPHS.iter().all(|row| row.len() == CHARACTERS.len() * ADVANCE as usize));
    }

    #[test]
    fn text_width_matches_its_dots() {
        assert_eq!((width(""), width("8"), width("88")), (0, 6, 13));
        assert_eq!(dots("#8").map(|(column, _)| column).max(), Some(width("#8") - 1));
        assert_eq!(dots(" \u{e4}?").count(), 0);
    }
}
