//! Pictures within a page.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use rayreel::color::{Rgb, Transfer};
use rayreel::output::{FrameFormat, encode};
use rayreel::trace::Film;

/// Returns a film as the address of a PNG.
pub(super) fn address(film: &Film, transfer: Transfer) -> anyhow::Result<String> {
    let bytes = encode(film, transfer, FrameFormat::default())?;
    Ok(format!("data:image/png;base64,{}", STANDARD.encode(bytes)))
}

/// Returns what differs in two films: by how many steps of 8 bits, so many times as bright.
pub(super) fn difference(film: &Film, other: &Film, transfer: Transfer, times: f64) -> Film {
    let pixels = film.pixels().iter().zip(other.pixels()).map(|(pixel, other)| {
        let (values, others) = (transfer.encode_unrounded(*pixel), transfer.encode_unrounded(*other));
        let channel = |channel: usize| {
            #[expect(clippy::cast_possible_truncation, reason = "it becomes a byte")]
            let apart = ((values[channel] - others[channel]).abs() * times / 255.0) as f32;
            apart
        };
        Rgb::new(channel(0), channel(1), channel(2))
    });
    Film::from_pixels(film.width(), film.height(), pixels)
}
