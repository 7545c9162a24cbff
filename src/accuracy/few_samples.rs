//! How good pictures with few samples are: some are good enough with one or two in every pixel.

use std::f64::consts::SQRT_2;

use super::FilmError;
use crate::engine::{Engine, EngineError};
use crate::systems::Knobs;
use crate::time::Time;
use crate::trace::Film;

/// The errors of pictures with 1, 2 and 4 samples per pixel, as the root of the mean square, in output values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FewSamples {
    errors: [f64; COUNTS.len()],
}

const COUNTS: [u32; 3] = [1, 2, 4];

impl FewSamples {
    /// Estimates them at some moments of a scene, the worst of all, from pictures of a quarter and an eighth of the film's sides: with
    /// them it is seen how errors change with the size, as edges take less of a larger picture.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn estimate(engine: &mut Engine, moments: &[Time]) -> Result<Self, EngineError> {
        let mut worst = Self::default();
        for moment in moments {
            let [small, smaller] = [errors(engine, *moment, 4)?, errors(engine, *moment, 8)?];
            for (worst, (small, smaller)) in worst.errors.iter_mut().zip(small.into_iter().zip(smaller)) {
                // From an eighth to a quarter once, and from there to the whole twice.
                let falls = if small > 0.0 { (smaller / small).clamp(1.0, SQRT_2) } else { 1.0 };
                *worst = worst.max(small / (falls * falls));
            }
        }
        Ok(worst)
    }

    /// Returns the fewest samples with which pictures are certainly as good as that. `None` if four are too few.
    #[must_use]
    pub fn enough_for(&self, error: f64) -> Option<u32> {
        /// What is estimated may be off by as much.
        const SURE: f64 = 1.25;
        let enough = |(_, found): &(u32, f64)| SURE * found <= error;
        COUNTS.into_iter().zip(self.errors).find(enough).map(|(count, _)| count)
    }

    /// Returns the errors with so many samples per pixel, if they fall as fast as edges' do, and as they do with lights, lenses and shutters.
    #[must_use]
    pub fn errors_with(&self, samples: u32) -> (f64, f64) {
        let [.., four] = self.errors;
        let more = 4.0 / f64::from(samples.max(4));
        (four * libm::pow(more, 0.75), four * more.sqrt())
    }
}

/// Returns the errors of a picture of a part of the film's width and height.
fn errors(engine: &mut Engine, moment: Time, divisor: u32) -> Result<[f64; 3], EngineError> {
    let (knobs, film) = (engine.knobs(), engine.film_settings());
    let size = Some(((film.width / divisor).max(1), (film.height / divisor).max(1)));
    let mut render = |samples, seed| {
        engine.set_knobs(Knobs {
            size,
            samples: Some(samples),
            max_error: Some(0.0),
            seed: Some(seed),
            ..knobs
        });
        let rendered = engine.render_at(moment);
        engine.set_knobs(knobs);
        rendered
    };
    let (single, twos) = (render(1, 1)?, [render(2, 1)?, render(2, 2)?]);
    let fours = [render(4, 3)?, render(4, 4)?];
    let apart = |one: &Film, other: &Film| FilmError::between(one, other, film.transfer).rms;
    // Independent pictures are farther apart than each is from the truth.
    let [two, four] = [&twos, &fours].map(|[one, other]| apart(one, other) / SQRT_2);
    let with_four = apart(&single, &fours[0]);
    Ok([(with_four * with_four - four * four).max(0.0).sqrt(), two, four])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fewest_that_do_are_enough() {
        let few = FewSamples { errors: [4.0, 2.0, 1.0] };
        assert_eq!(few.enough_for(5.1), Some(1));
        assert_eq!(few.enough_for(4.0), Some(2));
        assert_eq!(few.enough_for(1.3), Some(4));
        assert_eq!(few.enough_for(1.0), None);
        assert_eq!(few.errors_with(64), (0.125, 0.25));
        assert_eq!(few.errors_with(1), (1.0, 1.0));
    }
}
