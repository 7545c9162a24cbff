//! Letters, in the font Noto Sans (SIL Open Font License 1.1) of the crate `notosans`.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};

use crate::color::Rgb;
use crate::trace::FilmOverlay;

static FONT: LazyLock<Option<FontRef<'static>>> =
    LazyLock::new(|| FontRef::try_from_slice(notosans::REGULAR_TTF).ok());

/// Returns the width of a line of text of a height, in pixels.
pub(super) fn width(text: &str, height: f64) -> f64 {
    glyphs(text, height, [0.0, 0.0]).1
}

/// Draws a line of text whose top left is at a place, in pixels.
pub(super) fn draw(film: &mut FilmOverlay, text: &str, height: f64, place: [f64; 2], color: Rgb) {
    let Some(font) = &*FONT else { return };
    for outlined in glyphs(text, height, place).0.into_iter().filter_map(|glyph| font.outline_glyph(glyph)) {
        let corner = outlined.px_bounds().min;
        #[expect(clippy::cast_possible_truncation, reason = "whole numbers; films have at most 2^16 columns")]
        let (column, row) = (corner.x as i64, corner.y as i64);
        outlined.draw(|right, down, share| {
            film.cover((column + i64::from(right), row + i64::from(down)), share, color);
        });
    }
}

/// Returns the glyphs of a line of text, kerned, and its width.
#[expect(clippy::cast_possible_truncation, reason = "places of letters are rounded")]
fn glyphs(text: &str, height: f64, [left, top]: [f64; 2]) -> (Vec<Glyph>, f64) {
    let Some(font) = &*FONT else { return (Vec::new(), 0.0) };
    let scale = PxScale::from(height as f32);
    let scaled = font.as_scaled(scale);
    let (mut glyphs, mut before, mut right) = (Vec::new(), None, 0.0_f32);
    for letter in text.chars() {
        let id = font.glyph_id(letter);
        right += before.map_or(0.0, |before| scaled.kern(before, id));
        let place = point(left as f32 + right, top as f32 + scaled.ascent());
        glyphs.push(id.with_scale_and_position(scale, place));
        right += scaled.h_advance(id);
        before = Some(id);
    }
    (glyphs, f64::from(right))
}
