//! Sequences with a time limit: a controller that gives all frames the same error, the smallest that the time allows.

use std::collections::BTreeSet;
use std::time::{Duration, Instant};

use super::demand::Demand;
use crate::trace::{Outlook, RoundPolicy};

/// Controls which pixels of a frame get more samples in each round, so that all frames of a sequence finish in time and have equal errors.
///
/// The choice depends on a clock. Replaying the chosen rounds, which the engine reports, gives the same pictures without one.
///
/// Before each round, the controller uses the demands to find the error E that this frame and all remaining frames can reach in the
/// remaining time, and takes the samples needed for E. The measured cost of frames corrects errors of the demands.
#[derive(Debug)]
pub struct Deadline {
    start: Instant,
    /// The time limit, and the time reserved for the work after the last frame; seconds.
    within: f64,
    after: f64,
    /// The indices of the frames that have not begun, and the demands of surveyed frames.
    pending: BTreeSet<usize>,
    demands: Vec<Option<Demand>>,
    /// The sum of the demands of all remaining frames.
    total: Demand,
    /// The ratio of seconds to samples of rounds.
    rate: Recent,
    /// The ratio of samples taken to samples predicted.
    excess: Recent,
    /// Mean seconds of a frame before its first request for a further round, and after its last request.
    setup: Mean,
    finish: Mean,
    /// Mean seconds for writing a frame, and the number of frames not yet written.
    writing: Mean,
    unwritten: usize,
    frame: FrameInProgress,
}

/// The current frame. Times are in seconds.
#[derive(Clone, Copy, Debug, Default)]
struct FrameInProgress {
    index: usize,
    start: f64,
    /// The last request for a round: its time, and the sample count and the error of the picture at that time.
    request: Option<(f64, f64, f64)>,
    /// The samples and seconds of its further rounds.
    samples: f64,
    seconds: f64,
    /// Its share of the time, in seconds.
    share: Option<f64>,
}

/// A ratio of sums in which recent values have more weight.
#[derive(Clone, Copy, Debug, Default)]
struct Recent {
    above: f64,
    below: f64,
}

impl Recent {
    /// Adds to both sums after multiplying them by `decay`.
    fn add(&mut self, above: f64, below: f64, decay: f64) {
        self.above = decay * self.above + above;
        self.below = decay * self.below + below;
    }

    fn ratio(&self) -> Option<f64> {
        (self.below > 0.0).then(|| self.above / self.below)
    }
}

/// A mean in which recent values have more weight.
#[derive(Clone, Copy, Debug, Default)]
struct Mean(Option<f64>);

impl Mean {
    fn add(&mut self, number: f64) {
        /// The weight of the newest value.
        const NEWEST: f64 = 0.25;
        self.0 = Some(self.0.map_or(number, |mean| mean + NEWEST * (number - mean)));
    }

    fn get(self) -> f64 {
        self.0.unwrap_or(0.0)
    }
}

/// Largest fraction of the remaining time that one round may take. A round that takes twice as long as predicted, as when another process
/// takes half of the processor, is still in time.
const ROUND: f64 = 0.45;
/// Largest multiple of its share that a frame may take.
const MOST_SHARES: f64 = 2.5;
/// Smallest duration of a round, as a fraction of the duration of the frame's earlier rounds.
const SMALL: f64 = 0.05;
/// The fraction of its share that the last frame leaves unused.
const REST: f64 = 0.02;
/// Fraction of the time limit that is planned: the end of a round is not exact.
const PLANNED: f64 = 0.97;

impl Deadline {
    /// Returns a controller for a number of frames, with a time limit of `within` after `start`.
    #[must_use]
    pub fn new(start: Instant, within: Duration, frames: usize) -> Self {
        Self {
            start,
            within: within.as_secs_f64(),
            after: 0.0,
            pending: (0..frames).collect(),
            demands: vec![None; frames],
            total: Demand::default(),
            rate: Recent::default(),
            excess: Recent::default(),
            setup: Mean::default(),
            finish: Mean::default(),
            writing: Mean::default(),
            unwritten: 0,
            frame: FrameInProgress::default(),
        }
    }

    /// Returns the remaining time in seconds; 0 after the time limit.
    #[must_use]
    pub fn time_left(&self) -> f64 {
        self.time_left_at(self.now())
    }

    /// Reserves a number of seconds for the work after the last frame.
    pub fn reserve(&mut self, seconds: f64) {
        self.after = seconds;
    }

    /// Records the survey of a frame. `first` is the time until the end of its first round and `writing` the time for writing it; both are
    /// in seconds.
    pub fn note_survey(&mut self, index: usize, survey: &FrameSurvey, times: [f64; 2]) {
        self.note_demand(index, survey.demand, times);
        if let Some(calibration) = survey.calibration {
            self.calibrate(calibration);
        }
    }

    /// Records the demand of a frame, estimated from a few of its samples, and the times of its survey.
    fn note_demand(&mut self, index: usize, demand: Demand, [first, writing]: [f64; 2]) {
        self.demands[index] = Some(demand);
        self.setup.add(first);
        self.writing.add(writing);
    }

    /// Records the cost of further rounds of a surveyed frame.
    fn calibrate(&mut self, Calibration { samples, predicted, seconds }: Calibration) {
        self.rate.add(seconds, samples, 1.0);
        self.excess.add(samples, predicted, 1.0);
    }

    /// Gives each frame without a survey the demand of the nearest surveyed frame.
    pub fn spread_demands(&mut self) {
        let known: Vec<usize> =
            (0..self.demands.len()).filter(|index| self.demands[*index].is_some()).collect();
        let spread = (0..self.demands.len()).map(|index| {
            let next = known.partition_point(|known| *known < index);
            let near = known[next.saturating_sub(1)..known.len().min(next + 1)].iter();
            near.min_by_key(|known| known.abs_diff(index)).and_then(|known| self.demands[*known])
        });
        self.demands = spread.collect();
        self.total = Demand::default();
        self.pending.iter().filter_map(|index| self.demands[*index]).for_each(|demand| self.total += demand);
    }

    /// Removes a frame that already exists from the remaining frames.
    pub fn keep(&mut self, index: usize) {
        if self.pending.remove(&index)
            && let Some(demand) = self.demands[index]
        {
            self.total -= demand;
        }
    }

    /// Begins a frame.
    pub fn begin(&mut self, index: usize) {
        self.begin_at(index, self.now());
    }

    /// Ends the current frame, which is then to be written.
    pub fn end(&mut self) {
        self.end_at(self.now());
    }

    /// Records that a frame has been written, and the time taken.
    pub fn written(&mut self, took: Duration) {
        self.unwritten = self.unwritten.saturating_sub(1);
        self.writing.add(took.as_secs_f64());
    }

    fn now(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    fn time_left_at(&self, now: f64) -> f64 {
        let writing = (self.unwritten + 1) as f64 * self.writing.get();
        (PLANNED * self.within - self.after - writing - now).max(0.0)
    }

    fn begin_at(&mut self, index: usize, now: f64) {
        self.keep(index);
        self.frame = FrameInProgress { index, start: now, ..FrameInProgress::default() };
    }

    fn end_at(&mut self, now: f64) {
        self.unwritten += 1;
        let FrameInProgress { index, samples, request: Some((requested, _, error)), .. } = self.frame else {
            return;
        };
        self.finish.add(now - requested);
        if let Some(demand) = self.demands[index] {
            self.excess.add(samples, demand.samples(Demand::level(error)), 0.7);
        }
    }

    /// Records the cost of the last round.
    fn note_round(&mut self, now: f64, samples: f64) {
        let Some((requested, before, _)) = self.frame.request else { return };
        let seconds = now - requested;
        self.frame.samples += samples - before;
        self.frame.seconds += seconds;
        // A measurement loses weight by a factor of e per tenth of the time limit.
        self.rate.add(seconds, samples - before, libm::exp(-10.0 * seconds / self.within));
    }

    /// Returns the target level of error and the largest sample count of the next round; `None` to end the frame.
    fn next(&mut self, own: &Demand, samples: f64, error: f64, now: f64) -> Option<(f64, f64)> {
        if self.frame.request.is_none() {
            self.setup.add(now - self.frame.start);
        }
        self.note_round(now, samples);
        self.frame.request = Some((now, samples, error));
        let others = self.pending.len() as f64;
        let time =
            self.time_left_at(now) - others * (self.setup.get() + self.finish.get()) - self.finish.get();
        // Before any round has been measured, the rate of the first samples is used.
        let rate = self.rate.ratio().unwrap_or_else(|| self.setup.get() / samples);
        let excess = self.excess.ratio().unwrap_or(1.0).clamp(0.05, 4.0);
        let level = Demand::highest_level(|level| {
            rate * (own.samples(level) + excess * self.total.samples(level)) <= time
        });
        let wanted = rate * own.samples(level);
        if self.pending.is_empty() {
            let share = *self.frame.share.get_or_insert(time);
            return (time > REST * share).then_some((level, ROUND * time / rate));
        }
        // The first samples are poor predictors: the share is at least the prediction, and at least the average over the remaining frames.
        let predicted =
            self.demands[self.frame.index].map_or(0.0, |demand| rate * excess * demand.samples(level));
        let share = *self.frame.share.get_or_insert(predicted.max(time / (others + 1.0)));
        let most = (MOST_SHARES * share - self.frame.seconds).min(ROUND * time);
        (wanted.min(most) > SMALL * self.frame.seconds).then_some((level, most / rate))
    }
}

impl RoundPolicy for Deadline {
    fn least_gain(&mut self, outlook: &Outlook<'_>) -> Option<u32> {
        let own = Demand::of(outlook);
        let (level, most) = self.next(&own, outlook.samples(), outlook.error().value, self.now())?;
        Some(outlook.least_gain_for(Demand::error(level)).max(outlook.least_gain_within(most)))
    }
}

/// Returns the indices of a number of frames, each once, at distances of the golden ratio of their number. Any number of first indices is
/// spread over the whole sequence and over the periods of repeating content.
pub fn survey_order(frames: usize) -> impl Iterator<Item = usize> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let share = |a: usize, b: usize| {
        let (mut a, mut b) = (a, b);
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "less than there are frames")]
    let nearest = (GOLDEN * frames as f64) as usize;
    let step = (nearest..=frames).find(|step| share(*step, frames) == 1).unwrap_or(1);
    (0..frames).scan(0, move |index, _| Some(std::mem::replace(index, (*index + step) % frames)))
}

/// The survey of a frame: takes a few samples and estimates the effect of more.
#[derive(Debug)]
pub struct FrameSurvey {
    /// The end of further rounds, which measure the accuracy of the demand.
    end: Instant,
    rounds: u32,
    first: Option<Instant>,
    demand: Demand,
    /// The time at which the demand was found, and the sample count then.
    found: Option<(Instant, f64)>,
    calibration: Option<Calibration>,
}

/// The cost of further rounds of a frame: samples taken, samples predicted for the same error, and seconds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Calibration {
    samples: f64,
    predicted: f64,
    seconds: f64,
}

impl FrameSurvey {
    /// Returns a survey that ends with the round in progress at `end`, but not before the second round.
    #[must_use]
    pub fn until(end: Instant) -> Self {
        Self { end, rounds: 0, first: None, demand: Demand::default(), found: None, calibration: None }
    }

    /// Returns the time at which the first round, one sample per pixel, was done; `None` if that round was enough.
    #[must_use]
    pub fn first_round(&self) -> Option<Instant> {
        self.first
    }
}

impl RoundPolicy for FrameSurvey {
    fn least_gain(&mut self, outlook: &Outlook<'_>) -> Option<u32> {
        let (now, samples) = (Instant::now(), outlook.samples());
        self.first.get_or_insert(now);
        self.rounds += 1;
        if let Some((start, before)) = self.found {
            let predicted = self.demand.samples(Demand::level(outlook.error().value));
            let seconds = (now - start).as_secs_f64();
            self.calibration = Some(Calibration { samples: samples - before, predicted, seconds });
        } else {
            self.demand = Demand::of(outlook);
            self.found = (self.rounds == 2).then_some((now, samples));
        }
        // A round takes at most as many samples as the picture has: at first, samples of the quarter of the pixels that vary most.
        (self.rounds == 1 || now < self.end).then(|| {
            outlook.least_gain_for(outlook.error().value / 2.0).max(outlook.least_gain_within(samples))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames whose square error is their hardness divided by the sample count, and a simulated machine.
    struct Simulated {
        hardness: Vec<f64>,
        /// The number of surveyed frames for a number of frames.
        surveyed: fn(usize) -> usize,
        /// Seconds per sample at a fraction of the time limit.
        rate: fn(f64) -> f64,
        within: f64,
    }

    const PIXELS: f64 = 1e5;
    const FIRST: f64 = 0.004;
    const SAMPLE: f64 = 4e-8;

    impl Simulated {
        /// Renders all frames. Returns the time taken, and the errors of frames that took more than twice the first samples.
        fn render(&self) -> (f64, Vec<f64>) {
            let count = self.hardness.len();
            let demand = |hardness: f64, samples: f64| {
                Demand::from_fn(|error| (hardness / (error * error) - samples).max(0.0))
            };
            let mut deadline = Deadline::new(Instant::now(), Duration::from_secs_f64(self.within), count);
            let mut now = 0.0;
            for index in survey_order(count).take((self.surveyed)(count)) {
                deadline.note_demand(index, demand(self.hardness[index], 2.0 * PIXELS), [FIRST, 0.001]);
                now += 2.0 * FIRST;
            }
            deadline.spread_demands();
            let mut errors = Vec::new();
            for (index, hardness) in self.hardness.iter().enumerate() {
                deadline.begin_at(index, now);
                now += FIRST;
                let mut samples = PIXELS;
                loop {
                    let error = (hardness / samples).sqrt();
                    let Some((level, most)) = deadline.next(&demand(*hardness, samples), samples, error, now)
                    else {
                        break;
                    };
                    // A round at most doubles the samples.
                    let goal = Demand::error(level);
                    let wanted = (hardness / (goal * goal) - samples).max(0.0);
                    let taken = wanted.min(most).min(samples);
                    samples += taken;
                    now += taken * (self.rate)(now / self.within) + 0.0005;
                }
                if samples > 2.0 * PIXELS {
                    errors.push((hardness / samples).sqrt());
                }
                deadline.end_at(now);
                deadline.written(Duration::from_millis(1));
            }
            (now, errors)
        }
    }

    fn range(errors: &[f64]) -> (f64, f64) {
        errors.iter().fold((f64::INFINITY, 0.0), |(least, most), error| (error.min(least), error.max(most)))
    }

    fn steady(_: f64) -> f64 {
        SAMPLE
    }

    /// Halves the speed in the middle third of the time.
    fn disturbed(part: f64) -> f64 {
        if (0.33..0.67).contains(&part) { 2.0 * SAMPLE } else { SAMPLE }
    }

    #[test]
    fn time_limit_is_used_and_met() {
        let busy = |index: usize| if (32..64).contains(&index) { 4e8 } else { 1e6 };
        let sequences = [
            vec![1e7],
            vec![1e7; 24],
            (0..96).map(busy).collect(),
            (0..48_u8).map(|index| 1e7 * (1.0 + 0.9 * libm::sin(f64::from(index)))).collect(),
        ];
        let all: fn(usize) -> usize = |count| count;
        let few: fn(usize) -> usize = |count| count.div_ceil(4);
        for hardness in sequences {
            // Demands of frames without a survey are less accurate.
            for (surveyed, less) in [(all, 1.0), (few, 1.5)] {
                // The time lost by the disturbance is not known in advance.
                for (rate, within, unequal) in
                    [(steady as fn(f64) -> f64, 3.0, 1.6), (disturbed, 3.0, 2.0), (steady, 30.0, 1.6)]
                {
                    let simulated = Simulated { hardness: hardness.clone(), surveyed, rate, within };
                    let (took, errors) = simulated.render();
                    let case = format!("{} frames: {took} of {within}", hardness.len());
                    assert!(took > 0.9 * within && took < 1.05 * within, "{case}");
                    let (_, largest) = range(&errors);
                    let mut sorted = errors.clone();
                    sorted.sort_by(f64::total_cmp);
                    let median = sorted[errors.len() / 2];
                    assert!(largest < less * unequal * median, "{case}: {errors:.2?}");
                }
            }
        }
    }

    #[test]
    fn survey_order_contains_every_frame_once() {
        for count in 0..200 {
            let mut places: Vec<usize> = survey_order(count).collect();
            places.sort_unstable();
            assert!(places.into_iter().eq(0..count), "{count}");
        }
        // A survey of a fifth of the frames leaves gaps of at most twice the even spacing.
        let mut first: Vec<usize> = survey_order(100).take(20).collect();
        first.sort_unstable();
        assert!(first.windows(2).all(|pair| pair[1] - pair[0] <= 10), "{first:?}");
    }

    #[test]
    fn frames_reach_equal_errors() {
        let hardness: Vec<f64> = (0..24_u32).map(|index| 1e6 * f64::from(1 + index % 7)).collect();
        let simulated = Simulated { hardness, surveyed: |count| count, rate: steady, within: 3.0 };
        let (_, errors) = simulated.render();
        let (least, most) = range(&errors);
        assert!(most < 1.2 * least, "{errors:.2?}");
    }
}
