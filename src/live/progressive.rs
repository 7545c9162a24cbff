//! Schedule of a picture that takes long: coarse pictures of increasing quality first, and then the unfinished picture itself.
//!
//! The first coarse picture appears quickly for any scene. Each further one takes several times as long as its predecessor, and all of
//! them take a small fraction of the time of the requested picture. Their times are predicted from earlier pictures. If there are no
//! timings, or they no longer apply, a deadline stops a picture that takes too long, and a cheaper one is tried.
//!
//! The requested picture is visited while it is rendered. A visit records its speed and, now and then, shows it as it is.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::components::{FilmSettings, Quality};
use crate::systems::{Effect, RenderSettings};
use crate::trace::RenderJob;

/// Target time of the first coarse picture, in milliseconds: short compared with the 57 between a save and its picture on the page.
pub(super) const FIRST_MS: f64 = 6.0;
/// Least divisor of the first coarse picture of a frame. A picture of all pixels would not be coarse.
pub(super) const FIRST_DIVISOR: u32 = 2;
/// Maximum number of pixels of the first coarse picture while the speed is unknown. It takes [`FIRST_MS`] in a scene of 1.5 µs a pixel; simple
/// ones take 0.2 µs, and the deadline stops slow ones.
const MAX_PIXELS_UNTIMED: f64 = 4096.0;
/// Deadlines of the attempts at a coarse picture, in milliseconds. Together they stay below 100, which a user perceives as immediate. The
/// attempt after them has one pixel and no deadline.
const DEADLINES: [u64; 3] = [40, 25, 15];
/// Time, in milliseconds, above which a picture is shown even though a better one could follow at once: less than a display's frame at
/// 60 Hz, in which the picture might not be seen at all.
const UNSEEN_BELOW_MS: f64 = 10.0;
/// Minimum time budget of each further coarse picture, in milliseconds. Encoding and decoding it takes some 30 in addition.
const MIN_BUDGET_MS: f64 = 40.0;
/// Ratio of the time budget of a coarse picture to the time of its predecessor: the cost of half the divisor, which is the least visible
/// improvement.
const GROWTH: f64 = 4.0;
/// Maximum time of a further coarse picture as a fraction of the time of the requested picture. With [`GROWTH`], all of them take a twelfth
/// of it at most.
const MAX_SHARE: f64 = 1.0 / 16.0;
/// Expected time of the requested picture, in milliseconds, up to which no further coarse pictures precede it. A longer one is first shown
/// unfinished after that time.
const PREVIEWS_ABOVE_MS: f64 = 300.0;
/// Number of pixels below which more pixels are worth more than shadows: 21 by 12.
const FEW_PIXELS: f64 = 256.0;
/// Time between visits to a picture that is being rendered. The first one is later, at [`PREVIEWS_ABOVE_MS`], by which most pictures are finished.
const VISIT_INTERVAL: Duration = Duration::from_millis(200);
/// Inverse of the maximum fraction of the time that is spent on showing an unfinished picture.
const SHOWING_DIVISOR: u64 = 10;
/// Inverse of the fraction of the elapsed time that must pass before the picture is shown again. The first showings therefore come
/// quickly, and a picture that takes long does not keep a browser busy.
const REPEAT_DIVISOR: u64 = 3;
/// Upper limit, in milliseconds, of the time that must pass before the picture is shown again, so that it is seen to progress.
const MAX_REPEAT_MS: u64 = 5000;

/// The effort spent on a coarse picture, apart from its number of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effort {
    /// Surfaces and direct light only, without shadows.
    Direct,
    /// One sample per area light, and a limited ray depth.
    Reduced,
    /// No reductions.
    Full,
}

/// The settings of a coarse picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PreviewLevel {
    effort: Effort,
    /// Divisor of the film's width and height.
    divisor: u32,
    /// Number of attempts that were abandoned before this one.
    tried: u32,
}

/// The properties of the requested picture that determine its cost.
#[derive(Clone, Copy, Debug)]
pub(super) struct RequestedPicture {
    /// Width and height of the film.
    pub(super) film: (u32, u32),
    /// Divisor of the film's width and height.
    pub(super) divisor: u32,
    /// Samples per pixel.
    pub(super) samples: u32,
    /// Fraction of the pixels that are traced. The others are reused.
    pub(super) share: f64,
}

/// The timings of earlier pictures, in milliseconds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Timings {
    /// Time to animate and prepare the world at a moment.
    moment: f64,
    /// Time to trace a camera ray and all rays spawned by it, by effort.
    ray: [Option<f64>; 3],
}

impl PreviewLevel {
    /// Returns the render settings of the level, for a scene with this film and this quality.
    pub(super) fn settings(self, film: FilmSettings, quality: Quality) -> RenderSettings {
        let full = RenderSettings::draft(film, self.divisor);
        let reduced = RenderSettings { max_light_samples: Some(1), ..full };
        match self.effort {
            Effort::Direct => RenderSettings { depth: Some(1), without: [Effect::Shadows].into(), ..reduced },
            // Deep enough to see through a glass.
            Effort::Reduced => RenderSettings { depth: Some(quality.depth.min(5)), ..reduced },
            Effort::Full => full,
        }
    }

    pub(super) fn effort(self) -> Effort {
        self.effort
    }

    /// Returns the level with a divisor of at most `divisor`.
    pub(super) fn at_least(self, divisor: u32) -> Self {
        Self { divisor: self.divisor.min(divisor), ..self }
    }

    /// Returns the time after which the level is abandoned, or `None` for the last attempt, which has no deadline.
    pub(super) fn deadline(self) -> Option<Duration> {
        DEADLINES.get(self.tried as usize).map(|milliseconds| Duration::from_millis(*milliseconds))
    }

    /// Returns a cheaper level to be tried after this one was abandoned.
    pub(super) fn cheaper(self, film: (u32, u32)) -> Self {
        let most = match self.tried {
            0 => FEW_PIXELS,
            1 => FEW_PIXELS / 16.0,
            _ => 1.0,
        };
        let most = most.min(pixels(film, self.divisor) as f64 / GROWTH);
        Self { effort: Effort::Direct, divisor: divisor_for(film, most), tried: self.tried + 1 }
    }

    /// Returns whether the level took so little time that a better one can replace it before it is seen.
    pub(super) fn is_replaced_by(self, better: Self, took: f64) -> bool {
        took < UNSEEN_BELOW_MS && (better.divisor < self.divisor || self.effort != better.effort)
    }
}

impl RequestedPicture {
    /// Returns the number of camera rays.
    pub(super) fn rays(self) -> f64 {
        pixels(self.film, self.divisor) as f64 * f64::from(self.samples) * self.share
    }

    /// Returns the picture with the share that a job traces.
    pub(super) fn traced_by(self, job: &RenderJob) -> Self {
        Self { share: 1.0 - job.reused_share(), ..self }
    }

    /// Returns the number of camera rays of the finished part of the picture, but at least the rays of one sample of a tile, which are
    /// lost when the picture is stopped.
    pub(super) fn rays_so_far(self, job: &RenderJob) -> u64 {
        const TILE: u64 = 256;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
        let rays = (job.progress().samples * pixels(self.film, self.divisor) as f64) as u64;
        rays.max(TILE)
    }
}

impl Timings {
    /// Returns the first level for a film, with at most `milliseconds` of tracing and a divisor of at least `finest`.
    pub(super) fn first(&self, film: (u32, u32), milliseconds: f64, finest: u32) -> PreviewLevel {
        let level = |effort, pixels: f64| PreviewLevel {
            effort,
            divisor: divisor_for(film, pixels).max(finest),
            tried: 0,
        };
        let Some(reduced) = self.of(Effort::Reduced) else {
            return level(Effort::Reduced, MAX_PIXELS_UNTIMED);
        };
        let pixels = milliseconds / reduced;
        if pixels >= FEW_PIXELS.min(self::pixels(film, finest) as f64) {
            return level(Effort::Reduced, pixels);
        }
        let direct = self.of(Effort::Direct).map_or(FEW_PIXELS, |direct| milliseconds / direct);
        level(Effort::Direct, direct)
    }

    /// Returns the level after another one, or `None` if the requested picture should follow.
    pub(super) fn finer(
        &self,
        level: PreviewLevel,
        took: f64,
        target: RequestedPicture,
    ) -> Option<PreviewLevel> {
        let ray = self.of(level.effort)?;
        // A camera ray without reductions costs at least as much as a ray of the level.
        let all = self.of(Effort::Full).unwrap_or(0.0).max(ray) * target.rays();
        if all <= PREVIEWS_ABOVE_MS {
            return None;
        }
        let milliseconds = (GROWTH * took).max(MIN_BUDGET_MS);
        let fitting = divisor_for(target.film, milliseconds / ray);
        let divisor = fitting.min(level.divisor / 2).max(target.divisor);
        let takes = pixels(target.film, divisor) as f64 * ray;
        let is_worthwhile = divisor < level.divisor && takes <= MAX_SHARE * all;
        is_worthwhile.then_some(PreviewLevel { divisor, tried: 0, ..level })
    }

    pub(super) fn is_unknown(&self) -> bool {
        self.of(Effort::Reduced).is_none()
    }

    /// Returns the expected time of a picture in milliseconds, or `None` without timings.
    pub(super) fn expected(&self, target: RequestedPicture) -> Option<f64> {
        Some(self.moment + self.of(Effort::Full)? * target.rays())
    }

    /// Records the time to animate and prepare the world, in milliseconds.
    pub(super) fn note_moment(&mut self, milliseconds: f64) {
        self.moment = milliseconds;
    }

    /// Records that a picture took `milliseconds` for `rays` camera rays.
    pub(super) fn note(&mut self, effort: Effort, milliseconds: f64, rays: u64) {
        let ray = milliseconds / (rays.max(1) as f64);
        self.ray[effort as usize] = Some(ray);
        // Less effort takes no more time per ray.
        for cheaper in &mut self.ray[..effort as usize] {
            *cheaper = cheaper.map(|cheaper| cheaper.min(ray));
        }
        if effort == Effort::Full {
            self.ray[Effort::Reduced as usize].get_or_insert(ray);
        }
    }

    /// Records that a level was abandoned after `milliseconds`.
    pub(super) fn note_failure(&mut self, level: PreviewLevel, milliseconds: f64, film: (u32, u32)) {
        let at_least = milliseconds / pixels(film, level.divisor) as f64;
        for ray in &mut self.ray[level.effort as usize..] {
            *ray = Some(ray.map_or(at_least, |ray| ray.max(at_least)));
        }
        // Makes the next level much smaller.
        self.ray[level.effort as usize] = self.of(level.effort).map(|ray| ray.max(GROWTH * at_least));
    }

    fn of(&self, effort: Effort) -> Option<f64> {
        self.ray[effort as usize].map(|ray| ray.max(f64::MIN_POSITIVE))
    }
}

/// The times of visits and showings of a picture that is being rendered, in milliseconds since the start. Commands that interrupt the
/// picture do not postpone them.
pub(super) struct RefreshTimer {
    start: Instant,
    /// Time of the next visit, read by the render threads.
    due: AtomicU64,
    last_shown: AtomicU64,
    showing: AtomicU64,
}

impl RefreshTimer {
    pub(super) fn new() -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a constant")]
        let due = AtomicU64::new(PREVIEWS_ABOVE_MS as u64);
        Self { start: Instant::now(), due, last_shown: AtomicU64::new(0), showing: AtomicU64::new(0) }
    }

    pub(super) fn is_due(&self) -> bool {
        self.now() >= self.due.load(Ordering::Relaxed)
    }

    /// Schedules the next visit.
    pub(super) fn reschedule(&self) {
        self.due.store(self.now() + whole_milliseconds(VISIT_INTERVAL), Ordering::Relaxed);
    }

    /// Shows the unfinished picture by a call of `show` if it is time. Returns the result.
    pub(super) fn show_if_due<T>(&self, show: impl FnOnce() -> T) -> Option<T> {
        let (now, last) = (self.now(), self.last_shown.load(Ordering::Relaxed));
        let is_due = self.showing.load(Ordering::Relaxed) <= now / SHOWING_DIVISOR;
        if !is_due || now - last < (last / REPEAT_DIVISOR).min(MAX_REPEAT_MS) {
            return None;
        }
        let shown = show();
        self.showing.fetch_add(self.now() - now, Ordering::Relaxed);
        self.last_shown.store(self.now(), Ordering::Relaxed);
        Some(shown)
    }

    /// Returns the milliseconds since the start without those spent on showing.
    pub(super) fn traced(&self) -> f64 {
        (self.now() - self.showing.load(Ordering::Relaxed)) as f64
    }

    fn now(&self) -> u64 {
        whole_milliseconds(self.start.elapsed())
    }
}

fn whole_milliseconds(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

/// Runs `work`, which `interrupt` ends. The deadline counts from the first call of the function passed to `work`; when it passes,
/// `interrupt` becomes true without a command, and stays so until commands are taken. Returns the result, and whether the deadline passed.
pub(super) fn with_deadline<T>(
    interrupt: &AtomicBool,
    deadline: Option<Duration>,
    work: impl FnOnce(&(dyn Fn() + Sync)) -> T,
) -> (T, bool) {
    let Some(deadline) = deadline else { return (work(&|| ()), false) };
    let (started, done, late) = (OnceLock::new(), AtomicBool::new(false), AtomicBool::new(false));
    let result = thread::scope(|scope| {
        let clock = scope.spawn(|| {
            while !done.load(Ordering::Acquire) {
                let Some(started) = started.get() else {
                    thread::park();
                    continue;
                };
                let rest = deadline.saturating_sub(Instant::elapsed(started));
                if rest.is_zero() {
                    late.store(true, Ordering::Relaxed);
                    interrupt.store(true, Ordering::Relaxed);
                    return;
                }
                thread::park_timeout(rest);
            }
        });
        let result = work(&|| {
            if started.set(Instant::now()).is_ok() {
                clock.thread().unpark();
            }
        });
        done.store(true, Ordering::Release);
        clock.thread().unpark();
        result
    });
    (result, late.into_inner())
}

/// Returns the finished fraction of an unfinished picture, at most 0.99; 0 if it is unknown.
pub(super) fn share_of_unfinished(job: &RenderJob) -> f64 {
    job.progress().share.unwrap_or(0.0).min(0.99)
}

/// Returns whether the time of a picture predicts that of others, given the fraction of it that is reused. The tiles that an edit reaches
/// take longer than the mean: often they show glass or mirrors.
pub(super) fn is_representative(reused: f64) -> bool {
    reused < 0.5
}

/// Returns the number of pixels of a film whose sides are divided by `divisor`. Each side keeps at least one pixel.
fn pixels((width, height): (u32, u32), divisor: u32) -> u64 {
    let side = |side: u32| u64::from((side / divisor).max(1));
    side(width) * side(height)
}

/// Returns the divisor of a film's sides that leaves at most `most` pixels.
fn divisor_for((width, height): (u32, u32), most: f64) -> u32 {
    let (long, short) = (f64::from(width.max(height)), f64::from(width.min(height)));
    let divisor = (long * short / most.max(1.0)).sqrt();
    // The short side keeps one pixel, so only the long side shrinks.
    let divisor = if divisor > short { long / most.max(1.0) } else { divisor };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 1 to a film's side")]
    let divisor = divisor.ceil().clamp(1.0, long.max(1.0)) as u32;
    divisor
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILM: (u32, u32) = (3840, 2160);

    /// Returns all levels before a picture and their times, given the time of a camera ray for each effort, in milliseconds.
    fn levels_before(ray: [f64; 3], film: (u32, u32), samples: u32) -> (Vec<PreviewLevel>, Vec<f64>) {
        let mut timings = Timings::default();
        let target = RequestedPicture { film, divisor: 1, samples, share: 1.0 };
        let cost = |level: PreviewLevel| ray[level.effort as usize] * pixels(film, level.divisor) as f64;
        let (mut levels, mut times) = (Vec::new(), Vec::new());
        let mut next = Some(timings.first(film, FIRST_MS, 2));
        while let Some(level) = next {
            let deadline = level.deadline().map_or(f64::INFINITY, |deadline| 1e3 * deadline.as_secs_f64());
            let in_time = !levels.is_empty() || cost(level) <= deadline;
            if in_time {
                timings.note(level.effort, cost(level), pixels(film, level.divisor));
                levels.push(level);
                times.push(cost(level));
                next = timings.finer(level, cost(level), target);
            } else {
                timings.note_failure(level, deadline, film);
                next = Some(level.cheaper(film));
                assert!(times.len() < 4);
            }
        }
        (levels, times)
    }

    #[test]
    fn levels_get_finer_within_a_share_of_the_render_time() {
        for full in [1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0] {
            for (reduced, direct) in [(1.0, 1.0), (0.1, 0.5), (0.001, 0.01)] {
                for samples in [1, 4, 64, 4096] {
                    let ray = [reduced * direct * full, reduced * full, full];
                    for film in [FILM, (640, 360), (16, 9), (1, 1), (1, 2000)] {
                        let (levels, times) = levels_before(ray, film, samples);
                        let finer = levels.windows(2).all(|pair| pair[1].divisor < pair[0].divisor);
                        assert!(!levels.is_empty() && finer, "{ray:?} {film:?} {samples}: {levels:?}");
                        let target = RequestedPicture { film, divisor: 1, samples, share: 1.0 };
                        let (all, picture) = (times[1..].iter().sum::<f64>(), full * target.rays());
                        assert!(all <= 1.5 * MAX_SHARE * picture, "{ray:?} {film:?} {samples}: {times:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn first_level_fits_known_timings_and_shrinks_after_a_failure() {
        let mut timings = Timings::default();
        timings.note(Effort::Full, 200.0, 921_600);
        let first = timings.first((1280, 720), FIRST_MS, 2);
        assert_eq!((first.effort, first.divisor), (Effort::Reduced, 6));
        timings.note_failure(first, 40.0, (1280, 720));
        let again = timings.first((1280, 720), FIRST_MS, 2);
        assert!(again.divisor > 3 * first.divisor, "{again:?}");
        // If even a few pixels take long, the effort is reduced.
        timings.note(Effort::Reduced, 100.0, 100);
        assert_eq!(timings.first((1280, 720), FIRST_MS, 2).effort, Effort::Direct);
    }

    #[test]
    fn slow_pictures_have_many_levels() {
        for ray in [1e-4, 3e-4, 1e-3, 3e-3, 1e-2] {
            let (levels, times) = levels_before([ray; 3], FILM, 64);
            assert!(levels.len() > 3, "{ray}: {levels:?} {times:?}");
            let ratios = times.windows(2).map(|pair| pair[1] / pair[0].max(MIN_BUDGET_MS / GROWTH));
            assert!(ratios.fold(0.0, f64::max) < 3.0 * GROWTH, "{ray}: {times:?}");
        }
    }

    #[test]
    fn last_attempt_has_one_pixel_and_no_deadline() {
        for film in [FILM, (1, 1), (32_768, 1)] {
            let mut level = Timings::default().first(film, FIRST_MS, 2);
            let mut total = Duration::ZERO;
            while let Some(deadline) = level.deadline() {
                total += deadline;
                let cheaper = level.cheaper(film);
                assert!(cheaper.divisor > level.divisor || pixels(film, level.divisor) == 1, "{level:?}");
                level = cheaper;
            }
            assert!(total < Duration::from_millis(100) && pixels(film, level.divisor) == 1, "{level:?}");
        }
    }
}
