//! What is done while the requested picture is made.

use std::ops::ControlFlow::{self, Break, Continue};
use std::sync::Arc;

use super::board::Board;
use super::director::{Next, StepRole};
use super::easel::{Easel, Made, PictureKind};
use super::ladder::{Care, LadderStep, Target, Timings};
use super::state::{State, Times};
use super::visits::Visits;
use crate::color::Transfer;
use crate::trace::{Exposure, Film};

/// Looks at the requested picture from time to time: notes how quickly it comes, and shows what there is.
pub(super) struct Onlooker<'a> {
    /// The session's state when it was begun.
    pub(super) state: &'a State,
    pub(super) target: Target,
    pub(super) transfer: Transfer,
    /// The milliseconds that went into it before.
    pub(super) traced_before: f64,
    pub(super) visits: &'a Visits,
    /// Whether any of it has been shown.
    pub(super) is_shown: &'a mut bool,
    pub(super) timings: &'a mut Timings,
    pub(super) easel: &'a mut Easel,
    pub(super) board: &'a Board,
    /// The last coarse picture of the frame on show, and its milliseconds.
    pub(super) last_step: Option<(LadderStep, f64)>,
    /// What is made next, if it is not this picture.
    pub(super) next: &'a mut Next,
}

impl Onlooker<'_> {
    /// Looks at the picture, and says whether to go on with it.
    pub(super) fn visit(&mut self, exposure: &Exposure) -> ControlFlow<()> {
        let since = self.visits.now();
        self.visits.go_on();
        let traced = self.traced_before + self.visits.traced();
        self.timings.note(Care::Whole, traced, rays(exposure.share(), self.target));
        let so_far = share_of_unfinished(exposure);
        // With the speed now known there may be time for another step; after an unfinished picture it would be a step back.
        let step = self.last_step.filter(|_| !*self.is_shown);
        if let Some(finer) = step.and_then(|(step, took)| self.timings.finer(step, took, self.target)) {
            *self.next = Next::Step(finer, StepRole::Between);
            return Break(());
        }
        self.board.change(|state| state.progress = so_far);
        let beneath = self.easel.latest().map(|(_, film)| Arc::clone(film));
        if let Some(beneath) = beneath.filter(|_| self.visits.show()) {
            if !self.show(exposure.develop_over(&beneath), so_far, traced) {
                *self.next = Next::Nothing;
                return Break(());
            }
            self.visits.shown(since);
            self.visits.go_on();
            *self.is_shown = true;
        }
        Continue(())
    }

    /// Puts up what there is of the picture; returns whether that was possible.
    fn show(&mut self, film: Film, so_far: f64, traced: f64) -> bool {
        let made = Made {
            film,
            transfer: self.transfer,
            kind: PictureKind::Coarse(so_far),
            times: Times { trace: traced, ..self.state.times },
            rays: self.state.rays,
            plan: None,
            warnings: Vec::new(),
            rendering: true,
        };
        self.easel.put_up(self.state, made)
    }
}

/// Returns the share of a picture that exists, 0 to 1. How much there is to come where pixels get as many samples as they need is not
/// known before it is there.
pub(super) fn share_of_unfinished(exposure: &Exposure) -> f64 {
    exposure.share().min(0.99)
}

/// Returns the camera rays of a share of a picture: at least those of one sample of a tile, as so many are lost when it is
/// ended.
pub(super) fn rays(share: f64, target: Target) -> u64 {
    const IN_HAND: u64 = 256;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
    let rays = (share * target.rays()) as u64;
    rays.max(IN_HAND)
}
