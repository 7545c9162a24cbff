//! Resampling of films to another size.

use crate::color::Rgb;
use crate::trace::Film;

/// Returns a film of another size, by bilinear interpolation in linear light. The first and the last pixels keep their positions, because
/// cameras place them on the screen's edges.
pub(super) fn resampled(film: &Film, width: u32, height: u32) -> Film {
    let columns: Vec<_> = (0..width).map(|i| between(i, width, film.width())).collect();
    let rows: Vec<_> = (0..height).map(|j| between(j, height, film.height())).collect();
    let pixels: Vec<Rgb> = rows
        .iter()
        .flat_map(|(above, below, down)| {
            columns.iter().map(move |(left, right, across)| {
                let row = |j| mixed(film.pixel(*left, j), film.pixel(*right, j), *across);
                mixed(row(*above), row(*below), *down)
            })
        })
        .collect();
    Film::from_pixels(width, height, pixels.into_iter())
}

/// Returns the two indices among `from` between which index `place` among `count` lies, and the fraction of the way between them.
fn between(place: u32, count: u32, from: u32) -> (u32, u32, f32) {
    let last = from.saturating_sub(1);
    if count < 2 {
        return (last / 2, last / 2, 0.0);
    }
    let at = f64::from(place) * f64::from(last) / f64::from(count - 1);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the film")]
    let first = at as u32;
    #[expect(clippy::cast_possible_truncation, reason = "0 to 1")]
    let part = (at - f64::from(first)) as f32;
    (first, (first + 1).min(last), part)
}

fn mixed(one: Rgb, other: Rgb, part: f32) -> Rgb {
    one * (1.0 - part) + other * part
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(width: u32, height: u32) -> Film {
        let share = |place: u32, count: u32| place as f32 / (count - 1) as f32;
        let pixels: Vec<Rgb> = (0..width * height)
            .map(|index| Rgb::new(share(index % width, width), share(index / width, height), 0.25))
            .collect();
        Film::from_pixels(width, height, pixels.into_iter())
    }

    #[test]
    fn linear_ramps_are_preserved_at_every_size() {
        for (width, height) in [(2, 2), (5, 3), (64, 36), (9, 90)] {
            let (found, expected) = (resampled(&ramp(9, 5), width, height), ramp(width, height));
            for (found, expected) in found.pixels().iter().zip(expected.pixels()) {
                let apart = (*found - *expected).to_array().map(f32::abs);
                assert!(apart.iter().all(|apart| *apart < 1e-6), "{found:?} {expected:?}");
            }
        }
    }

    #[test]
    fn single_pixels_are_spread_and_taken_from_the_middle() {
        let one = Film::from_pixels(1, 1, [Rgb::ONE].into_iter());
        assert_eq!(resampled(&one, 3, 2).pixels(), &[Rgb::ONE; 6]);
        assert_eq!(resampled(&ramp(3, 3), 1, 1).pixels(), &[Rgb::new(0.5, 0.5, 0.25)]);
    }
}
