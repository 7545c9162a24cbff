//! Reuse of the tiles of the frame that a sequence rendered last.

use std::sync::Arc;
use std::time::Duration;

use crate::color::Encoding;
use crate::systems::FrameReport;
use crate::trace::ReusablePicture;

/// Minimum time of a frame of which tiles are reused: copying its film and comparing its scene takes 3 to 6 ms in large frames.
const LEAST: Duration = Duration::from_millis(20);
/// Minimum share of the pixels that must be reused, lest reuse be given up. Scenes that reuse 29 to 85 % take 1.09 to 5 times less time
/// (`benches/reuse.rs`); recording takes up to 5 % more.
const WORTHWHILE: f64 = 0.1;
/// Number of frames after which reuse is tried again. A vain trial records two frames, each of which takes 5 % more instructions in the scene where
/// that costs most (ambient_only): less than 1 % of 18 frames.
const REST: u32 = 16;

/// The frame that a sequence rendered last. Its tiles are reused in the next one, for as long as enough of them are the same.
#[derive(Debug)]
pub struct FormerFrame<E: Encoding> {
    picture: Option<Arc<ReusablePicture<E>>>,
    /// True if the current frame is compared with the picture.
    is_compared: bool,
    /// True if enough of the last frame was reused.
    was_worthwhile: bool,
    /// Time of the last frame of which nothing was reused.
    whole: Duration,
    /// Number of frames until the next trial.
    rest: u32,
}

impl<E: Encoding> Default for FormerFrame<E> {
    fn default() -> Self {
        Self { picture: None, is_compared: false, was_worthwhile: false, whole: Duration::ZERO, rest: 0 }
    }
}

impl<E: Encoding> FormerFrame<E> {
    /// Begins a frame. Returns the picture for [`RenderRequest::reuse`](crate::RenderRequest::reuse), or `None` if the frame is to be
    /// rendered in full.
    pub(super) fn begin(&mut self) -> Option<&mut Option<Arc<ReusablePicture<E>>>> {
        self.is_compared = self.picture.is_some();
        self.is_due().then_some(&mut self.picture)
    }

    fn is_due(&self) -> bool {
        self.rest == 0 && self.whole >= LEAST
    }

    /// Ends a frame, and judges whether reuse is worthwhile: by its share, which does not depend on how busy the machine is.
    pub(super) fn end(&mut self, report: &FrameReport) {
        let was_due = self.is_due();
        self.rest = self.rest.saturating_sub(1);
        let is_worthwhile = report.reused > WORTHWHILE;
        // After worthwhile reuse, a vain one may be due to a cut, and the next frame belongs to the same shot.
        let is_vain = self.is_compared && !is_worthwhile && !self.was_worthwhile;
        // Frames with an error target, for example, are never recorded.
        if is_vain || was_due && self.picture.is_none() {
            (self.picture, self.rest) = (None, REST);
        }
        self.was_worthwhile = is_worthwhile;
        if report.reused == 0.0 {
            self.whole = report.animate + report.prepare + report.trace;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::World;
    use crate::engine::{Engine, RenderRequest};
    use crate::time::Time;

    /// Renders frames that take these times in full, and of which half is reused if they are similar to the former one. Returns which of them
    /// are recorded.
    fn recorded(frames: impl Iterator<Item = (u64, bool)>) -> Vec<bool> {
        let (mut former, mut any) = (FormerFrame::default(), None);
        let request = RenderRequest { reuse: Some(&mut any), ..RenderRequest::at(Time::ZERO) };
        Engine::new(World::new()).render(request).unwrap();
        let record = |(milliseconds, is_similar): (u64, bool)| {
            let is_recorded = former.begin().is_some();
            let reused = if former.is_compared && is_similar { 0.5 } else { 0.0 };
            let trace = Duration::from_millis(milliseconds);
            if is_recorded {
                former.picture.clone_from(&any);
            }
            former.end(&FrameReport { trace, reused, ..FrameReport::default() });
            is_recorded
        };
        frames.map(record).collect()
    }

    #[test]
    fn frames_are_recorded_while_enough_is_reused() {
        let still = recorded((0..40).map(|_| (100, true)));
        assert!(!still[0] && still[1..].iter().all(|is_recorded| *is_recorded));
        let cut = recorded((0..40).map(|frame| (100, frame != 20)));
        assert_eq!(cut, still);
        let quick = recorded((0..40).map(|_| (19, true)));
        assert!(quick.iter().all(|is_recorded| !is_recorded));
    }

    #[test]
    fn vain_trials_are_rare() {
        let moving = recorded((0..70).map(|_| (100, false)));
        let count = moving.iter().filter(|is_recorded| **is_recorded).count();
        assert_eq!(count, 8, "two of 18");
    }
}
