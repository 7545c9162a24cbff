//! The frames that need each effect, with the reasons.

use rayreel::time::FrameList;
use rayreel::{Effect, Engine, EngineError, Need, RenderRequest};

/// The effects that the chosen frames need.
pub(super) struct PlannedTimeline {
    /// The examined frames, ascending.
    frames: Vec<u32>,
    /// Number of chosen frames, if not all of them are examined.
    spread_over: Option<usize>,
    effects: Vec<EffectSpans>,
}

/// An effect and its need over the examined frames.
pub(super) struct EffectSpans {
    pub(super) effect: Effect,
    /// One span for each distinct need, in the order of first appearance.
    pub(super) spans: Vec<Span>,
}

/// The frames with the same need.
pub(super) struct Span {
    pub(super) need: Need,
    /// First and last frames of runs without gaps among the examined frames.
    runs: Vec<(u32, u32)>,
    count: usize,
    /// True if the span holds all examined frames.
    all: bool,
}

impl PlannedTimeline {
    /// Maximum number of frames examined: seven minutes at 24 frames per second.
    pub(super) const MOST: u32 = 10_000;

    /// Plans these frames, or [`PlannedTimeline::MOST`] of them, spread evenly, if there are more.
    pub(super) fn of(engine: &mut Engine, list: &FrameList) -> Result<Self, EngineError> {
        let spread = list.spread_frames(Self::MOST);
        let spread_over = spread.is_some().then(|| list.count());
        let mut effects: Vec<EffectSpans> =
            Effect::ALL.into_iter().map(|effect| EffectSpans { effect, spans: Vec::new() }).collect();
        let mut frames: Vec<u32> = Vec::new();
        for frame in spread.unwrap_or_else(|| list.frames().collect()) {
            let before = frames.last().copied();
            let time = engine.timeline.time_of(frame);
            let request = RenderRequest { fingerprint: false, ..RenderRequest::at(time) };
            let Some(plan) = &engine.plan(request)?.plan else { continue };
            for needs in &mut effects {
                needs.add(plan.need(needs.effect), frame, before);
            }
            frames.push(frame);
        }
        for span in effects.iter_mut().flat_map(|effect| &mut effect.spans) {
            span.all = span.count == frames.len();
        }
        Ok(Self { frames, spread_over, effects })
    }

    /// Returns the number of examined frames.
    pub(super) fn count(&self) -> usize {
        self.frames.len()
    }

    /// Returns the number of chosen frames, if not all of them are examined.
    pub(super) fn spread_over(&self) -> Option<usize> {
        self.spread_over
    }

    pub(super) fn effects(&self) -> impl Iterator<Item = &EffectSpans> {
        self.effects.iter()
    }

    /// Returns the first, middle and last frame, plus further frames, so that every needed effect is needed in at least one of them.
    pub(super) fn samples(&self) -> Vec<u32> {
        let last = self.frames.len().saturating_sub(1);
        let mut samples: Vec<u32> =
            [0, last / 2, last].into_iter().filter_map(|index| self.frames.get(index).copied()).collect();
        for effect in &self.effects {
            let needed: Vec<&Span> = effect.spans.iter().filter(|span| span.need.is_needed()).collect();
            let measured = needed.iter().any(|span| samples.iter().any(|frame| span.holds(*frame)));
            if let (false, Some(span)) = (measured, needed.first()) {
                samples.push(span.runs[0].0);
            }
        }
        samples.sort_unstable();
        samples.dedup();
        samples
    }

    /// Summarises the needs in a few sentences.
    pub(super) fn describe(&self) -> String {
        let names = |chosen: &dyn Fn(&EffectSpans) -> bool| {
            let names: Vec<_> =
                self.effects.iter().filter(|one| chosen(one)).map(|one| one.effect.name()).collect();
            names.join(", ")
        };
        let always = names(&|effect| effect.is_always_needed());
        let never = self.effects.iter().filter(|effect| !effect.is_ever_needed()).count();
        let at_times = names(&|effect| effect.is_ever_needed() && !effect.is_always_needed());
        let sentence = |start: &str, names: String| {
            if names.is_empty() { String::new() } else { format!("{start} {names}.\n") }
        };
        let others = if never > 0 { format!("the other {never}") } else { String::new() };
        let closely =
            "Of the frames between these nothing is known; --frames looks at some of them one by one.\n";
        [
            sentence("Every frame needs", always),
            sentence("Some need", at_times),
            sentence("No frame needs", others),
            self.spread_over.map_or_else(String::new, |_| closely.to_owned()),
        ]
        .concat()
    }
}

impl EffectSpans {
    fn add(&mut self, need: Need, frame: u32, before: Option<u32>) {
        let index = self.spans.iter().position(|span| span.need == need).unwrap_or_else(|| {
            self.spans.push(Span { need, runs: Vec::new(), count: 0, all: false });
            self.spans.len() - 1
        });
        let span = &mut self.spans[index];
        span.count += 1;
        match span.runs.last_mut() {
            Some((_, last)) if Some(*last) == before => *last = frame,
            _ => span.runs.push((frame, frame)),
        }
    }

    pub(super) fn is_ever_needed(&self) -> bool {
        self.spans.iter().any(|span| span.need.is_needed())
    }

    fn is_always_needed(&self) -> bool {
        self.spans.iter().all(|span| span.need.is_needed())
    }
}

impl Span {
    /// Formats the frames as `all` or `0-40, 60`, shortened if there are many runs.
    pub(super) fn describe(&self) -> String {
        const MOST: usize = 3;
        if self.all {
            return "all".to_owned();
        }
        let run = |(first, last): &(u32, u32)| {
            if first == last { first.to_string() } else { format!("{first}-{last}") }
        };
        let mut words: Vec<_> = self.runs.iter().take(MOST).map(run).collect();
        if self.runs.len() > MOST {
            words.push("..".to_owned());
        }
        words.join(", ")
    }

    fn holds(&self, frame: u32) -> bool {
        self.runs.iter().any(|(first, last)| (*first..=*last).contains(&frame))
    }

    /// Returns the first and last frames of all runs.
    pub(super) fn frames(&self) -> &[(u32, u32)] {
        &self.runs
    }
}
