//! Sequences within a time: a controller that gives all frames the same error, the smallest that there is time for.

use std::collections::BTreeSet;
use std::time::{Duration, Instant};

use super::Demand;
use crate::trace::{Outlook, RoundPolicy};

/// Decides, round after round, which pixels of a frame get more samples, so that all frames of a sequence are done in time and are as good as each
/// other. It follows a clock; the rounds that it has chosen, which the engine tells, give the same pictures again without one.
///
/// Before each round it looks for the error E that this frame and all that are left can reach in the time that is left, from their
/// demands, and takes the samples that E asks for. What the demands are wrong about is corrected by what frames turn out to take.
#[derive(Debug)]
pub struct Deadline {
    start: Instant,
    /// The time that there is, in seconds, and the part that what comes after the frames takes.
    within: f64,
    after: f64,
    /// The frames that are not begun, by their places in the sequence; and the demands of those that were surveyed.
    left: BTreeSet<usize>,
    demands: Vec<Option<Demand>>,
    /// The sum of the demands of all that are left.
    total: Demand,
    /// Seconds and samples of rounds.
    rate: Recent,
    /// Samples taken and samples foreseen.
    harder: Recent,
    /// Seconds that frames take before they are asked for a second round, and after their last one.
    before: Mean,
    behind: Mean,
    /// Seconds that it takes to write a frame, and the frames that are not written yet.
    writing: Mean,
    unwritten: usize,
    frame: Frame,
}

/// The frame in hand. Times are in seconds.
#[derive(Clone, Copy, Debug, Default)]
struct Frame {
    place: usize,
    begun: f64,
    /// The last request for a round: its time, and the samples and the error of the picture then.
    asked: Option<(f64, f64, f64)>,
    /// The samples and seconds of its rounds.
    samples: f64,
    seconds: f64,
    /// The seconds that are its share.
    share: Option<f64>,
}

/// A ratio of sums in which what is recent counts more.
#[derive(Clone, Copy, Debug, Default)]
struct Recent {
    above: f64,
    below: f64,
}

impl Recent {
    /// Adds to both sums, of which a part is kept.
    fn add(&mut self, above: f64, below: f64, kept: f64) {
        self.above = kept * self.above + above;
        self.below = kept * self.below + below;
    }

    fn ratio(&self) -> Option<f64> {
        (self.below > 0.0).then(|| self.above / self.below)
    }
}

/// A mean in which the last numbers count most.
#[derive(Clone, Copy, Debug, Default)]
struct Mean(Option<f64>);

impl Mean {
    fn add(&mut self, number: f64) {
        /// The weight of the newest.
        const NEWEST: f64 = 0.25;
        self.0 = Some(self.0.map_or(number, |mean| mean + NEWEST * (number - mean)));
    }

    fn get(self) -> f64 {
        self.0.unwrap_or(0.0)
    }
}

/// The most of the time left that one round may take: if it takes twice as long as foreseen, as when another process takes half of the
/// processor, it is still in time.
const ROUND: f64 = 0.45;
/// A frame gets at most so many times its share.
const MOST_SHARES: f64 = 2.5;
/// A round takes at least this part of the rounds before.
const SMALL: f64 = 0.05;
/// The last frame leaves this part of its share.
const REST: f64 = 0.02;
/// The part of the time that is planned for: the end of a round is not exact.
const PLANNED: f64 = 0.97;

impl Deadline {
    /// Returns the deadline of so many frames, so long after a start.
    #[must_use]
    pub fn new(start: Instant, within: Duration, frames: usize) -> Self {
        Self {
            start,
            within: within.as_secs_f64(),
            after: 0.0,
            left: (0..frames).collect(),
            demands: vec![None; frames],
            total: Demand::default(),
            rate: Recent::default(),
            harder: Recent::default(),
            before: Mean::default(),
            behind: Mean::default(),
            writing: Mean::default(),
            unwritten: 0,
            frame: Frame::default(),
        }
    }

    /// Returns the time that is left, in seconds; 0 if none is.
    #[must_use]
    pub fn left(&self) -> f64 {
        self.left_at(self.now())
    }

    /// Notes that what comes after all frames takes so many seconds.
    pub fn reserve(&mut self, seconds: f64) {
        self.after = seconds;
    }

    /// Notes the demand of a frame, as far as a few of its samples tell; it took so many seconds until the first round was done, and to write.
    pub fn note_demand(&mut self, place: usize, demand: Demand, [first, writing]: [f64; 2]) {
        self.demands[place] = Some(demand);
        self.before.add(first);
        self.writing.add(writing);
    }

    /// Notes what further rounds of a surveyed frame took.
    pub fn calibrate(&mut self, Calibration { samples, foreseen, seconds }: Calibration) {
        self.rate.add(seconds, samples, 1.0);
        self.harder.add(samples, foreseen, 1.0);
    }

    /// Gives frames that were not surveyed the demand of the nearest that was.
    pub fn spread_demands(&mut self) {
        let known: Vec<usize> =
            (0..self.demands.len()).filter(|place| self.demands[*place].is_some()).collect();
        let spread = (0..self.demands.len()).map(|place| {
            let next = known.partition_point(|known| *known < place);
            let near = known[next.saturating_sub(1)..known.len().min(next + 1)].iter();
            near.min_by_key(|known| known.abs_diff(place)).and_then(|known| self.demands[*known])
        });
        self.demands = spread.collect();
        self.total = Demand::default();
        self.left.iter().filter_map(|place| self.demands[*place]).for_each(|demand| self.total += demand);
    }

    /// Notes that a frame is there already.
    pub fn keep(&mut self, place: usize) {
        if self.left.remove(&place)
            && let Some(demand) = self.demands[place]
        {
            self.total -= demand;
        }
    }

    /// Begins a frame.
    pub fn begin(&mut self, place: usize) {
        self.begin_at(place, self.now());
    }

    /// Ends it: it is to be written.
    pub fn end(&mut self) {
        self.end_at(self.now());
    }

    /// Notes that a frame is written, which took so long.
    pub fn written(&mut self, took: Duration) {
        self.unwritten = self.unwritten.saturating_sub(1);
        self.writing.add(took.as_secs_f64());
    }

    fn now(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    fn left_at(&self, now: f64) -> f64 {
        let writing = (self.unwritten + 1) as f64 * self.writing.get();
        (PLANNED * self.within - self.after - writing - now).max(0.0)
    }

    fn begin_at(&mut self, place: usize, now: f64) {
        self.keep(place);
        self.frame = Frame { place, begun: now, ..Frame::default() };
    }

    fn end_at(&mut self, now: f64) {
        self.unwritten += 1;
        let Frame { place, samples, asked: Some((asked, _, error)), .. } = self.frame else { return };
        self.behind.add(now - asked);
        if let Some(demand) = self.demands[place] {
            self.harder.add(samples, demand.samples(Demand::level(error)), 0.7);
        }
    }

    /// Notes what the last round took.
    fn note_round(&mut self, now: f64, samples: f64) {
        let Some((asked, before, _)) = self.frame.asked else { return };
        let seconds = now - asked;
        self.frame.samples += samples - before;
        self.frame.seconds += seconds;
        // What a tenth of the time ago was measured counts e times less.
        self.rate.add(seconds, samples - before, libm::exp(-10.0 * seconds / self.within));
    }

    /// Returns the level of error that is to be reached, and the most samples of the next round; `None` to end the frame.
    fn next(&mut self, own: &Demand, (samples, error): (f64, f64), now: f64) -> Option<(f64, f64)> {
        if self.frame.asked.is_none() {
            self.before.add(now - self.frame.begun);
        }
        self.note_round(now, samples);
        self.frame.asked = Some((now, samples, error));
        let others = self.left.len() as f64;
        let time = self.left_at(now) - others * (self.before.get() + self.behind.get()) - self.behind.get();
        // Before the first round that is measured: all that there is, at the speed of the first samples.
        let rate = self.rate.ratio().unwrap_or_else(|| self.before.get() / samples);
        let harder = self.harder.ratio().unwrap_or(1.0).clamp(0.05, 4.0);
        let level = Demand::highest_level(|level| {
            rate * (own.samples(level) + harder * self.total.samples(level)) <= time
        });
        let wanted = rate * own.samples(level);
        if self.left.is_empty() {
            let share = *self.frame.share.get_or_insert(time);
            return (time > REST * share).then_some((level, ROUND * time / rate));
        }
        // First samples tell little: what was foreseen is the frame's share, or what all frames get on average.
        let foreseen =
            self.demands[self.frame.place].map_or(0.0, |demand| rate * harder * demand.samples(level));
        let share = *self.frame.share.get_or_insert(foreseen.max(time / (others + 1.0)));
        let most = (MOST_SHARES * share - self.frame.seconds).min(ROUND * time);
        (wanted.min(most) > SMALL * self.frame.seconds).then_some((level, most / rate))
    }
}

impl RoundPolicy for Deadline {
    fn least_gain(&mut self, outlook: &Outlook<'_>) -> Option<u32> {
        let own = Demand::of(outlook);
        let (level, most) = self.next(&own, (outlook.samples(), outlook.error().value), self.now())?;
        Some(outlook.least_gain_for(Demand::error(level)).max(outlook.least_gain_within(most)))
    }
}

/// Returns the places of so many frames, each once, in an order in which the first ones, however many, are spread over all, and over the periods
/// of what repeats: steps by the golden ratio.
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
    (0..frames).scan(0, move |place, _| Some(std::mem::replace(place, (*place + step) % frames)))
}

/// Looks at a frame: takes a few samples of it, and tells what more of them would do.
#[derive(Debug)]
pub struct FrameSurvey {
    /// The end of further rounds, whose samples tell how right the demand is.
    end: Instant,
    rounds: u32,
    first: Option<Instant>,
    demand: Demand,
    /// The moment at which the demand was found, and the samples then.
    found: Option<(Instant, f64)>,
    calibration: Option<Calibration>,
}

/// The samples that a frame took for an error, those that were foreseen for it, and the seconds.
#[derive(Clone, Copy, Debug)]
pub struct Calibration {
    samples: f64,
    foreseen: f64,
    seconds: f64,
}

impl FrameSurvey {
    /// Returns a survey that ends with the round that a moment is in, but not before the second one.
    #[must_use]
    pub fn until(end: Instant) -> Self {
        Self { end, rounds: 0, first: None, demand: Demand::default(), found: None, calibration: None }
    }

    /// Returns when the first round was done, after a sample of each pixel; `None` where that was enough.
    #[must_use]
    pub fn first_round(&self) -> Option<Instant> {
        self.first
    }

    /// Returns the demand of the frame.
    #[must_use]
    pub fn demand(&self) -> Demand {
        self.demand
    }

    /// Returns what the rounds after the second one took, if there were any.
    #[must_use]
    pub fn calibration(&self) -> Option<Calibration> {
        self.calibration
    }
}

impl RoundPolicy for FrameSurvey {
    fn least_gain(&mut self, outlook: &Outlook<'_>) -> Option<u32> {
        let (now, samples) = (Instant::now(), outlook.samples());
        self.first.get_or_insert(now);
        self.rounds += 1;
        if let Some((begun, before)) = self.found {
            let foreseen = self.demand.samples(Demand::level(outlook.error().value));
            let seconds = (now - begun).as_secs_f64();
            self.calibration = Some(Calibration { samples: samples - before, foreseen, seconds });
        } else {
            self.demand = Demand::of(outlook);
            self.found = (self.rounds == 2).then_some((now, samples));
        }
        // As many samples as there are: those of a fourth of the pixels at first, the ones that vary most.
        (self.rounds == 1 || now < self.end).then(|| {
            outlook.least_gain_for(outlook.error().value / 2.0).max(outlook.least_gain_within(samples))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames whose square error is their hardness over the number of samples, and a machine.
    struct Simulated {
        hardness: Vec<f64>,
        /// The number of surveyed frames among so many.
        surveyed: fn(usize) -> usize,
        /// Seconds for a sample at a time.
        rate: fn(f64) -> f64,
        within: f64,
    }

    const PIXELS: f64 = 1e5;
    const FIRST: f64 = 0.004;
    const SAMPLE: f64 = 4e-8;

    impl Simulated {
        /// Renders all frames. Returns the time that it took, and the errors of those that took twice the first samples or more.
        fn render(&self) -> (f64, Vec<f64>) {
            let count = self.hardness.len();
            let demand = |hardness: f64, samples: f64| {
                Demand::from_fn(|error| (hardness / (error * error) - samples).max(0.0))
            };
            let mut deadline = Deadline::new(Instant::now(), Duration::from_secs_f64(self.within), count);
            let mut now = 0.0;
            for place in survey_order(count).take((self.surveyed)(count)) {
                deadline.note_demand(place, demand(self.hardness[place], 2.0 * PIXELS), [FIRST, 0.001]);
                now += 2.0 * FIRST;
            }
            deadline.spread_demands();
            let mut errors = Vec::new();
            for (place, hardness) in self.hardness.iter().enumerate() {
                deadline.begin_at(place, now);
                now += FIRST;
                let mut samples = PIXELS;
                loop {
                    let error = (hardness / samples).sqrt();
                    let Some((level, most)) =
                        deadline.next(&demand(*hardness, samples), (samples, error), now)
                    else {
                        break;
                    };
                    // A round doubles the samples at most.
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

    /// Half as fast in the middle third of the time.
    fn disturbed(part: f64) -> f64 {
        if (0.33..0.67).contains(&part) { 2.0 * SAMPLE } else { SAMPLE }
    }

    #[test]
    fn the_time_is_used_and_kept() {
        let busy = |place: usize| if (32..64).contains(&place) { 4e8 } else { 1e6 };
        let sequences = [
            vec![1e7],
            vec![1e7; 24],
            (0..96).map(busy).collect(),
            (0..48_u8).map(|place| 1e7 * (1.0 + 0.9 * libm::sin(f64::from(place)))).collect(),
        ];
        let all: fn(usize) -> usize = |count| count;
        let few: fn(usize) -> usize = |count| count.div_ceil(4);
        for hardness in sequences {
            // Frames that were not surveyed are known less well.
            for (surveyed, less) in [(all, 1.0), (few, 1.5)] {
                // What is lost by the disturbance is not known before.
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
    fn all_frames_are_surveyed_once_in_the_end() {
        for count in 0..200 {
            let mut places: Vec<usize> = survey_order(count).collect();
            places.sort_unstable();
            assert!(places.into_iter().eq(0..count), "{count}");
        }
        // A fifth of the frames leaves no gap of more than twice as many as there would be.
        let mut first: Vec<usize> = survey_order(100).take(20).collect();
        first.sort_unstable();
        assert!(first.windows(2).all(|pair| pair[1] - pair[0] <= 10), "{first:?}");
    }

    #[test]
    fn frames_are_as_good_as_each_other() {
        let hardness: Vec<f64> = (0..24_u32).map(|place| 1e6 * f64::from(1 + place % 7)).collect();
        let simulated = Simulated { hardness, surveyed: |count| count, rate: steady, within: 3.0 };
        let (_, errors) = simulated.render();
        let (least, most) = range(&errors);
        assert!(most < 1.2 * least, "{errors:.2?}");
    }
}
