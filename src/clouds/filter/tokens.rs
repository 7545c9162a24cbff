//! The words, numbers and signs of a condition.

use std::ops::Range;

use crate::clouds::error::{CloudError, CloudPart};

#[derive(Clone, Debug)]
pub(super) struct Token {
    pub(super) kind: TokenKind,
    pub(super) place: Range<usize>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum TokenKind {
    Number(f64),
    Text(String),
    Name(String),
    Sign(&'static str),
}

/// The signs, longer ones before those with which they begin.
const SIGNS: [&str; 20] = [
    "==", "!=", "<=", ">=", "&&", "||", "<", ">", "=", "!", "+", "-", "*", "/", "%", "^", "(", ")", ",", "&",
];

/// Returns the tokens of a condition.
pub(super) fn tokens(text: &str) -> Result<Vec<Token>, CloudError> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        let run = |is_in: fn(char) -> bool| rest.find(|letter| !is_in(letter)).unwrap_or(rest.len());
        let is_of_name = |letter: char| letter.is_alphanumeric() || "_.[]:".contains(letter);
        let (kind, length) = if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        } else if first.is_ascii_digit() || first == '.' {
            let mut length = run(|letter| letter.is_ascii_digit() || letter == '.');
            // An exponent, as in `1e-3`.
            if let Some(exponent) = rest[length..].strip_prefix(['e', 'E']) {
                let digits = exponent.trim_start_matches(['+', '-']);
                let count =
                    digits.len() - digits.trim_start_matches(|letter: char| letter.is_ascii_digit()).len();
                if count > 0 {
                    length += 1 + (exponent.len() - digits.len()) + count;
                }
            }
            let number = rest[..length].parse().map_err(|_| {
                error(
                    at..at + length,
                    format!("`{}` is not a number", &rest[..length]),
                    "write a number, as 1.5",
                )
            })?;
            (TokenKind::Number(number), length)
        } else if let Some(quote) = ['\'', '"', '`'].into_iter().find(|quote| *quote == first) {
            let Some(length) = rest[1..].find(quote) else {
                return Err(error(
                    at..text.len(),
                    "the quote is not closed",
                    format!("end the text with a {quote}"),
                ));
            };
            let inside = rest[1..=length].to_owned();
            // A column whose name is no word is written in backquotes.
            let kind = if quote == '`' { TokenKind::Name(inside) } else { TokenKind::Text(inside) };
            (kind, length + 2)
        } else if first.is_alphabetic() || first == '_' {
            let length = run(is_of_name);
            let name = &rest[..length];
            let kind = match name {
                "and" => TokenKind::Sign("&&"),
                "or" => TokenKind::Sign("||"),
                "not" => TokenKind::Sign("!"),
                name => TokenKind::Name(name.to_owned()),
            };
            (kind, length)
        } else if let Some(sign) = SIGNS.into_iter().find(|sign| rest.starts_with(sign)) {
            if let "=" | "&" = sign {
                return Err(error(
                    at..at + 1,
                    format!("`{sign}` means nothing"),
                    format!("write `{sign}{sign}`"),
                ));
            }
            (TokenKind::Sign(sign), sign.len())
        } else {
            let message = format!("`{}` is not part of a condition", first.escape_default());
            return Err(error(
                at..at + first.len_utf8(),
                message,
                "compare columns, as `z > 0 and type == 2`",
            ));
        };
        tokens.push(Token { kind, place: at..at + length });
        at += length;
    }
    Ok(tokens)
}

/// Returns a mistake at a place of the condition.
pub(super) fn error(place: Range<usize>, message: impl Into<String>, help: impl Into<String>) -> CloudError {
    CloudError::new(CloudPart::Filter(place), message, help)
}
