//! How good pictures with few samples are: some are good enough with one or two in every pixel.

use std::f64::consts::SQRT_2;
use std::sync::atomic::AtomicBool;

use super::stop::{Stop, render, unless_cancelled};
use super::{FilmError, FrameSamples, Pilot};
use crate::engine::{Engine, EngineError};
use crate::systems::Knobs;
use crate::time::Time;

/// The errors of pictures with 1, 2 and 4 samples per pixel, as the root of the mean square, in output values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FewSamples {
    errors: [f64; COUNTS.len()],
}

const COUNTS: [u32; 3] = [1, 2, 4];
/// What is estimated may be off by as much.
const SURE: f64 = 1.25;

impl FewSamples {
    /// Estimates them at a pilot's moments, the worst of all, from pictures of a part of the film's sides and of half of that: with
    /// both it is seen how errors change with the size, as edges take less of a larger picture. Ends as soon as it is clear that four
    /// samples are too few for `wanted`. `None` if it was cancelled.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn estimate(
        engine: &mut Engine,
        pilot: &Pilot,
        wanted: f64,
        cancelled: &AtomicBool,
    ) -> Result<Option<Self>, EngineError> {
        unless_cancelled(estimate(engine, pilot, wanted, cancelled))
    }

    /// Returns the samples with which pictures are as good as that: as many in all pixels where few are enough. `None` if the most that a
    /// pixel may get are too few.
    #[must_use]
    pub fn samples_for(&self, error: f32, most: u32) -> Option<FrameSamples> {
        let enough = |(_, found): &(u32, f64)| SURE * found <= f64::from(error);
        match COUNTS.into_iter().zip(self.errors).find(enough).filter(|(count, _)| *count <= most) {
            // From four on, pictures tell how good they are.
            Some((count, _)) if count < 4 => Some(FrameSamples { samples: count, max_error: 0.0 }),
            Some((count, _)) => Some(FrameSamples::for_error(error, count)),
            None if self.errors_with(most).0 > f64::from(error) => None,
            None => Some(FrameSamples::for_error(error, most)),
        }
    }

    /// Returns the errors with so many samples per pixel, if they fall as fast as edges' do, and as they do with lights, lenses and shutters.
    #[must_use]
    pub fn errors_with(&self, samples: u32) -> (f64, f64) {
        let known = COUNTS.into_iter().zip(self.errors).rfind(|(count, _)| *count <= samples);
        let (count, error) = known.unwrap_or((1, self.errors[0]));
        let more = f64::from(count) / f64::from(samples.max(1));
        (error * libm::pow(more, 0.75), error * more.sqrt())
    }
}

fn estimate(
    engine: &mut Engine,
    &Pilot { ref moments, divisor }: &Pilot,
    wanted: f64,
    cancelled: &AtomicBool,
) -> Result<FewSamples, Stop> {
    let mut worst = FewSamples::default();
    let doublings = f64::from(divisor.ilog2());
    for moment in moments {
        let smaller = errors(engine, (*moment, 2 * divisor), cancelled)?;
        // At best errors fall with the root of the size.
        let best = smaller[2] / libm::exp2((doublings + 1.0) / 2.0);
        if SURE * best > wanted {
            let four = worst.errors[2].max(best);
            return Ok(FewSamples {
                errors: [worst.errors[0].max(smaller[0]), worst.errors[1].max(smaller[1]), four],
            });
        }
        let small = errors(engine, (*moment, divisor), cancelled)?;
        for (worst, (small, smaller)) in worst.errors.iter_mut().zip(small.into_iter().zip(smaller)) {
            let falls = if small > 0.0 { (smaller / small).clamp(1.0, SQRT_2) } else { 1.0 };
            *worst = worst.max(small / libm::pow(falls, doublings));
        }
    }
    Ok(worst)
}

/// Returns the errors of a picture of a part of the film's width and height.
fn errors(
    engine: &mut Engine,
    (moment, divisor): (Time, u32),
    cancelled: &AtomicBool,
) -> Result<[f64; 3], Stop> {
    let (knobs, film) = (engine.knobs(), engine.film_settings());
    let size = Some(((film.width / divisor).max(1), (film.height / divisor).max(1)));
    let mut films = Vec::new();
    for (samples, seed) in [(1, 1), (2, 1), (2, 2), (4, 3), (4, 4)] {
        let (samples, seed) = (Some(samples), Some(seed));
        engine.set_knobs(Knobs { size, samples, seed, max_error: Some(0.0), ..knobs });
        let rendered = render(engine, moment, cancelled);
        engine.set_knobs(knobs);
        films.push(rendered?);
    }
    let apart = |one: usize, other: usize| FilmError::between(&films[one], &films[other], film.transfer).rms;
    // Independent pictures are farther apart than each is from the truth.
    let (two, four, with_four) = (apart(1, 2) / SQRT_2, apart(3, 4) / SQRT_2, apart(0, 3));
    Ok([(with_four * with_four - four * four).max(0.0).sqrt(), two, four])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fewest_that_do_are_chosen() {
        let few = FewSamples { errors: [4.0, 2.0, 1.0] };
        let everywhere = |samples| Some(FrameSamples { samples, max_error: 0.0 });
        assert_eq!(few.samples_for(5.1, 64), everywhere(1));
        assert_eq!(few.samples_for(4.0, 64), everywhere(2));
        assert_eq!(few.samples_for(1.3, 64), Some(FrameSamples::for_error(1.3, 4)));
        assert_eq!(few.samples_for(1.0, 64), Some(FrameSamples::for_error(1.0, 64)));
        assert_eq!(few.samples_for(0.2, 64), Some(FrameSamples::for_error(0.2, 64)));
        assert_eq!(few.samples_for(0.1, 64), None);
        assert_eq!(few.samples_for(1.3, 1), None);
    }

    #[test]
    fn errors_fall_by_the_number_of_samples() {
        let few = FewSamples { errors: [4.0, 2.0, 1.0] };
        assert_eq!(few.errors_with(64), (0.125, 0.25));
        assert_eq!(few.errors_with(1), (4.0, 4.0));
        assert_eq!(few.errors_with(2), (2.0, 2.0));
    }
}
