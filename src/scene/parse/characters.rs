//! Characters that are invalid in a scene, and their probable meaning.

/// Returns the message, label and remedy for an invalid character outside strings and comments.
pub(super) fn strange(character: char) -> (String, String, String) {
    let code = format!("U+{:04X}", u32::from(character));
    if let Some(name) = invisible(character) {
        return (
            format!("there is {name} here, which cannot be seen"),
            code,
            "delete it, and write an ordinary space if there is to be one".to_owned(),
        );
    }
    if let Some(ordinary) = ordinary(character) {
        return (
            format!("`{character}` is not the ordinary sign `{ordinary}`"),
            code,
            format!("write `{ordinary}`; such signs come from word processors and web pages"),
        );
    }
    let help = match character {
        '#' => "comments start with //",
        '/' => "comments start with //; instead of a division, write the number that comes out, as 0.5",
        '*' | '%' | '^' => "write the number that comes out; scripts can calculate, as in Script(\"2 * t\")",
        ';' => "values are separated by commas",
        '=' => "a name and its value are separated by a colon, as in `radius: 1`",
        _ => "remove it, or put it into a text in double quotes",
    };
    let shown =
        if character.is_ascii() { character.to_string() } else { character.escape_debug().to_string() };
    (format!("`{shown}` means nothing here"), "not part of any value".to_owned(), help.to_owned())
}

/// Returns whether a character is valid in scenes, as punctuation or in words.
pub(super) fn is_known(character: char) -> bool {
    character.is_alphanumeric() || "()[]{},:\"'_.+-".contains(character)
}

fn invisible(character: char) -> Option<&'static str> {
    match character {
        '\u{a0}' | '\u{2007}' | '\u{202f}' => Some("a no-break space"),
        '\u{1680}' | '\u{2000}'..='\u{200a}' | '\u{205f}' | '\u{3000}' => Some("a space of another width"),
        '\u{200b}' | '\u{2060}' | '\u{feff}' => Some("a space of no width"),
        '\u{ad}' => Some("a soft hyphen"),
        '\u{200c}' | '\u{200d}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => {
            Some("a mark for typesetting")
        }
        _ if character.is_control() => Some("a control character"),
        _ => None,
    }
}

/// Returns the ASCII character that a typographic one stands for.
fn ordinary(character: char) -> Option<char> {
    match character {
        '“' | '”' | '„' | '‟' | '«' | '»' | '‘' | '’' | '‚' | '‛' | '‹' | '›' | '″' => {
            Some('"')
        }
        '‐' | '‑' | '‒' | '–' | '—' | '―' | '−' => Some('-'),
        '、' | '،' => Some(','),
        // The block of full-width characters has the order of ASCII.
        '！'..='～' => u8::try_from(u32::from(character) - 0xff01 + 0x21).ok().map(char::from),
        _ => None,
    }
}
