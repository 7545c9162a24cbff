//! How good pictures with few samples are: some are good enough with a single one in every pixel.

use std::f64::consts::SQRT_2;
use std::sync::atomic::AtomicBool;

use super::estimate::pair;
use super::stop::{Stop, render, unless_cancelled};
use super::{FrameSamples, Pilot};
use crate::engine::{Engine, EngineError};
use crate::systems::Knobs;
use crate::time::Time;

/// The errors of pictures with one and with four samples per pixel, as the root of the mean square, in output values. From two on
/// pictures tell themselves how good they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FewSamples {
    one: f64,
    four: f64,
    /// By what factor they may be larger.
    uncertain: f64,
}

impl FewSamples {
    /// Estimates them at a pilot's moments, the worst of all, from pictures of a part of the film's sides and of half of that: with
    /// both it is seen how errors change with the size, as edges take less of a larger picture. Ends as soon as it is clear that one
    /// sample is too few for `wanted`. `None` if it was cancelled.
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
        let knobs = engine.knobs();
        let estimated = estimate(engine, pilot, wanted, cancelled);
        engine.set_knobs(knobs);
        unless_cancelled(estimated)
    }

    /// Returns the samples with which pictures are as good as that: one in each pixel where that is certainly enough, and otherwise as many
    /// as each needs. `None` if the most that a pixel may get are certainly too few.
    #[must_use]
    pub fn samples_for(&self, error: f32, most: u32) -> Option<FrameSamples> {
        let wanted = f64::from(error);
        if self.uncertain * self.one <= wanted || (most == 1 && self.one <= wanted) {
            return Some(FrameSamples { samples: 1, max_error: 0.0 });
        }
        // Where errors fall as fast as those of edges do.
        let best = if most < 4 { self.one } else { self.four } * libm::pow(self.more(most), 0.75);
        (best <= wanted).then(|| FrameSamples::for_error(error, most))
    }

    /// Returns an error that pictures with so many samples will hardly exceed: that with lights, lenses and shutters, whose errors fall more
    /// slowly than those of edges.
    #[must_use]
    pub fn certain_error(&self, samples: u32) -> f64 {
        self.uncertain * if samples < 4 { self.one } else { self.four } * self.more(samples).sqrt()
    }

    /// Returns what part the known samples are of so many.
    fn more(&self, samples: u32) -> f64 {
        let known = if samples < 4 { 1.0 } else { 4.0 };
        known / f64::from(samples.max(1))
    }
}

fn estimate(
    engine: &mut Engine,
    &Pilot { ref moments, divisor, uncertain }: &Pilot,
    wanted: f64,
    cancelled: &AtomicBool,
) -> Result<FewSamples, Stop> {
    let mut worst = FewSamples { one: 0.0, four: 0.0, uncertain };
    let doublings = f64::from(divisor.ilog2());
    for moment in moments {
        let smaller = errors(engine, (*moment, 2 * divisor), cancelled)?;
        // At best errors fall with the root of the size.
        let falls = libm::exp2((doublings + 1.0) / 2.0);
        let [one, four] = smaller.map(|error| error / falls);
        if uncertain * one > wanted {
            let uncertain = uncertain * falls;
            return Ok(FewSamples { one: worst.one.max(one), four: worst.four.max(four), uncertain });
        }
        let small = errors(engine, (*moment, divisor), cancelled)?;
        let [one, four] = std::array::from_fn(|index| {
            let (small, smaller) = (small[index], smaller[index]);
            let falls = if small > 0.0 { (smaller / small).clamp(1.0, SQRT_2) } else { 1.0 };
            small / libm::pow(falls, doublings)
        });
        (worst.one, worst.four) = (worst.one.max(one), worst.four.max(four));
    }
    Ok(worst)
}

/// Returns the errors of a picture of a part of the film's width and height, with one and with four samples. Knobs stay turned.
fn errors(
    engine: &mut Engine,
    (moment, divisor): (Time, u32),
    cancelled: &AtomicBool,
) -> Result<[f64; 2], Stop> {
    let film = engine.film_settings();
    let size = Some(((film.width / divisor).max(1), (film.height / divisor).max(1)));
    let knobs = |samples| Knobs { size, samples: Some(samples), max_error: Some(0.0), ..Knobs::default() };
    let four = pair(engine, moment, knobs(4), cancelled)?;
    engine.set_knobs(knobs(1));
    let single = render(engine, moment, cancelled)?;
    Ok([four.error_of(&single, engine), four.estimate.rms])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sample_is_chosen_where_it_is_enough() {
        let few = FewSamples { one: 4.0, four: 1.0, uncertain: 1.25 };
        let one = Some(FrameSamples { samples: 1, max_error: 0.0 });
        assert_eq!(few.samples_for(5.1, 64), one);
        assert_eq!(few.samples_for(4.0, 64), Some(FrameSamples::for_error(4.0, 64)));
        // It is the most, and may be enough.
        assert_eq!(few.samples_for(4.0, 1), one);
        assert_eq!(few.samples_for(3.9, 1), None);
        assert_eq!(few.samples_for(1.0, 4), Some(FrameSamples::for_error(1.0, 4)));
        assert_eq!(few.samples_for(0.9, 4), None);
        assert_eq!(few.samples_for(0.2, 64), Some(FrameSamples::for_error(0.2, 64)));
        assert_eq!(few.samples_for(0.1, 64), None);
    }

    #[test]
    fn errors_fall_by_the_number_of_samples() {
        let few = FewSamples { one: 4.0, four: 1.0, uncertain: 1.25 };
        assert_eq!([1, 4, 64].map(|samples| few.certain_error(samples)), [5.0, 1.25, 0.3125]);
        for samples in [1, 2, 3, 4, 7, 64] {
            #[expect(clippy::cast_possible_truncation, reason = "a few digits")]
            let error = few.certain_error(samples) as f32;
            assert!(few.samples_for(error, samples).is_some(), "{samples}");
        }
    }
}
