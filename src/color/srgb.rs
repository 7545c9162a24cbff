//! sRGB colours from bytes and from hexadecimal digits.

use super::{Rgb, Transfer};

/// Returns the linear light of an sRGB colour with 8-bit channels, as scene files convert it.
///
/// ```
/// use rayreel::color::{hex, srgb};
/// assert_eq!(srgb(255, 120, 60), hex("#ff783c")?);
/// # Ok::<(), rayreel::color::HexError>(())
/// ```
#[must_use]
pub fn srgb(red: u8, green: u8, blue: u8) -> Rgb {
    Transfer::Srgb.decode([red, green, blue].map(f64::from))
}

/// Parses an sRGB colour such as `#ff783c`, and returns its linear light.
///
/// # Errors
///
/// If the text is not a `#` with six hexadecimal digits, of either case.
pub fn hex(text: &str) -> Result<Rgb, HexError> {
    let channels = hex_channels(text).ok_or_else(|| HexError(text.to_owned()))?;
    Ok(Transfer::Srgb.decode(channels))
}

/// The error for a text that is not a colour in hexadecimal digits.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a colour: write six hexadecimal digits after a #, as in `#ff783c`")]
pub struct HexError(String);

debug_as_message!(HexError);

/// Returns the channels, in 0..=255, of a colour in the form `#rrggbb`.
pub(crate) fn hex_channels(text: &str) -> Option<[f64; 3]> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6)?;
    // `from_str_radix` accepts a sign.
    if !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return None;
    }
    let [_, red, green, blue] = u32::from_str_radix(digits, 16).ok()?.to_be_bytes();
    Some([red, green, blue].map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_six_digits_are_a_colour() {
        assert_eq!(hex_channels("#Ff783c"), Some([255.0, 120.0, 60.0]));
        for wrong in ["", "#", "ff783c", "#ff783", "#ff783c0", "#+f783c", "#ff 83c", "#éfffff"] {
            assert_eq!(hex_channels(wrong), None, "{wrong}");
        }
        let message = hex("red").unwrap_err().to_string();
        assert_eq!(message, "`red` is not a colour: write six hexadecimal digits after a #, as in `#ff783c`");
    }
}
