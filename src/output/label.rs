//! Labels below pictures, in a font of a few bitmap glyphs.

/// Glyphs side by side, and the characters in their order. Any other character is drawn as a space.
struct GlyphTable {
    characters: &'static str,
    rows: [&'static str; HEIGHT as usize],
}

const TABLES: [GlyphTable; 3] = [
    GlyphTable { characters: "0123456789.s#", rows: DIGITS },
    GlyphTable { characters: "abcdefghijklm", rows: FIRST_LETTERS },
    GlyphTable { characters: "nopqrtuvwxyz", rows: LAST_LETTERS },
];

const DIGITS: [&str; HEIGHT as usize] = [
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

/// Letters with descenders stand on the baseline, as high as the letters without.
const FIRST_LETTERS: [&str; HEIGHT as usize] = [
    "       ##                ##          ###         ##                   ##      ###          ",
    "       ##                ##         ##           ##       ##      ##  ##       ##          ",
    "       ##                ##         ##           ##       ##      ##  ##       ##          ",
    "       ##                ##        #####         ##                   ##       ##          ",
    " ####  #####   ####   #####  ####   ##     ##### #####   ###     ###  ## ##    ##   ## ##  ",
    "    ## ##  ## ##  ## ##  ## ##  ##  ##    ##  ## ##  ##   ##      ##  ####     ##   ###### ",
    " ##### ##  ## ##     ##  ## ######  ##     ##### ##  ##   ##      ##  ###      ##   # ## # ",
    "##  ## ##  ## ##  ## ##  ## ##      ##        ## ##  ##   ##      ##  ####     ##   # ## # ",
    " ##### #####   ####   #####  ####   ##    ####   ##  ##  ####  ###    ## ##   ####  # ## # ",
];

const LAST_LETTERS: [&str; HEIGHT as usize] = [
    "                                                                                    ",
    "                                    ##                                              ",
    "                                    ##                                              ",
    "                                   #####                                            ",
    "#####   ####  #####   ##### ## ###  ##    ##  ## ##  ## # ## # ##  ## ##  ## ###### ",
    "##  ## ##  ## ##  ## ##  ## ###     ##    ##  ## ##  ## # ## #  ####  ##  ##    ##  ",
    "##  ## ##  ## #####   ##### ##      ##    ##  ## ##  ## # ## #   ##    #####   ##   ",
    "##  ## ##  ## ##         ## ##      ##    ##  ##  ####  ######  ####      ##  ##    ",
    "##  ##  ####  ##         ## ##       ###   #####   ##    #  #  ##  ## ####   ###### ",
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
    let find = |GlyphTable { characters, rows }: GlyphTable| {
        Some((characters.find(character)? * ADVANCE as usize, rows))
    };
    TABLES.into_iter().find_map(find).into_iter().flat_map(|(start, rows)| {
        (0..).zip(rows).flat_map(move |(row, dots)| {
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
        let characters: String = TABLES.map(|table| table.characters).concat();
        let glyphs: BTreeSet<Vec<_>> =
            characters.chars().map(|character| glyph(character).collect()).collect();
        assert_eq!((glyphs.len(), characters.len()), (38, 38));
        for glyph in glyphs {
            assert!(!glyph.is_empty());
            assert!(glyph.iter().all(|(column, row)| *column < ADVANCE - 1 && *row < HEIGHT));
        }
        let width = |table: &GlyphTable| table.characters.len() * ADVANCE as usize;
        assert!(TABLES.iter().all(|table| table.rows.iter().all(|row| row.len() == width(table))));
    }

    #[test]
    fn text_width_matches_its_dots() {
        assert_eq!((width(""), width("8"), width("88")), (0, 6, 13));
        assert_eq!(dots("#8").map(|(column, _)| column).max(), Some(width("#8") - 1));
        assert_eq!(dots(" \u{e4}?").count(), 0);
    }
}
