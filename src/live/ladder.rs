//! The choice of quick pictures that lead up to the requested one.
//!
//! The first comes soon, whatever the scene; each further one takes several times as long as the one before; all of them take a
//! small part of what the picture itself does. What they take is known from those before. Where it is not, or not any more, a
//! deadline ends what takes too long, and something lesser is tried.

use std::time::Duration;

use crate::engine::Draft;

/// The time, in milliseconds, that the first quick picture should take.
pub(super) const FIRST: f64 = 6.0;
/// The most pixels of the first one while no speed is known.
const UNKNOWN: f64 = 4096.0;
/// The time, in milliseconds, above which a picture is shown though a better one could follow at once.
const SOON: f64 = 10.0;
/// The further ones take at least this many milliseconds,
const NEXT: f64 = 40.0;
/// and this many times as long as the one before, with at most half its divisor,
const GROWTH: f64 = 4.0;
/// and at most this share of the time of the requested picture.
const SHARE: f64 = 1.0 / 16.0;
/// A requested picture that takes less, in milliseconds, is not preceded by further ones.
const QUICK: f64 = 300.0;
/// With fewer pixels than this, shadows are worth less than more pixels.
const ENOUGH: f64 = 256.0;

/// The care taken over a quick picture: what is left out of it, besides pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Care {
    /// Leaves out all that can be: only surfaces and direct light remain.
    Bare,
    /// Leaves out samples of lights, and late generations of rays.
    Plain,
    /// Leaves out nothing.
    Whole,
}

/// A quick picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LadderStep {
    care: Care,
    /// The divisor of the film's width and height.
    divisor: u32,
    /// The number of quicker attempts that were given up before.
    tried: u32,
}

/// The requested picture, as far as its cost depends on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    /// The film's width and height.
    pub(super) film: (u32, u32),
    /// The divisor of the film's width and height.
    pub(super) divisor: u32,
    /// The samples per pixel.
    pub(super) samples: u32,
}

/// The timings of pictures so far, in milliseconds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Timings {
    /// The time to bring the world to a moment.
    pub(super) moment: f64,
    /// The time to trace a camera ray with all that it causes, by care.
    ray: [Option<f64>; 3],
}

impl LadderStep {
    /// Returns the settings it is rendered with.
    pub(super) fn draft(self) -> Draft {
        let (light_samples, depth) = match self.care {
            Care::Bare => (1, 1),
            // Enough generations to see through a glass.
            Care::Plain => (1, 5),
            Care::Whole => (u32::MAX, u32::MAX),
        };
        Draft { divisor: self.divisor, light_samples, depth, shadows: self.care != Care::Bare }
    }

    pub(super) fn care(self) -> Care {
        self.care
    }

    /// Returns the time after which it is given up. `None` for the last attempt, which never is.
    pub(super) fn deadline(self) -> Option<Duration> {
        let milliseconds = [40, 25, 15].get(self.tried as usize)?;
        Some(Duration::from_millis(*milliseconds))
    }

    /// Returns a quicker one, to be tried after this one was given up.
    pub(super) fn lesser(self, film: (u32, u32)) -> Self {
        let most = match self.tried {
            0 => ENOUGH,
            1 => ENOUGH / 16.0,
            _ => 1.0,
        };
        let most = most.min(pixels(film, self.divisor) as f64 / GROWTH);
        Self { care: Care::Bare, divisor: divisor_for(film, most), tried: self.tried + 1 }
    }

    /// Returns whether it took so little time that a better one can replace it before anybody sees it.
    pub(super) fn is_surpassed_by(self, better: Self, took: f64) -> bool {
        took < SOON && (better.divisor < self.divisor || self.care != better.care)
    }
}

impl Target {
    /// Returns the number of camera rays.
    pub(super) fn rays(self) -> f64 {
        pixels(self.film, self.divisor) as f64 * f64::from(self.samples)
    }
}

impl Timings {
    /// Returns the first step for a film, within `milliseconds` of tracing and with a divisor of at least `finest`.
    pub(super) fn first(&self, film: (u32, u32), milliseconds: f64, finest: u32) -> LadderStep {
        let step =
            |care, pixels: f64| LadderStep { care, divisor: divisor_for(film, pixels).max(finest), tried: 0 };
        let Some(plain) = self.of(Care::Plain) else { return step(Care::Plain, UNKNOWN) };
        let pixels = milliseconds / plain;
        if pixels >= ENOUGH.min(self::pixels(film, finest) as f64) {
            return step(Care::Plain, pixels);
        }
        let bare = self.of(Care::Bare).map_or(ENOUGH, |bare| milliseconds / bare);
        step(Care::Bare, bare)
    }

    /// Returns the step after another one; `None` if it is time for the requested picture.
    pub(super) fn finer(&self, step: LadderStep, took: f64, target: Target) -> Option<LadderStep> {
        let ray = self.of(step.care)?;
        // At least as much as a step, since nothing is left out of it.
        let whole = self.of(Care::Whole).unwrap_or(0.0).max(ray) * target.rays();
        if whole <= QUICK {
            return None;
        }
        let milliseconds = (GROWTH * took).max(NEXT);
        let fitting = divisor_for(target.film, milliseconds / ray);
        let divisor = fitting.min(step.divisor / 2).max(target.divisor);
        let takes = pixels(target.film, divisor) as f64 * ray;
        let is_worthwhile = divisor < step.divisor && takes <= SHARE * whole;
        is_worthwhile.then_some(LadderStep { divisor, tried: 0, ..step })
    }

    pub(super) fn is_unknown(&self) -> bool {
        self.of(Care::Plain).is_none()
    }

    /// Returns the expected milliseconds of a picture; `None` if nothing is known.
    pub(super) fn expected(&self, target: Target) -> Option<f64> {
        Some(self.moment + self.of(Care::Whole)? * target.rays())
    }

    /// Records that a picture took `milliseconds` for `rays` camera rays.
    pub(super) fn note(&mut self, care: Care, milliseconds: f64, rays: u64) {
        let ray = milliseconds / (rays.max(1) as f64);
        self.ray[care as usize] = Some(ray);
        // Less care takes no more time.
        for lesser in &mut self.ray[..care as usize] {
            *lesser = lesser.map(|lesser| lesser.min(ray));
        }
        if care == Care::Whole {
            self.ray[Care::Plain as usize].get_or_insert(ray);
        }
    }

    /// Records that a step was given up after `milliseconds`.
    pub(super) fn note_failure(&mut self, step: LadderStep, milliseconds: f64, film: (u32, u32)) {
        let at_least = milliseconds / pixels(film, step.divisor) as f64;
        for ray in &mut self.ray[step.care as usize..] {
            *ray = Some(ray.map_or(at_least, |ray| ray.max(at_least)));
        }
        // The next one is to be much smaller.
        self.ray[step.care as usize] = self.of(step.care).map(|ray| ray.max(GROWTH * at_least));
    }

    fn of(&self, care: Care) -> Option<f64> {
        self.ray[care as usize].map(|ray| ray.max(f64::MIN_POSITIVE))
    }
}

/// Returns the pixels of a film whose sides are divided: at least one.
fn pixels((width, height): (u32, u32), divisor: u32) -> u64 {
    let side = |side: u32| u64::from((side / divisor).max(1));
    side(width) * side(height)
}

/// Returns the divisor of a film's sides that leaves at most `most` pixels.
fn divisor_for((width, height): (u32, u32), most: f64) -> u32 {
    let (long, short) = (f64::from(width.max(height)), f64::from(width.min(height)));
    let divisor = (long * short / most.max(1.0)).sqrt();
    // A single row stays one.
    let divisor = if divisor > short { long / most.max(1.0) } else { divisor };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 1 to a film's side")]
    let divisor = divisor.ceil().clamp(1.0, long.max(1.0)) as u32;
    divisor
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILM: (u32, u32) = (3840, 2160);

    /// All steps up to a picture, by what a camera ray takes in milliseconds with each care, and what they take.
    fn climb(ray: [f64; 3], film: (u32, u32), samples: u32) -> (Vec<LadderStep>, Vec<f64>) {
        let mut timings = Timings::default();
        let target = Target { film, divisor: 1, samples };
        let cost = |step: LadderStep| ray[step.care as usize] * pixels(film, step.divisor) as f64;
        let (mut steps, mut times) = (Vec::new(), Vec::new());
        let mut next = Some(timings.first(film, FIRST, 2));
        while let Some(step) = next {
            let deadline = step.deadline().map_or(f64::INFINITY, |deadline| 1e3 * deadline.as_secs_f64());
            let in_time = !steps.is_empty() || cost(step) <= deadline;
            if in_time {
                timings.note(step.care, cost(step), pixels(film, step.divisor));
                steps.push(step);
                times.push(cost(step));
                next = timings.finer(step, cost(step), target);
            } else {
                timings.note_failure(step, deadline, film);
                next = Some(step.lesser(film));
                assert!(times.len() < 4);
            }
        }
        (steps, times)
    }

    #[test]
    fn steps_get_finer_and_take_a_small_part_of_the_whole() {
        for whole in [1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0] {
            for (plainer, barer) in [(1.0, 1.0), (0.1, 0.5), (0.001, 0.01)] {
                for samples in [1, 4, 64, 4096] {
                    let ray = [plainer * barer * whole, plainer * whole, whole];
                    for film in [FILM, (640, 360), (16, 9), (1, 1), (1, 2000)] {
                        let (steps, times) = climb(ray, film, samples);
                        let finer = steps.windows(2).all(|pair| pair[1].divisor < pair[0].divisor);
                        assert!(!steps.is_empty() && finer, "{ray:?} {film:?} {samples}: {steps:?}");
                        let target = Target { film, divisor: 1, samples };
                        let (all, picture) = (times[1..].iter().sum::<f64>(), whole * target.rays());
                        assert!(all <= 1.5 * SHARE * picture, "{ray:?} {film:?} {samples}: {times:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_known_makes_the_first_step_fit_and_a_failure_makes_it_smaller() {
        let mut timings = Timings::default();
        timings.note(Care::Whole, 200.0, 921_600);
        let first = timings.first((1280, 720), FIRST, 2);
        assert_eq!((first.care, first.divisor), (Care::Plain, 6));
        timings.note_failure(first, 40.0, (1280, 720));
        let again = timings.first((1280, 720), FIRST, 2);
        assert!(again.divisor > 3 * first.divisor, "{again:?}");
        // Where even few pixels take long, there is less in them.
        timings.note(Care::Plain, 100.0, 100);
        assert_eq!(timings.first((1280, 720), FIRST, 2).care, Care::Bare);
    }

    #[test]
    fn a_picture_that_takes_minutes_is_led_up_to_by_many() {
        for ray in [1e-4, 3e-4, 1e-3, 3e-3, 1e-2] {
            let (steps, times) = climb([ray; 3], FILM, 64);
            assert!(steps.len() > 3, "{ray}: {steps:?} {times:?}");
            let leaps = times.windows(2).map(|pair| pair[1] / pair[0].max(NEXT / GROWTH));
            assert!(leaps.fold(0.0, f64::max) < 3.0 * GROWTH, "{ray}: {times:?}");
        }
    }

    #[test]
    fn whatever_is_tried_in_vain_the_last_has_one_pixel_and_no_deadline() {
        for film in [FILM, (1, 1), (32_768, 1)] {
            let mut step = Timings::default().first(film, FIRST, 2);
            let mut patience = Duration::ZERO;
            while let Some(deadline) = step.deadline() {
                patience += deadline;
                let lesser = step.lesser(film);
                assert!(lesser.divisor > step.divisor || pixels(film, step.divisor) == 1, "{step:?}");
                step = lesser;
            }
            assert!(patience < Duration::from_millis(100) && pixels(film, step.divisor) == 1, "{step:?}");
        }
    }
}
