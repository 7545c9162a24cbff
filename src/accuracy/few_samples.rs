//! How good pictures with few samples are: some are good enough with a single one in every pixel.

use std::f64::consts::SQRT_2;
use std::sync::atomic::AtomicBool;

use super::calibration::{SmallPicture, calibrated};
use super::estimate::pair;
use super::stop::{Stop, render, unless_cancelled};
use super::{FrameSamples, Pilot};
use crate::engine::{Engine, EngineError};
use crate::systems::Knobs;
use crate::time::Time;

/// The errors of pictures with one and with four samples per pixel, as the root of the mean square, in output values. From two on
/// pictures tell themselves how good they are.
#[derive(Clone, Debug, PartialEq)]
pub struct FewSamples {
    one: f64,
    four: f64,
    /// By what factor they may be larger.
    uncertain: f64,
    /// The pictures of which that is known; none where they were too small to tell more.
    pictures: Vec<SmallPicture>,
}

impl FewSamples {
    /// Estimates them at a pilot's moments, the worst of all, from pictures of a part of the film's sides and of half of that: with
    /// both it is seen how errors change with the size, as edges take less of a larger picture. Of a short sequence, it ends as soon as it
    /// is clear that one sample is too few for `wanted`. `None` if it was cancelled.
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
            return Some(FrameSamples::everywhere(1));
        }
        // Where errors fall as fast as those of edges do.
        let best = if most < 4 { self.one } else { self.four } * libm::pow(self.more(most), 0.75);
        (best <= wanted).then(|| FrameSamples::for_error(error, most))
    }

    /// Returns samples with which pictures are only as much better than asked for as frames may differ: how good those with the chosen ones
    /// are is seen from some more of the pilot's pictures. As they are, where all pixels have as many, and for sequences that are too
    /// short for that. `None` if it was cancelled.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn calibrate(
        &self,
        engine: &mut Engine,
        chosen: FrameSamples,
        cancelled: &AtomicBool,
    ) -> Result<Option<FrameSamples>, EngineError> {
        if chosen.max_error == 0.0 || self.pictures.is_empty() {
            return Ok(Some(chosen));
        }
        let knobs = engine.knobs();
        let calibrated = calibrated(engine, &self.pictures, (chosen, self.uncertain), cancelled);
        engine.set_knobs(knobs);
        unless_cancelled(calibrated)
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
    /// What pictures of smaller parts of the film's sides cost and tell is out of proportion.
    const COARSEST: u32 = 4;
    let mut worst = FewSamples { one: 0.0, four: 0.0, uncertain, pictures: Vec::new() };
    let doublings = f64::from(divisor.ilog2());
    for moment in moments {
        let smaller = errors(engine, (*moment, 2 * divisor), cancelled)?;
        // At best errors fall with the root of the size.
        let falls = libm::exp2((doublings + 1.0) / 2.0);
        let [one, four] = smaller.map(|error| error / falls);
        if divisor > COARSEST && uncertain * one > wanted {
            let (one, four) = (worst.one.max(one), worst.four.max(four));
            return Ok(FewSamples { one, four, uncertain: uncertain * falls, ..worst });
        }
        let small = errors(engine, (*moment, divisor), cancelled)?;
        let larger: [f64; 2] = std::array::from_fn(|index| {
            let (small, smaller) = (small[index], smaller[index]);
            let falls = if small > 0.0 { (smaller / small).clamp(1.0, SQRT_2) } else { 1.0 };
            libm::pow(falls, doublings)
        });
        let [one, four]: [f64; 2] = std::array::from_fn(|index| small[index] / larger[index]);
        (worst.one, worst.four) = (worst.one.max(one), worst.four.max(four));
        if divisor <= COARSEST {
            // Errors that seem to fall more slowly are not taken for too small.
            let (moment, size, larger) = (*moment, part(engine, divisor), f64::min(larger[0], larger[1]));
            worst.pictures.push(SmallPicture { moment, size, larger });
        }
    }
    Ok(worst)
}

/// Returns the errors of a picture of a part of the film's width and height, with one and with four samples. Knobs stay turned.
fn errors(
    engine: &mut Engine,
    (moment, divisor): (Time, u32),
    cancelled: &AtomicBool,
) -> Result<[f64; 2], Stop> {
    let size = Some(part(engine, divisor));
    let knobs = |samples| Knobs { size, samples: Some(samples), max_error: Some(0.0), ..Knobs::default() };
    let four = pair(engine, moment, knobs(4), cancelled)?;
    engine.set_knobs(knobs(1));
    let single = render(engine, moment, cancelled)?;
    Ok([four.error_of(&single, engine), four.estimate.rms])
}

/// Returns the columns and rows of a part of the film's width and height.
fn part(engine: &Engine, divisor: u32) -> (u32, u32) {
    let film = engine.film_settings();
    ((film.width / divisor).max(1), (film.height / divisor).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::FilmError;
    use crate::components::{FilmSettings, Sampling};

    #[test]
    fn one_sample_is_chosen_where_it_is_enough() {
        let few = FewSamples { one: 4.0, four: 1.0, uncertain: 1.25, pictures: Vec::new() };
        let one = Some(FrameSamples::everywhere(1));
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

    /// Frames of a shipped scene that are smaller, and their pilot.
    fn shipped(scene: &str) -> (Engine, Pilot) {
        let path = format!("{}/scenes/{scene}.ron", env!("CARGO_MANIFEST_DIR"));
        let mut engine = Engine::load(path).unwrap();
        for film in engine.world_mut().query_mut::<&mut FilmSettings>() {
            (film.width, film.height) = (240, 135);
        }
        let timeline = engine.timeline();
        let frames = timeline.frame_count() as usize;
        (engine, Pilot::new(frames, |frame| timeline.time_of(u32::try_from(frame).unwrap())))
    }

    /// Pictures are better than asked for by much less than they would be, and take fewer samples.
    #[test]
    fn what_is_overestimated_is_not_paid_for() {
        let never = AtomicBool::new(false);
        for (scene, asked) in [("first_light", 0.5), ("robot_arm", 1.0)] {
            let (mut engine, pilot) = shipped(scene);
            let few = FewSamples::estimate(&mut engine, &pilot, asked.into(), &never).unwrap().unwrap();
            let chosen = FrameSamples::for_error(asked, Sampling::LARGEST_COUNT);
            assert_eq!(few.samples_for(asked, Sampling::LARGEST_COUNT), Some(chosen));
            let calibrated = few.calibrate(&mut engine, chosen, &never).unwrap().unwrap();
            assert!((1.05..=1.125).contains(&calibrated.overestimate), "{scene}: {calibrated:?}");
            let moment = engine.timeline().time_of(20);
            let mut render = |samples: u32, max_error: Option<f32>, seed: u64| {
                let knobs = Knobs { samples: Some(samples), max_error, seed: Some(seed), ..Knobs::default() };
                engine.set_knobs(knobs);
                (
                    engine.render_at(moment).unwrap(),
                    engine.report().rays.camera,
                    engine.film_settings().transfer,
                )
            };
            let (reference, ..) = render(1024, Some(0.0), 1);
            let [(usual, usual_rays), (found, rays)] = [chosen, calibrated].map(|samples| {
                let knobs = samples.knobs();
                let (film, rays, transfer) = render(samples.samples, knobs.max_error, 2);
                (FilmError::between(&film, &reference, transfer).rms, rays)
            });
            assert!(rays < usual_rays && found > usual, "{scene}: {rays} {usual_rays}, {found} {usual}");
            assert!(found <= asked.into(), "{scene}: {found}");
            assert_eq!(few.calibrate(&mut engine, chosen, &AtomicBool::new(true)).unwrap(), None);
        }
    }

    #[test]
    fn nothing_is_turned_up_where_little_is_known() {
        let never = AtomicBool::new(false);
        let (mut engine, _) = shipped("box_field");
        let timeline = engine.timeline();
        let short = Pilot::new(3, |frame| timeline.time_of(u32::try_from(frame).unwrap()));
        let few = FewSamples::estimate(&mut engine, &short, 2.0, &never).unwrap().unwrap();
        let chosen = FrameSamples::for_error(2.0, 64);
        assert_eq!(few.calibrate(&mut engine, chosen, &never).unwrap(), Some(chosen));
        // No more samples than there may be, whatever is asked.
        let (mut engine, pilot) = shipped("box_field");
        let few = FewSamples::estimate(&mut engine, &pilot, 2.0, &never).unwrap().unwrap();
        let capped = FrameSamples::for_error(0.01, 4);
        assert_eq!(few.calibrate(&mut engine, capped, &never).unwrap(), Some(capped));
    }

    #[test]
    fn errors_fall_by_the_number_of_samples() {
        let few = FewSamples { one: 4.0, four: 1.0, uncertain: 1.25, pictures: Vec::new() };
        assert_eq!([1, 4, 64].map(|samples| few.certain_error(samples)), [5.0, 1.25, 0.3125]);
        for samples in [1, 2, 3, 4, 7, 64] {
            #[expect(clippy::cast_possible_truncation, reason = "a few digits")]
            let error = few.certain_error(samples) as f32;
            assert!(few.samples_for(error, samples).is_some(), "{samples}");
        }
    }
}
