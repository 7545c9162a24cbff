//! Sources as HTML, with comments, strings and numbers highlighted.

/// Returns a text with the characters of HTML escaped.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Returns a text as HTML, with code between backticks.
pub(crate) fn prose(text: &str) -> String {
    let parts = text.split('`').zip([["", ""], ["<code>", "</code>"]].into_iter().cycle());
    parts.map(|(part, [start, end])| format!("{start}{}{end}", escaped(part))).collect()
}

/// Returns the first lines of a source, whole unless it is long, and the number of lines after them.
pub(crate) fn beginning(source: &str) -> (&str, usize) {
    /// Longer than what people write; programs write keys of a hundred thousand bytes.
    const LONGEST: usize = 32 << 10;
    let cut =
        if source.len() > LONGEST { source[..source.floor_char_boundary(LONGEST)].rfind('\n') } else { None };
    let (shown, rest) = source.split_at(cut.map_or(source.len(), |end| end + 1));
    (shown, rest.lines().count())
}

/// Returns the source of a scene or a script as HTML.
pub(crate) fn highlighted(source: &str) -> String {
    let (mut html, mut rest, mut is_word) = (String::new(), source, false);
    while let Some(first) = rest.chars().next() {
        let (class, length) = match token(rest) {
            // Digits within a word are no number.
            Some(("number", _)) if is_word => ("", first.len_utf8()),
            Some(found) => found,
            None => ("", first.len_utf8()),
        };
        let (text, after) = rest.split_at(length);
        is_word = class.is_empty() && (first.is_alphanumeric() || first == '_');
        match class {
            "" => html += &escaped(text),
            class => html += &format!("<span class=\"{class}\">{}</span>", escaped(text)),
        }
        rest = after;
    }
    html
}

/// Returns the class and the length of the comment, string or number that a text begins with.
fn token(text: &str) -> Option<(&'static str, usize)> {
    let to = |end: &str, from: usize| text[from..].find(end).map_or(text.len(), |at| from + at + end.len());
    let hashes = text.bytes().skip(1).take_while(|byte| *byte == b'#').count();
    if text.starts_with("//") {
        Some(("comment", text.find('\n').unwrap_or(text.len())))
    } else if text.starts_with("/*") {
        Some(("comment", to("*/", 2)))
    } else if text.starts_with('r') && text[1 + hashes..].starts_with('"') {
        Some(("string", to(&format!("\"{}", "#".repeat(hashes)), hashes + 2)))
    } else if let Some(quote) = text.chars().next().filter(|first| *first == '"' || *first == '`') {
        let mut is_escaped = false;
        let end = text.char_indices().skip(1).find(|(_, letter)| {
            let is_end = *letter == quote && !is_escaped;
            is_escaped = *letter == '\\' && !is_escaped;
            is_end
        });
        Some(("string", end.map_or(text.len(), |(at, _)| at + 1)))
    } else if text.starts_with(|first: char| first.is_ascii_digit()) {
        let mut before = ' ';
        let end = text.find(|letter: char| {
            let is_sign = matches!(letter, '-' | '+') && matches!(before, 'e' | 'E');
            before = letter;
            !(letter.is_ascii_alphanumeric() || letter == '.' || letter == '_' || is_sign)
        });
        // Two points are a range.
        let end = end.unwrap_or(text.len());
        let end = text[..end].find("..").unwrap_or(end);
        Some(("number", end))
    } else {
        None
    }
}
